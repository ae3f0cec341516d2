//! How contacts of granular discs are found, and how the programs of a step are run.

use super::ListOptions;
use super::fast::FastSearch;
use stripmine_kernels::{Execution, InstructionSet};

/// How contacts are found.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Contacts {
    /// On the lattice: the method of the source.
    Lattice,
    /// Each pair once and the law for contacts only; the machine's execution does not matter.
    Fast(FastSearch),
    /// By neighbour lists: its rival.
    Lists(ListOptions),
}

/// How the programs are run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Machine {
    /// How instructions meet elements.
    pub execution: Execution,
    /// The instructions.
    pub set: InstructionSet,
}
