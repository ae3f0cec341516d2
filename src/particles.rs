//! Particles as a scene knows them, before a method lays them out for itself.

/// Discs in the plane. All columns have one entry a disc.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Particles {
    /// Centres (length).
    pub position: Vec<[f64; 2]>,
    /// Velocities (length/time).
    pub velocity: Vec<[f64; 2]>,
    /// Angular velocities, counter-clockwise (1/time).
    pub omega: Vec<f64>,
    /// Radii (length).
    pub radius: Vec<f64>,
    /// Masses (mass); infinite for a fixed disc.
    pub mass: Vec<f64>,
}

impl Particles {
    /// How many there are.
    pub fn len(&self) -> usize {
        self.position.len()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.position.is_empty()
    }
}
