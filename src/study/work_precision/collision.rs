//! Collision of two discs: errors of its outcomes as functions of the step and of the phase of a step at which the contact begins.
//!
//! A step that contains the beginning or the end of a contact makes an error that depends on its phase within the step: for a
//! force that starts as ξ^s it is dt^(s+1) ζ(−s, phase), Hurwitz's zeta function, whose mean over all phases is zero. Errors of
//! single runs therefore do not fall on a line over the step. The root mean square over the phases does, and so does the
//! mean, which falls faster.

use super::orders::{FittedOrder, fit};
use crate::study::choice::SettingChoice;
use crate::study::runs::StudyRuns;
use crate::study::state::{ParticleState, delayed_scene};
use crate::study::trial::{RunFailure, RunSampling};
use crate::study::{StudyError, Subject};
use stripmine_physics::method::{ChoiceEffect, StartPurpose};
use stripmine_physics::scene::Overrides;

/// Outcomes of a collision: ratio of the relative speeds after and before, and the angle by which the relative velocity turns (radian).
const OUTCOMES: [&str; 2] = ["restitution", "deflection"];
/// Step of the reference, in parts of the smallest step tried.
const REFERENCE: f64 = 0.125;
/// Errors above this are outside the range of convergence.
const LARGE: f64 = 0.1;

/// Errors of a collision.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Collision {
    /// Starts of each step, each a fraction of a step later than the last.
    pub phases: u32,
    /// Errors by scheme and step.
    pub(crate) errors: Vec<OutcomeError>,
    /// Orders fitted to them.
    pub orders: Vec<OutcomeOrder>,
}

/// Error of the outcomes of a scheme at a step.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct OutcomeError {
    pub(crate) choice: String,
    /// The step (time).
    pub step: f64,
    /// Root mean square over the phases, for each outcome.
    pub spread: [f64; 2],
    /// Magnitude of the mean over the phases.
    pub mean: [f64; 2],
}

/// Order of convergence of a scheme.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct OutcomeOrder {
    pub(crate) choice: String,
    pub outcome: &'static str,
    /// Order of the root mean square over the phases.
    pub spread: Option<FittedOrder>,
    /// Order of the mean over the phases.
    pub mean: Option<FittedOrder>,
}

/// True if a scene is a collision of two discs.
fn is_collision(subject: &Subject) -> bool {
    let particles = subject.prepared.particles();
    subject.trials.has_contacts && particles.grain_count() == 2 && particles.len() == 2
}

/// Runs the collision with every scheme at some steps (time, rising), each from as many starts as there are phases. None unless the scene is a
/// collision of two discs that separate within its time.
///
/// # Errors
/// [`StudyError`] as for [`StudyRuns::recall`].
pub(crate) fn collision(
    runs: &StudyRuns<'_>,
    steps: &[f64],
    phases: u32,
) -> Result<Option<Collision>, StudyError> {
    let Some(&smallest) = steps.first().filter(|_| is_collision(runs.subject)) else { return Ok(None) };
    let over_phases = |choice: &SettingChoice, step: f64| -> Result<Option<Vec<[f64; 2]>>, StudyError> {
        let outcome = |phase: u32| {
            let key = format!("collision|{}|{step:?}|{phase}/{phases}", choice.label());
            let fits = |found: &Option<[f64; 2]>| found.iter().flatten().all(|value| value.is_finite());
            let late = f64::from(phase) / f64::from(phases) * step;
            let outcome = runs.recall(&key, fits, || outcome(runs, choice, step, late));
            outcome.map(|outcome| outcome.ok().flatten())
        };
        (0..phases).map(outcome).collect()
    };
    let first = runs.subject.reference(0);
    let Some(reference) = over_phases(&first, REFERENCE * smallest)? else { return Ok(None) };
    let reference = mean(&reference);
    let is_alike = |choice: &SettingChoice| {
        [ChoiceEffect::Precision, ChoiceEffect::Cost].iter().all(|&decides| choice.agrees_on(&first, decides))
    };
    let schemes: Vec<SettingChoice> =
        SettingChoice::all(runs.subject.entry.axes).into_iter().filter(is_alike).collect();
    let cases: Vec<(&SettingChoice, f64)> =
        schemes.iter().flat_map(|choice| steps.iter().map(move |step| (choice, *step))).collect();
    let found = runs.journal.run_all(&cases, |&(choice, step)| {
        let error = |outcomes: Vec<[f64; 2]>| {
            let off: Vec<[f64; 2]> =
                outcomes.iter().map(|outcome| [0, 1].map(|i| outcome[i] - reference[i])).collect();
            let squares: Vec<[f64; 2]> = off.iter().map(|off| off.map(|off| off * off)).collect();
            let (spread, mean) = (mean(&squares).map(f64::sqrt), mean(&off).map(f64::abs));
            OutcomeError { choice: choice.label(), step, spread, mean }
        };
        Ok::<_, StudyError>(over_phases(choice, step)?.map(error))
    })?;
    let errors: Vec<OutcomeError> = found.into_iter().flatten().collect();
    let order = |choice: &SettingChoice, i: usize| {
        let of = |error: fn(&OutcomeError) -> [f64; 2]| {
            let own = errors.iter().filter(|error| error.choice == choice.label());
            fit(&own.map(|it| (it.step, error(it)[i])).collect::<Vec<_>>(), 0.0, LARGE)
        };
        OutcomeOrder {
            choice: choice.label(),
            outcome: OUTCOMES[i],
            spread: of(|error| error.spread),
            mean: of(|error| error.mean),
        }
    };
    let orders = schemes.iter().flat_map(|choice| [0, 1].map(|i| order(choice, i))).collect();
    Ok(Some(Collision { phases, errors, orders }))
}

fn mean(values: &[[f64; 2]]) -> [f64; 2] {
    [0, 1].map(|i| values.iter().map(|value| value[i]).sum::<f64>() / values.len().max(1) as f64)
}

/// Outcomes of a collision delayed by a time; none where the discs do not touch and separate.
fn outcome(
    runs: &StudyRuns<'_>,
    choice: &SettingChoice,
    step: f64,
    late: f64,
) -> Result<Option<[f64; 2]>, RunFailure> {
    let scene = delayed_scene(&runs.subject.prepared_as(choice, step, &Overrides::new())?, late);
    let domain = scene.domain;
    let steps = (runs.subject.duration() / step).round() as u64;
    let course = RunSampling { steps, looks: 1, each: 1e-6 };
    let end = runs.follow(&scene, StartPurpose::Measurement, course, |_| {})?;
    let pair = |particles| ParticleState::of(particles).pair(&domain);
    let (Some((before, gap)), Some((after, apart))) = (pair(scene.particles()), pair(&end.particles()))
    else {
        return Ok(None);
    };
    let speed = |[u, v]: [f64; 2]| u.hypot(v);
    let turned =
        libm::atan2(before[0] * after[1] - before[1] * after[0], before[0] * after[0] + before[1] * after[1]);
    let is_over = gap > 0.0 && apart > 0.0 && before != after;
    Ok(is_over.then(|| [speed(after) / speed(before), turned]))
}
