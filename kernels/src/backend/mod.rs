//! The machines a text runs on: register files (scalar, `pulp`, `wide`) and the tape.

mod dispatch;
mod pulp;
mod registers;
mod scalar;
pub mod tape;
mod wide;

pub use dispatch::{GROUP, InstructionSet};
pub(crate) use dispatch::{Task, dispatch};
pub use pulp::{Pulp, PulpElement};
pub(crate) use registers::Strip;
pub use registers::{IndexLanes, Registers};
pub use scalar::Scalar;
pub use tape::{Listing, Tape};
pub use wide::{Wide, WideElement};

/// A precision that every register file has lanes for.
pub trait Precision: PulpElement + WideElement {}

impl Precision for f64 {}
impl Precision for f32 {}
