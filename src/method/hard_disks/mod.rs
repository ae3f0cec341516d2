//! ISO99: event-driven hard discs, exact between collisions.

mod benches;
mod collapse;
mod collision_log;
mod compress;
mod engine;
mod entry;
mod event;
mod fast;
mod floor;
mod idle;
mod items;
mod keys;
mod options;
#[cfg(test)]
mod oracle;
mod prepared;
mod presets;
mod reference;
mod restored;
mod scene;
mod sections;
mod simulation;
mod study;
mod verbs;

pub use compress::compress;
pub use entry::ENTRY;
