//! Studies of particles in a bath.

pub(super) mod accuracy;
pub(super) mod diffusion;
pub(super) mod losses;
pub(super) mod sectors;

/// Parts of a run, each a measurement; their scatter gives the error.
const PARTS: usize = 20;
