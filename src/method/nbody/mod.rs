//! PWP: bodies in space that all attract each other, by softened gravity with G = 1.

mod benches;
mod bodies;
mod choice;
mod conserved;
mod encounter;
mod entry;
mod field;
mod items;
mod keys;
mod options;
mod prepared;
mod presets;
mod rounded;
mod scene;
mod schemes;
mod sections;
mod shifted;
mod simulation;
mod starts;
mod study;
mod swept;
#[cfg(test)]
mod tests;
mod trials;
mod watch;

pub use entry::ENTRY;
