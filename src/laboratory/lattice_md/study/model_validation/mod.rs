//! How good is the host model? Predicted against measured: whole steps of moving discs and their phases, timed as runs time them, and
//! programs of laws that nothing was calibrated on.

mod errors;
mod strangers;

pub use errors::{Case, Errors, PHASES, PHASES_OF_DATA, STEP, STEPS, STEPS_OF_DATA, STRANGERS};

use super::calibration::CalibrationError;
use super::phase_times::{FAST, FAST_LISTS, LISTS, PhaseTimes, Run, Sampling, phase_times};
use super::predicted_step::Step;
use super::rounds::Bound;
use crate::model::host::{HostModel, OutOfRange};
use serde::Serialize;
use strangers::strangers;
use stripmine_kernels::Execution;
use stripmine_physics::method::lattice_md::{Checked, Lengths, Phase, model, programs};
use stripmine_physics::method::throughput::MeasurementError;

/// How much is measured.
#[derive(Clone, Debug)]
pub struct Effort {
    /// NP.
    pub particles: Vec<usize>,
    /// ρ on cells as wide as the radius.
    pub occupancies: Vec<f64>,
    /// Rounds over all runs.
    pub rounds: Bound,
    /// Particle-steps of a run, about.
    pub particle_steps: usize,
}

/// What is run, as scenes name it; programs with their execution.
const EXECUTIONS: [(&str, Option<Execution>); 7] = [
    ("eager", Some(Execution::Eager)),
    ("strip:64", Some(Execution::Strip(64))),
    ("strip:512", Some(Execution::Strip(512))),
    ("chained", Some(Execution::Chained)),
    (FAST, None),
    (FAST_LISTS, None),
    (LISTS, None),
];
const PRECISIONS: [&str; 3] = ["f64", "f32", "mixed"];

/// Steps before the clock starts: of programs, whose time does not depend on the data, only the caches must be in their steady state.
const WARMED: usize = 3;

/// Why there is no validation.
#[derive(Debug, thiserror::Error)]
pub enum ValidationError {
    /// The processor cannot be calibrated.
    #[error(transparent)]
    Calibration(#[from] CalibrationError),
    /// A scene broke.
    #[error(transparent)]
    Measurement(#[from] MeasurementError),
    /// A run lies outside what was calibrated.
    #[error("{case}: {cause}")]
    OutOfRange {
        /// The run.
        case: String,
        /// Why.
        cause: OutOfRange,
    },
}

/// Where the model comes from.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Calibrated {
    /// With the program, of another machine perhaps.
    Shipped,
    /// From a host file of this processor and its instructions.
    Before,
    /// From a host file of another processor, or of other instructions.
    Elsewhere,
    /// Just before the runs.
    Now,
}

impl Calibrated {
    /// Whose model it is, for sentences: a model of another machine is never called one of this host.
    pub fn model_of(self, title: &str) -> String {
        match self {
            Calibrated::Shipped => format!("the shipped model of {title}"),
            Calibrated::Before => format!("the model of {title} from a host file"),
            Calibrated::Elsewhere => format!("the model of another host, {title}, from a host file"),
            Calibrated::Now => format!("the model of this host, {title}, calibrated just before"),
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
    /// In which state the machine was when it was calibrated.
    pub state: String,
    /// Where it comes from.
    pub calibrated: Calibrated,
    /// Rounds over all runs.
    pub rounds: usize,
    /// Every case.
    pub cases: Vec<Case>,
    /// The errors of all, and group by group.
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

/// Predicts by a model and measures, on one thread. `progress` gets the share that is done.
///
/// # Errors
/// [`ValidationError`] if a scene breaks or lies outside what was calibrated; the latter before anything is run.
pub fn model_validation(
    host: &HostModel,
    calibrated: Calibrated,
    effort: &Effort,
    progress: impl Fn(f64) + Sync,
) -> Result<ModelValidation, ValidationError> {
    let runs: Vec<Run> = runs(effort).collect();
    // Before discs are placed: large scenes take their time.
    for run in &runs {
        let out = |cause| ValidationError::OutOfRange { case: run.name(), cause };
        host.admits(run.particles).map_err(out)?;
        if run.rates().is_some() {
            rated(host, run, &PhaseTimes::none(run.particles)).map_err(out)?;
        }
    }
    let mut scenes = runs.into_iter().map(Scene::new).collect::<Result<Vec<_>, _>>()?;
    for scene in &scenes {
        scene.programs(host)?;
    }
    let alone = rayon::ThreadPoolBuilder::new().num_threads(1).build().map_err(MeasurementError::Threads)?;
    alone.install(|| {
        let (mut rounds, mut done, all) = (effort.rounds.begin(), 0, scenes.len() as f64);
        while rounds.next().is_some() {
            for (at, scene) in scenes.iter_mut().enumerate() {
                scene.measure(effort)?;
                progress(0.9 * rounds.share((at + 1) as f64 / all));
            }
            done += 1;
        }
        let mut cases = vec![];
        for scene in &scenes {
            cases.extend(scene.cases(host)?);
        }
        cases.extend(strangers(host)?);
        progress(1.0);
        Ok(ModelValidation {
            host: host.title.clone(),
            instruction_set: host.instruction_set.clone(),
            state: host.measured.state.clone(),
            calibrated,
            rounds: done,
            errors: errors::errors(&cases),
            cases,
        })
    })
}

fn runs(effort: &Effort) -> impl Iterator<Item = Run> {
    let places = effort
        .particles
        .iter()
        .flat_map(|&particles| effort.occupancies.iter().map(move |&occupancy| (particles, occupancy)));
    places.flat_map(|(particles, occupancy)| {
        PRECISIONS.into_iter().flat_map(move |precision| {
            EXECUTIONS.map(|(execution, _)| Run { particles, occupancy, precision, execution })
        })
    })
}

/// A run, and what was measured of it.
struct Scene {
    run: Run,
    checked: Checked,
    step: Option<(Step, Execution)>,
    times: Option<PhaseTimes>,
}

impl Scene {
    fn new(run: Run) -> Result<Scene, MeasurementError> {
        let checked = run.scene(std::convert::identity)?;
        let named = EXECUTIONS.iter().find(|(name, _)| *name == run.execution);
        let step = named.and_then(|(_, execution)| *execution).map(|execution| {
            let model = model(&checked);
            let lengths = Lengths::new(&model, checked.particles.grain_count(), checked.particles.len());
            (Step::new(&programs(&model, checked.scene.machine.precision), &lengths), execution)
        });
        Ok(Scene { run, checked, step, times: None })
    }

    /// Nanoseconds of every phase of programs, and the baseline's; none where work depends on the data.
    fn programs(&self, host: &HostModel) -> Result<Option<Vec<[f64; 2]>>, ValidationError> {
        let Some((step, execution)) = &self.step else { return Ok(None) };
        let phases = Phase::ALL.iter().map(|&phase| step.phase(host, phase, *execution));
        phases.collect::<Result<_, _>>().map(Some).map_err(|cause| self.out(cause))
    }

    fn out(&self, cause: OutOfRange) -> ValidationError {
        ValidationError::OutOfRange { case: self.run.name(), cause }
    }

    fn measure(&mut self, effort: &Effort) -> Result<(), MeasurementError> {
        let sampling = Sampling {
            equilibration: match self.step {
                Some(_) => WARMED,
                None => (effort.particle_steps / self.run.particles).clamp(5, 50),
            },
            repeats: 1,
            particle_steps: effort.particle_steps,
            // Lists are rebuilt every few steps only.
            least_steps: if self.run.has_lists() { 6 } else { 2 },
        };
        self.times = Some(PhaseTimes::with(self.times.take(), phase_times(&self.checked, &sampling)?));
        Ok(())
    }

    /// The phases and the whole step.
    fn cases(&self, host: &HostModel) -> Result<Vec<Case>, ValidationError> {
        let Some(times) = &self.times else { return Ok(vec![]) };
        let predicted: Vec<(f64, Option<f64>)> = match self.programs(host)? {
            Some(all) => all.into_iter().map(|[ns, baseline]| (ns, Some(baseline))).collect(),
            None => {
                let phases = rated(host, &self.run, times).map_err(|cause| self.out(cause))?;
                phases.into_iter().map(|ns| (ns, None)).collect()
            }
        };
        let Run { particles, occupancy, precision, execution } = self.run;
        let place = format!("{precision}, NP = {particles}, ρ = {occupancy}");
        let phases = Phase::ALL.iter().zip(predicted).map(|(&phase, (predicted, baseline))| Case {
            place: place.clone(),
            execution,
            phase: phase.name(),
            predicted,
            measured: times.of(phase),
            halves: times.halves(phase),
            baseline,
        });
        // Not every execution has every phase.
        let mut cases: Vec<Case> = phases.filter(|case| case.measured > 0.0).collect();
        let step = Case::step(&cases);
        cases.extend(step);
        Ok(cases)
    }
}

/// What is predicted of the phases of a run whose work depends on the data, given what it had to do.
fn rated(host: &HostModel, run: &Run, times: &PhaseTimes) -> Result<Vec<f64>, OutOfRange> {
    let method = run.rates().unwrap_or_default();
    let rates = host.rates.get(method).ok_or_else(|| OutOfRange::NotMeasured(format!("method {method}")))?;
    Phase::ALL.iter().map(|phase| rates.phase(run.precision, phase.name(), &times.amounts)).collect()
}
