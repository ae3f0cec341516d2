//! Tapes: kernels recorded as vector instructions, which are counted, listed, and executed as on the CRAY.

mod allocation;
mod folding;
mod instruction;
mod interpreter;
mod listing;
mod outline;
mod pool;
mod recorded;
mod recorder;
mod register_file;

pub use instruction::{
    ArrayReference, Effect, Indices, Instruction, Number, Operand, PredicateInstruction, RegisterKind,
    RegisterName, TapeAction,
};
pub use listing::{ListingLine, TapeListing};
pub use outline::{Outline, Outlines, VectorLocation, register_shape};
pub use recorded::Tape;
