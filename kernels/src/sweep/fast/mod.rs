//! Fast sweep: each pair is visited once, contacts are found first, and the law is evaluated for contacts only.
//!
//! ```text
//! for every band of rows, in two stages:            Sweep      bands.rs
//!     until the rows are searched:
//!         find some 500 pairs that may touch        Finder     lattice/, sectors.rs, verlet.rs
//!         law for a register of pairs at a time     Evaluate   contacts.rs, of records (records.rs)
//!         add to the sums, pair by pair
//! for every disc:                                   Advance    advance.rs
//!     correct with its sums, predict the next step, list it if it left its cell
//! ```
//!
//! Reasons for its speed:
//!
//! - *Each pair once.* A pair is found from its first disc only. So half of the pairs are tried, and one evaluation of the law
//!   serves both discs.
//! - *Search first, evaluation later.* Most near pairs are not in contact, and the law is expensive (a root, two divisions,
//!   velocities to load). The search compares distances only, on the lattice in single precision with a margin. The law then sees
//!   registers nearly full of contacts, in full precision.
//! - *Some 500 pairs at a time.* The pairs and the columns of their discs are still in the first-level cache when the law reads
//!   them.
//! - *One pass for corrector and predictor.* The state is read and written once a step.
//!
//! A [`Finder`] finds pairs that may touch: every touching pair once, and some others; the law decides whether two discs touch.
//! On the [`lattice`] an [`Occupancy`](lattice::Occupancy) stores which disc is in which cell and is updated with the discs that
//! change cells. The alternatives are [`Sectors`], which hold any number of discs, and the [`VerletList`] with a skin.
//!
//! Sums are in the finder's order, one contact after the other, inside bands of rows that depend on the scene alone. So
//! instruction set, threads and the order of the discs in memory change no bit.

mod advance;
mod bands;
mod contacts;
mod finder;
mod grid;
pub mod lattice;
mod motion;
mod near;
mod pairs;
mod records;
mod sectors;
mod verlet;

pub use advance::{Advance, DisplacementLimit, PassReport, PositionCopies};
pub use bands::{BandReport, Sweep, SweepReport};
pub use finder::{Finder, RankShare, RowLayout, SearchCursor};
pub use grid::{CellGrid, GridError};
pub use motion::EquationOfMotion;
pub use pairs::{CellOffset, PairBuffer, PairSequence, SENTINELS};
pub use records::{ForceRecords, RecordEntry, RecordPart, StateRecords};
pub use sectors::Sectors;
pub use verlet::VerletList;
