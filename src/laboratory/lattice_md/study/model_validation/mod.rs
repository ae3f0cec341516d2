//! Validation of the host model: predicted and measured times of whole steps of moving discs, of their phases, and of programs of laws without
//! calibration.

mod errors;
mod uncalibrated_laws;

use super::StudyError;
use super::calibration::calibrate;
use super::phase_times::{BenchRun, FAST, FAST_LISTS, LISTS, PRECISIONS, PhaseTimedRun, step_of_scene};
use crate::console::CommandFailure;
use crate::frame::FrameBuilder;
use crate::laboratory::running::on_threads;
use crate::model::host::{Amounts, HostModel, OutOfRange, StepArrays, default_model};
use crate::results::{FinishedItem, StudyEnvironment, StudySize};
use errors::ValidationCase;
use std::time::Instant;
use stripmine_kernels::Execution;
use stripmine_kernels::backend::tape::Outlines;
use stripmine_physics::method::lattice_md::{Part, Phase};
use stripmine_physics::reported::{ErrorClass, Reported};
use stripmine_physics::scene::Overrides;
use uncalibrated_laws::uncalibrated_laws;

/// Size of a validation.
pub(crate) struct ValidationSize {
    pub(crate) particles: Vec<usize>,
    /// ρ on cells as wide as the radius.
    pub(crate) occupancies: Vec<f64>,
    /// Maximum number of rounds over all runs, and approximate total seconds; at least one round is made.
    pub(crate) rounds: usize,
    pub(crate) seconds: f64,
}

/// Names of the measured executions; programs also with their [`Execution`].
const EXECUTIONS: [(&str, Option<Execution>); 7] = [
    ("eager", Some(Execution::Eager)),
    ("strip:64", Some(Execution::Strip(64))),
    ("strip:512", Some(Execution::Strip(512))),
    ("chained", Some(Execution::Chained)),
    (FAST, None),
    (FAST_LISTS, None),
    (LISTS, None),
];

/// Run or program outside the calibrated range.
#[derive(Debug, thiserror::Error)]
#[error("{case}: {cause}")]
struct OutsideCalibration {
    case: String,
    cause: OutOfRange,
}

impl OutsideCalibration {
    fn of(case: String) -> impl FnOnce(OutOfRange) -> StudyError {
        |cause| StudyError::Own(Box::new(OutsideCalibration { case, cause }))
    }
}

impl Reported for OutsideCalibration {
    fn class(&self) -> ErrorClass {
        ErrorClass::Precondition
    }
}

/// Validates the shipped model on a few runs, or in full a freshly calibrated model on more runs.
///
/// # Errors
/// [`StudyError`] if this host cannot be calibrated or a scene breaks.
pub(crate) fn reproduce(lab: &StudyEnvironment<'_>, size: StudySize) -> Result<FinishedItem, CommandFailure> {
    let progress = lab.progress;
    if size == StudySize::Quick {
        let host = default_model()?;
        let (whose, occupancies) = (format!("the shipped model of {}", host.title), vec![0.2]);
        let effort = ValidationSize { particles: vec![300], occupancies, rounds: 2, seconds: f64::INFINITY };
        return Ok(model_validation(&host, whose, &effort, progress)?);
    }
    let host = calibrate(25.0, |share| progress(0.5 * share))?;
    let (whose, occupancies) = (fresh_model_title(&host), vec![0.072, 0.24]);
    let effort = ValidationSize { particles: vec![150, 4000], occupancies, rounds: 6, seconds: 15.0 };
    Ok(model_validation(&host, whose, &effort, |share| progress(0.5 + 0.5 * share))?)
}

/// Description of a model calibrated on this host.
pub(crate) fn fresh_model_title(host: &HostModel) -> String {
    format!("the model of this host, {}, calibrated just before", host.title)
}

/// Predicts with a model, described by `whose`, and measures on one thread. `progress` receives the completed share.
///
/// # Errors
/// [`StudyError`] if a scene breaks or lies outside the calibrated range; the latter before any run.
pub(crate) fn model_validation(
    host: &HostModel,
    whose: String,
    effort: &ValidationSize,
    progress: impl Fn(f64) + Sync,
) -> Result<FinishedItem, StudyError> {
    let runs: Vec<BenchRun> = runs(effort).collect();
    // Before discs are placed, which takes long in large scenes.
    for run in &runs {
        host.check_length(run.particles).map_err(OutsideCalibration::of(case_name(run)))?;
        if run.rates().is_some() {
            let amounts = Amounts { steps: 1.0, discs: run.particles as f64, ..Amounts::default() };
            run.predicted(host, &amounts).map_err(OutsideCalibration::of(case_name(run)))?;
        }
    }
    let scenes = runs.into_iter().map(|run| PhaseTimedRun::new(run, &Overrides::new()));
    let mut scenes = scenes.collect::<Result<Vec<_>, _>>()?;
    for scene in &scenes {
        predicted_phases(host, scene)?;
    }
    on_threads(1, || {
        let (start, mut done) = (Instant::now(), 0);
        let spent = || start.elapsed().as_secs_f64() / effort.seconds;
        // The next round, if as long as the previous ones, must end in time.
        while done == 0 || done < effort.rounds && spent() * (1.0 + 1.0 / done as f64) <= 1.0 {
            let all = scenes.len() as f64;
            for (scene, at) in scenes.iter_mut().zip(1..) {
                scene.measure()?;
                let by_number = (done as f64 + f64::from(at) / all) / effort.rounds as f64;
                progress(0.9 * by_number.max(spent()).min(1.0));
            }
            done += 1;
        }
        let mut cases = vec![];
        for scene in &scenes {
            cases.extend(measured_cases(host, scene)?);
        }
        cases.extend(uncalibrated_laws(host)?);
        progress(1.0);
        let summary = FrameBuilder::of([host])
            .text("model", |_| &whose)
            .text("instructions", |host| &host.instruction_set)
            .text("state of the machine when it was calibrated", |host| &host.measured.state)
            .count("rounds", |_| done)
            .frame("summary", "The model");
        Ok(FinishedItem::of([summary].into_iter().chain(errors::frames(&cases))).with_seeds([1]))
    })
}

fn runs(effort: &ValidationSize) -> impl Iterator<Item = BenchRun> {
    let places = effort
        .particles
        .iter()
        .flat_map(|&particles| effort.occupancies.iter().map(move |&occupancy| (particles, occupancy)));
    places.flat_map(|(particles, occupancy)| {
        PRECISIONS.into_iter().flat_map(move |precision| {
            EXECUTIONS.map(|(execution, _)| BenchRun { particles, occupancy, precision, execution })
        })
    })
}

fn case_label(BenchRun { particles, occupancy, precision, .. }: &BenchRun) -> String {
    format!("{precision}, NP = {particles}, ρ = {occupancy}")
}

fn case_name(run: &BenchRun) -> String {
    format!("{}, {}", run.execution, case_label(run))
}

/// Predicted nanoseconds of every phase.
fn predicted_phases(host: &HostModel, scene: &PhaseTimedRun) -> Result<Vec<f64>, StudyError> {
    let run = scene.run;
    let named = EXECUTIONS.iter().find(|(name, _)| *name == run.execution);
    let Some(execution) = named.and_then(|(_, execution)| *execution) else {
        return run
            .predicted(host, &scene.amounts_per_step())
            .map_err(OutsideCalibration::of(case_name(&run)));
    };
    let (programs, lengths) = step_of_scene(&scene.checked);
    let outlined = programs.iter().map(|it| (it.part, it.program.outlines(), lengths.range(it.length).len()));
    let outlined: Vec<(Part, Outlines, usize)> = outlined.collect();
    let cycle: Vec<(&Outlines, usize)> = outlined.iter().map(|(_, outlines, n)| (outlines, *n)).collect();
    let around = StepArrays::of_step(&cycle);
    let of_phase = |phase: &Phase| {
        let parts: &[Part] = match phase {
            Phase::Predict => &[Part::Predictor],
            Phase::Index => &[Part::Index, Part::Lattice],
            Phase::Forces => &[Part::Forces],
            Phase::Correct => &[Part::Corrector],
            // Only in the fast engine, which has no programs.
            Phase::CorrectPredict | Phase::Halo => &[],
        };
        let own = outlined.iter().filter(|(part, ..)| parts.contains(part));
        own.map(|(_, outlines, n)| host.program(outlines, *n, execution, &around)).sum()
    };
    Phase::ALL.iter().map(of_phase).collect::<Result<_, _>>().map_err(OutsideCalibration::of(case_name(&run)))
}

/// Cases of the phases of a run and of the whole step.
fn measured_cases(host: &HostModel, scene: &PhaseTimedRun) -> Result<Vec<ValidationCase>, StudyError> {
    let phases =
        Phase::ALL.iter().zip(predicted_phases(host, scene)?).map(|(&phase, predicted)| ValidationCase {
            place: case_label(&scene.run),
            execution: scene.run.execution,
            phase: phase.name(),
            predicted,
            measured: scene.ns(phase),
        });
    // Not every execution has every phase.
    let mut cases: Vec<ValidationCase> = phases.filter(|case| case.measured > 0.0).collect();
    cases.extend(ValidationCase::step(&cases));
    Ok(cases)
}
