//! A text made ready to run: recorded once, checked before every run, executed in one of several ways.

use crate::backend::tape::Outlines;
use crate::backend::{
    GROUP, InstructionSet, Line, Precision, Registers, Scalar, Strip, Tape, Task, dispatch,
};
use crate::isa::{Footprint, Memory, OpCounts, ProgramError, Storage, Text};
use crate::threads::{on_threads, pieces};
use std::ops::Range;

/// How a program's instructions meet the elements of its arrays. All ways give the same bits.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Execution {
    /// Every instruction is a pass over all elements: the unchained CRAY.
    Eager,
    /// The program runs instruction by instruction on strips of this many elements.
    Strip(usize),
    /// The program is compiled for one register at a time: every result feeds the next instruction directly.
    Chained,
}

/// A text with its tape: what is counted, listed and executed is one and the same.
#[derive(Clone, Debug)]
pub struct Program<T: Text> {
    text: T,
    tape: Tape<T::Lane>,
    footprint: Footprint,
}

impl<T: Text> Program<T> {
    /// Records the text.
    ///
    /// # Panics
    /// If the text writes an array that it also meets at a shift: its result would depend on the strip length.
    pub fn new(text: T) -> Self {
        let tape = Tape::record(&text);
        let footprint = tape.footprint();
        let hazard = footprint.accesses().iter().find(|a| a.writes && (a.lowest, a.highest) != (0, 0));
        assert!(
            hazard.is_none(),
            "{} is written and met at a shift: strips would see each other's results",
            hazard.map_or("", |access| access.array.label()),
        );
        Program { text, tape, footprint }
    }

    /// The recorded instructions.
    pub fn tape(&self) -> &Tape<T::Lane> {
        &self.tape
    }

    /// The text.
    pub fn text(&self) -> &T {
        &self.text
    }
}

impl<T: Text> Program<T>
where
    T::Lane: Precision,
{
    /// Runs the program for the elements of `range` of the memory's arrays.
    ///
    /// # Errors
    /// [`ProgramError`] names the array that is missing, too short or read-only, a strip length that cannot be, or an
    /// instruction set that the processor lacks. Nothing was executed then.
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
            Execution::Chained => dispatch(set, Compiled { text: &self.text, memory, range }),
        }
    }
}

impl<T: Text + Sync> Program<T>
where
    T::Lane: Precision,
{
    /// As [`Program::run`], on the threads of the current `rayon` pool: elements are cut into bands, which depend on
    /// `range` alone. A program whose elements depend on each other (a scatter) runs on one thread.
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

/// What runs a program over one band.
type BandOf<'r> = dyn Fn(&Memory<'_>, Range<usize>) -> Result<(), ProgramError> + Sync + 'r;

/// Runs a program over bands of a range, each with a part of the memory. The program is called through a pointer, so that this is compiled
/// once. The memory was admitted, and the program is elementwise.
fn in_bands(memory: &Memory<'_>, range: Range<usize>, run: &BandOf<'_>) -> Result<(), ProgramError> {
    let shared = Shared(memory);
    let counters = on_threads(pieces(range, BAND), |band| {
        // SAFETY: bands do not overlap, and the program writes only at the own place and reads at others only what it
        // does not write.
        let part = unsafe { shared.part() };
        run(&part, band).map(|()| part.counters())
    });
    let counters: Result<Vec<_>, _> = counters.into_iter().collect();
    counters?.into_iter().for_each(|more| memory.join(more));
    Ok(())
}

/// Elements of a band: enough to be worth a thread's while.
const BAND: usize = 256 * GROUP;

/// A memory that several threads take their parts of.
struct Shared<'r, 'a>(&'r Memory<'a>);

// SAFETY: `part` copies the columns and touches no counter; what threads then do with them is the caller's promise.
unsafe impl Sync for Shared<'_, '_> {}

impl Shared<'_, '_> {
    /// As [`Memory::part`].
    ///
    /// # Safety
    /// As there.
    unsafe fn part(&self) -> Memory<'_> {
        // SAFETY: the caller promises that no element is written through one part and touched through another.
        unsafe { self.0.part() }
    }
}

/// A program whatever its text: what a method keeps a list of.
pub trait Runnable: Send + Sync {
    /// [`Program::run_on_threads`].
    ///
    /// # Errors
    /// As there.
    fn run(
        &self,
        memory: &Memory<'_>,
        range: Range<usize>,
        execution: Execution,
        set: InstructionSet,
    ) -> Result<(), ProgramError>;

    /// Bytes of the register files that an execution keeps for a range of elements, and the precision of the programs that
    /// share them: of numbers, of predicates, of indices. None where instructions feed each other.
    ///
    /// # Errors
    /// [`ProgramError::NoSuchInstructionSet`].
    fn register_bytes(
        &self,
        range: &Range<usize>,
        execution: Execution,
        set: InstructionSet,
    ) -> Result<(&'static str, [usize; 3]), ProgramError>;

    /// What is executed, section by section.
    fn tally(&self) -> Vec<(&'static str, OpCounts)>;

    /// The vector instructions, as an assembly listing.
    fn listing(&self) -> String;

    /// The vector instructions as words.
    fn lines(&self) -> Vec<Line>;

    /// The vector instructions, and the passes that execute them, as a timing model sees them.
    fn outlines(&self) -> Outlines;
}

impl<T: Text + Send + Sync> Runnable for Program<T>
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

    fn listing(&self) -> String {
        self.tape.listing().to_string()
    }

    fn lines(&self) -> Vec<Line> {
        self.tape.lines()
    }

    fn outlines(&self) -> Outlines {
        self.tape.outlines()
    }
}

/// An admitted run of a text compiled for registers.
struct Compiled<'r, T> {
    text: &'r T,
    memory: &'r Memory<'r>,
    range: Range<usize>,
}

impl<T: Text> Task<T::Lane> for Compiled<'_, T>
where
    T::Lane: Precision,
{
    /// The text on full registers, and what is left over element by element.
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

impl<T: Text> Compiled<'_, T>
where
    T::Lane: Precision,
{
    /// The text element by element from `base` on: the same bits, so not worth a copy for every register file.
    #[inline(never)]
    fn elements(&self, mut base: usize) {
        while base < self.range.end {
            self.text.body(Strip::new(Scalar::default(), self.memory, base));
            base += 1;
        }
    }
}
