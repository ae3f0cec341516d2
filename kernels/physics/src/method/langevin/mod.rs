//! LAN17: particles in a bath of friction and noise, with pair forces or without.

mod benches;
mod checked;
mod dynamics;
mod entry;
mod found;
pub mod keys;
pub mod laws;
mod limits;
mod losses;
pub mod options;
mod prepared;
mod presets;
mod programs;
mod quantities;
mod scene;
mod simulation;
mod trials;

pub use entry::ENTRY;

use crate::method::FailureKind;

/// More particles were thrown out than the scene allows.
pub(crate) const LOST: FailureKind = FailureKind::new("lost");
