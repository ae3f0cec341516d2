//! Tests of plans by carrying them out from many starts. Each is judged by the target error, the predicted time, and the cost of the best of a grid.

mod frames;
mod grid;
mod reference;
mod runs;
mod scenes;
#[cfg(test)]
mod tests;
mod verdict;

pub(crate) use frames::made;
pub(crate) use scenes::{PlanCase, QUICK, SCENES};

use super::recommended::RunPlan;
use super::trial_runs::{measure_findings, plan_or_scene};
use super::{PlanTarget, in_unit};
use crate::results::{Journal, Progress, ProgressMeter};
use crate::study::trial::{Stopwatch, TrialControl};
use crate::study::{StudyCase, StudyError, first_line};
use grid::{ConfigurationGrid, RelativeCosts};
use reference::ReferenceMean;
use runs::{EstimatedMean, StartEnsemble};
use scenes::SceneClass;
use std::sync::atomic::AtomicBool;
use stripmine_physics::number::significant;
use stripmine_physics::scene::Width;
use verdict::PlanVerdict;

/// Effort of a test: wall seconds, and the number of runs.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PlanTestEffort {
    /// Time of the trials of a plan; and of repeated ones where these give no plan, for scenes that allow it.
    pub trials: [f64; 2],
    /// Limit of a plan: longer ones are refused.
    pub limit: f64,
    /// Number of estimates by each plan, each from its own start.
    pub(crate) estimates: usize,
    /// Longest time of a reference.
    pub(crate) reference: f64,
    pub grid: f64,
}

/// Judged plans.
#[derive(Clone, Debug)]
pub(crate) struct TestedPlans {
    plans: Vec<JudgedPlan>,
    effort: PlanTestEffort,
}

/// A judged plan.
#[derive(Clone, Debug)]
struct JudgedPlan {
    class: SceneClass,
    scene: String,
    quantity: &'static str,
    /// Target error, as requested.
    asked: &'static str,
    /// Wall seconds of its trials.
    trials: f64,
    /// Runs of the plan, or the reason why there is no plan.
    outcome: Result<CarriedPlan, String>,
}

/// A plan that was carried out.
#[derive(Clone, Debug)]
struct CarriedPlan {
    /// The plan in a line.
    plan: String,
    /// Target error, in the quantity's unit.
    error: f64,
    reference: Result<ReferenceMean, String>,
    /// Comparison with the reference; none without one.
    verdict: Option<PlanVerdict>,
    /// Wall seconds: predicted, and taken by the first estimate.
    seconds: [f64; 2],
    /// Costs relative to the best of the grid; none where the plan was not compared.
    costs: Option<RelativeCosts>,
}

/// A plan for an error.
struct PlanAttempt {
    asked: &'static str,
    error: Width,
    /// Wall seconds of its trials.
    trials: f64,
    plan: Result<RunPlan, String>,
}

/// Judges plans for some scenes.
///
/// # Errors
/// [`StudyError`] if a scene is invalid, or threads cannot be started.
pub(crate) fn judge_plans(
    asked: &[PlanCase],
    effort: PlanTestEffort,
    progress: Progress<'_>,
) -> Result<TestedPlans, StudyError> {
    let meter = ProgressMeter::new(asked.iter().map(|it| it.errors.len() as f64).sum(), progress);
    let (watch, never) = (Stopwatch::wall(), AtomicBool::new(false));
    let trial = TrialControl { watch: &watch, stop: &never };
    let mut plans = vec![];
    for it in asked {
        plans.extend(judged(it, effort, trial, &meter)?);
    }
    Ok(TestedPlans { plans, effort })
}

/// Judges the plans of a scene. Plans for the same mean share its reference and its grid.
fn judged(
    asked: &PlanCase,
    effort: PlanTestEffort,
    trial: TrialControl<'_>,
    meter: &ProgressMeter<'_>,
) -> Result<Vec<JudgedPlan>, StudyError> {
    let case = asked.load()?;
    let target =
        PlanTarget::of(&case, Some(asked.quantity), None).map_err(|it| StudyError::Own(Box::new(it)))?;
    let target = PlanTarget { limit: effort.limit, ..target };
    let parsed = asked.errors.iter().filter_map(|error| Some((*error, Width::parse(error)?)));
    let planned: Vec<PlanAttempt> = parsed
        .map(|(text, error)| {
            let target = PlanTarget { error: Some(error), ..target.clone() };
            let attempts = if asked.is_patient { &effort.trials[..] } else { &effort.trials[..1] };
            let mut planned = PlanAttempt { asked: text, error, trials: 0.0, plan: Err(String::new()) };
            for &seconds in attempts {
                if planned.plan.is_err() {
                    planned.trials = seconds;
                    planned.plan = by_trials(&case, &target, seconds, trial);
                }
            }
            meter.add(0.5);
            planned
        })
        .collect();
    let mut askings: Vec<EstimatedMean> = vec![];
    for asking in planned.iter().flat_map(|it| &it.plan).map(EstimatedMean::from) {
        if !askings.contains(&asking) {
            askings.push(asking);
        }
    }
    let refused = |it: &PlanAttempt| Err(it.plan.as_ref().err().cloned().unwrap_or_default());
    let mut outcomes: Vec<Result<CarriedPlan, String>> = planned.iter().map(refused).collect();
    for asking in askings {
        let ensemble = StartEnsemble { case: &case, target: &target, trial, asking };
        let alike: Vec<(usize, &PlanAttempt, &RunPlan)> = (planned.iter().enumerate())
            .filter_map(|(at, it)| Some((at, it, it.plan.as_ref().ok()?)))
            .filter(|(.., plan)| EstimatedMean::from(*plan) == asking)
            .collect();
        for (at, carried) in carried_out(&ensemble, &alike, asked.is_compared, effort)? {
            outcomes[at] = Ok(carried);
        }
    }
    meter.add(0.5 * planned.len() as f64);
    let all = planned.iter().zip(outcomes).map(|(it, outcome)| JudgedPlan {
        class: asked.class,
        scene: case.arguments(),
        quantity: target.quantity.name,
        asked: it.asked,
        trials: it.trials,
        outcome,
    });
    Ok(all.collect())
}

/// Makes a plan from trials of some seconds.
fn by_trials(
    case: &StudyCase,
    target: &PlanTarget,
    seconds: f64,
    trial: TrialControl<'_>,
) -> Result<RunPlan, String> {
    let found = measure_findings(case, target, seconds, trial, (&|_| {}, &Journal::none()))
        .map_err(|error| first_line(&error.to_string()))?;
    plan_or_scene(case, target, &found, "").map_err(|unreached| unreached.to_string())
}

/// Carries out plans for the same mean.
fn carried_out(
    ensemble: &StartEnsemble<'_>,
    plans: &[(usize, &PlanAttempt, &RunPlan)],
    is_compared: bool,
    effort: PlanTestEffort,
) -> Result<Vec<(usize, CarriedPlan)>, StudyError> {
    let in_parts = |it: &PlanAttempt| in_unit(it.error, 1.0);
    let finest = plans.iter().map(|(_, it, _)| *it).min_by(|a, b| in_parts(a).total_cmp(&in_parts(b)));
    let Some(finest) = finest else { return Ok(vec![]) };
    let reference = ensemble.reference(finest.error, effort.reference);
    let mut all = vec![];
    for (at, planned, plan) in plans {
        let (runs, taken) = ensemble.estimates(plan, effort.estimates).map_err(StudyError::Threads)?;
        let of = |mean: f64| in_unit(planned.error, mean);
        let error = match &reference {
            Ok(reference) => of(reference.known.mean),
            Err(_) => of(plan.mean.map_or(f64::NAN, |[mean, _]| mean)),
        };
        let verdict = reference.as_ref().ok().map(|it| PlanVerdict::of(&runs, it.mean(), error));
        let seconds = [plan.seconds.likely, taken];
        let carried = CarriedPlan {
            plan: in_a_line(plan),
            error,
            reference: reference.clone(),
            verdict,
            seconds,
            costs: None,
        };
        all.push((*at, carried));
    }
    let (true, Ok(reference)) = (is_compared, reference) else { return Ok(all) };
    let only: Vec<&RunPlan> = plans.iter().map(|(.., plan)| *plan).collect();
    // A scene that fails at its own step has no grid.
    if let Ok(grid) = ConfigurationGrid::of(ensemble, reference, &only, effort.grid) {
        for (number, ((_, carried), plan)) in all.iter_mut().zip(only).enumerate() {
            let verdict = carried.verdict.as_ref();
            carried.costs = verdict.and_then(|verdict| grid.costs(number, plan, verdict, carried.error));
        }
    }
    Ok(all)
}

fn in_a_line(plan: &RunPlan) -> String {
    let step = plan.step.map(|step| format!(", dt {}", significant(step, 3)));
    let seeds = (plan.seeds > 1).then(|| format!(", {} seeds", plan.seeds));
    let time = format!(", time {}", significant(plan.time, 3));
    [Some(plan.configuration.clone()), step, Some(time), seeds].into_iter().flatten().collect()
}
