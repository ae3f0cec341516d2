//! Studies of particles in a bath.

pub mod accuracy;
pub mod diffusion;
pub mod losses;
pub mod sectors;

/// Parts of a run, each a measurement; their scatter gives the error.
const PARTS: usize = 20;
