//! The programs of a step on drill scenes of many sizes, one after the other, by the interpreter and as compiled loops; and what of
//! the model is fitted to them.

use super::fit::{Row, suited};
use crate::laboratory::lattice_md::study::phase_times::Run;
use crate::laboratory::lattice_md::study::samples::Samples;
use crate::model::host::{Around, class_counts, starts};
use crate::statistics::median;
use std::collections::BTreeMap;
use std::ops::Range;
use std::rc::Rc;
use stripmine_kernels::backend::Precision;
use stripmine_kernels::backend::tape::Outlines;
use stripmine_kernels::isa::{Memory, OpClass, ProgramError};
use stripmine_kernels::sweep::lattice::Coordinates;
use stripmine_kernels::{Execution, InstructionSet};
use stripmine_physics::method::lattice_md::{Arrays, Discs, Lengths, Model, StepProgram, model, programs};
use stripmine_physics::method::throughput::MeasurementError;
use stripmine_physics::scene::{self, Overrides, SEED, TEMPERATURE};

/// Cells of the largest drill scene, about.
pub(super) const LONGEST: usize = 4_000_000;

/// NP and ρ of the drill scenes: lattices of 600 to 400 000 cells, some with many discs and some with few.
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

/// A scene as large as vectors may be, in one precision.
const LARGEST: (usize, f64) = (30_000, 30_000.0 / LONGEST as f64);

/// The scene of the models that leave something out of the bench scene's, or have something more, so that more programs are drilled.
const VARIED: (usize, f64) = (300, 0.13);
const VARIANTS: [fn(&mut Model); 3] = [
    |model| {
        model.friction = false;
        model.contact.shear_damping = 0.0;
    },
    |model| model.discs = Discs::Varying,
    // The source's, which does not check itself, as runs do.
    |model| {
        model.discs = Discs::Varying;
        model.coordinates = Coordinates::Absolute;
        model.gravity = [9.81, 0.0];
        model.watch = None;
    },
];

/// Discs at rest: no drill depends on what the one before has left.
fn at_rest(scene: Overrides) -> Overrides {
    scene.set(&TEMPERATURE, 0.0).set(&SEED, 7_u64)
}

/// How they are executed; strips whose registers lie in the first and in the second level, and of which none leaves elements over.
const EXECUTIONS: [Execution; 5] = [
    Execution::Chained,
    Execution::Eager,
    Execution::Strip(32),
    Execution::Strip(128),
    Execution::Strip(1024),
];

/// Elements of the longest vectors of a sample of the interpreter and of loops, about, and steps at most.
const INTERPRETED_ELEMENTS: usize = 20_000;
const LOOP_ELEMENTS: usize = 100_000;
const MOST: usize = 8;

/// Vectors of this number of elements take part in every n-th sweep only: the longest would take most of the time.
fn turn(elements: usize) -> usize {
    match elements {
        0..=30_000 => 1,
        30_001..=100_000 => 2,
        100_001..=1_000_000 => 6,
        _ => 64,
    }
}

/// The element types of lanes.
pub(super) const LANES: [&str; 2] = ["f64", "f32"];

/// Footprints of the levels: about those of caches, and beyond.
const KIB: f64 = 1024.0;
pub(super) const FOOTPRINTS: [f64; 5] =
    [32.0 * KIB, 256.0 * KIB, 2048.0 * KIB, 16_384.0 * KIB, 131_072.0 * KIB];

/// Arrays of either precision.
trait Laid {
    fn memory(&mut self) -> Memory<'_>;

    /// Lays them out again, at other addresses. Whether rows conflict in the first-level cache depends on these: with some
    /// layouts the predictor took 256 ns, with most 160. Longer rows come from farther away in any case.
    fn elsewhere(&mut self);
}

impl<S: Precision, P: Precision> Laid for Arrays<S, P> {
    fn memory(&mut self) -> Memory<'_> {
        self.memory().0
    }

    fn elsewhere(&mut self) {
        *self = self.clone();
    }
}

/// The programs of one model in one precision.
struct Step {
    programs: Vec<StepProgram>,
    ranges: Vec<Range<usize>>,
    arrays: Box<dyn Laid>,
    /// Of every program, by execution.
    samples: [Vec<Samples>; EXECUTIONS.len()],
}

impl Step {
    fn new(
        (particles, occupancy): (usize, f64),
        precision: &'static str,
        change: fn(&mut Model),
    ) -> Result<Step, MeasurementError> {
        let checked = Run { particles, occupancy, precision, execution: "chained" }.scene(at_rest)?;
        let mut model = model(&checked);
        change(&mut model);
        let (discs, precision) = (&checked.particles, checked.scene.machine.precision);
        let lengths = Lengths::new(&model, discs.grain_count(), discs.len());
        let programs = programs(&model, precision);
        Ok(Step {
            ranges: programs.iter().map(|step| lengths.range(step.length)).collect(),
            samples: std::array::from_fn(|_| vec![Samples::default(); programs.len()]),
            programs,
            arrays: match precision {
                scene::Precision::F64 => Box::new(Arrays::<f64, f64>::new(&model, discs)),
                scene::Precision::F32 => Box::new(Arrays::<f32, f32>::new(&model, discs)),
                scene::Precision::Mixed => Box::new(Arrays::<f64, f32>::new(&model, discs)),
            },
        })
    }

    /// One more sample of the programs one after the other, as in a step, by every execution, where it is their turn.
    fn sweep(&mut self, set: InstructionSet, number: usize) -> Result<(), ProgramError> {
        let longest = self.ranges.iter().map(ExactSizeIterator::len).max().unwrap_or(1).max(1);
        if !number.is_multiple_of(turn(longest)) {
            return Ok(());
        }
        self.arrays.elsewhere();
        let memory = self.arrays.memory();
        for (execution, samples) in EXECUTIONS.into_iter().zip(&mut self.samples) {
            let elements = match execution {
                Execution::Chained => LOOP_ELEMENTS,
                _ => INTERPRETED_ELEMENTS,
            };
            Samples::take_in_turns(samples, (elements / longest).clamp(1, MOST), |at| {
                self.programs[at].program.run(&memory, self.ranges[at].clone(), execution, set)
            })?;
        }
        Ok(())
    }

    /// Its programs as they were run.
    fn ran(&self) -> Vec<Ran> {
        let outlines: Vec<Rc<Outlines>> =
            self.programs.iter().map(|step| Rc::new(step.program.outlines())).collect();
        let lengths = || self.ranges.iter().map(ExactSizeIterator::len);
        let cycle: Vec<(&Outlines, usize)> = outlines.iter().map(Rc::as_ref).zip(lengths()).collect();
        let around = Rc::new(Around::of_step(&cycle));
        let of_execution = |(execution, samples): (Execution, &Vec<Samples>)| {
            let each = outlines.iter().zip(lengths()).zip(samples);
            let ran = each.map(|((outlines, n), samples)| {
                let (outlines, around) = (Rc::clone(outlines), Rc::clone(&around));
                Ran { outlines, n, execution, around, ns: samples.middle() }
            });
            ran.collect::<Vec<Ran>>()
        };
        EXECUTIONS.into_iter().zip(&self.samples).flat_map(of_execution).collect()
    }
}

/// A program as it was run.
pub(super) struct Ran {
    outlines: Rc<Outlines>,
    n: usize,
    pub(super) execution: Execution,
    around: Rc<Around>,
    /// Nanoseconds that it took.
    ns: f64,
}

/// Every program to be measured, and the arrays they run on.
pub(super) struct Programs(Vec<Step>);

impl Programs {
    /// Lays out the drill scenes.
    pub(super) fn new() -> Result<Programs, MeasurementError> {
        let as_it_is: fn(&mut Model) = |_| ();
        let varied = VARIANTS.map(|change| (VARIED, change));
        let all = SCENES.map(|place| (place, as_it_is)).into_iter().chain(varied);
        let of =
            |(place, change)| ["f64", "f32", "mixed"].map(|precision| Step::new(place, precision, change));
        let largest = Step::new(LARGEST, "f32", as_it_is);
        all.flat_map(of).chain([largest]).collect::<Result<_, _>>().map(Programs)
    }

    /// One more sample of all, and of the binding of their arrays.
    ///
    /// # Errors
    /// [`ProgramError`] if one cannot be run.
    pub(super) fn sweep(
        &mut self,
        set: InstructionSet,
        number: usize,
        binding: &mut Samples,
    ) -> Result<(), ProgramError> {
        self.0.iter_mut().try_for_each(|step| step.sweep(set, number))?;
        let Some(step) = self.0.first_mut() else { return Ok(()) };
        binding.take(20_000.0, || {
            _ = std::hint::black_box(step.arrays.memory());
            Ok(())
        })
    }

    /// All samples.
    pub(super) fn samples(&self) -> impl Iterator<Item = &Samples> {
        self.0.iter().flat_map(|step| step.samples.iter().flatten())
    }

    /// The programs as they were run.
    pub(super) fn ran(&self) -> impl Iterator<Item = Ran> {
        self.0.iter().flat_map(Step::ran)
    }
}

/// A run, the classes of operations and the start of a pass of both lanes, and a byte of every level.
const CLASSES: usize = OpClass::ALL.len();
const UNKNOWN: usize = 1 + 2 * (CLASSES + 1) + FOOTPRINTS.len();

/// What suits some runs best.
pub(super) struct Fitted {
    /// Nanoseconds of a run.
    pub(super) run: f64,
    /// Of both lanes: an operation of each class, and the start of a pass.
    pub(super) lanes: [(BTreeMap<String, f64>, f64); 2],
    /// A byte of each level.
    pub(super) levels: [f64; FOOTPRINTS.len()],
    /// Median deviation.
    pub(super) residual: f64,
}

/// Fits what programs took, interpreted or as loops.
pub(super) fn fit<'a>(ran: impl Iterator<Item = &'a Ran>, shapes: &[([f64; 3], usize); 2]) -> Fitted {
    let row = |&Ran { ref outlines, n, execution, ref around, ns }: &Ran| {
        let lane = usize::from(outlines.lane != LANES[0]);
        let (register_bytes, lanes) = shapes[lane];
        let mut features = [0.0; UNKNOWN];
        features[0] = 1.0;
        let of_lane = &mut features[1 + lane * (CLASSES + 1)..][..=CLASSES];
        let counts = class_counts(outlines, execution).into_iter().map(|count| count * n as f64);
        let paid = counts.chain([starts(outlines, (n, execution), lanes)]);
        of_lane.iter_mut().zip(paid).for_each(|(feature, paid)| *feature = paid);
        let bytes = around.bytes(outlines, (n, execution), register_bytes, &FOOTPRINTS);
        features[1 + 2 * (CLASSES + 1)..].copy_from_slice(&bytes);
        Row { features, ns }
    };
    let rows: Vec<Row<UNKNOWN>> = ran.filter(|ran| ran.n > 0 && ran.ns.is_finite()).map(row).collect();
    let costs = suited(&rows);
    let of_lane = |lane: usize| {
        let costs = &costs[1 + lane * (CLASSES + 1)..];
        let named = OpClass::ALL.iter().zip(costs).filter(|(_, cost)| **cost > 0.0);
        (named.map(|(class, &cost)| (class.name().to_owned(), cost)).collect(), costs[CLASSES])
    };
    Fitted {
        run: costs[0],
        lanes: [0, 1].map(of_lane),
        levels: std::array::from_fn(|at| costs[1 + 2 * (CLASSES + 1) + at]),
        residual: median(rows.iter().map(|row| row.deviation(&costs))),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::laboratory::lattice_md::study::efficiency_table::{Question, step};

    #[test]
    fn the_step_of_the_source_is_drilled() {
        let source = Step::new(VARIED, "f64", VARIANTS[VARIANTS.len() - 1]).unwrap();
        let signatures = |programs: &[StepProgram]| -> Vec<String> {
            programs.iter().map(|step| step.program.outlines().signature()).collect()
        };
        let drilled = signatures(&source.programs);
        for (of, wanted) in signatures(&step(&Question::default()).unwrap().0).iter().enumerate() {
            assert!(drilled.contains(wanted), "program {of}: {wanted} is none of {drilled:?}");
        }
    }
}
