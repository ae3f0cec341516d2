//! One collision of two discs: what comes out of it, over the step and over where in a step the contact begins.
//!
//! A step that holds the beginning or the end of a contact makes an error that depends on where in the step it falls: for a
//! force that sets in as ξ^s it is dt^(s+1) ζ(−s, phase), Hurwitz's zeta function, whose mean over all phases is zero. A
//! single run therefore lies on no line over the step; the root of the mean square over the phases does, and so does the
//! mean, which falls faster.

use super::choice::Choice;
use super::orders::{Fitted, fit};
use super::state::{State, displaced};
use super::subject::Subject;
use super::trial::{Course, follow};
use crate::results::{Journal, JournalError, Meter};
use stripmine_physics::method::{Decides, Purpose};
use stripmine_physics::scene::Overrides;

/// Outcomes of a collision.
pub const OUTCOMES: [&str; 2] = ["restitution", "deflection"];
/// The step of the reference, in the smallest of the steps that are tried.
const REFERENCE: f64 = 0.125;

/// What came out.
#[derive(Clone, Debug, PartialEq)]
pub struct Collision {
    /// Relative speed after over that before, and the angle by which the relative velocity turns (radian), of the reference.
    pub reference: [f64; 2],
    /// Starts a step, each a part of a step later than the one before.
    pub phases: u32,
    /// Errors by scheme and step.
    pub errors: Vec<OutcomeError>,
    /// Orders fitted through them.
    pub orders: Vec<OutcomeOrder>,
}

/// The error of the outcomes of a scheme with a step.
#[derive(Clone, Debug, PartialEq)]
pub struct OutcomeError {
    pub choice: String,
    /// The step (time).
    pub step: f64,
    /// Root of the mean square over the phases, for each outcome.
    pub spread: [f64; 2],
    /// Magnitude of the mean over the phases.
    pub mean: [f64; 2],
}

/// How the errors of a scheme fall with the step.
#[derive(Clone, Debug, PartialEq)]
pub struct OutcomeOrder {
    pub choice: String,
    pub outcome: String,
    /// Of the root of the mean square over the phases.
    pub spread: Option<Fitted>,
    /// Of the mean over the phases.
    pub mean: Option<Fitted>,
}

/// Whether a scene is a collision of two discs.
pub fn is_collision(subject: &Subject) -> bool {
    let particles = subject.prepared.particles();
    subject.trials.has_contacts && particles.grain_count() == 2 && particles.len() == 2
}

/// Collisions by every scheme over `steps` (time, rising), each with `phases` starts. None where the discs do not part within
/// the time of the scene.
pub fn collision(
    subject: &Subject,
    steps: &[f64],
    phases: u32,
    journal: &Journal,
    meter: &Meter<'_>,
) -> Result<Option<Collision>, JournalError> {
    let Some(&smallest) = steps.first() else { return Ok(None) };
    let outcome = |choice: &Choice, step: f64, phase: u32| {
        let key = format!("collision|{}|{step:?}|{phase}/{phases}", choice.label());
        let fits = |found: &Option<[f64; 2]>| found.iter().flatten().all(|value| value.is_finite());
        journal.recall(&key, fits, || {
            Ok::<_, JournalError>(outcome(subject, choice, step, f64::from(phase) / f64::from(phases), meter))
        })
    };
    let over_phases = |choice: &Choice, step: f64| -> Result<Option<Vec<[f64; 2]>>, JournalError> {
        (0..phases).map(|phase| outcome(choice, step, phase)).collect()
    };
    let first = subject.own.with(subject.trials.references[0]);
    let Some(reference) = over_phases(&first, REFERENCE * smallest)? else { return Ok(None) };
    let reference = mean(&reference);
    let schemes: Vec<Choice> =
        Choice::all(subject.entry.axes).into_iter().filter(|choice| varies(choice, &first)).collect();
    let cases: Vec<(&Choice, f64)> =
        schemes.iter().flat_map(|choice| steps.iter().map(move |step| (choice, *step))).collect();
    let found: Vec<Option<OutcomeError>> = journal.over(&cases, |(choice, step)| {
        let error = |outcomes: Vec<[f64; 2]>| {
            let off: Vec<[f64; 2]> =
                outcomes.iter().map(|outcome| [0, 1].map(|i| outcome[i] - reference[i])).collect();
            let squares: Vec<[f64; 2]> = off.iter().map(|off| off.map(|off| off * off)).collect();
            OutcomeError {
                choice: choice.label(),
                step: *step,
                spread: mean(&squares).map(f64::sqrt),
                mean: mean(&off).map(f64::abs),
            }
        };
        Ok::<_, JournalError>(over_phases(choice, *step)?.map(error))
    })?;
    let errors: Vec<OutcomeError> = found.into_iter().flatten().collect();
    let order = |choice: &Choice, i: usize| {
        let of = |error: fn(&OutcomeError) -> [f64; 2]| {
            let own = errors.iter().filter(|error| error.choice == choice.label());
            fit(&own.map(|it| (it.step, error(it)[i])).collect::<Vec<_>>(), 0.0, LARGE)
        };
        OutcomeOrder {
            choice: choice.label(),
            outcome: OUTCOMES[i].to_owned(),
            spread: of(|error| error.spread),
            mean: of(|error| error.mean),
        }
    };
    let orders = schemes.iter().flat_map(|choice| [0, 1].map(|i| order(choice, i))).collect();
    Ok(Some(Collision { reference, phases, errors, orders }))
}

/// Errors that are of no convergence.
const LARGE: f64 = 0.1;

/// Whether a choice differs from another in what decides the order at most.
fn varies(choice: &Choice, other: &Choice) -> bool {
    [Decides::Digits, Decides::Cost].iter().all(|&decides| choice.agrees(other, decides))
}

fn mean(values: &[[f64; 2]]) -> [f64; 2] {
    [0, 1].map(|i| values.iter().map(|value| value[i]).sum::<f64>() / values.len().max(1) as f64)
}

/// What comes out of a collision whose discs fly a part of a step longer before it; none where it breaks or does not end.
fn outcome(subject: &Subject, choice: &Choice, step: f64, phase: f64, meter: &Meter<'_>) -> Option<[f64; 2]> {
    let scene = subject.prepared_as(choice, step, &Overrides::new()).ok()?;
    let domain = scene.domain;
    let late = displaced(scene.particles(), &domain, |_, disc| {
        disc.planar_velocity().map(|part| -phase * step * part)
    });
    let scene = scene.model.started_from(late);
    let (before, gap) = State::of(scene.particles()).pair(&domain)?;
    let steps = (subject.steps as f64 * subject.step / step).round() as u64;
    let course = Course { steps, looks: 1, each: 1e-6 };
    let end = follow(&scene, Purpose::Measurement, course, None, meter, |_| {}).ok()?;
    let (after, apart) = end.state.pair(&domain)?;
    let speed = |[u, v]: [f64; 2]| u.hypot(v);
    let turned =
        libm::atan2(before[0] * after[1] - before[1] * after[0], before[0] * after[0] + before[1] * after[1]);
    let is_over = gap > 0.0 && apart > 0.0 && before != after;
    is_over.then(|| [speed(after) / speed(before), turned])
}
