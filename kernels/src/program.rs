//! Programs: kernels recorded once, checked before every run, and executed in one of several ways.

use crate::backend::tape::Outlines;
use crate::backend::{
    GROUP, InstructionSet, ListingLine, Precision, RegisterTask, Registers, Scalar, Strip, Tape, dispatch,
};
use crate::emit::{EmitError, EmittedKernel, GroupSize, emit};
use crate::isa::{Footprint, Kernel, Memory, OpCounts, ProgramError, Storage};
use crate::threads::{on_threads, pieces};
use std::ops::Range;

/// Order in which instructions and elements are processed. All executions give the same bits.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Execution {
    /// Every instruction is a pass over all elements: the unchained CRAY.
    Eager,
    /// The kernel runs instruction by instruction on strips of this many elements.
    Strip(usize),
    /// The kernel is compiled for one register at a time: every result feeds the next instruction directly.
    Chained,
}

/// A kernel with its tape: the same operations are counted, listed and executed.
#[derive(Clone, Debug)]
pub struct Program<T: Kernel> {
    text: T,
    tape: Tape<T::Lane>,
    footprint: Footprint,
}

impl<T: Kernel> Program<T> {
    /// Records the kernel.
    ///
    /// # Panics
    /// If the kernel writes an array that it also reads at a shift: its result would depend on the strip length.
    pub fn new(text: T) -> Self {
        let tape = Tape::record(&text);
        let footprint = tape.footprint();
        let hazard = footprint.accesses().iter().find(|a| a.writes && (a.lowest, a.highest) != (0, 0));
        assert!(
            hazard.is_none(),
            "{} is written and read at a shift, so results would depend on the strip length",
            hazard.map_or("", |access| access.array.label()),
        );
        Program { text, tape, footprint }
    }

    /// A kernel recorded as `tape`; all its accesses are within `footprint`.
    pub(crate) fn with_footprint(text: T, tape: Tape<T::Lane>, footprint: Footprint) -> Self {
        Program { text, tape, footprint }
    }

    /// Recorded instructions.
    pub fn tape(&self) -> &Tape<T::Lane> {
        &self.tape
    }

    /// The kernel.
    pub fn kernel(&self) -> &T {
        &self.text
    }
}

impl<T: Kernel> Program<T>
where
    T::Lane: Precision,
{
    /// Runs the kernel for the elements of `range` of the memory's arrays.
    ///
    /// # Errors
    /// [`ProgramError`] names the array that is missing, too short or read-only, a strip length of zero, or an instruction set
    /// that the processor lacks. Nothing was executed then.
    pub fn run(
        &self,
        memory: &Memory<'_>,
        range: Range<usize>,
        execution: Execution,
        set: InstructionSet,
    ) -> Result<(), ProgramError> {
        memory.admit(&self.footprint, &range)?;
        match execution {
            Execution::Strip(0) => Err(ProgramError::EmptyStrip),
            Execution::Eager => T::Lane::interpret(&self.tape, memory, range.clone(), range.len(), set),
            Execution::Strip(length) => T::Lane::interpret(&self.tape, memory, range, length, set),
            Execution::Chained => dispatch(set, ChainedRun { text: &self.text, memory, range }),
        }
    }
}

impl<T: Kernel + Sync> Program<T>
where
    T::Lane: Precision,
{
    /// Runs the kernel as [`Program::run`] does, on the threads of the current `rayon` pool. Elements are cut into bands, which
    /// depend on `range` alone. A kernel with dependent elements (a scatter) runs on one thread.
    ///
    /// # Errors
    /// As [`Program::run`].
    pub fn run_on_threads(
        &self,
        memory: &Memory<'_>,
        range: Range<usize>,
        execution: Execution,
        set: InstructionSet,
    ) -> Result<(), ProgramError> {
        let alone = rayon::current_num_threads() == 1 || range.len() <= BAND;
        if alone || execution == Execution::Eager || !self.footprint.is_elementwise() {
            return self.run(memory, range, execution, set);
        }
        memory.admit(&self.footprint, &range)?;
        in_bands(memory, range, &|part, band| self.run(part, band, execution, set))
    }
}

/// Function that runs a kernel over one band.
type BandRun<'r> = dyn Fn(&Memory<'_>, Range<usize>) -> Result<(), ProgramError> + Sync + 'r;

/// Runs a kernel over bands of a range, each with a part of the memory. The kernel is called through a pointer, so that this
/// function is compiled once. The memory was admitted, and the kernel is elementwise.
fn in_bands(memory: &Memory<'_>, range: Range<usize>, run: &BandRun<'_>) -> Result<(), ProgramError> {
    let shared = SharedMemory(memory);
    let counters = on_threads(pieces(range, BAND), |band| {
        // SAFETY: bands do not overlap. The kernel writes only the own element, and reads at shifts only arrays that it does not
        // write.
        let part = unsafe { shared.part() };
        run(&part, band).map(|()| part.counters())
    });
    let counters: Result<Vec<_>, _> = counters.into_iter().collect();
    counters?.into_iter().for_each(|more| memory.join(more));
    Ok(())
}

/// Elements of a band: enough to be worth a thread.
const BAND: usize = 256 * GROUP;

/// A memory whose parts several threads use.
struct SharedMemory<'r, 'a>(&'r Memory<'a>);

// SAFETY: `part` copies the columns and touches no counter; the caller is responsible for their use by the threads.
unsafe impl Sync for SharedMemory<'_, '_> {}

impl SharedMemory<'_, '_> {
    /// Part of the memory, see [`Memory::part`].
    ///
    /// # Safety
    /// As [`Memory::part`].
    unsafe fn part(&self) -> Memory<'_> {
        // SAFETY: the caller promises that no element is written through one part and touched through another.
        unsafe { self.0.part() }
    }
}

/// A program with its kernel type erased, for the lists of a method.
pub trait Runnable: Send + Sync {
    /// Runs the kernel on threads, see [`Program::run_on_threads`].
    ///
    /// # Errors
    /// As [`Program::run_on_threads`].
    fn run(
        &self,
        memory: &Memory<'_>,
        range: Range<usize>,
        execution: Execution,
        set: InstructionSet,
    ) -> Result<(), ProgramError>;

    /// Precision of the lanes, and sizes in bytes of the register files that an execution allocates for a range of elements:
    /// numbers, predicates, indices. Programs of one precision share them. They are zero where instructions feed each other.
    ///
    /// # Errors
    /// [`ProgramError::NoSuchInstructionSet`] if this processor lacks it.
    fn register_bytes(
        &self,
        range: &Range<usize>,
        execution: Execution,
        set: InstructionSet,
    ) -> Result<(&'static str, [usize; 3]), ProgramError>;

    /// Operations executed, section by section.
    fn tally(&self) -> Vec<(&'static str, OpCounts)>;

    /// Bytes of an element's loads and stores, section by section.
    fn moved_bytes(&self) -> Vec<u64>;

    /// Vector instructions as an assembly listing.
    fn listing(&self) -> String;

    /// Vector instructions in words.
    fn lines(&self) -> Vec<ListingLine>;

    /// Outlines of the vector instructions and of the passes that execute them, for a timing model.
    fn outlines(&self) -> Outlines;

    /// The kernel as a function of RISC-V vector code.
    ///
    /// # Errors
    /// As [`emit`](crate::emit::emit).
    fn emitted(&self, size: GroupSize) -> Result<EmittedKernel, EmitError>;
}

impl<T: Kernel + Send + Sync> Runnable for Program<T>
where
    T::Lane: Precision,
{
    fn run(
        &self,
        memory: &Memory<'_>,
        range: Range<usize>,
        execution: Execution,
        set: InstructionSet,
    ) -> Result<(), ProgramError> {
        self.run_on_threads(memory, range, execution, set)
    }

    fn register_bytes(
        &self,
        range: &Range<usize>,
        execution: Execution,
        set: InstructionSet,
    ) -> Result<(&'static str, [usize; 3]), ProgramError> {
        let bytes = match execution {
            Execution::Chained => [0; 3],
            Execution::Eager => T::Lane::register_bytes(&self.tape, range.len(), set)?,
            Execution::Strip(length) => T::Lane::register_bytes(&self.tape, length.min(range.len()), set)?,
        };
        Ok((T::Lane::NAME, bytes))
    }

    fn tally(&self) -> Vec<(&'static str, OpCounts)> {
        self.tape.tally()
    }

    fn moved_bytes(&self) -> Vec<u64> {
        self.tape.moved_bytes()
    }

    fn listing(&self) -> String {
        self.tape.listing().to_string()
    }

    fn lines(&self) -> Vec<ListingLine> {
        self.tape.lines()
    }

    fn outlines(&self) -> Outlines {
        self.tape.outlines()
    }

    fn emitted(&self, size: GroupSize) -> Result<EmittedKernel, EmitError> {
        emit(&self.tape, size)
    }
}

/// An admitted run of a kernel compiled for registers.
struct ChainedRun<'r, T> {
    text: &'r T,
    memory: &'r Memory<'r>,
    range: Range<usize>,
}

impl<T: Kernel> RegisterTask<T::Lane> for ChainedRun<'_, T>
where
    T::Lane: Precision,
{
    /// Runs the kernel on full registers, and on the rest element by element.
    #[inline(always)]
    fn on<R: Registers<Lane = T::Lane>>(self, registers: R) {
        let Range { start: mut base, end } = self.range;
        while base + R::LANES <= end {
            self.text.body(Strip::new(registers, self.memory, base));
            base += R::LANES;
        }
        self.elements(base);
    }
}

impl<T: Kernel> ChainedRun<'_, T>
where
    T::Lane: Precision,
{
    /// Runs the kernel element by element from `base` on. The bits are the same, so one copy serves all register files.
    #[inline(never)]
    fn elements(&self, mut base: usize) {
        while base < self.range.end {
            self.text.body(Strip::new(Scalar::default(), self.memory, base));
            base += 1;
        }
    }
}
