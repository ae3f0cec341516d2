//! The lattice algorithm, executed fast: each pair is met once, contacts are looked for first, and the law is asked
//! about contacts only.
//!
//! [`Occupancy`] keeps which disc is in which cell, brought up to date by the discs that change cells; beside it the
//! discs' places inside their cells, in single precision. A [`Sweep`] compares these in registers of neighbouring cells
//! (a superset of the contacts: whether two discs touch is the law's to decide; a sparse lattice is searched disc by
//! disc instead), and evaluates the law, in full precision, for what it found, gathered. [`Advance`] is corrector and
//! next predictor in one pass.
//!
//! Sums are in order of cells and places, one contact after the other, inside bands of rows that depend on the lattice
//! alone: instruction set, threads and the order of the discs in memory change no bit.

mod advance;
mod bands;
mod contacts;
mod finder;
pub mod lattice;
mod sectors;
mod verlet;

pub use advance::{Advance, Copies, Leash, Motion};
pub use bands::{Met, Sweep};
pub use contacts::Discs;
pub use finder::{Cursor, Finder, Pairs, Rows};
pub use sectors::{Grid, Sectors, Touches};
pub use verlet::VerletList;

/// Elements behind the discs' own in every column that a sweep reads: two discs that never touch, which fill up
/// registers.
pub const SENTINELS: usize = 2;
