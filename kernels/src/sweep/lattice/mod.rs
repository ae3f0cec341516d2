//! The exclusive lattice of BP93: at most one disc a cell, so that every neighbour is a fixed shift away.
//!
//! A step sweeps it in vector programs, each a text of its own: [`cells::Clear`], [`cells::Enter`], [`cells::Check`]
//! and [`cells::Images`] keep the Index, [`vectors::Spread`] maps the discs' quantities to lattice vectors,
//! [`forces::Forces`] runs a law over the places of a mask.

pub mod cells;
pub mod forces;
mod shape;
pub mod vectors;

pub use shape::{Coordinates, Frame, Image, LatticeShape, ShapeError};
