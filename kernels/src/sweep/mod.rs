//! How a law meets its pairs.

pub mod lattice;
