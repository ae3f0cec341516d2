//! Lattice molecular dynamics of granular discs, BP93: every step is a sequence of vector programs over the discs and
//! over a lattice with at most one disc a cell. Beside it, on the same state and with the same law, the rival that the
//! source compares with: scalar neighbour lists.

mod arrays;
mod crossings;
mod fast;
mod model;
mod neighbor_list;
mod programs;
mod simulation;
mod walls;
mod watch;

pub use arrays::{Arrays, Lengths};
pub use fast::{OnConflict, Search};
pub use model::{Discs, GearValues, Model, OnLongStep, Scheme, Watch};
pub use neighbor_list::{ListOptions, Rebuild};
pub use programs::{Part, StepProgram, execute, ledger, programs, rival_ledger};
pub use simulation::{Contacts, LatticeMd, Machine, start};
