//! The fast engine's sweep: each pair is met once, contacts are looked for first, and the law is asked about contacts only.
//!
//! ```text
//! for every band of rows, in two stages:            Sweep      bands.rs
//!     until the rows are searched:
//!         find some 500 pairs that may touch        Finder     lattice/, sectors.rs, verlet.rs
//!         law for a register of pairs at a time     Evaluate   contacts.rs
//!         add to the sums, pair by pair
//! for every disc:                                   Advance    advance.rs
//!     correct with its sums, predict the next step, list it if it left its cell
//! ```
//!
//! Why it is fast:
//!
//! - *Each pair once.* A pair is found from one of its discs only, the one that comes first, so half of the pairs are tried,
//!   and the law is evaluated once for both discs.
//! - *Found first, computed later.* Most pairs that are near are no contacts, and the law is costly (a root, two divisions,
//!   velocities to load). The search compares distances only, on the lattice in single precision with a margin; the law
//!   then sees registers nearly full of contacts, in full precision.
//! - *Some 500 pairs at a time.* The pairs and the columns of their discs are still in the first-level cache when the law
//!   reads them.
//! - *One pass for corrector and predictor.* The state is read and written once a step.
//!
//! A [`Finder`] finds pairs that may touch: every pair that does, once, and some others; whether two discs touch is the law's
//! to decide. On the [`lattice`] an [`Occupancy`](lattice::Occupancy) keeps which disc is in which cell, brought up to date
//! by the discs that change cells. Its rivals are [`Sectors`], which hold any number of discs, and the [`VerletList`] with a
//! skin.
//!
//! Sums are in the finder's order, one contact after the other, inside bands of rows that depend on the scene alone:
//! instruction set, threads and the order of the discs in memory change no bit.

mod advance;
mod bands;
mod contacts;
mod finder;
mod grid;
pub mod lattice;
mod near;
mod pairs;
mod sectors;
mod verlet;

pub use advance::{Advance, Copies, DisplacementLimit, Motion, Passed};
pub use bands::{Met, OfBand, Sweep};
pub use contacts::Discs;
pub use finder::{Cursor, Finder, Rows, Share};
pub use grid::{Grid, GridError};
pub use pairs::{Pairs, SENTINELS, Touches};
pub use sectors::Sectors;
pub use verlet::VerletList;
