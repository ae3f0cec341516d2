//! ISO99: event-driven hard discs, exact between collisions.

pub(crate) mod benches;
mod checked;
mod collapse;
mod collision_log;
mod compress;
mod engine;
mod entry;
mod event;
mod failures;
mod fall;
mod fast;
mod floor;
mod followed;
mod foreseen;
mod idle;
pub mod keys;
mod operations;
pub mod options;
#[cfg(test)]
mod oracle;
mod prepared;
mod presets;
mod quantities;
pub mod reference;
mod restored;
mod scene;
mod simulation;
mod squeezed;
mod sums;

pub use compress::compress;
pub use entry::ENTRY;

use crate::method::FailureKind;

/// An event that lies before one that has happened.
pub(crate) const BACK_IN_TIME: FailureKind = FailureKind::new("back-in-time");

/// Collisions without end in a finite time.
pub const INELASTIC_COLLAPSE: FailureKind = FailureKind::new("inelastic-collapse");

/// Discs that lie still, where contacts do not last.
pub(crate) const RESTING: FailureKind = FailureKind::new("resting");

/// Nothing will ever happen.
pub(crate) const IDLE: FailureKind = FailureKind::new("idle");
