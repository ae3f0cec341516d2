//! The fast execution: each pair is met once, contacts are looked for first, and the law is asked about contacts only.
//!
//! A [`Finder`] finds pairs that may touch: whether two discs do is the law's to decide. On the [`lattice`] an
//! [`Occupancy`](lattice::Occupancy) keeps which disc is in which cell, brought up to date by the discs that change
//! cells, and beside it the discs' places inside their cells, in single precision, which are compared in registers of
//! neighbouring cells. Its rivals are [`Sectors`], which hold any number of discs, and the [`VerletList`] with a skin.
//! A [`Sweep`] evaluates the law, in full precision, for what was found, gathered. [`Advance`] is corrector and next
//! predictor in one pass.
//!
//! Sums are in the finder's order, one contact after the other, inside bands of rows that depend on the scene alone:
//! instruction set, threads and the order of the discs in memory change no bit.

mod advance;
mod bands;
mod contacts;
mod finder;
pub mod lattice;
mod sectors;
mod verlet;

pub use advance::{Advance, Copies, Leash, Motion, Passed};
pub use bands::{Met, Sweep};
pub use contacts::Discs;
pub use finder::{Cursor, Finder, Pairs, Rows};
pub use sectors::{Grid, GridError, Sectors, Touches};
pub use verlet::VerletList;

/// Elements behind the discs' own in every column that a sweep reads: two discs that never touch, which fill up
/// registers.
pub const SENTINELS: usize = 2;
