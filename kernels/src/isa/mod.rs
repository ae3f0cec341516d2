//! Instruction set: the interface of kernels to the machine, and the table of operations.

pub mod aligned_column;
mod element;
mod footprint;
pub(crate) mod list;
mod machine;
mod memory;
pub mod op;
mod slot;
mod vector;

pub use aligned_column::AlignedColumn;
pub use element::{Element, Storage};
pub use footprint::{Access, Footprint};
pub(crate) use machine::is_same_storage;
pub use machine::{Kernel, Machine};
pub(crate) use memory::ArrayColumn;
pub use memory::{COUNTERS, LaneCounter, Memory, ProgramError};
pub use op::{Op, OpClass, OpCounts};
pub use slot::{Array, Slot};
pub use vector::{Predicate, Vector};
