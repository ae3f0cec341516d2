//! Studies of particles in a heat bath.

pub(super) mod accuracy;
pub(super) mod diffusion;
pub(super) mod losses;
mod output;
pub(super) mod sectors;

/// Blocks of a run; the error of a mean follows from the scatter of the block means.
const PARTS: usize = 20;
