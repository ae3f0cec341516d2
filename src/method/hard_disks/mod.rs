//! ISO99: event-driven hard discs, exact between collisions.

mod benches;
mod choice;
mod collapse;
mod engine;
mod entry;
mod event;
mod grid;
mod keys;
mod prepared;
mod presets;
mod scene;
mod simulation;
mod tournament;

pub use entry::ENTRY;
