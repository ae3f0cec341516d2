//! LAN17: particles in a bath of friction and noise, with Lennard-Jones pairs.

mod benches;
mod dynamics;
mod entry;
mod items;
mod keys;
mod limits;
mod losses;
mod options;
mod prepared;
mod presets;
mod programs;
mod scene;
mod sections;
mod simulation;
mod study;
mod trials;

pub use entry::ENTRY;
