//! ISO99: event-driven hard discs, exact between collisions.

pub mod benches;
mod checked;
mod collapse;
mod collision_log;
mod compress;
mod engine;
mod entry;
mod event;
mod fall;
mod fast;
mod floor;
mod idle;
pub mod keys;
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

pub use compress::compress;
pub use entry::ENTRY;
