//! Similarity of scenes: decides whether timings of one scene apply to another.

use crate::study::StudyCase;
use serde::{Deserialize, Serialize};
use std::f64::consts::PI;

/// Largest ratio of particle counts and largest difference of packing fractions between similar scenes: crossings of costs lie farther apart.
const PARTICLES: f64 = 2.0;
const PACKING: f64 = 0.05;

/// Properties of a scene that decide which configuration is the fastest.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct SceneFeatures {
    method: String,
    particles: usize,
    /// Area of the particles over that of the box; 0 where the box has no area.
    packing_fraction: f64,
}

impl SceneFeatures {
    /// Returns the properties of a scene.
    pub(super) fn of(case: &StudyCase) -> SceneFeatures {
        let particles = case.prepared.particles();
        let discs: f64 = particles.grains().iter().map(|it| PI * it.radius * it.radius).sum();
        let packing_fraction = discs / case.prepared.domain.area();
        SceneFeatures {
            method: case.entry.vocabulary.keys.method.to_owned(),
            particles: particles.grain_count(),
            packing_fraction: if packing_fraction.is_finite() { packing_fraction } else { 0.0 },
        }
    }

    /// Distance between two scenes, 0 for equal ones; none where they are not similar.
    pub(super) fn feature_distance(&self, other: &SceneFeatures) -> Option<f64> {
        let of_particles = (self.particles.max(1) as f64 / other.particles.max(1) as f64).ln().abs();
        let apart = (of_particles / PARTICLES.ln())
            .max((self.packing_fraction - other.packing_fraction).abs() / PACKING);
        (self.method == other.method && apart <= 1.0).then_some(apart)
    }
}
