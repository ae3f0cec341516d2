//! Discs of a sample.

/// Discs present, in the order of the scene, in columns.
#[derive(Clone, Debug, Default)]
pub(super) struct SampledDiscs {
    pub(super) x: Vec<f64>,
    pub(super) y: Vec<f64>,
    pub(super) vx: Vec<f64>,
    pub(super) vy: Vec<f64>,
    pub(super) radius: Vec<f64>,
    pub(super) mass: Vec<f64>,
    /// Number of its species from 0.
    pub(super) species: Vec<u8>,
}
