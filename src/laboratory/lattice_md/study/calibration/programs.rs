//! Timing of the programs of a step on drill scenes of many sizes, with the interpreter and as compiled loops.

use super::fit::FitRow;
use crate::laboratory::lattice_md::study::phase_times::{BenchRun, PRECISIONS, step_of_scene};
use crate::laboratory::lattice_md::study::samples::Samples;
use crate::model::host::{StepArrays, charges};
use std::ops::Range;
use stripmine_kernels::backend::Precision;
use stripmine_kernels::backend::tape::Outlines;
use stripmine_kernels::isa::{Memory, ProgramError};
use stripmine_kernels::{Execution, InstructionSet};
use stripmine_physics::method::lattice_md::{ProgramArrays, StepProgram, model};
use stripmine_physics::method::throughput::MeasurementError;
use stripmine_physics::scene::{self, Overrides, SEED, TEMPERATURE};

/// Approximate number of cells of the largest drill scene.
pub(super) const LONGEST: usize = 4_000_000;

/// NP and ρ of the drill scenes: lattices of 600 to 400 000 cells, some dense and some sparse.
const SCENES: [(usize, f64); 12] = [
    (70, 0.12),
    (480, 0.21),
    (210, 0.06),
    (1300, 0.13),
    (720, 0.06),
    (3300, 0.21),
    (2400, 0.13),
    (5800, 0.21),
    (4300, 0.06),
    (19_000, 0.21),
    (8200, 0.06),
    (24_000, 0.06),
];

/// Scene with the longest vectors, in one precision.
const LARGEST: (usize, f64) = (30_000, 30_000.0 / LONGEST as f64);

/// Timed executions; registers of the strips fit into the first-level and second-level caches, and no strip leaves a remainder.
const EXECUTIONS: [Execution; 5] = [
    Execution::Chained,
    Execution::Eager,
    Execution::Strip(32),
    Execution::Strip(128),
    Execution::Strip(1024),
];

/// Approximate number of elements per sample of the interpreter and of loops, and maximum number of steps.
const INTERPRETED_ELEMENTS: usize = 20_000;
const LOOP_ELEMENTS: usize = 100_000;
const MOST: usize = 8;

/// Element types of lanes.
pub(super) const LANES: [&str; 2] = ["f64", "f32"];

/// Footprints of the memory levels: approximately those of caches, and beyond.
const KIB: f64 = 1024.0;
pub(super) const FOOTPRINTS: [f64; 5] =
    [32.0 * KIB, 256.0 * KIB, 2048.0 * KIB, 16_384.0 * KIB, 131_072.0 * KIB];

/// Number of fitted costs of a kind of execution on lanes of one element type: four, and one per byte at each footprint.
pub(super) const PRICES: usize = 4 + FOOTPRINTS.len();

/// Arrays of either precision.
trait ArraySet {
    fn memory(&mut self) -> Memory<'_>;

    /// Moves the arrays to other addresses. Conflicts of rows in the first-level cache depend on them: with some layouts the predictor took
    /// 256 ns, with most 160 ns. Longer rows come from higher levels anyway.
    fn relocate(&mut self);
}

impl<S: Precision, P: Precision> ArraySet for ProgramArrays<S, P> {
    fn memory(&mut self) -> Memory<'_> {
        self.memory().0
    }

    fn relocate(&mut self) {
        *self = self.clone();
    }
}

/// Programs of one model in one precision, with their samples.
struct DrillStep {
    programs: Vec<StepProgram>,
    ranges: Vec<Range<usize>>,
    arrays: Box<dyn ArraySet>,
    /// Samples of every program, by execution.
    samples: [Vec<Samples>; EXECUTIONS.len()],
}

impl DrillStep {
    fn new(
        (particles, occupancy): (usize, f64),
        precision: &'static str,
    ) -> Result<DrillStep, MeasurementError> {
        // The discs are at rest, so no drill depends on the previous one.
        let at_rest = Overrides::new().set(&TEMPERATURE, 0.0).set(&SEED, 7_u64);
        let checked = BenchRun { particles, occupancy, precision, execution: "chained" }.scene(&at_rest)?;
        let (model, discs, (programs, lengths)) =
            (model(&checked), &checked.particles, step_of_scene(&checked));
        Ok(DrillStep {
            ranges: programs.iter().map(|step| lengths.range(step.length)).collect(),
            samples: std::array::from_fn(|_| vec![Samples::default(); programs.len()]),
            programs,
            arrays: match checked.scene.machine.precision {
                scene::Precision::F64 => Box::new(ProgramArrays::<f64, f64>::new(&model, discs)),
                scene::Precision::F32 => Box::new(ProgramArrays::<f32, f32>::new(&model, discs)),
                scene::Precision::Mixed => Box::new(ProgramArrays::<f64, f32>::new(&model, discs)),
            },
        })
    }

    /// Takes one sample of the programs in the order of a step, with every execution. Long vectors are only measured in every n-th sweep, since
    /// they would take most of the time.
    fn sweep(&mut self, set: InstructionSet, number: usize) -> Result<(), ProgramError> {
        let longest = self.ranges.iter().map(ExactSizeIterator::len).max().unwrap_or(1).max(1);
        let turn = match longest {
            0..=30_000 => 1,
            30_001..=100_000 => 2,
            100_001..=1_000_000 => 6,
            _ => 64,
        };
        if !number.is_multiple_of(turn) {
            return Ok(());
        }
        self.arrays.relocate();
        let memory = self.arrays.memory();
        for (execution, samples) in EXECUTIONS.into_iter().zip(&mut self.samples) {
            let is_chained = execution == Execution::Chained;
            let elements = if is_chained { LOOP_ELEMENTS } else { INTERPRETED_ELEMENTS };
            Samples::take_in_turns(samples, (elements / longest).clamp(1, MOST), |at| {
                self.programs[at].program.run(&memory, self.ranges[at].clone(), execution, set)
            })?;
        }
        Ok(())
    }

    /// Charges and times of the programs on lanes of an element type, with a kind of execution.
    fn rows(&self, (lane, is_chained): (&str, bool), shape: ([f64; 3], usize)) -> Vec<FitRow<PRICES>> {
        let lengths = self.ranges.iter().map(ExactSizeIterator::len);
        let programs: Vec<(Outlines, usize)> =
            self.programs.iter().map(|step| step.program.outlines()).zip(lengths).collect();
        let cycle: Vec<(&Outlines, usize)> = programs.iter().map(|(outlines, n)| (outlines, *n)).collect();
        let around = StepArrays::of_step(&cycle);
        let alike = EXECUTIONS.into_iter().zip(&self.samples);
        let alike = alike.filter(|(execution, _)| (*execution == Execution::Chained) == is_chained);
        let each = alike.flat_map(|(execution, samples)| {
            let of_lane =
                cycle.iter().zip(samples).filter(|((outlines, n), _)| outlines.lane == lane && *n > 0);
            of_lane.filter_map(move |(&(outlines, n), it)| Some((outlines, (n, execution), it.median()?)))
        });
        let row = |(outlines, run, ns)| {
            let charges = charges(outlines, run, shape, &around, &FOOTPRINTS);
            FitRow { features: std::array::from_fn(|at| charges[at]), ns }
        };
        each.map(row).collect()
    }
}

/// All measured programs with their arrays.
pub(super) struct DrillPrograms(Vec<DrillStep>);

impl DrillPrograms {
    /// Places the drill scenes in memory.
    pub(super) fn new() -> Result<DrillPrograms, MeasurementError> {
        let scenes = SCENES.into_iter();
        let of = |place| PRECISIONS.map(|precision| DrillStep::new(place, precision));
        scenes
            .flat_map(of)
            .chain([DrillStep::new(LARGEST, "f32")])
            .collect::<Result<_, _>>()
            .map(DrillPrograms)
    }

    /// Takes one sample of all programs.
    ///
    /// # Errors
    /// [`ProgramError`] if a program cannot be run.
    pub(super) fn sweep(&mut self, set: InstructionSet, number: usize) -> Result<(), ProgramError> {
        self.0.iter_mut().try_for_each(|step| step.sweep(set, number))
    }

    /// All samples.
    pub(super) fn samples(&self) -> impl Iterator<Item = &Samples> {
        self.0.iter().flat_map(|step| step.samples.iter().flatten())
    }

    /// Charges and times of all programs on lanes of an element type, with a kind of execution.
    pub(super) fn rows(&self, of: (&str, bool), shape: ([f64; 3], usize)) -> Vec<FitRow<PRICES>> {
        self.0.iter().flat_map(|step| step.rows(of, shape)).collect()
    }
}
