//! LAN17: particles in a bath of friction and noise, with Lennard-Jones pairs.

mod benches;
mod dynamics;
mod entry;
pub mod keys;
mod limits;
mod losses;
pub mod options;
mod prepared;
mod presets;
mod programs;
mod scene;
mod simulation;
mod trials;

pub use entry::ENTRY;
