//! Error of a mean over the wall time of its run, for each integrator and some of its steps: bias and chance added.

use super::bias::Bias;
use super::findings::{Findings, Way};
use super::lengths::Chance;
use super::recommended::Plan;
use super::{ExplainError, Target, seen};
use crate::frame::{Frame, Rows};
use crate::results::Made;
use crate::study::trial::{ROWS, Trial};
use crate::study::{Case, Choice};
use stripmine_physics::method::Decides;
use stripmine_physics::number::significant;

/// Name of the item.
pub const NAME: &str = "accuracy";

/// Steps of a curve in parts of the longest.
const STEPS: [f64; 3] = [1.0, 0.5, 0.25];
/// Points of a curve between an interval of wall time and ten times that.
const POINTS: i32 = 8;
/// Decades of wall time that curves cover: from the shortest run that has a mean.
const DECADES: i32 = 4;
/// Errors for which the cheapest point is named, in parts of the mean.
const WISHES: [f64; 5] = [0.1, 0.03, 0.01, 0.003, 0.001];

/// A curve: an integrator at a step.
struct Curve<'f> {
    label: String,
    way: &'f Way,
    step: Option<f64>,
    /// Wall seconds, expected error, and the most that it is.
    points: Vec<[f64; 3]>,
}

/// Measures a scene in trials of some seconds, as frames. `ask` is the plan that is marked, where an error is asked for.
///
/// # Errors
/// [`ExplainError`] if every trial breaks, or the quantity has no mean.
pub fn accuracy(
    case: &Case,
    target: &Target,
    seconds: f64,
    trial: Trial<'_>,
    scene: &str,
) -> Result<Made, ExplainError> {
    let findings = seen::seen(case, target, seconds, trial)?;
    let quick = Target { limit: f64::INFINITY, ..target.clone() };
    let plan = seen::planned(case, &quick, &findings, "").ok();
    Ok(made(scene, target, &findings, plan.as_ref(), case))
}

fn made(scene: &str, target: &Target, findings: &Findings, plan: Option<&Plan>, case: &Case) -> Made {
    let curves = curves(case, findings);
    Made::of([
        summary(scene, target, findings),
        points(&curves),
        marks(plan, target),
        biases(findings, &curves),
        wishes(findings, &curves),
    ])
}

/// The cheapest configuration of each integrator; where there are none, of each engine.
fn curves<'f>(case: &Case, findings: &'f Findings) -> Vec<Curve<'f>> {
    let chance = findings.chance();
    let choice = |way: &Way| {
        let settings: Vec<(&str, &str)> =
            way.settings.iter().map(|(axis, name)| (axis.as_str(), name.as_str())).collect();
        case.own.with(&settings)
    };
    let mut chosen: Vec<(&Way, Choice)> = vec![];
    for way in findings.ways.iter().filter(|way| way.dropped.is_none() && way.cost.is_some()) {
        let own = choice(way);
        let is_another = |(_, other): &(&Way, Choice)| {
            !own.agrees(other, Decides::Order) || own.scheme().is_none() && !own.agrees(other, Decides::Cost)
        };
        if chosen.iter().all(is_another) {
            chosen.push((way, own));
        }
    }
    let steps = |way: &Way| if way.step.is_some() { &STEPS[..] } else { &STEPS[..1] };
    let of = |way: &'f Way| {
        let chance = &chance;
        steps(way).iter().map(move |part| {
            let step = way.step.map(|step| part * step);
            let label =
                step.map_or(way.label.clone(), |it| format!("{}, dt {}", way.label, significant(it, 3)));
            Curve { label, way, step, points: run_lengths(way, step, *part, findings, chance) }
        })
    };
    chosen.iter().flat_map(|(way, _)| of(way)).collect()
}

/// Errors over wall times.
fn run_lengths(
    way: &Way,
    step: Option<f64>,
    part: f64,
    findings: &Findings,
    chance: &Chance,
) -> Vec<[f64; 3]> {
    let Some(cost) = way.cost.map(|cost| cost / part) else { return vec![] };
    let off = way.bias.zip(step).map(|(bias, step): (Bias, f64)| bias.at(step)).unwrap_or_default();
    let mean = &findings.mean;
    // A mean that does not vary has no shortest run: one of the trials' is taken.
    let shortest = findings.whole.unwrap_or(if mean.apart > 0.0 {
        mean.apart
    } else {
        mean.transient.max(cost.recip())
    });
    let lengths = (0..=POINTS * DECADES).map(|at| shortest * 10f64.powf(f64::from(at) / f64::from(POINTS)));
    let of = |time: f64| {
        let seconds = findings.start + ROWS[1] * findings.row + cost * (time + mean.transient);
        let chance = chance.over(time);
        [seconds, off.shift + chance, off.below + chance]
    };
    lengths.map(of).filter(|point| point[1].is_finite()).collect()
}

fn summary(scene: &str, target: &Target, findings: &Findings) -> Frame {
    let mean = &findings.mean;
    let not_compared =
        findings.ways.iter().filter_map(|way| Some(format!("{}: {}", way.label, way.dropped.as_ref()?)));
    Rows::of([()])
        .text("scene", |()| scene)
        .text("quantity", |()| target.quantity.name)
        .text("unit", |()| target.quantity.unit)
        .number("mean", 6, |()| mean.mean)
        .number("bar of the mean", 6, |()| mean.bar)
        .text("configuration of the mean", |()| &findings.mean_way)
        .short("transient", |()| mean.transient)
        .short("time between independent samples", |()| mean.apart)
        .text("over the whole run", |()| if findings.whole.is_some() { "yes" } else { "no" })
        .text("not compared", |()| not_compared.clone().collect::<Vec<_>>().join("; "))
        .frame("summary", "Mean of the scene")
}

fn points(curves: &[Curve<'_>]) -> Frame {
    Rows::of(curves.iter().flat_map(|curve| curve.points.iter().map(move |point| (curve, point))))
        .text("curve", |(curve, _)| &curve.label)
        .number("wall time (s)", 6, |(_, point)| point[0])
        .number("error", 6, |(_, point)| point[1])
        .number("most", 6, |(_, point)| point[2])
        .frame("points", "Error of the mean over the wall time of a run: expected bias, and chance with a probability of 95 %")
}

/// The scene's own values and the plan.
fn marks(plan: Option<&Plan>, target: &Target) -> Frame {
    let own = plan
        .and_then(|plan| plan.own.as_ref())
        .map(|own| ("the scene as it stands", own.seconds, own.error.most));
    let asked = plan.filter(|_| target.error.is_some());
    let asked = asked.map(|plan| ("the plan", plan.seconds.likely, plan.expected.most));
    let drawn = own
        .into_iter()
        .chain(asked)
        .filter(|(_, seconds, error)| seconds.is_finite() && error.is_finite() && *error > 0.0);
    Rows::of(drawn)
        .text("mark", |it| it.0)
        .number("wall time (s)", 6, |it| it.1)
        .number("error", 6, |it| it.2)
        .frame("marks", "The scene as it stands, and the plan")
}

fn biases(findings: &Findings, curves: &[Curve<'_>]) -> Frame {
    let compared = curves.iter().filter_map(|curve| Some((curve.way, curve.way.bias?, curve.step?)));
    let mean = findings.mean.mean.abs();
    Rows::of(compared)
        .text("configuration", |it| &it.0.label)
        .short("dt", |it| it.2)
        .short("bias", |it| {
            it.1.shift.signum()
                * it.1.at(it.2).below.min(it.1.shift.abs() * (it.2 / it.1.step).min(1.0).powf(it.1.power))
        })
        .short("± (95 %)", |it| it.1.bar * (it.2 / it.1.step).min(1.0).powf(it.1.power))
        .number("of the mean (%)", 3, |it| 100.0 * it.1.at(it.2).shift / mean)
        .text("significant", |it| if it.1.is_significant() { "yes" } else { "no" })
        .short("window", |it| it.1.window)
        .number("part of the bias that the window shows", 3, |it| it.1.part)
        .count("pairs of runs", |it| it.1.starts)
        .short("longest step", |it| it.0.step)
        .text("bound of the step", |it| it.0.bound.clone().unwrap_or_default())
        .frame("biases", "Bias of the mean by the step")
}

/// The cheapest run for each error.
fn wishes(findings: &Findings, curves: &[Curve<'_>]) -> Frame {
    let mean = findings.mean.mean.abs();
    let cheapest = |wish: f64| {
        let all = curves.iter().flat_map(|curve| curve.points.iter().map(move |point| (curve, point)));
        all.filter(|(_, point)| point[1] <= wish * mean).min_by(|a, b| a.1[0].total_cmp(&b.1[0]))
    };
    Rows::of(WISHES.map(|wish| (wish, cheapest(wish))))
        .short("error (%)", |(wish, _)| 100.0 * wish)
        .text("cheapest", |(_, found)| {
            found.map_or("none of those drawn".to_owned(), |(curve, _)| curve.label.clone())
        })
        .short("wall time (s)", |(_, found)| found.map(|(_, point)| point[0]))
        .frame("wishes", "The cheapest configuration and step for an error")
}
