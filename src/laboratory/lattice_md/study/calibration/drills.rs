//! Drills: what each kind of pass of the interpreter takes in the first-level cache.

use super::fit;
use super::programs::Ran;
use crate::laboratory::lattice_md::study::samples::Samples;
use crate::model::host::{Around, LaneCosts};
use std::rc::Rc;
use stripmine_kernels::backend::tape::register_shape;
use stripmine_kernels::drills::{Drilled, Kind, LONGEST, ROUNDS};
use stripmine_kernels::isa::{Memory, ProgramError};
use stripmine_kernels::{Execution, InstructionSet, Runnable};

/// Shortest vectors: what is left of hardware registers goes element by element.
pub(super) const SHORTEST_VECTOR: usize = 8;
/// Vectors that stay in the first-level cache, in hardware registers.
const SHORT: [usize; 6] = [1, 2, 4, 8, 16, 32];
/// Elements of the longest of these, for registers of any width.
pub(super) const NEAR: usize = 32 * 64;
/// Vectors beyond those of the drill scenes.
const LONG: [usize; 2] = [700_000, LONGEST];
/// Long vectors take part in every n-th sweep only: they would take most of the time.
const TURN: usize = 16;
/// Least nanoseconds of a sample.
const SHORTEST: f64 = 60_000.0;

/// A kind over vectors of `n` elements: long and short drill.
struct Point {
    kind: usize,
    n: usize,
    samples: [Samples; 2],
}

/// Everything drilled on lanes of one precision.
pub(super) struct Lane {
    pub(super) name: &'static str,
    programs: Vec<[Box<dyn Runnable>; 2]>,
    points: Vec<Point>,
    /// The short drill of the last kind, which moves most.
    long: [Samples; LONG.len()],
    pub(super) costs: LaneCosts,
}

impl Lane {
    /// Nothing measured yet; conversions are from and to the other precision.
    pub(super) fn new<L: Drilled>(set: InstructionSet) -> Result<Lane, ProgramError> {
        let (register_bytes, lanes) = register_shape::<L>(set)?;
        let of_kind =
            |kind| SHORT.map(|registers| Point { kind, n: registers * lanes, samples: Default::default() });
        Ok(Lane {
            name: L::NAME,
            programs: Kind::ALL.iter().map(|&kind| L::drill(kind)).collect(),
            points: (0..Kind::ALL.len()).flat_map(of_kind).collect(),
            long: Default::default(),
            costs: LaneCosts { register_bytes, lanes, ..LaneCosts::default() },
        })
    }

    /// One more sample of every short vector.
    pub(super) fn sweep(&mut self, memory: &Memory<'_>, set: InstructionSet) {
        for Point { kind, n, samples } in &mut self.points {
            for (samples, program) in samples.iter_mut().zip(&self.programs[*kind]) {
                samples.take(SHORTEST, || run(program.as_ref(), memory, *n, set));
            }
        }
    }

    /// One more sample of every long vector, in some sweeps.
    pub(super) fn sweep_long(&mut self, memory: &Memory<'_>, set: InstructionSet, number: usize) {
        let Some([_, program]) = self.programs.last().filter(|_| number.is_multiple_of(TURN)) else { return };
        for (n, samples) in LONG.into_iter().zip(&mut self.long) {
            samples.take(SHORTEST, || run(program.as_ref(), memory, n, set));
        }
    }

    /// All samples of short vectors.
    pub(super) fn samples(&self) -> impl Iterator<Item = &Samples> {
        self.points.iter().flat_map(|point| &point.samples)
    }

    /// Fits element and start of every kind.
    pub(super) fn fit(&mut self) {
        let each = |point: &Point| {
            let [long, short] = point.samples.each_ref().map(Samples::middle);
            (point.n as f64, ((long - short) / (ROUNDS[0] - ROUNDS[1]) as f64).max(1e-3))
        };
        for (at, kind) in Kind::ALL.iter().enumerate() {
            let points = self.points.iter().filter(|point| point.kind == at);
            self.costs.passes.insert(kind.name(), fit::line(points.map(each)));
        }
        let [shifted, _] = self.costs.passes.remove(&Kind::Shifted.name()).unwrap_or_default();
        let [plain, _] = self.costs.passes.get("sub").copied().unwrap_or_default();
        self.costs.array_operand = (shifted - plain).max(0.0);
    }

    /// Long vectors, as programs.
    pub(super) fn ran(&self) -> Vec<Ran> {
        let Some([_, program]) = self.programs.last() else { return vec![] };
        let outlines = Rc::new(program.outlines());
        let of = |(n, samples): (usize, &Samples)| Ran {
            around: Around::of_step(&[(&outlines, n)]).into(),
            outlines: Rc::clone(&outlines),
            n,
            execution: Execution::Eager,
            ns: samples.middle(),
        };
        LONG.into_iter().zip(&self.long).map(of).collect()
    }
}

fn run(program: &dyn Runnable, memory: &Memory<'_>, n: usize, set: InstructionSet) {
    let outcome = program.run(memory, 0..n, Execution::Eager, set);
    debug_assert!(outcome.is_ok(), "{outcome:?}");
}
