//! How good is the host model? Predicted against measured: whole steps of moving discs and their phases, timed as runs time them, and
//! programs of laws that nothing was calibrated on.

mod errors;
mod strangers;

use super::calibration::{self, CalibrationError, calibrate};
use super::phase_times::{FAST, FAST_LISTS, LISTS, PhaseTimes, Run, Sampling, phase_times};
use super::predicted_step::Step;
use super::rounds::Bound;
use crate::console::Failure;
use crate::frame::{Frame, Rows};
use crate::model::host::{HostModel, OutOfRange, default_model};
use crate::results::{Lab, Made, Size};
use errors::Case;
use std::time::Duration;
use strangers::strangers;
use stripmine_kernels::{Execution, InstructionSet};
use stripmine_physics::method::lattice_md::{Checked, Lengths, Phase, model, programs};
use stripmine_physics::method::throughput::MeasurementError;
use stripmine_physics::origin;

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
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
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

/// The item: the shipped model on few runs, or, in full, a model calibrated just before on more of them.
///
/// # Errors
/// [`ValidationError`] if this host cannot be calibrated or a scene breaks.
pub fn made(lab: &Lab<'_>, size: Size) -> Result<Made, Failure> {
    let effort = |particles: &[usize], occupancies: &[f64], rounds| Effort {
        particles: particles.to_vec(),
        occupancies: occupancies.to_vec(),
        rounds,
        particle_steps: 10_000,
    };
    let progress = lab.progress;
    Ok(match size {
        Size::Quick => {
            let effort = effort(&[300], &[0.2], Bound::of(2));
            model_validation(&default_model()?, Calibrated::Shipped, &effort, progress)?
        }
        Size::Full | Size::All => {
            let effort_of_calibration = calibration::Effort { seconds: 25.0 };
            let set = InstructionSet::best();
            let host = calibrate(origin::host(), set, effort_of_calibration, |share| progress(0.5 * share))?;
            let rounds = Bound { most: 6, within: Some(Duration::from_secs(15)) };
            let effort = effort(&[150, 4000], &[0.072, 0.24], rounds);
            model_validation(&host, Calibrated::Now, &effort, |share| progress(0.5 + 0.5 * share))?
        }
    })
}

fn summary(host: &HostModel, calibrated: Calibrated, rounds: usize) -> Frame {
    let remark = match calibrated {
        Calibrated::Shipped => "It comes with the program and is not of this host: calibrate first.",
        Calibrated::Before => "It was calibrated at another time.",
        Calibrated::Elsewhere => {
            "It is of another processor, or of other instructions than this host measures by."
        }
        Calibrated::Now => "It was calibrated just before, on other numbers of discs and densities.",
    };
    Rows::of([host])
        .text("model", |host| calibrated.model_of(&host.title))
        .text("remark", |_| remark)
        .text("instructions", |host| &host.instruction_set)
        .text("state of the machine when it was calibrated", |host| &host.measured.state)
        .count("rounds", |_| rounds)
        .frame("summary", "The model")
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
) -> Result<Made, ValidationError> {
    let runs: Vec<Run> = runs(effort).collect();
    // Before discs are placed: large scenes take their time.
    for run in &runs {
        let out = |cause| ValidationError::OutOfRange { case: run.name(), cause };
        host.admits(run.particles).map_err(out)?;
        if run.rates().is_some() {
            run.predicted(host, &PhaseTimes::none(run.particles).amounts).map_err(out)?;
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
        let frames = errors::frames(&cases).into_iter();
        Ok(Made::of(std::iter::once(summary(host, calibrated, done)).chain(frames)).with_seeds([1]))
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

    /// Nanoseconds of every phase of programs; none where work depends on the data.
    fn programs(&self, host: &HostModel) -> Result<Option<Vec<f64>>, ValidationError> {
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
        let predicted = match self.programs(host)? {
            Some(phases) => phases,
            None => self.run.predicted(host, &times.amounts).map_err(|cause| self.out(cause))?,
        };
        let Run { particles, occupancy, precision, execution } = self.run;
        let place = format!("{precision}, NP = {particles}, ρ = {occupancy}");
        let phases = Phase::ALL.iter().zip(predicted).map(|(&phase, predicted)| Case {
            place: place.clone(),
            execution,
            phase: phase.name(),
            predicted,
            measured: times.of(phase),
            depends_on_data: self.step.is_none(),
        });
        // Not every execution has every phase.
        let mut cases: Vec<Case> = phases.filter(|case| case.measured > 0.0).collect();
        let step = Case::step(&cases);
        cases.extend(step);
        Ok(cases)
    }
}
