//! Plans for what should keep its value: the step at which it goes no farther than is asked for.

use super::Target;
use super::bias::Off;
use super::decisions::decisions;
use super::findings::{Findings, Way};
use super::lengths::{Length, Weighed};
use super::optimum::Optimum;
use super::plan::{TIME_WITHIN, in_unit, overrides, phases, prefer};
use super::recommended::{Decision, Expected, Interval, Own, Plan};
use super::unreached::Unreached;
use crate::study::Case;
use crate::study::trial::ROWS;
use stripmine_physics::number::significant;

/// What is recommended for a quantity that should keep its value over the scene's own time.
///
/// # Errors
/// [`Unreached`], where no way comes to what is asked for.
pub fn keeping(case: &Case, target: &Target, findings: &Findings, origin: &str) -> Result<Plan, Unreached> {
    let usable = || findings.ways.iter().filter(|way| way.dropped.is_none());
    let time = case.duration().or_else(|| Some(usable().next()?.drift?.time)).unwrap_or(0.0);
    let of_own = usable().find(|way| way.label == case.own.label());
    let own_error = of_own.and_then(|way| Some(way.drift?.over(time).at(case.step()?)));
    let error = target.error.map(|width| in_unit(width, 1.0));
    let wanted = error.or(own_error.map(|error| 2.0 * error)).unwrap_or(1e-3);
    let costs = |way: &Way, step: f64| {
        Some(findings.start + ROWS[1] * findings.row + way.cost? * way.step? / step * time)
    };
    let mut weighed: Vec<Weighed<'_>> = usable()
        .filter_map(|way| {
            let (drift, longest) = (way.drift?.over(time), way.step?);
            let step = drift.step_for(wanted)?;
            let optimum = Optimum {
                part: step / longest,
                bias: Off::exactly(drift.at(step)),
                time,
                seconds: costs(way, step)?,
            };
            Some(Weighed { way, optimum })
        })
        .collect();
    weighed.sort_by(|a, b| a.optimum.seconds.total_cmp(&b.optimum.seconds));
    prefer(&mut weighed, case);
    let Some(best) = weighed.first() else {
        let least = usable().filter_map(|way| Some(way.drift?.over(time).farthest[1]));
        let least = least.fold(f64::INFINITY, f64::min);
        return Err(Unreached { wanted, known: f64::NAN, least, takes: None });
    };
    let step = best.way.step.map(|step| best.optimum.part * step);
    let likely = best.optimum.seconds;
    let length = Length { time, seeds: 1, seconds: likely, why: String::new() };
    let mut decisions = decisions(case, findings, &weighed, &length, wanted);
    decisions.truncate(case.entry.axes.len());
    let drift = best.way.drift;
    decisions.extend(drift.zip(step).map(|(drift, step)| Decision {
        what: "dt".to_owned(),
        chosen: significant(step, 4),
        why: format!(
            "{} in a time of {} at {}, {} at half of it: it falls with the power {}",
            significant(drift.farthest[0], 2),
            significant(drift.time, 3),
            significant(drift.step, 3),
            significant(drift.farthest[1], 2),
            significant(drift.power(), 2)
        ),
        beside: vec![],
    }));
    Ok(Plan {
        scene: case.arguments(),
        method: case.entry.vocabulary.keys.method,
        way: best.way.label.clone(),
        quantity: target.quantity.name,
        unit: target.quantity.unit,
        mean: None,
        error,
        decisions,
        expected: Expected::of(best.optimum.bias, 0.0),
        seconds: Interval::within(likely, TIME_WITHIN),
        memory: case.prepared.memory.needed,
        phases: phases(best, time),
        step,
        time,
        is_whole: false,
        transient: 0.0,
        seeds: 1,
        starts_differ: None,
        overrides: overrides(case, best.way, step, None),
        own: of_own.zip(case.step()).and_then(|(way, step)| {
            Some(Own {
                seconds: costs(way, step)?,
                error: Expected::of(Off::exactly(way.drift?.over(time).at(step)), 0.0),
            })
        }),
        left_out: vec![],
        origin: origin.to_owned(),
    })
}
