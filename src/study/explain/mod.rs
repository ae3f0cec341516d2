//! Which way to run a scene, with which step and for how long, for an error that can be borne at the least cost.
//!
//! Trial runs of some seconds say what each way costs (`findings`), how long its step may be before theory, a check or a failure speaks against it, how a
//! mean scatters, and how far a long step takes it off (`bias`). From these follow the step and the run length that reach an error most cheaply
//! (`optimum`), and with them a plan (`plan`). Nothing here is fitted: what trials could not see is counted as error, with its bar.

pub(crate) mod accuracy;
mod alike;
mod another_start;
mod as_it_stands;
mod bias;
pub(crate) mod certified;
mod collisions;
mod creep;
mod decisions;
mod differences;
mod drift;
mod drifts;
mod findings;
mod keeping;
mod kept;
pub(crate) mod left_out;
mod lengths;
mod margin;
mod mean;
mod optimum;
mod plan;
mod recommended;
#[cfg(test)]
mod rules;
mod seen;
mod shadow;
mod skin;
mod timing;
mod tuned;
mod twins;
mod unreached;
mod whole;
mod words;

pub(crate) use kept::{Kept, KeptError};
use plan::in_unit;
pub(crate) use recommended::Plan;
pub(crate) use tuned::tuned;
pub(crate) use unreached::Unreached;
pub(crate) use words::{page, seconds, with_unit};

use super::Case;
use crate::results::{Journal, JournalError};
use crate::study::trial::Trial;
use findings::Findings;
use seen::{planned, seen};
use stripmine_physics::method::{Kind, Quantity};
use stripmine_physics::number::significant;
use stripmine_physics::reported::{Class, Reported};
use stripmine_physics::scene::Width;

/// Seconds of trials at most, where nothing else is asked for, and where one is patient.
pub(crate) const SECONDS: [f64; 2] = [10.0, 60.0];

/// The most wall seconds that a plan may take by default.
pub(crate) const LIMIT: f64 = 3600.0;

/// What is asked for.
#[derive(Clone, Debug)]
pub(crate) struct Target {
    pub quantity: Quantity,
    /// Its place among those observed.
    pub place: usize,
    /// The error of its mean that can be borne; none where the scene's own values are to be judged.
    pub error: Option<Width>,
    /// Wall seconds in which the least error is to be had, in the place of an error.
    pub within: Option<f64>,
    /// The most wall seconds that a plan may take.
    pub limit: f64,
    /// From when to when each run is averaged over (time); none for the steady state, or the whole run of a scene that changes all along.
    pub window: Option<[f64; 2]>,
}

/// Why there is no plan.
#[derive(Debug, thiserror::Error)]
pub(crate) enum ExplainError {
    /// The scene observes nothing of that name.
    #[error("`{name}` is nothing that this scene observes\n  help: one of {}", known.join(", "))]
    NoSuchQuantity {
        /// What was asked for.
        name: String,
        /// What it observes.
        known: Vec<&'static str>,
    },
    /// The scene breaks, however it is run.
    #[error(
        "every trial of the scene breaks; tried were:{}\n  help: lower integrator.dt, or mend what the failures name",
        .0.iter().map(|(what, why)| format!("\n  {what}: {why}")).collect::<String>()
    )]
    EveryWayFails(Vec<(String, String)>),
    /// The quantity comes to no mean.
    #[error(
        "{quantity} did not become stationary during the trials: {why}\n  help: {}; or choose another quantity with --of",
        longer_trials(*enough, *run)
    )]
    NoMean {
        quantity: &'static str,
        /// What was seen.
        why: String,
        /// Seconds of trials that would be enough, as far as these tell.
        enough: Option<f64>,
        /// Wall seconds of a run of the scene as it stands.
        run: Option<f64>,
    },
    /// No way comes to the error.
    #[error(
        "no plan reaches an error of {} of {quantity}: {unreached}\n  help: accept a larger error, or {}",
        significant(unreached.wanted, 3),
        unreached.advice()
    )]
    OutOfReach {
        quantity: &'static str,
        /// What was asked for, and what is known.
        unreached: Unreached,
    },
    /// No plan is as quick.
    #[error(
        "no run tells a mean of {quantity} in {} s: the shortest takes about {} s\n  help: give it more with --time",
        significant(*within, 3),
        significant(*least, 2)
    )]
    TooQuick {
        quantity: &'static str,
        /// Wall seconds that were given.
        within: f64,
        /// Wall seconds of the quickest plan.
        least: f64,
    },
    /// A window that is none.
    #[error(
        "{0:?} is no window\n  help: give the time from which and to which a run is averaged over, such as --window 2 8"
    )]
    NoWindow(Vec<f64>),
    /// Nothing was kept of the scene.
    #[error(
        "nothing is known here of this scene\n  help: run it without --estimate once; what is measured is kept"
    )]
    NothingKept,
    #[error(transparent)]
    Kept(#[from] KeptError),
    /// The journal of trials.
    #[error(transparent)]
    Journal(#[from] JournalError),
    /// The user stopped it.
    #[error("the trials were stopped\n  help: the same command goes on with those that are finished")]
    Stopped,
}

/// The longest that trials may be asked to take (s).
const LONGEST: f64 = 3600.0;

/// Advice that makes trials long enough, or spares them where the scene itself takes less time.
fn longer_trials(enough: Option<f64>, run: Option<f64>) -> String {
    match enough.map(f64::ceil) {
        Some(enough) if run.is_some_and(|run| run < enough) => format!(
            "trials of about {} s would be enough, and a run of the scene as it stands takes about {}: run it instead, and average",
            significant(enough, 2),
            seconds(run.unwrap_or(enough))
        ),
        Some(seconds) if seconds <= LONGEST => {
            format!("trials of about {seconds:.0} s should be enough: --seconds {seconds:.0}")
        }
        Some(seconds) => {
            format!(
                "trials of about {} s should be enough, more than {LONGEST:.0} s",
                significant(seconds, 2)
            )
        }
        None => "--patient looks longer, and where some whole runs take less than that, at these".to_owned(),
    }
}

impl Reported for ExplainError {
    fn class(&self) -> Class {
        match self {
            ExplainError::NoSuchQuantity { .. } | ExplainError::NoWindow(_) => Class::Usage,
            ExplainError::Kept(error) => error.class(),
            ExplainError::Journal(error) => error.class(),
            _ => Class::Precondition,
        }
    }

    fn passed_on(&self) -> Option<&dyn Reported> {
        match self {
            ExplainError::Kept(error) => Some(error),
            ExplainError::Journal(error) => Some(error),
            _ => None,
        }
    }
}

impl Target {
    /// Of a quantity, or the first that the method has a mean of.
    ///
    /// # Errors
    /// [`ExplainError::NoSuchQuantity`]
    pub(crate) fn of(case: &Case, name: Option<&str>, error: Option<Width>) -> Result<Target, ExplainError> {
        let quantities = case.entry.quantities;
        let is_judged = |quantity: &&Quantity| quantity.kind != Kind::Time;
        let known: Vec<&'static str> = quantities.iter().filter(is_judged).map(|it| it.name).collect();
        let first = || {
            let of_trials = case.entry.trials.and_then(|trials| trials.observables.first().copied());
            let of_intervals = quantities.iter().find(|it| it.kind == Kind::Interval);
            of_trials.or(of_intervals.map(|it| it.name)).unwrap_or_default()
        };
        let name = name.unwrap_or_else(first);
        let place = quantities.iter().position(|it| it.name == name && is_judged(&it));
        let place = place.ok_or_else(|| ExplainError::NoSuchQuantity { name: name.to_owned(), known })?;
        Ok(Target { quantity: quantities[place], place, error, within: None, limit: LIMIT, window: None })
    }

    /// The same over a window, from one time to another, where one is given.
    ///
    /// # Errors
    /// [`ExplainError::NoWindow`] if it does not end after it begins.
    pub(crate) fn over(self, window: Option<&[f64]>) -> Result<Target, ExplainError> {
        match window {
            None => Ok(self),
            Some(&[from, to]) if 0.0 <= from && from < to && to.is_finite() => {
                Ok(Target { window: Some([from, to]), ..self })
            }
            Some(window) => Err(ExplainError::NoWindow(window.to_vec())),
        }
    }

    /// Whether it should keep its value: its error is then how far it goes from the first.
    pub(crate) fn is_kept(&self) -> bool {
        self.quantity.kind == Kind::Kept
    }
}

/// What is recommended: by what is kept of the scene from trials at least as long, or by trials of some seconds, which are kept. Of no seconds at
/// all nothing is run. What cannot be kept, or recalled, is no reason not to plan: `notice` is told.
///
/// # Errors
/// [`ExplainError`]
pub(crate) fn explain(
    case: &Case,
    target: &Target,
    seconds: f64,
    kept: &Kept,
    trial: Trial<'_>,
    notice: &dyn Fn(&KeptError),
) -> Result<Plan, ExplainError> {
    let key = kept.key(case, target);
    let recalled = kept.recall(case, &key, seconds).unwrap_or_else(|error| {
        notice(&error);
        None
    });
    let (findings, origin) = match recalled {
        Some((findings, origin)) => (findings, origin),
        None if seconds == 0.0 => return Err(ExplainError::NothingKept),
        None => {
            let begun = trial.watch.now();
            let journal = kept.journal(case, target, seconds).unwrap_or_else(|error| {
                notice(&error);
                Journal::none()
            });
            let findings = seen(case, target, seconds, trial, (&|_| {}, &journal))?;
            let taken = trial.watch.now() - begun;
            let kept_now = kept.keep(case, &key, [seconds, taken], &findings);
            if let Err(error) = kept_now.and_then(|()| kept.close(case, target, seconds)) {
                notice(&error);
            }
            (findings, kept.origin(taken))
        }
    };
    if let Some(within) = target.within {
        return within_seconds(case, target, &findings, &origin, within);
    }
    let quantity = target.quantity.name;
    planned(case, target, &findings, &origin)
        .map_err(|it| ExplainError::OutOfReach { quantity, unreached: Unreached { trials: seconds, ..it } })
}

/// Errors are asked for within this factor of the least that can be had in a time.
const NEAR: f64 = 1.02;
/// From the least to the largest error that is weighed against a time, in parts of the mean.
const WEIGHED: [f64; 2] = [1e-12, 10.0];

/// The plan of the least error that is expected to take no more than some wall seconds.
///
/// # Errors
/// [`ExplainError::TooQuick`], where no plan is as quick.
fn within_seconds(
    case: &Case,
    target: &Target,
    findings: &Findings,
    origin: &str,
    within: f64,
) -> Result<Plan, ExplainError> {
    let scale = if target.is_kept() { 1.0 } else { findings.mean.mean.abs() };
    let asking = |error: f64| {
        let target =
            Target { error: Some(Width::Absolute(error * scale)), limit: f64::INFINITY, ..target.clone() };
        planned(case, &target, findings, origin)
    };
    let [mut low, mut high] = WEIGHED;
    let mut best = None;
    while high / low > NEAR {
        let middle = (low * high).sqrt();
        match asking(middle) {
            Ok(plan) if plan.seconds.likely <= within => {
                high = middle;
                best = Some(plan);
            }
            _ => low = middle,
        }
    }
    best.ok_or_else(|| ExplainError::TooQuick {
        quantity: target.quantity.name,
        within,
        least: asking(WEIGHED[1]).map_or(f64::INFINITY, |plan| plan.seconds.likely),
    })
}
