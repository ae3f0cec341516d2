//! Compiled loops: the programs of a step on vectors in the first-level cache, and their classes of operations.

use super::fit;
use super::large::{self, Ran, SCENES};
use super::passes::{Lane, estimate};
use super::step::{ELEMENTS, INTERPRETED, Near, STRIPPED, STRIPS, Step, executions};
use super::timing::{PARTS, Samples};
use super::variants::{AT_REST, DRILL, VARIANTS, Variant};
use crate::method::lattice_md::model;
use crate::method::lattice_md::study::noise_monitor::NoiseMonitor;
use crate::method::lattice_md::study::phase_times::{QUIET, Run};
use crate::method::lattice_md::{Arrays, Lengths, programs};
use crate::method::throughput::MeasurementError;
use crate::model::host::{Estimate, Factors, LoopCosts, PassCost, ProgramCost, class_counts};
use crate::statistics::non_negative;
use std::collections::BTreeMap;
use stripmine_kernels::backend::Precision;
use stripmine_kernels::isa::{Memory, OpClass};
use stripmine_kernels::{Execution, InstructionSet};

/// Whole vectors whose halves of the samples are farther apart than this share are worth more of them.
const UNSETTLED: f64 = 0.1;

/// The interpreter is slow: it takes part in every n-th sweep, by the number of elements of the vectors.
fn turn(elements: usize) -> usize {
    match elements {
        0..=30_000 => 2,
        30_001..=100_000 => 4,
        _ => 8,
    }
}

/// Operations of each class of an element, and the nanoseconds it took.
type Counted = (BTreeMap<&'static str, f64>, f64);

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

/// Every loop to be measured, and the arrays they run on.
pub(super) struct Loops {
    steps: Vec<Step>,
    arrays: Vec<Box<dyn Laid>>,
}

impl Loops {
    /// Lays out the drill scenes.
    pub(super) fn new() -> Result<Loops, MeasurementError> {
        let mut loops = Loops { steps: vec![], arrays: vec![] };
        let large = SCENES.iter().map(|&place| (place, &VARIANTS[0]));
        let small = VARIANTS.iter().map(|variant| ((DRILL.particles, DRILL.occupancy), variant));
        for ((particles, occupancy), variant) in small.chain(large) {
            for precision in ["f64", "f32", "mixed"] {
                let run = Run { particles, occupancy, precision, ..DRILL };
                match precision {
                    "f64" => loops.lay_out::<f64, f64>(&run, variant)?,
                    "f32" => loops.lay_out::<f32, f32>(&run, variant)?,
                    _ => loops.lay_out::<f64, f32>(&run, variant)?,
                }
            }
        }
        Ok(loops)
    }

    fn lay_out<S: Precision, P: Precision>(
        &mut self,
        run: &Run,
        variant: &Variant,
    ) -> Result<(), MeasurementError> {
        let checked = run.scene(&AT_REST)?;
        let mut model = model(&checked);
        (variant.change)(&mut model);
        let lengths = Lengths::new(&model, checked.particles.grain_count(), checked.particles.len());
        let programs = programs::<S, P>(&model);
        let ranges = programs.iter().map(|step| lengths.range(step.length)).collect();
        let near: Vec<Near> = programs.iter().map(|_| Near::default()).collect();
        let whole: Vec<Samples> = programs.iter().map(|_| Samples::default()).collect();
        let interpreted = INTERPRETED.map(|_| whole.clone());
        let large = run.particles != DRILL.particles;
        let name = format!("{}{}", run.precision, variant.suffix);
        self.steps.push(Step {
            name,
            programs,
            ranges,
            memory: self.arrays.len(),
            large,
            strips: near.clone(),
            loops: near,
            whole,
            interpreted,
        });
        self.arrays.push(Box::new(Arrays::<S, P>::new(&model, &checked.particles)));
        Ok(())
    }

    /// One more sample of every loop; `lanes` says how many elements of a type are in a hardware register.
    pub(super) fn sweep(
        &mut self,
        monitor: &mut NoiseMonitor,
        set: InstructionSet,
        lanes: &dyn Fn(&str) -> usize,
        number: usize,
    ) {
        for step in &mut self.steps {
            let arrays = &mut self.arrays[step.memory];
            arrays.elsewhere();
            let memory = arrays.memory();
            let takes_turn = step.large && number.is_multiple_of(turn(step.longest()));
            step.in_turns(monitor, set, &memory, |execution| execution == Execution::Chained || takes_turn);
            // What is near is learned from the small ones.
            if !step.large {
                step.near(monitor, set, &memory, lanes);
            }
        }
    }

    /// Some more samples of whole vectors whose samples differ, or were always disturbed.
    /// Whether there were any.
    pub(super) fn again(&mut self, monitor: &mut NoiseMonitor, set: InstructionSet, reference: f64) -> bool {
        self.evaluate(reference);
        let mut any = false;
        for step in self.steps.iter_mut().filter(|step| step.large) {
            let mut unsettled = vec![];
            for (execution, samples, _) in executions(&mut step.whole, &mut step.interpreted) {
                let settled = |of: &Samples| of.disagreement() <= UNSETTLED && of.quiet() >= QUIET;
                if !samples.iter().all(settled) {
                    Samples::go_on(samples);
                    unsettled.push(execution);
                }
            }
            for _ in 0..PARTS * usize::from(!unsettled.is_empty()) {
                let arrays = &mut self.arrays[step.memory];
                arrays.elsewhere();
                step.in_turns(monitor, set, &arrays.memory(), |execution| unsettled.contains(&execution));
            }
            any |= !unsettled.is_empty();
        }
        any
    }

    /// Evaluates all samples for an undisturbed core.
    pub(super) fn evaluate(&mut self, reference: f64) {
        for step in &mut self.steps {
            let near = step.loops.iter_mut().chain(&mut step.strips).flat_map(Near::all_mut);
            let samples = near.chain(&mut step.whole).chain(step.interpreted.iter_mut().flatten());
            samples.for_each(|samples| samples.evaluate(reference));
        }
    }

    /// All samples.
    pub(super) fn samples(&self) -> impl Iterator<Item = &Samples> {
        self.steps
            .iter()
            .filter(|step| !step.large)
            .flat_map(|step| step.loops.iter().chain(&step.strips).flat_map(Near::all))
    }

    /// What the programs take in the interpreter, where a run takes `run` nanoseconds in addition: into the costs of their lanes. With how
    /// many times as long as in drills of nothing but themselves their passes take to begin.
    pub(super) fn see(&self, lanes: &mut [Lane], run: f64) -> f64 {
        let mut begins = vec![];
        for step in self.steps.iter().filter(|step| !step.large) {
            for (program, near) in step.programs.iter().zip(&step.strips) {
                let outlines = program.program.outlines();
                let Some(lane) = lanes.iter_mut().find(|lane| lane.name == outlines.lane) else { continue };
                let samples = &near.whole;
                let elements = (STRIPPED * lane.costs.lanes) as f64;
                let [short, long] = STRIPS.map(|strip| (STRIPPED / strip) as f64);
                let start = |of: &dyn Fn(&Samples) -> f64| {
                    ((of(&samples[0]) - of(&samples[1])) / (short - long)).max(0.0)
                };
                let element = |of: &dyn Fn(&Samples) -> f64| {
                    ((of(&samples[1]) - run - long * start(of)) / elements).max(1e-4)
                };
                let what = format!("{}, {}", program.part.name(), step.name);
                let (element, start) = (estimate(samples, element), estimate(samples, start));
                let cost = seen_near(what, element, start, near.rest(lane.costs.lanes, 1));
                begins.extend(lane.begin(&outlines, cost.start.value));
                lane.costs.seen.entry(outlines.signature()).or_insert(cost);
            }
        }
        fit::median(begins.into_iter())
    }

    /// The costs.
    pub(super) fn costs(&self, lanes: &[Lane]) -> LoopCosts {
        let mut seen = BTreeMap::new();
        let mut of_lane: BTreeMap<String, Vec<Counted>> = BTreeMap::new();
        for step in self.steps.iter().filter(|step| !step.large) {
            for (program, near) in step.programs.iter().zip(&step.loops) {
                let samples = &near.whole;
                let [short, long] = ELEMENTS.map(|n| n as f64);
                let element =
                    estimate(samples, |of| ((of(&samples[1]) - of(&samples[0])) / (long - short)).max(1e-4));
                let start = estimate(samples, |of| {
                    let slope = (of(&samples[1]) - of(&samples[0])) / (long - short);
                    (of(&samples[0]) - short * slope).max(0.0)
                });
                let outlines = program.program.outlines();
                let what = format!("{}, {}", program.part.name(), step.name);
                of_lane
                    .entry(outlines.lane.to_owned())
                    .or_default()
                    .push((class_counts(&outlines), element.value));
                let lanes = lanes.iter().find(|lane| lane.name == outlines.lane);
                let rest = near.rest(lanes.map_or(1, |lane| lane.costs.lanes), 0);
                seen.entry(outlines.signature()).or_insert(seen_near(what, element, start, rest));
            }
        }
        let mut classes = BTreeMap::new();
        let mut residuals = vec![];
        for (lane, loops) in of_lane {
            let names: Vec<&'static str> = OpClass::ALL.iter().map(|class| class.name()).collect();
            let count = |counts: &BTreeMap<&'static str, f64>, name| counts.get(name).copied().unwrap_or(0.0);
            let rows: Vec<([f64; OpClass::ALL.len()], f64)> = loops
                .iter()
                .map(|(counts, ns)| {
                    (
                        std::array::from_fn(|at| names.get(at).map_or(0.0, |name| count(counts, name)) / ns),
                        1.0,
                    )
                })
                .collect();
            let costs = non_negative(&rows);
            for (counts, ns) in &loops {
                let sum: f64 = names.iter().zip(costs).map(|(name, cost)| count(counts, name) * cost).sum();
                residuals.push((sum / ns - 1.0).abs());
            }
            let named = names.iter().zip(costs).filter(|(_, cost)| *cost > 0.0);
            classes.insert(lane, named.map(|(name, cost)| ((*name).to_owned(), cost)).collect());
        }
        LoopCosts { classes, residual: fit::median(residuals.into_iter()), overlap: 0.5, seen }
    }

    /// The programs of the large drill scenes in every execution; `look` is what looking at the clock takes.
    pub(super) fn large(&self, lanes: &[Lane], look: f64) -> Vec<Ran> {
        self.steps.iter().filter(|step| step.large).flat_map(|step| large::ran(step, lanes, look)).collect()
    }
}

/// A program of which nothing is known yet but what it takes in the first-level cache.
fn seen_near(what: String, element: Estimate, start: Estimate, rest: PassCost) -> ProgramCost {
    ProgramCost { what, element, start, rest, factors: Factors::default() }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::method::lattice_md::StepProgram;
    use crate::method::lattice_md::study::efficiency_table::{Question, step};

    #[test]
    fn the_step_of_the_source_is_drilled() {
        let mut loops = Loops { steps: vec![], arrays: vec![] };
        let source = VARIANTS.last().unwrap();
        loops.lay_out::<f64, f64>(&DRILL, source).unwrap();
        let signatures = |programs: &[StepProgram]| -> Vec<String> {
            programs.iter().map(|step| step.program.outlines().signature()).collect()
        };
        let drilled = signatures(&loops.steps[0].programs);
        for (of, wanted) in signatures(&step(&Question::default()).unwrap().0).iter().enumerate() {
            assert!(drilled.contains(wanted), "program {of}: {wanted} is none of {drilled:?}");
        }
    }
}
