//! The programs of a step, and the samples of them: in the first-level cache, and over whole vectors.

use crate::laboratory::lattice_md::study::samples::Samples;
use std::ops::Range;
use stripmine_kernels::isa::Memory;
use stripmine_kernels::{Execution, InstructionSet};
use stripmine_physics::method::lattice_md::StepProgram;

/// Elements of the short and of the longer runs of a loop: whole registers, and in the first-level cache.
pub(super) const ELEMENTS: [usize; 2] = [32, 96];
/// Hardware registers of elements that the interpreter goes over, in strips of two lengths: far enough apart to tell what an
/// element takes from what a pass takes to begin, and short enough that arrays and registers lie in the first-level cache.
pub(super) const STRIPPED: usize = 16;
pub(super) const STRIPS: [usize; 2] = [2, 8];
/// How many elements are left over beyond whole registers of `lanes` elements, in runs that measure what these take.
pub(super) fn left_over(lanes: usize) -> [usize; 2] {
    [1, lanes.saturating_sub(1).max(2)]
}
/// Least nanoseconds of a sample.
const SHORTEST: f64 = 40_000.0;
/// Elements of the longest vectors of a sample of the interpreter and of loops, about, and steps at most.
const INTERPRETED_ELEMENTS: usize = 20_000;
const LOOP_ELEMENTS: usize = 100_000;
const MOST: usize = 8;

/// How the interpreter runs them: in one strip, and in strips whose registers lie in the first and in the second level, among
/// them the vectors of a CRAY, which most people will ask for. Powers of two, so that no strip leaves elements over.
pub(super) const INTERPRETED: [Execution; 5] = [
    Execution::Eager,
    Execution::Strip(32),
    Execution::Strip(64),
    Execution::Strip(256),
    Execution::Strip(1024),
];

/// The loops of one model in one precision.
pub(super) struct Step {
    pub(super) programs: Vec<StepProgram>,
    pub(super) ranges: Vec<Range<usize>>,
    pub(super) memory: usize,
    pub(super) large: bool,
    pub(super) loops: Vec<Near>,
    /// The interpreter in short strips.
    pub(super) strips: Vec<Near>,
    /// Whole vectors, one program after the other as in a step.
    pub(super) whole: Vec<Samples>,
    /// The same by the interpreter.
    pub(super) interpreted: [Vec<Samples>; INTERPRETED.len()],
}

impl Step {
    /// Elements of the longest vector.
    pub(super) fn longest(&self) -> usize {
        self.ranges.iter().map(ExactSizeIterator::len).max().unwrap_or(1).max(1)
    }

    /// One more sample of the programs over whole vectors, one after the other as in a step, by the executions that are
    /// wanted.
    pub(super) fn in_turns(
        &mut self,
        set: InstructionSet,
        memory: &Memory<'_>,
        wanted: impl Fn(Execution) -> bool,
    ) {
        let longest = self.longest();
        let Step { programs, ranges, whole, interpreted, .. } = self;
        for (execution, samples, elements) in executions(whole, interpreted) {
            if wanted(execution) {
                Samples::take_in_turns(samples, (elements / longest).clamp(1, MOST), |at| {
                    run(&programs[at], memory, ranges[at].clone(), execution, set);
                });
            }
        }
    }

    /// One more sample of every program in the first-level cache; `lanes` says how many elements of a type are in a hardware
    /// register.
    pub(super) fn near(&mut self, set: InstructionSet, memory: &Memory<'_>, lanes: &dyn Fn(&str) -> usize) {
        let Step { programs, ranges, loops, strips, .. } = self;
        for (at, (loops, strips)) in loops.iter_mut().zip(strips).enumerate() {
            let start = ranges[at].start;
            let run = |n: usize, execution| run(&programs[at], memory, start..start + n, execution, set);
            let lanes = lanes(programs[at].program.outlines().lane);
            let left = left_over(lanes);
            let [short, long] = ELEMENTS;
            for (samples, n) in loops.all_mut().zip([short, long, short + left[0], short + left[1]]) {
                samples.take(SHORTEST, || run(n, Execution::Chained));
            }
            let whole = STRIPPED * lanes;
            let [short, long] = STRIPS.map(|strip| strip * lanes);
            let all = [(whole, short), (whole, long), (whole + left[0], long), (whole + left[1], long)];
            for (samples, (n, strip)) in strips.all_mut().zip(all) {
                samples.take(SHORTEST, || run(n, Execution::Strip(strip)));
            }
        }
    }
}

/// The samples of whole vectors by each execution, and how many elements a sample goes over, about.
pub(super) fn executions<'a>(
    whole: &'a mut Vec<Samples>,
    interpreted: &'a mut [Vec<Samples>; INTERPRETED.len()],
) -> impl Iterator<Item = (Execution, &'a mut Vec<Samples>, usize)> {
    let interpreted = INTERPRETED.into_iter().zip(interpreted);
    let interpreted = interpreted.map(|(execution, samples)| (execution, samples, INTERPRETED_ELEMENTS));
    interpreted.chain([(Execution::Chained, whole, LOOP_ELEMENTS)])
}

fn run(
    step: &StepProgram,
    memory: &Memory<'_>,
    elements: Range<usize>,
    execution: Execution,
    set: InstructionSet,
) {
    let outcome = step.program.run(memory, elements, execution, set);
    debug_assert!(outcome.is_ok(), "{outcome:?}");
}

/// Runs of a program in the first-level cache.
#[derive(Clone, Default)]
pub(super) struct Near {
    /// Over whole registers: short and longer.
    pub(super) whole: [Samples; 2],
    /// With elements left over: few and many.
    pub(super) left: [Samples; 2],
}

impl Near {
    pub(super) fn all(&self) -> impl Iterator<Item = &Samples> {
        self.whole.iter().chain(&self.left)
    }

    pub(super) fn all_mut(&mut self) -> impl Iterator<Item = &mut Samples> {
        self.whole.iter_mut().chain(&mut self.left)
    }
}
