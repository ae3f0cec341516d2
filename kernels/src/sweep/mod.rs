//! Sweeps: they find the pairs of particles and evaluate a law for each.

pub mod all_pairs;
pub mod fast;
pub mod lattice;
pub mod neighbor_list;
pub mod pair;
pub mod walls;
