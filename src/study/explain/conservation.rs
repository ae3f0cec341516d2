//! Plans for conserved quantities: the step at which their deviation stays within the target error.

use super::PlanTarget;
use super::bias::BiasEstimate;
use super::decisions::decisions;
use super::drift::StepDeviations;
use super::drifts::wanted;
use super::findings::{Findings, MeasuredConfiguration};
use super::lengths::{PlanCandidate, RunLength};
use super::optimum::Optimum;
use super::plan::{TIME_WITHIN, in_unit, overrides, own_rows, phases, prefer};
use super::recommended::{Decision, ExpectedError, LikelyRange, OwnResult, RunPlan};
use super::unreachable::Unreached;
use crate::study::StudyCase;
use stripmine_physics::number::significant;

/// Returns the cheapest plan for a quantity that should be conserved over the scene's own run.
///
/// # Errors
/// [`Unreached`], where no configuration reaches the target.
pub(crate) fn conserved_quantity_plan(
    case: &StudyCase,
    target: &PlanTarget,
    findings: &Findings,
    origin: &str,
) -> Result<RunPlan, Unreached> {
    let usable = || findings.configurations.iter().filter(|configuration| configuration.dropped.is_none());
    let time = case.duration().unwrap_or(0.0);
    let of_own = findings.configurations.iter().find(|configuration| configuration.label == case.own.label());
    let own = own_result(case, findings, time);
    let error = target.error.map(|width| in_unit(width, 1.0));
    let mut wanted = wanted(case, target, findings.own_run.as_ref());
    let costs = |configuration: &MeasuredConfiguration, step: f64| {
        Some(
            findings.start
                + findings.row_seconds(time)
                + configuration.cost? * configuration.step? / step * time,
        )
    };
    let candidates = |wanted: f64| {
        let reaching = own.as_ref().filter(|own| own.error.most <= wanted);
        let of_trials = usable().filter_map(|configuration| {
            let found = configuration.drift.as_ref()?.step_for(wanted)?;
            let is_own = configuration.label == case.own.label() && Some(found.step) == case.step();
            let optimum = Optimum {
                part: found.step / configuration.step?,
                bias: BiasEstimate::exactly(found.farthest()),
                time,
                seconds: costs(configuration, found.step)?,
            };
            // A run of the scene as it stands is the candidate below.
            (!is_own || reaching.is_none()).then_some(PlanCandidate { configuration, optimum })
        });
        // The scene as it stands is always a candidate.
        let as_it_stands = reaching.and_then(|own| {
            let configuration = of_own?;
            let part = case.step()? / configuration.step?;
            let bias = BiasEstimate::exactly(own.error.most);
            Some(PlanCandidate { configuration, optimum: Optimum { part, bias, time, seconds: own.seconds } })
        });
        of_trials.chain(as_it_stands).collect::<Vec<_>>()
    };
    let mut weighed = candidates(wanted);
    // A scene that warns is kept only if nothing found is better.
    if let (true, None, Some(own)) = (weighed.is_empty(), error, &own) {
        wanted = if own.error.most.is_finite() { own.error.most } else { wanted };
        weighed = candidates(wanted);
    }
    weighed.sort_by(|a, b| a.optimum.seconds.total_cmp(&b.optimum.seconds));
    prefer(&mut weighed, case);
    let least = usable().filter_map(|configuration| Some(configuration.drift.as_ref()?.least()));
    let of_scene = findings.own_run.as_ref().map_or(f64::INFINITY, |run| run.deviation.most);
    let least = least.fold(of_scene, f64::min);
    let Some(best) = weighed.first() else {
        let expected = usable().filter_map(|configuration| {
            costs(configuration, configuration.drift.as_ref()?.expected_step(wanted)?)
        });
        let expected = expected.reduce(f64::min);
        return Err(Unreached { expected, ..Unreached::of(wanted, least) });
    };
    let likely = best.optimum.seconds;
    if likely > target.limit {
        return Err(Unreached { takes: Some([likely, target.limit]), ..Unreached::of(wanted, least) });
    }
    let step = best.configuration.step.map(|step| best.optimum.part * step);
    let length = RunLength { time, seeds: 1, seconds: likely, why: String::new() };
    let mut decisions = decisions(case, findings, &weighed, &length, (wanted, None));
    decisions.truncate(case.entry.axes.len());
    let drift = best.configuration.drift.as_ref();
    decisions.extend(drift.zip(step).map(|(drift, step)| step_of(drift, step, time)));
    let tried =
        drift.and_then(|drift| drift.tried.iter().find(|it| it.farthest() == best.optimum.bias.below));
    Ok(RunPlan {
        scene: case.arguments(),
        method: case.entry.vocabulary.keys.method,
        configuration: best.configuration.label.clone(),
        quantity: target.quantity.name,
        unit: target.quantity.unit,
        mean: None,
        error,
        decisions,
        expected: ExpectedError::of(best.optimum.bias, 0.0),
        deviation: tried.map(|it| it.deviation),
        seconds: LikelyRange::within(likely, TIME_WITHIN),
        memory: case.prepared.memory.needed,
        phases: phases(best, time),
        step,
        time,
        rows: time / own_rows(case, step),
        is_whole: false,
        transient: 0.0,
        seeds: 1,
        starts_differ: None,
        overrides: overrides(case, best.configuration, step, (None, 0.0)),
        own,
        left_out: vec![],
        origin: origin.to_owned(),
    })
}

/// Returns cost and error of the scene as it stands, over its whole run; the error is NaN where there was no time to run it.
fn own_result(case: &StudyCase, findings: &Findings, time: f64) -> Option<OwnResult> {
    let of_own = findings.configurations.iter().find(|configuration| configuration.label == case.own.label());
    let run = findings.own_run.as_ref();
    let (start, row, unit) = match run.and_then(|run| run.costs.as_ref()) {
        Some(costs) => (costs.start, costs.row, costs.unit),
        None => {
            let configuration = of_own?;
            let slower = configuration.step? / case.step()?;
            (findings.start, findings.row, configuration.cost? * slower)
        }
    };
    let error = run.map_or(f64::NAN, |run| run.deviation.most);
    Some(OwnResult {
        seconds: start + row * findings.mean.rows_in(time) + unit * time,
        error: ExpectedError::of(BiasEstimate::exactly(error), 0.0),
        faults: run.map_or(String::new(), |run| run.faults.clone()),
    })
}

/// Decision on the step, with the deviation at it and at the next longer one.
fn step_of(drift: &StepDeviations, step: f64, time: f64) -> Decision {
    let at = |step: f64| drift.at(step).map_or("unknown".to_owned(), |farthest| significant(farthest, 2));
    let longer = drift.tried.iter().rev().find(|it| it.step > step * (1.0 + 1e-9));
    let longer = longer.map_or(String::new(), |it| {
        let farthest = if it.farthest().is_finite() {
            significant(it.farthest(), 2)
        } else {
            "the run fails".to_owned()
        };
        format!("; at {}: {farthest}", significant(it.step, 4))
    });
    Decision {
        what: "dt".to_owned(),
        chosen: significant(step, 4),
        why: format!(
            "changes by at most {} over the whole run of {}{longer}",
            at(step),
            significant(time, 3)
        ),
        beside: vec![],
    }
}
