//! What a simulation knows of each of its particles.

use crate::particles::{Particles, States};

/// Data of each particle as it stands. A new output of this kind is one function here, with what it is where nothing better is known,
/// and one where it is known.
pub trait PerParticle {
    /// The particles, positions inside the box.
    fn particles(&self) -> Particles;

    /// Places and velocities of the grains in the plane, places inside the box.
    fn states(&self, states: &mut States) {
        states.take_up(&self.particles());
    }

    /// Positions alone, in single precision, one for each particle of the start in its order; no numbers where one is lost.
    fn positions(&self) -> Vec<[f32; 3]> {
        self.particles().positions()
    }

    /// How many periods each particle has moved along x and y since the start, in the order of [`particles`](Self::particles); empty
    /// where that is not followed along every periodic side.
    fn images(&self) -> Vec<[i32; 2]> {
        vec![]
    }
}
