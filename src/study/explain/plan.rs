//! Choice of the plan from the measurements.

use super::PlanTarget;
use super::bias::BiasEstimate;
use super::decisions::{decisions, left_out};
use super::findings::{Findings, MeasuredConfiguration};
use super::lengths::{PlanCandidate, StatisticalError, cheapest_optimum, length_and_seeds};
use super::optimum::SHORTEST;
use super::recommended::{ExpectedError, LikelyRange, OwnResult, RunPlan};
use super::unreachable::Unreached;
use crate::study::trial::ROWS;
use crate::study::{SettingChoice, StudyCase, TIE, rounded};
use stripmine_physics::method::Every;
use stripmine_physics::scene::{Overrides, STEPS, THERMO_EVERY, TIME, Width};

/// Factor of uncertainty of predicted times: other programs share the machine.
pub(super) const TIME_WITHIN: f64 = 1.5;
/// Fewest rows of a mean.
const FEWEST_ROWS: f64 = 100.0;

/// Returns the cheapest plan for the target error.
///
/// # Errors
/// [`Unreached`], where no configuration reaches the target.
pub(crate) fn plan(
    case: &StudyCase,
    target: &PlanTarget,
    findings: &Findings,
    origin: &str,
) -> Result<RunPlan, Unreached> {
    let mean = &findings.mean;
    let own_configuration =
        findings.configurations.iter().find(|configuration| configuration.label == case.own.label());
    let own = own_configuration.and_then(|configuration| own(case, configuration, findings));
    let error = target.error.map(|width| in_unit(width, mean.mean));
    // Without a target error the plan matches the error of the scene's own values.
    let of_own = own.as_ref().map(|own| own.error.most).filter(|most| most.is_finite() && *most > 0.0);
    let wanted = error.or(of_own).unwrap_or(0.01 * mean.mean.abs());
    let usable = |configuration: &&MeasuredConfiguration| {
        configuration.cost.is_some() && configuration.dropped.is_none()
    };
    let chance = findings.chance();
    let mut weighed: Vec<PlanCandidate<'_>> = findings
        .configurations
        .iter()
        .filter(usable)
        .filter_map(|configuration| {
            Some(PlanCandidate {
                configuration,
                optimum: cheapest_optimum(configuration, findings, &chance, wanted)?,
            })
        })
        .collect();
    weighed.sort_by(|a, b| a.optimum.seconds.total_cmp(&b.optimum.seconds));
    prefer(&mut weighed, case);
    let Some(best) = weighed.first() else {
        // Only the bias at the shortest step considered is left.
        let least = |configuration: &MeasuredConfiguration| {
            Some(configuration.bias?.at(SHORTEST * configuration.step?).shift)
        };
        let least =
            findings.configurations.iter().filter(usable).filter_map(least).fold(f64::INFINITY, f64::min);
        return Err(Unreached { known: mean.bar, ..Unreached::of(wanted, least) });
    };
    let unreached = |least: f64| Unreached { known: mean.bar, ..Unreached::of(wanted, least) };
    let length = length_and_seeds(case, best, findings).map_err(unreached)?;
    if length.seconds > target.limit {
        // The statistical error falls with the square root of the time.
        let left = target.limit * (length.time / length.seconds);
        let least = best.optimum.bias.with_statistical_error(chance.over(left));
        return Err(Unreached { takes: Some([length.seconds, target.limit]), ..unreached(least) });
    }
    let step = best.configuration.step.map(|step| best.optimum.part * step);
    let per_run = findings.whole.unwrap_or(length.time / length.seeds as f64 + mean.transient);
    let expected = ExpectedError::of(best.optimum.bias, chance.over(length.time));
    let seconds = LikelyRange::within(length.seconds, TIME_WITHIN);
    Ok(RunPlan {
        scene: case.arguments(),
        method: case.entry.vocabulary.keys.method,
        configuration: best.configuration.label.clone(),
        quantity: target.quantity.name,
        unit: target.quantity.unit,
        mean: Some([mean.mean, mean.bar]),
        error,
        decisions: decisions(case, findings, &weighed, &length, (wanted, target.window)),
        expected,
        deviation: None,
        seconds,
        memory: case.prepared.memory.needed * length.seeds.min(findings.threads as u64).max(1),
        phases: phases(best, per_run),
        step,
        time: per_run,
        rows: mean.rows_in(per_run),
        is_whole: findings.whole.is_some(),
        transient: mean.transient,
        seeds: length.seeds,
        starts_differ: findings.starts_differ,
        overrides: overrides(case, best.configuration, step, (Some(per_run), mean.every)),
        own,
        left_out: left_out(findings, wanted, mean.mean),
        origin: origin.to_owned(),
    })
}

/// Puts first, among configurations as cheap within timing accuracy, the scene's own, or else the first in the order of the settings: longer trials
/// then lead to the same plan.
pub(super) fn prefer(weighed: &mut [PlanCandidate<'_>], case: &StudyCase) {
    let Some(cheapest) = weighed.first().map(|it| it.optimum.seconds) else { return };
    let own = case.own.label();
    let order: Vec<String> = SettingChoice::all(case.entry.axes).iter().map(SettingChoice::label).collect();
    let place = |it: &PlanCandidate<'_>| {
        let label = &it.configuration.label;
        (*label != own, order.iter().position(|known| known == label).unwrap_or(usize::MAX))
    };
    let tied = weighed.iter().take_while(|it| it.optimum.seconds <= TIE * cheapest).count();
    if let Some(chosen) = (0..tied).min_by_key(|&at| place(&weighed[at])) {
        weighed[..=chosen].rotate_right(1);
    }
}

/// Wall seconds of a run in each phase.
pub(super) fn phases(best: &PlanCandidate<'_>, time: f64) -> Vec<(String, f64)> {
    let scaled = |(name, cost): &(String, f64)| (name.clone(), cost / best.optimum.part * time);
    best.configuration.phases.iter().map(scaled).collect()
}

/// Returns the overrides of a plan: its step, run time and time between rows (time; 0 where that does not matter).
pub(super) fn overrides(
    case: &StudyCase,
    configuration: &MeasuredConfiguration,
    step: Option<f64>,
    (time, every): (Option<f64>, f64),
) -> Overrides {
    let mut overrides = configuration.overrides.clone();
    // The run uses the step as printed.
    let step = step.map(|step| rounded(step, 4));
    if let (Some(trials), Some(step)) = (case.entry.trials, step) {
        overrides = overrides.set(trials.step, step);
    }
    let time = time.or(case.duration());
    // The run length is given as the scene gives it: in steps or as a time.
    let Some(time) = time else { return overrides };
    overrides = match (case.values.is_given(&STEPS), step) {
        (true, Some(step)) => overrides.set(&STEPS, (time / step).ceil() as u64),
        _ => overrides.set(&TIME, no_shorter(time)),
    };
    // The scene's own rows are used where they are enough for a mean with an error bar and none were planned.
    let between = match every {
        0.0 if time >= FEWEST_ROWS * own_rows(case, step) => return overrides,
        0.0 => time / ROWS,
        _ => every.min(time / ROWS),
    };
    match step {
        Some(step) => overrides.set(&THERMO_EVERY, (between / step).max(1.0) as u64),
        None => overrides.set(&THERMO_EVERY, rounded(between, 3)),
    }
}

/// Time between the rows of a scene at a step (time); infinite where it writes none.
pub(super) fn own_rows(case: &StudyCase, step: Option<f64>) -> f64 {
    match case.prepared.schedule.rows {
        Every::Steps(steps) => step.map_or(f64::INFINITY, |step| steps as f64 * step),
        Every::Time(time) => time,
        Every::Never | Every::Seconds(_) => f64::INFINITY,
    }
}

/// Rounds a time to six digits, never down.
fn no_shorter(time: f64) -> f64 {
    let nearest = rounded(time, 6);
    if nearest < time { rounded(time * (1.0 + 5.1e-6), 6) } else { nearest }
}

/// Converts an error to the quantity's unit.
pub(crate) fn in_unit(width: Width, mean: f64) -> f64 {
    match width {
        Width::Percent(percent) => 0.01 * percent * mean.abs(),
        Width::Absolute(error) => error,
    }
}

fn own(case: &StudyCase, configuration: &MeasuredConfiguration, findings: &Findings) -> Option<OwnResult> {
    let (time, step) = (case.duration()?, case.step());
    let cost = configuration.cost? * configuration.step.zip(step).map_or(1.0, |(longest, own)| longest / own);
    // The bias is that of the scene's own integrator, in any precision that was measured.
    let is_alike = |it: &&MeasuredConfiguration| {
        it.settings.iter().any(|(name, setting)| {
            name == "integrator" && configuration.settings.contains(&(name.clone(), setting.clone()))
        })
    };
    let bias = findings.configurations.iter().filter(is_alike).find_map(|it| it.bias);
    let bias = match (bias, step) {
        (Some(bias), Some(step)) => bias.over(step, time),
        (None, Some(_)) => BiasEstimate::exactly(f64::NAN),
        (_, None) => BiasEstimate::default(),
    };
    let left = time - findings.mean.transient;
    let every = own_rows(case, step);
    let known = findings.mean.with_row_spacing(every);
    let chance =
        if left > 0.0 { StatisticalError::of(&known, findings.whole).over(left) } else { f64::INFINITY };
    let seconds = findings.start + findings.row * (time / every) + cost * time;
    Some(OwnResult { seconds, error: ExpectedError::of(bias, chance), faults: String::new() })
}
