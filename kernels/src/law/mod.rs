//! Pair laws: forces between two particles, written once for every machine and every sweep.

mod environment;
pub mod granular;
pub mod gravity;
pub mod lennard_jones;
pub mod potential;
mod quantity;
pub mod spring;
mod stated;
mod table;
pub mod tabulated;
pub mod yukawa;

pub use environment::{Env, Law, ObservationRequest, WallCoefficient};
pub use quantity::{Axis, ParticleField, ParticleSum};
pub use stated::{StatedEnv, check};
pub use table::LawTable;
