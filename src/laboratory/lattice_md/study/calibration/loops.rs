//! Compiled loops: the programs of a step on vectors in the first-level cache, and their classes of operations.

use super::fit;
use super::large::{self, Ran, SCENES};
use super::passes::Lane;
use super::step::{ELEMENTS, INTERPRETED, Near, STRIPPED, STRIPS, Step, left_over};
use super::variants::{AT_REST, DRILL, VARIANTS, Variant};
use crate::laboratory::lattice_md::study::phase_times::Run;
use crate::laboratory::lattice_md::study::samples::Samples;
use crate::model::host::{Estimate, LoopCosts, class_counts};
use crate::statistics::{non_negative, quantile};
use std::collections::BTreeMap;
use stripmine_kernels::backend::Precision;
use stripmine_kernels::isa::{Memory, OpClass};
use stripmine_kernels::{Execution, InstructionSet};
use stripmine_physics::method::lattice_md::model;
use stripmine_physics::method::lattice_md::{Arrays, Lengths, programs};
use stripmine_physics::method::throughput::MeasurementError;
use stripmine_physics::scene;

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
                    "f64" => loops.lay_out::<f64, f64>(&run, variant, scene::Precision::F64)?,
                    "f32" => loops.lay_out::<f32, f32>(&run, variant, scene::Precision::F32)?,
                    _ => loops.lay_out::<f64, f32>(&run, variant, scene::Precision::Mixed)?,
                }
            }
        }
        Ok(loops)
    }

    fn lay_out<S: Precision, P: Precision>(
        &mut self,
        run: &Run,
        variant: &Variant,
        precision: scene::Precision,
    ) -> Result<(), MeasurementError> {
        let checked = run.scene(&AT_REST)?;
        let mut model = model(&checked);
        (variant.change)(&mut model);
        let lengths = Lengths::new(&model, checked.particles.grain_count(), checked.particles.len());
        let programs = programs(&model, precision);
        let ranges = programs.iter().map(|step| lengths.range(step.length)).collect();
        let near: Vec<Near> = programs.iter().map(|_| Near::default()).collect();
        let whole: Vec<Samples> = programs.iter().map(|_| Samples::default()).collect();
        let interpreted = INTERPRETED.map(|_| whole.clone());
        let large = run.particles != DRILL.particles;
        self.steps.push(Step {
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
    pub(super) fn sweep(&mut self, set: InstructionSet, lanes: &dyn Fn(&str) -> usize, number: usize) {
        for step in &mut self.steps {
            let arrays = &mut self.arrays[step.memory];
            arrays.elsewhere();
            let memory = arrays.memory();
            let takes_turn = step.large && number.is_multiple_of(turn(step.longest()));
            step.in_turns(set, &memory, |execution| execution == Execution::Chained || takes_turn);
            // What is near is learned from the small ones.
            if !step.large {
                step.near(set, &memory, lanes);
            }
        }
    }

    /// All samples.
    pub(super) fn samples(&self) -> impl Iterator<Item = &Samples> {
        self.steps
            .iter()
            .filter(|step| !step.large)
            .flat_map(|step| step.loops.iter().chain(&step.strips).flat_map(Near::all))
    }

    /// How many times as long as in drills of nothing but themselves the passes of a program take to begin, where a run takes `run`
    /// nanoseconds in addition.
    pub(super) fn begin(&self, lanes: &[Lane], run: f64) -> f64 {
        let mut begins = vec![];
        for step in self.steps.iter().filter(|step| !step.large) {
            for (program, near) in step.programs.iter().zip(&step.strips) {
                let outlines = program.program.outlines();
                let Some(lane) = lanes.iter().find(|lane| lane.name == outlines.lane) else { continue };
                let [short, long] = STRIPS.map(|strip| (STRIPPED / strip) as f64);
                let [in_short, in_long] = near.whole.each_ref().map(Samples::middle);
                let start = ((in_short - in_long) / (short - long)).max(0.0);
                if in_long - run - long * start > 0.0 {
                    begins.extend(lane.begin(&outlines, start));
                }
            }
        }
        fit::median(begins.into_iter())
    }

    /// The costs of classes of operations, fitted to all loops.
    pub(super) fn costs(&self, lanes: &[Lane]) -> LoopCosts {
        let mut of_lane: BTreeMap<String, Vec<Counted>> = BTreeMap::new();
        let (mut starts, mut longer) = (vec![], vec![]);
        for step in self.steps.iter().filter(|step| !step.large) {
            for (program, near) in step.programs.iter().zip(&step.loops) {
                let [short, long] = ELEMENTS.map(|n| n as f64);
                let [in_short, in_long] = near.whole.each_ref().map(Samples::middle);
                let element = ((in_long - in_short) / (long - short)).max(1e-4);
                starts.push((in_short - short * element).max(0.0));
                let outlines = program.program.outlines();
                let lanes = lanes.iter().find(|lane| lane.name == outlines.lane);
                let [few, many] = left_over(lanes.map_or(1, |lane| lane.costs.lanes)).map(|left| left as f64);
                let [in_few, in_many] = near.left.each_ref().map(Samples::middle);
                longer.push(((in_many - in_few) / (many - few) / element).max(0.0));
                of_lane.entry(outlines.lane.to_owned()).or_default().push((class_counts(&outlines), element));
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
        let [start, left] = [starts, longer].map(estimate);
        LoopCosts { residual: fit::median(residuals.into_iter()), overlap: 0.5, start, left, classes }
    }

    /// The programs of the large drill scenes in every execution; `look` is what looking at the clock takes.
    pub(super) fn large(&self, lanes: &[Lane], look: f64) -> Vec<Ran> {
        self.steps.iter().filter(|step| step.large).flat_map(|step| large::ran(step, lanes, look)).collect()
    }
}

/// The middle of what loops show, and how far they differ.
fn estimate(mut values: Vec<f64>) -> Estimate {
    values.sort_by(f64::total_cmp);
    let at = |share: f64| quantile(&values, share).unwrap_or(0.0);
    Estimate { value: at(0.5), interval: 0.5 * (at(0.975) - at(0.025)) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::laboratory::lattice_md::study::efficiency_table::{Question, step};
    use stripmine_physics::method::lattice_md::StepProgram;

    #[test]
    fn the_step_of_the_source_is_drilled() {
        let mut loops = Loops { steps: vec![], arrays: vec![] };
        let source = VARIANTS.last().unwrap();
        loops.lay_out::<f64, f64>(&DRILL, source, scene::Precision::F64).unwrap();
        let signatures = |programs: &[StepProgram]| -> Vec<String> {
            programs.iter().map(|step| step.program.outlines().signature()).collect()
        };
        let drilled = signatures(&loops.steps[0].programs);
        for (of, wanted) in signatures(&step(&Question::default()).unwrap().0).iter().enumerate() {
            assert!(drilled.contains(wanted), "program {of}: {wanted} is none of {drilled:?}");
        }
    }
}
