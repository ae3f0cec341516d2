//! The planner: finds the configuration, step and run length that reach a target error at the least cost.
//!
//! Short trial runs measure the cost of each configuration (`findings`), the longest step before a theoretical limit, a check or a failure, the
//! scatter of the mean, and its bias at a long step (`bias`). From these follow the cheapest step and run length (`optimum`), and with them a plan
//! (`plan`). Nothing here is fitted: what the trials could not resolve counts as error, with its error bar.

pub(crate) mod accuracy;
mod another_start;
mod as_it_stands;
mod auto_settings;
mod bias;
mod cache;
pub(crate) mod certified;
mod collisions;
mod conservation;
mod creep;
mod decisions;
mod differences;
mod drift;
mod drifts;
mod findings;
pub(crate) mod left_out;
mod lengths;
mod margin;
mod mean;
mod optimum;
mod plan;
mod recommended;
#[cfg(test)]
mod rules;
mod shadow;
mod similarity;
mod simpler_models;
mod skin;
mod timing;
mod trial_runs;
mod unreachable;
mod whole_runs;
mod words;

pub(crate) use auto_settings::tuned_settings;
pub(crate) use cache::{PlanCache, PlanCacheError};
use plan::in_unit;
pub(crate) use recommended::RunPlan;
pub(crate) use unreachable::Unreached;
pub(crate) use words::{page, seconds, with_unit};

use super::StudyCase;
use crate::results::{Journal, JournalError};
use crate::study::trial::TrialControl;
use findings::Findings;
use stripmine_physics::method::{ObservedQuantity, QuantityKind};
use stripmine_physics::number::significant;
use stripmine_physics::reported::{ErrorClass, Reported};
use stripmine_physics::scene::Width;
use trial_runs::{measure_findings, plan_or_scene};

/// Longest total time of the trials (s): by default, and with `--patient`.
pub(crate) const SECONDS: [f64; 2] = [10.0, 60.0];

/// Longest wall time of a plan by default (s).
pub(crate) const LIMIT: f64 = 3600.0;

/// Most bodies that are judged over every step of their whole run: it takes seconds, and the mean of a few orbits says little.
const FEW: usize = 16;

/// True if a scene has few bodies, whose close encounters decide its error.
fn is_of_few(case: &StudyCase) -> bool {
    let has_late_encounters = case.entry.trials.is_some_and(|trials| trials.has_late_encounters);
    has_late_encounters && case.prepared.particles().len() <= FEW
}

/// Quantity and error that a plan is asked for.
#[derive(Clone, Debug)]
pub(crate) struct PlanTarget {
    pub quantity: ObservedQuantity,
    /// Index among the observed quantities.
    pub place: usize,
    /// Target error of the mean; none where the scene's own values are to be judged.
    pub error: Option<Width>,
    /// Wall seconds within which the error is to be minimised, instead of a target error.
    pub within: Option<f64>,
    /// Longest wall time of a plan (s).
    pub limit: f64,
    /// Window that each run is averaged over (time); none for the steady state, or for the whole run of a scene that never becomes stationary.
    pub window: Option<[f64; 2]>,
}

/// Failures to make a plan.
#[derive(Debug, thiserror::Error)]
pub(crate) enum ExplainError {
    /// The scene does not observe the named quantity.
    #[error("this scene does not observe `{name}`\n  help: use one of {}", known.join(", "))]
    NoSuchQuantity { name: String, known: Vec<&'static str> },
    /// Every configuration of the scene fails.
    #[error(
        "every trial of the scene fails; tried:{}\n  help: lower integrator.dt, or fix what the failures name",
        .0.iter().map(|(what, why)| format!("\n  {what}: {why}")).collect::<String>()
    )]
    EveryConfigurationFails(Vec<(String, String)>),
    /// The quantity does not become stationary.
    #[error(
        "{quantity} did not become stationary during the trials: {why}\n  help: {}; or choose another quantity with --of",
        longer_trials(*enough, *run)
    )]
    NoMean {
        quantity: &'static str,
        why: String,
        /// Trial time that would suffice (s), estimated from these trials.
        enough: Option<f64>,
        /// Wall time of a run of the scene as it stands (s).
        run: Option<f64>,
    },
    /// No configuration reaches the error.
    #[error(
        "no configuration tried reaches an error of {} of {quantity}: {unreached}\n  help: accept a larger error, or {}",
        significant(unreached.wanted, 3),
        unreached.advice()
    )]
    OutOfReach {
        quantity: &'static str,
        /// Requested error, and the errors found.
        unreached: Unreached,
    },
    /// A share of a mean of 0 is no error.
    #[error(
        "the trials give a mean of 0 for {quantity}, and a percentage of 0 is no error\n  help: give the error as a number, such as --error 0.01; or, where the quantity changes later, choose --window"
    )]
    ShareOfZero { quantity: &'static str },
    /// No plan is fast enough.
    #[error(
        "{quantity} cannot be estimated within {} s: the shortest run takes about {} s\n  help: raise --time",
        significant(*within, 3),
        significant(*least, 2)
    )]
    TooQuick {
        quantity: &'static str,
        within: f64,
        /// Wall seconds of the fastest plan.
        least: f64,
    },
    /// The window does not end after it begins.
    #[error(
        "{0:?} is not a time window: expected its start before its end\n  help: give two times to average between, such as --window 2 8"
    )]
    NoWindow(Vec<f64>),
    /// The cache has no measurements of the scene.
    #[error(
        "no cached measurements for this scene on this machine\n  help: run once without --estimate; its measurements are cached"
    )]
    NothingKept,
    #[error(transparent)]
    Kept(#[from] PlanCacheError),
    /// The journal of trials failed.
    #[error(transparent)]
    Journal(#[from] JournalError),
    /// The user interrupted the trials.
    #[error("the trials were stopped\n  help: the same command resumes after the finished trials")]
    Stopped,
}

/// Longest trial time that can be requested (s).
const LONGEST: f64 = 3600.0;

/// Returns the advice for trials that were too short: longer ones, or a run of the scene itself where that takes less time.
fn longer_trials(enough: Option<f64>, run: Option<f64>) -> String {
    match enough.map(f64::ceil) {
        Some(enough) if run.is_some_and(|run| run < enough) => format!(
            "trials would need about {} s, but a run of the scene itself takes about {}: run and average it instead",
            significant(enough, 2),
            seconds(run.unwrap_or(enough))
        ),
        Some(seconds) if seconds <= LONGEST => {
            format!("longer trials should be enough: --seconds {seconds:.0}")
        }
        Some(seconds) => {
            format!(
                "trials would need about {} s, above the maximum of {LONGEST:.0} s",
                significant(seconds, 2)
            )
        }
        None => "use --patient for longer trials, which cover whole runs where these fit".to_owned(),
    }
}

impl Reported for ExplainError {
    fn class(&self) -> ErrorClass {
        match self {
            ExplainError::NoSuchQuantity { .. } | ExplainError::NoWindow(_) => ErrorClass::Usage,
            ExplainError::Kept(error) => error.class(),
            ExplainError::Journal(error) => error.class(),
            _ => ErrorClass::Precondition,
        }
    }

    fn inner_error(&self) -> Option<&dyn Reported> {
        match self {
            ExplainError::Kept(error) => Some(error),
            ExplainError::Journal(error) => Some(error),
            _ => None,
        }
    }
}

impl PlanTarget {
    /// Returns the target for a named quantity. By default it is the first conserved one for few bodies, and else the first one with a mean.
    ///
    /// # Errors
    /// [`ExplainError::NoSuchQuantity`]
    pub(crate) fn of(
        case: &StudyCase,
        name: Option<&str>,
        error: Option<Width>,
    ) -> Result<PlanTarget, ExplainError> {
        let quantities = case.quantities();
        let is_judged = |quantity: &&ObservedQuantity| quantity.kind != QuantityKind::Time;
        let known: Vec<&'static str> = quantities.iter().filter(is_judged).map(|it| it.name).collect();
        let first = || {
            let of_trials = case.entry.trials.and_then(|trials| trials.observables.first().copied());
            let of_kind = |kind| quantities.iter().find(|it| it.kind == kind).map(|it| it.name);
            let of_few = of_kind(QuantityKind::Kept).filter(|_| is_of_few(case));
            of_few.or(of_trials).or(of_kind(QuantityKind::Interval)).unwrap_or_default()
        };
        let name = name.unwrap_or_else(first);
        let place = quantities.iter().position(|it| it.name == name && is_judged(&it));
        let place = place.ok_or_else(|| ExplainError::NoSuchQuantity { name: name.to_owned(), known })?;
        Ok(PlanTarget { quantity: quantities[place], place, error, within: None, limit: LIMIT, window: None })
    }

    /// Restricts the target to a time window, if one is given.
    ///
    /// # Errors
    /// [`ExplainError::NoWindow`] if it does not end after it begins.
    pub(crate) fn over(self, window: Option<&[f64]>) -> Result<PlanTarget, ExplainError> {
        match window {
            None => Ok(self),
            Some(&[from, to]) if 0.0 <= from && from < to && to.is_finite() => {
                Ok(PlanTarget { window: Some([from, to]), ..self })
            }
            Some(window) => Err(ExplainError::NoWindow(window.to_vec())),
        }
    }

    /// True if the quantity should be conserved: its error is then the largest deviation from its first value.
    pub(crate) fn is_kept(&self) -> bool {
        self.quantity.kind == QuantityKind::Kept
    }
}

/// Makes a plan from cached measurements of trials at least as long, or from new trials, which are then cached. With zero seconds nothing is run.
/// Failures of the cache do not prevent a plan: they are passed to `notice`.
///
/// # Errors
/// [`ExplainError`]
pub(crate) fn explain(
    case: &StudyCase,
    target: &PlanTarget,
    seconds: f64,
    kept: &PlanCache,
    trial: TrialControl<'_>,
    notice: &dyn Fn(&PlanCacheError),
) -> Result<RunPlan, ExplainError> {
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
            let findings = measure_findings(case, target, seconds, trial, (&|_| {}, &journal))?;
            let taken = trial.watch.now() - begun;
            let kept_now = kept.store_findings(case, &key, [seconds, taken], &findings);
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
    let is_share = matches!(target.error, Some(Width::Percent(_))) && !target.is_kept();
    if is_share && findings.mean.mean == 0.0 && findings.mean.bar == 0.0 {
        return Err(ExplainError::ShareOfZero { quantity });
    }
    plan_or_scene(case, target, &findings, &origin)
        .map_err(|it| ExplainError::OutOfReach { quantity, unreached: Unreached { trials: seconds, ..it } })
}

/// Relative accuracy of the smallest error found by bisection.
const NEAR: f64 = 1.02;
/// Smallest and largest error of the bisection, in parts of the mean.
const WEIGHED: [f64; 2] = [1e-12, 10.0];

/// Returns the plan with the smallest error that is expected to take at most `within` wall seconds.
///
/// # Errors
/// [`ExplainError::TooQuick`], where no plan is fast enough.
fn within_seconds(
    case: &StudyCase,
    target: &PlanTarget,
    findings: &Findings,
    origin: &str,
    within: f64,
) -> Result<RunPlan, ExplainError> {
    let scale = if target.is_kept() { 1.0 } else { findings.mean.mean.abs() };
    let asking = |error: f64| {
        let target = PlanTarget {
            error: Some(Width::Absolute(error * scale)),
            limit: f64::INFINITY,
            ..target.clone()
        };
        plan_or_scene(case, &target, findings, origin)
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
