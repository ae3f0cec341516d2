//! What is measured of particles in a bath beside a run: each study a file, its section of the report in `sections`.

pub mod accuracy;
pub mod diffusion;
pub mod losses;
pub mod sectors;

pub use crate::statistics::Mean;

/// Parts of a run, each a measurement; their scatter gives the error.
pub const PARTS: usize = 20;
