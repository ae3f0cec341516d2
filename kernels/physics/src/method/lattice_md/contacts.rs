//! Search for contacts of granular discs, and execution of the programs of a step.

use super::ListOptions;
use super::fast::FastSearch;
use stripmine_kernels::{Execution, InstructionSet};

/// Search for contacts.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Contacts {
    /// On the lattice: the method of the source.
    Lattice,
    /// Each pair once and the law for contacts only; the machine's execution does not matter.
    Fast(FastSearch),
    /// By neighbour lists: its rival.
    Lists(ListOptions),
}

/// Execution of the programs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Machine {
    /// Eager, strip-mined or chained.
    pub execution: Execution,
    /// The instructions.
    pub set: InstructionSet,
}
