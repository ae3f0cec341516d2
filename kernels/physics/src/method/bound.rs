//! Vector programs of a scene with the arrays that they work on, for execution on another machine.

use std::ops::Range;
use stripmine_kernels::Runnable;
use stripmine_kernels::isa::Memory;

/// Call of a program over a range of elements.
#[derive(Clone)]
pub struct ProgramCall<'p> {
    /// Part of the step.
    pub part: &'static str,
    /// The program.
    pub program: &'p dyn Runnable,
    /// Elements that it runs over.
    pub range: Range<usize>,
}

/// Receives the programs of a step, or of its forces, in order, with their arrays at the start.
pub type BoundPrograms<'t> = dyn FnMut(&[ProgramCall<'_>], &Memory<'_>) + 't;
