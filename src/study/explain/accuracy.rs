//! Smallest error of a mean against the wall time of its run, for each integrator: bias plus statistical error at the best of some steps.

use super::drift::StepDeviation;
use super::findings::{Findings, MeasuredConfiguration};
use super::lengths::StatisticalError;
use super::recommended::RunPlan;
use super::{ExplainError, PlanTarget, trial_runs};
use crate::frame::{FrameBuilder, ResultFrame};
use crate::results::{FinishedItem, Journal};
use crate::study::trial::TrialControl;
use crate::study::{SettingChoice, StudyCase};
use stripmine_physics::method::ChoiceEffect;

pub(crate) const NAME: &str = "accuracy";

/// Steps of a curve, in parts of the longest.
const STEPS: [f64; 3] = [1.0, 0.5, 0.25];
/// Points of a curve per decade of wall time.
const POINTS: i32 = 8;
/// Decades of wall time of a curve.
const DECADES: i32 = 4;
/// Independent samples of the shortest run.
const SHORTEST: f64 = 5.0;
/// Errors for which the cheapest run is listed, in parts of the mean.
const WISHES: [f64; 5] = [0.1, 0.03, 0.01, 0.003, 0.001];

/// Smallest error of a configuration against wall time, at the best of its steps.
struct ErrorCurve<'f> {
    configuration: &'f MeasuredConfiguration,
    points: Vec<ErrorPoint>,
}

/// Error at a wall time.
struct ErrorPoint {
    /// Wall seconds of a run.
    seconds: f64,
    /// The step (time); none where the method takes none.
    step: Option<f64>,
    /// Expected sum of bias and statistical error, and its upper bound.
    error: f64,
    most: f64,
}

/// Measures a scene in trials of some seconds and returns frames. The plan is marked if an error is requested.
///
/// # Errors
/// [`ExplainError`] if every trial fails, or the quantity has no mean.
pub(crate) fn accuracy(
    case: &StudyCase,
    target: &PlanTarget,
    seconds: f64,
    trial: TrialControl<'_>,
    (scene, progress, journal): (&str, &dyn Fn(f64), &Journal),
) -> Result<FinishedItem, ExplainError> {
    let findings = trial_runs::measure_findings(case, target, seconds, trial, (progress, journal))?;
    let quick = PlanTarget { limit: f64::INFINITY, ..target.clone() };
    let plan = trial_runs::plan_or_scene(case, &quick, &findings, "").ok();
    Ok(made(scene, target, &findings, plan.as_ref(), case))
}

fn made(
    scene: &str,
    target: &PlanTarget,
    findings: &Findings,
    plan: Option<&RunPlan>,
    case: &StudyCase,
) -> FinishedItem {
    let curves = curves(case, findings);
    FinishedItem::of([
        summary(scene, target, findings, &curves),
        points(&curves),
        marks(plan, target),
        biases(findings, &curves),
        cheapest_for_errors(findings, &curves),
    ])
}

/// Returns the cheapest configuration of each integrator, or of each engine where there are no integrators.
fn curves<'f>(case: &StudyCase, findings: &'f Findings) -> Vec<ErrorCurve<'f>> {
    let chance = findings.chance();
    let mut chosen: Vec<(&MeasuredConfiguration, SettingChoice)> = vec![];
    for configuration in findings
        .configurations
        .iter()
        .filter(|configuration| configuration.dropped.is_none() && configuration.cost.is_some())
    {
        let own = configuration.choice(case);
        let is_another = |(_, other): &(&MeasuredConfiguration, SettingChoice)| {
            !own.agrees_on(other, ChoiceEffect::Order)
                || own.scheme().is_none() && !own.agrees_on(other, ChoiceEffect::Cost)
        };
        if chosen.iter().all(is_another) {
            chosen.push((configuration, own));
        }
    }
    chosen
        .iter()
        .map(|(configuration, _)| ErrorCurve {
            configuration,
            points: least_errors(configuration, case, findings, &chance),
        })
        .collect()
}

/// Smallest errors against wall time.
fn least_errors(
    configuration: &MeasuredConfiguration,
    case: &StudyCase,
    findings: &Findings,
    chance: &StatisticalError,
) -> Vec<ErrorPoint> {
    let Some(cost) = configuration.cost else { return vec![] };
    if let (Some(drift), Some(step), Some(time)) = (&configuration.drift, configuration.step, case.duration())
    {
        let of = |it: &StepDeviation| {
            let seconds = findings.start + findings.row_seconds(time) + cost * step / it.step * time;
            ErrorPoint { seconds, step: Some(it.step), error: it.farthest(), most: it.farthest() }
        };
        return drift.tried.iter().map(of).filter(|it| it.error.is_finite() && it.error > 0.0).collect();
    }
    let mean = &findings.mean;
    // Costs of a unit of time: the steps alone, and its rows. The fixed rows of whole runs belong to the start.
    let rows = findings.row * mean.rows();
    let start = findings.start + if rows > 0.0 { 0.0 } else { findings.row_seconds(0.0) };
    // A mean without fluctuations has no shortest run.
    let shortest = findings.whole.unwrap_or(if mean.apart > 0.0 { SHORTEST * mean.apart } else { 1.0 });
    let first = start + (cost + rows) * (shortest + mean.transient);
    let walls = (0..=POINTS * DECADES).map(|at| first * 10f64.powf(f64::from(at) / f64::from(POINTS)));
    let steps = if configuration.step.is_some() { &STEPS[..] } else { &STEPS[..1] };
    let least = |seconds: f64| {
        let of = |part: &f64| {
            let step = configuration.step.map(|step| part * step);
            let time = (seconds - start) / (cost / part + rows) - mean.transient;
            let off = configuration
                .bias
                .zip(step)
                .map(|(bias, step)| bias.over(step, time.max(0.0)))
                .unwrap_or_default();
            let chance = if time > 0.0 { chance.over(time) } else { f64::INFINITY };
            ErrorPoint { seconds, step, error: off.shift + chance, most: off.below + chance }
        };
        steps.iter().map(of).min_by(|a, b| a.error.total_cmp(&b.error))
    };
    walls.filter_map(least).filter(|point| point.error.is_finite()).collect()
}

fn summary(scene: &str, target: &PlanTarget, findings: &Findings, curves: &[ErrorCurve<'_>]) -> ResultFrame {
    let least = |values: &mut dyn Iterator<Item = f64>| values.reduce(f64::min);
    let first = least(&mut curves.iter().filter_map(|curve| Some(curve.points.first()?.seconds)));
    let longest = curves
        .iter()
        .filter(|curve| curve.configuration.bound.is_some())
        .filter_map(|curve| curve.configuration.step);
    let longest = longest.reduce(f64::max);
    let mean = &findings.mean;
    let not_compared = findings.configurations.iter().filter_map(|configuration| {
        Some(format!("{}: {}", configuration.label, configuration.dropped.as_ref()?))
    });
    FrameBuilder::of([()])
        .text("scene", |()| scene)
        .text("quantity", |()| target.quantity.name)
        .text("unit", |()| target.quantity.unit)
        .number("mean", 6, |()| mean.mean)
        .number("bar of the mean", 6, |()| mean.bar)
        .text("configuration of the mean", |()| &findings.mean_configuration)
        .short("transient", |()| mean.transient)
        .short("time between independent samples", |()| mean.apart)
        .short("shortest wall time (s)", |()| first)
        .short("longest step", |()| longest)
        .text("over the whole run", |()| if findings.whole.is_some() { "yes" } else { "no" })
        .text("not compared", |()| not_compared.clone().collect::<Vec<_>>().join("; "))
        .frame("summary", "Mean of the scene")
}

fn points(curves: &[ErrorCurve<'_>]) -> ResultFrame {
    FrameBuilder::of(curves.iter().flat_map(|curve| curve.points.iter().map(move |point| (curve, point))))
        .text("configuration", |(curve, ..)| &curve.configuration.label)
        .number("wall time (s)", 6, |(.., point)| point.seconds)
        .short("dt", |(.., point)| point.step)
        .number("error", 6, |(.., point)| point.error)
        .number("most", 6, |(.., point)| point.most)
        .frame(
            "points",
            "Smallest error over the wall time of a run: expected bias, and statistical error with 95 % confidence",
        )
}

/// The scene as it stands, and the plan.
fn marks(plan: Option<&RunPlan>, target: &PlanTarget) -> ResultFrame {
    let own = plan
        .and_then(|plan| plan.own.as_ref())
        .map(|own| ("the scene as it stands", own.seconds, own.error.most));
    let asked = plan.filter(|_| target.error.is_some());
    let asked = asked.map(|plan| ("the plan", plan.seconds.likely, plan.expected.most));
    let drawn = own
        .into_iter()
        .chain(asked)
        .filter(|(_, seconds, error)| seconds.is_finite() && error.is_finite() && *error > 0.0);
    FrameBuilder::of(drawn)
        .text("mark", |it| it.0)
        .number("wall time (s)", 6, |it| it.1)
        .number("error", 6, |it| it.2)
        .frame("marks", "The scene as it stands, and the plan")
}

fn biases(findings: &Findings, curves: &[ErrorCurve<'_>]) -> ResultFrame {
    let steps = |curve: &ErrorCurve<'_>| Some((curve.configuration.bias?, curve.configuration.step?));
    let compared = curves.iter().filter_map(|curve| Some((curve.configuration, steps(curve)?)));
    let compared = compared
        .flat_map(|(configuration, (bias, longest))| STEPS.map(|part| (configuration, bias, part * longest)));
    let mean = findings.mean.mean.abs();
    FrameBuilder::of(compared)
        .text("configuration", |it| &it.0.label)
        .short("dt", |it| it.2)
        .short("bias", |it| it.1.measured_at(it.2)[0])
        .short("± (95 %)", |it| it.1.measured_at(it.2)[1])
        .number("of the mean (%)", 3, |it| 100.0 * it.1.at(it.2).shift / mean)
        .text("significant", |it| if it.1.is_significant() { "yes" } else { "no" })
        .short("by pairs of runs", |it| it.1.pairs_at(it.2).map(|it| it[0]))
        .short("by pairs, ± (95 %)", |it| it.1.pairs_at(it.2).map(|it| it[1]))
        .short("by the shadow energy", |it| it.1.shadow_at(it.2).map(|it| it[0]))
        .short("by the shadow energy, ± (95 %)", |it| it.1.shadow_at(it.2).map(|it| it[1]))
        .short("size by single collisions", |it| it.1.collisions_at(it.2))
        .short("window", |it| it.1.window)
        .number("part of the bias that the window shows", 3, |it| it.1.part)
        .count("pairs of runs", |it| it.1.starts)
        .short("longest step", |it| it.0.step)
        .text("bound of the step", |it| it.0.bound.clone().unwrap_or_default())
        .frame("biases", "Bias of the mean by the step")
}

fn cheapest_for_errors(findings: &Findings, curves: &[ErrorCurve<'_>]) -> ResultFrame {
    let mean = findings.mean.mean.abs();
    let cheapest = |wish: f64| {
        let all = curves.iter().flat_map(|curve| curve.points.iter().map(move |point| (curve, point)));
        all.filter(|(_, point)| point.error <= wish * mean).min_by(|a, b| a.1.seconds.total_cmp(&b.1.seconds))
    };
    FrameBuilder::of(WISHES.map(|wish| (wish, cheapest(wish))))
        .short("error (%)", |(wish, _)| 100.0 * wish)
        .text("cheapest", |(_, found)| {
            found.map_or("none of those drawn".to_owned(), |(curve, _)| curve.configuration.label.clone())
        })
        .short("dt", |(_, found)| found.and_then(|(_, point)| point.step))
        .short("wall time (s)", |(_, found)| found.map(|(_, point)| point.seconds))
        .frame("wishes", "The cheapest configuration and step for an error")
}
