//! Machines that a kernel runs on: register files (scalar, `pulp`, `wide`) and the tape.

mod dispatch;
mod estimated;
mod precision;
mod pulp;
mod registers;
mod scalar;
pub mod tape;
mod values;
mod wide;

pub(crate) use dispatch::dispatch_estimating;
pub(crate) use dispatch::{GROUP, dispatch};
pub use dispatch::{InstructionSet, RegisterTask, dispatch_best, dispatch_native};
pub use estimated::EstimatingElement;
pub use precision::Precision;
pub use pulp::{Pulp, PulpElement};
pub(crate) use registers::Strip;
pub(crate) use registers::coordinates::coordinate_pair;
pub use registers::records::RecordPlaces;
pub(crate) use registers::records::{QUAD, block, registers_of};
pub use registers::{IndexLanes, Registers};
pub use scalar::Scalar;
pub use tape::{ListingLine, Tape, TapeListing};
pub use wide::{Wide, WideElement};
