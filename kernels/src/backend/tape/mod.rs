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
    Action, Effect, File, Indices, Instruction, Number, Operand, Reference, RegisterName, Truth,
};
pub use listing::{Line, Listing};
pub use outline::{Outline, Outlines, Place, register_shape};
pub use recorded::Tape;
