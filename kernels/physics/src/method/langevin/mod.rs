//! Langevin dynamics (LAN17): particles in a bath of friction and noise, with or without pair forces.

mod benches;
mod checked;
mod chosen_search;
mod dynamics;
mod entry;
pub mod keys;
pub mod laws;
mod limits;
mod losses;
pub mod options;
mod pair_table;
mod prepared;
mod presets;
mod programs;
mod quantities;
mod scene;
mod simulation;
mod trials;

pub use entry::ENTRY;

use crate::method::FailureKind;

/// More particles were lost than the scene allows.
pub(crate) const LOST: FailureKind = FailureKind::new("lost");
