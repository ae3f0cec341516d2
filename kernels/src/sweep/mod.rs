//! How a law meets its pairs.

pub mod all_pairs;
pub mod fast;
pub mod lattice;
pub mod neighbor_list;
pub mod pair;
