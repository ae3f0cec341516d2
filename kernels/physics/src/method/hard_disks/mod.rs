//! Event-driven hard discs, exact between collisions (ISO99).

pub(crate) mod benches;
mod checked;
mod collapse;
mod collision_log;
mod compress;
mod configuration;
mod engine;
mod entry;
mod event;
mod failures;
mod fall;
mod fast;
mod floor;
mod followed;
mod forecast;
mod identities;
mod idle;
pub mod keys;
mod operations;
pub mod options;
#[cfg(test)]
mod oracle;
mod overlap_repair;
mod prepared;
mod presets;
mod quantities;
pub mod reference;
mod restored;
mod scene;
mod simulation;
mod sums;

pub use compress::compress;
pub use entry::ENTRY;

use crate::method::FailureKind;

/// An event earlier than one that has happened.
pub(crate) const BACK_IN_TIME: FailureKind = FailureKind::new("back-in-time");

/// Infinitely many collisions in a finite time.
pub const INELASTIC_COLLAPSE: FailureKind = FailureKind::new("inelastic-collapse");

/// Discs at rest, which hard discs without lasting contacts cannot represent.
pub(crate) const RESTING: FailureKind = FailureKind::new("resting");

/// No event will ever happen.
pub(crate) const IDLE: FailureKind = FailureKind::new("idle");
