//! The exclusive lattice of BP93: at most one disc per cell, so that every neighbour is at a fixed shift.
//!
//! A step runs these kernels: [`cells::ClearIndex`], [`cells::EnterDiscs`], [`cells::CheckIndex`] and [`cells::IndexImages`] update the Index,
//! [`vectors::SpreadToLattice`] gathers the discs' quantities into lattice vectors, and [`forces::Forces`] evaluates a law at the offsets
//! of a mask.

pub mod cells;
pub mod forces;
mod shape;
pub mod vectors;

pub use shape::{Coordinates, Image, LatticeFrame, LatticeShape, ShapeError};
