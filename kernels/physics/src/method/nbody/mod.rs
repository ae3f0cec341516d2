//! Bodies in space under softened all-pairs gravity (PWP).

mod benches;
pub mod bodies;
mod checked;
mod choice;
mod conserved;
mod encounter;
mod entry;
mod failures;
pub mod field;
mod imported;
pub mod keys;
mod monitor;
pub mod options;
mod prepared;
mod presets;
mod quantities;
mod ranked;
mod rounded;
pub mod scene;
pub mod schemes;
mod shifted;
mod simulation;
pub mod starts;
mod sums;
mod swept;
#[cfg(test)]
mod tests;
mod trials;

pub use entry::ENTRY;

use crate::method::FailureKind;

/// Bodies so near to each other that the clock cannot resolve their motion.
pub(crate) const COLLISION: FailureKind = FailureKind::new("collision");
/// Bodies that were bound have become unbound.
pub(crate) const UNBOUND: FailureKind = FailureKind::new("unbound");
