//! How good is the host model? Predicted against measured, on runs that nothing was fitted to: whole steps of moving
//! discs, phase by phase.

use super::throughput::MeasurementError;
use crate::method::lattice_md::{Lengths, Model, Part, StepProgram, programs};
use crate::method::{Failure, Phase};
use crate::model::host::{HostModel, OutOfRange, element_bytes};
use crate::run::{assemble, model};
use crate::scene::{Document, Precision};
use serde::Serialize;
use std::collections::BTreeMap;
use std::f64::consts::PI;
use stripmine_kernels::Execution;
use stripmine_kernels::backend::tape::{Outlines, Place};
use stripmine_kernels::isa::Array;

/// What is run.
#[derive(Clone, Debug)]
pub struct Effort {
    /// NP.
    pub particles: Vec<usize>,
    /// ρ on cells as wide as the radius.
    pub occupancies: Vec<f64>,
    /// Repeats, of which the best counts.
    pub repeats: usize,
    /// Particle-steps of a repeat, about.
    pub particle_steps: usize,
}

/// The executions, by the name that a scene gives them.
const EXECUTIONS: [(&str, Execution); 4] = [
    ("eager", Execution::Eager),
    ("strip:64", Execution::Strip(64)),
    ("strip:512", Execution::Strip(512)),
    ("chained", Execution::Chained),
];

const PRECISIONS: [&str; 3] = ["f64", "f32", "mixed"];

/// Why there is no validation.
#[derive(Debug, thiserror::Error)]
pub enum ValidationError {
    /// A run broke.
    #[error(transparent)]
    Measurement(#[from] MeasurementError),
    /// A case that the model does not reach.
    #[error("{case}: {cause}")]
    OutOfRange {
        /// The case.
        case: String,
        /// Why.
        cause: OutOfRange,
    },
}

/// A phase of a step of one run.
#[derive(Clone, Debug, Serialize)]
pub struct Case {
    /// NP.
    pub particles: usize,
    /// ρ on cells as wide as the radius.
    pub occupancy: f64,
    /// Precision of state and forces.
    pub precision: &'static str,
    /// The execution.
    pub execution: &'static str,
    /// The phase.
    pub phase: &'static str,
    /// Nanoseconds predicted.
    pub predicted: f64,
    /// Nanoseconds of the best repeat.
    pub measured: f64,
    /// Nanoseconds of the median repeat.
    pub median: f64,
    /// Nanoseconds by the trivial baseline: operations times elements, at the cost of a sum in the cache.
    pub baseline: f64,
}

impl Case {
    /// How far the prediction lies off, as a share of the measured time.
    pub fn error(&self) -> f64 {
        (self.predicted / self.measured - 1.0).abs()
    }

    /// The same of the baseline.
    pub fn baseline_error(&self) -> f64 {
        (self.baseline / self.measured - 1.0).abs()
    }

    /// All that tells it from the others.
    pub fn name(&self) -> String {
        let Case { particles, occupancy, precision, execution, phase, .. } = self;
        format!("{phase}, {execution}, {precision}, NP = {particles}, ρ = {occupancy}")
    }
}

/// The errors of some cases.
#[derive(Clone, Debug, Serialize)]
pub struct Errors {
    /// What the cases have in common.
    pub what: String,
    /// Cases.
    pub cases: usize,
    /// The median error.
    pub median: f64,
    /// Nine of ten lie below.
    pub ninth_tenth: f64,
    /// The largest.
    pub worst: f64,
    /// Cases within 5, 10, 20 and 30 %.
    pub within: [usize; 4],
    /// The median error of the trivial baseline.
    pub baseline_median: f64,
    /// Median of how much slower the median repeat was than the best: what the measurement itself is good for.
    pub spread: f64,
}

impl Errors {
    fn of(what: String, cases: &[&Case]) -> Errors {
        let sorted = |of: &dyn Fn(&Case) -> f64| {
            let mut values: Vec<f64> = cases.iter().map(|case| of(case)).collect();
            values.sort_by(f64::total_cmp);
            values
        };
        let quantile = |sorted: &[f64], share: f64| {
            let last = sorted.len().saturating_sub(1);
            sorted.get((share * last as f64).round() as usize).copied().unwrap_or(f64::NAN)
        };
        let errors = sorted(&Case::error);
        Errors {
            what,
            cases: cases.len(),
            median: quantile(&errors, 0.5),
            ninth_tenth: quantile(&errors, 0.9),
            worst: quantile(&errors, 1.0),
            within: [0.05, 0.1, 0.2, 0.3].map(|limit| errors.iter().filter(|&&error| error <= limit).count()),
            baseline_median: quantile(&sorted(&Case::baseline_error), 0.5),
            spread: quantile(&sorted(&|case| case.median / case.measured - 1.0), 0.5),
        }
    }
}

/// The dataset.
#[derive(Clone, Debug, Serialize)]
pub struct ModelValidation {
    /// The host model: of which processor.
    pub host: String,
    /// Its instructions.
    pub instruction_set: String,
    /// Whether it is the model that comes with the program, of another machine perhaps.
    pub shipped: bool,
    /// Every case.
    pub cases: Vec<Case>,
    /// The errors of all, of every execution and of every phase.
    pub errors: Vec<Errors>,
}

impl ModelValidation {
    /// The cases from the worst on.
    pub fn worst(&self) -> Vec<&Case> {
        let mut cases: Vec<&Case> = self.cases.iter().collect();
        cases.sort_by(|a, b| b.error().total_cmp(&a.error()));
        cases
    }
}

/// Predicts and measures, on one thread. `progress` gets the share that is done.
///
/// # Errors
/// [`ValidationError`] if a scene breaks or lies outside what was calibrated; the latter before anything is run.
pub fn model_validation(
    host: &HostModel,
    shipped: bool,
    effort: &Effort,
    progress: impl Fn(f64) + Sync,
) -> Result<ModelValidation, ValidationError> {
    let mut scenes = vec![];
    for &particles in &effort.particles {
        for &occupancy in &effort.occupancies {
            for precision in PRECISIONS {
                for (name, execution) in EXECUTIONS {
                    scenes.push(Scene::new(host, particles, occupancy, precision, name, execution)?);
                }
            }
        }
    }
    let alone = rayon::ThreadPoolBuilder::new().num_threads(1).build().map_err(MeasurementError::Threads)?;
    let mut cases = vec![];
    for (done, scene) in scenes.iter().enumerate() {
        cases.extend(alone.install(|| scene.measure(effort))?);
        progress((done + 1) as f64 / scenes.len() as f64);
    }
    let all: Vec<&Case> = cases.iter().collect();
    let mut errors = vec![Errors::of("all".to_owned(), &all)];
    let mut group = |what: &str, keep: &dyn Fn(&Case) -> bool| {
        let kept: Vec<&Case> = cases.iter().filter(|case| keep(case)).collect();
        errors.push(Errors::of(what.to_owned(), &kept));
    };
    EXECUTIONS.iter().for_each(|(name, _)| group(name, &|case| case.execution == *name));
    Phase::ALL.iter().for_each(|phase| group(phase.name(), &|case| case.phase == phase.name()));
    PRECISIONS.iter().for_each(|name| group(name, &|case| case.precision == *name));
    Ok(ModelValidation {
        host: host.title.clone(),
        instruction_set: host.instruction_set.clone(),
        shipped,
        cases,
        errors,
    })
}

/// A run to be measured, with what is predicted of it.
struct Scene {
    overrides: Vec<String>,
    particles: usize,
    occupancy: f64,
    precision: &'static str,
    execution: &'static str,
    /// Predicted nanoseconds of every phase, and the baseline's.
    predicted: Vec<[f64; 2]>,
}

impl Scene {
    fn new(
        host: &HostModel,
        particles: usize,
        occupancy: f64,
        precision: &'static str,
        name: &'static str,
        execution: Execution,
    ) -> Result<Scene, ValidationError> {
        let case = || format!("{name}, {precision}, NP = {particles}, ρ = {occupancy}");
        host.admits(particles).map_err(|cause| ValidationError::OutOfRange { case: case(), cause })?;
        let overrides = vec![
            format!("particles.count={particles}"),
            format!("particles.packing_fraction={}", PI * occupancy),
            "method.cell_edge=0.5".to_owned(),
            format!("method.precision=\"{precision}\""),
            format!("method.execution=\"{name}\""),
        ];
        let document = Document::load("bench", &overrides).map_err(MeasurementError::from)?;
        let checked = document.check().map_err(MeasurementError::from)?;
        let model = model(&checked);
        let lengths = Lengths::new(&model, checked.particles.grain_count(), checked.particles.len());
        let step = Step::new(&of_precision(&model, checked.scene.method.precision), &lengths);
        let predicted = Phase::ALL.iter().map(|&phase| step.phase(host, phase, execution));
        let predicted = predicted
            .collect::<Result<_, _>>()
            .map_err(|cause| ValidationError::OutOfRange { case: case(), cause })?;
        Ok(Scene { overrides, particles, occupancy, precision, execution: name, predicted })
    }

    fn measure(&self, effort: &Effort) -> Result<Vec<Case>, MeasurementError> {
        let mut method = assemble(&Document::load("bench", &self.overrides)?.check()?)?;
        let steps = (effort.particle_steps / self.particles).clamp(2, 2000);
        let mut advance = |times: usize| -> Result<[f64; Phase::ALL.len()], Failure> {
            method.reset_timings();
            (0..times).try_for_each(|_| method.step())?;
            let mut each = [0.0; Phase::ALL.len()];
            for (ns, &phase) in each.iter_mut().zip(Phase::ALL) {
                *ns = 1e9 * method.timings().seconds(phase) / times as f64;
            }
            Ok(each)
        };
        advance(steps.clamp(5, 50))?;
        let repeats: Vec<_> = (0..effort.repeats).map(|_| advance(steps)).collect::<Result<_, _>>()?;
        let case = |(at, phase): (usize, &Phase)| {
            let mut samples: Vec<f64> = repeats.iter().map(|repeat| repeat[at]).collect();
            samples.sort_by(f64::total_cmp);
            Case {
                particles: self.particles,
                occupancy: self.occupancy,
                precision: self.precision,
                execution: self.execution,
                phase: phase.name(),
                predicted: self.predicted[at][0],
                measured: samples[0],
                median: samples[samples.len() / 2],
                baseline: self.predicted[at][1],
            }
        };
        Ok(Phase::ALL.iter().enumerate().map(case).collect())
    }
}

/// The programs of a model in its precision.
pub fn of_precision(model: &Model, precision: Precision) -> Vec<StepProgram> {
    match precision {
        Precision::F64 => programs::<f64, f64>(model),
        Precision::F32 => programs::<f32, f32>(model),
        Precision::Mixed => programs::<f64, f32>(model),
    }
}

/// The programs of a step as the model sees them.
pub struct Step {
    programs: Vec<(Part, Outlines, usize)>,
    /// Bytes of all arrays of the step, and how many there are.
    bytes: f64,
    arrays: usize,
}

impl Step {
    /// Of programs over vectors of these lengths.
    pub fn new(step: &[StepProgram], lengths: &Lengths) -> Step {
        let programs: Vec<(Part, Outlines, usize)> = step
            .iter()
            .map(|step| (step.part, step.program.outlines(), lengths.range(step.length).len()))
            .collect();
        let mut arrays: BTreeMap<(Array, &'static str), f64> = BTreeMap::new();
        for (_, outlines, n) in &programs {
            for place in outlines.passes.iter().flat_map(|pass| pass.reads.iter().chain(&pass.writes)) {
                if let Place::Memory(reference) | Place::Indexed(reference) = place {
                    let bytes = arrays.entry((reference.array, reference.element)).or_default();
                    *bytes = bytes.max(element_bytes(reference.element) * *n as f64);
                }
            }
        }
        Step { programs, bytes: arrays.values().sum(), arrays: arrays.len() }
    }

    /// Nanoseconds of a phase, and the baseline's.
    ///
    /// # Errors
    /// [`OutOfRange`] where the model does not reach.
    pub fn phase(
        &self,
        host: &HostModel,
        phase: Phase,
        execution: Execution,
    ) -> Result<[f64; 2], OutOfRange> {
        let parts: &[Part] = match phase {
            Phase::Predict => &[Part::Predictor],
            Phase::Index => &[Part::Index, Part::Lattice],
            Phase::Forces => &[Part::Forces],
            Phase::Correct => &[Part::Corrector],
        };
        // Every part binds the arrays of the step anew.
        let mut sum = parts.len() as f64 * self.arrays as f64 * host.bind;
        let mut baseline = 0.0;
        for (_, outlines, n) in self.programs.iter().filter(|(part, ..)| parts.contains(part)) {
            sum += host.program(outlines, *n, execution, self.bytes)?;
            baseline += host.baseline(outlines, *n, execution);
        }
        Ok([sum, baseline])
    }
}
