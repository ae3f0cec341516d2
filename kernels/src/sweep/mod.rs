//! Sweeps: they find the pairs of particles and evaluate a law for each.

pub mod all_pairs;
pub mod fast;
pub mod lattice;
mod lookup;
pub mod neighbor_list;
pub mod pair;
pub mod walls;
