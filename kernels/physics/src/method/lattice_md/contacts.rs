//! Search for contacts of granular discs, and execution of the programs of a step.

use super::ListOptions;
use super::fast::FastSearch;
use stripmine_kernels::{Execution, InstructionSet};

/// Search for contacts.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ContactSearch {
    /// On the lattice: the method of BP93.
    Lattice,
    /// Visits each pair once and evaluates the law for contacts only; the machine's execution does not matter.
    Fast(FastSearch),
    /// By neighbour lists: BP93's alternative.
    Lists(ListOptions),
}

/// Execution of the programs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ProgramExecution {
    /// Eager, strip-mined or chained.
    pub execution: Execution,
    /// Instruction set.
    pub set: InstructionSet,
}
