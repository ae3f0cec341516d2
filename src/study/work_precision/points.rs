//! Points of the charts, as frames.

use super::dataset::{DiagramConfiguration, DiagramRun, NamedDiagrams, WorkPrecision};
use super::front::front;
use super::growth::COMPARABLE;
use super::measures::Measure;
use crate::frame::{FrameBuilder, ResultFrame};
use crate::statistics::median;

/// Height of failed runs, relative to the largest error drawn.
const ABOVE: f64 = 10.0;
/// Configurations with their own name in a chart; all others share one style.
const NAMED: usize = 4;
/// A point of a chart of error over cost: chart, kind of series, name of the series, cost and error.
type ChartPoint = (&'static str, &'static str, String, f64, f64);

/// Points of the charts of error over cost.
pub(super) fn drawn(scenes: &NamedDiagrams) -> ResultFrame {
    let all = scenes.iter().flat_map(|(name, data)| {
        let mut points = vec![];
        for (chart, measure) in [("position", Measure::Position), ("energy", Measure::Energy)] {
            points.extend(diagram(data, chart, measure));
        }
        let [mut searches, mut clocks] = [const { vec![] }; 2];
        for (at, configuration) in data.configurations.iter().enumerate() {
            let own = || data.runs.iter().filter(move |run| run.configuration == at);
            if configuration.is_own_arithmetic {
                let points = points_of(own(), Measure::Position, DiagramRun::cost);
                searches.extend(points.map(|it| (configuration.cost.clone(), it)));
            }
            let points = points_of(own(), Measure::Position, |run| run.outcome.as_ref().ok()?.clocks);
            clocks.extend(points.map(|it| (configuration.label.clone(), it)));
        }
        // A single search has nothing to compare with.
        if searches.iter().all(|(search, _)| *search == searches[0].0) {
            searches.clear();
        }
        for (chart, all) in [("searches", searches), ("clocks", clocks)] {
            points.extend(
                all.into_iter().map(|(series, (cost, error))| (chart, "configuration", series, cost, error)),
            );
        }
        points.into_iter().map(move |point| (name, point))
    });
    FrameBuilder::of(all)
        .text("scene", |(name, _)| *name)
        .text("chart", |(_, (chart, ..))| *chart)
        .text("kind", |(_, (_, kind, ..))| *kind)
        .text("series", |(_, (_, _, series, ..))| series.clone())
        .number("cost", 6, |(_, (.., cost, _))| *cost)
        .number("error", 6, |(_, (.., error))| *error)
        .frame("drawn", "Points of the charts: processor time, or clock periods, for a unit of time")
}

/// Cost and error of runs that finished, by rising cost.
fn points_of<'d>(
    runs: impl Iterator<Item = &'d DiagramRun>,
    measure: Measure,
    cost: impl Fn(&DiagramRun) -> Option<f64>,
) -> impl Iterator<Item = (f64, f64)> {
    let points = runs.filter_map(|run| Some((cost(run)?, run.error(measure)?)));
    let mut points: Vec<_> = points.filter(|(_, error)| *error > 0.0).collect();
    points.sort_by(|a, b| a.0.total_cmp(&b.0));
    points.into_iter()
}

/// Error over cost of every scheme and precision with the scene's own search and execution. Errors below that of the reference are omitted.
/// The scene's own configuration has a name, then those of the front, then the most accurate.
fn diagram(data: &WorkPrecision, chart: &'static str, measure: Measure) -> Vec<ChartPoint> {
    let floor = data.reference.floor.get(&measure).copied().unwrap_or(0.0);
    let shown = || data.runs.iter().filter(|run| data.of(run).is_primary);
    let known = |(_, error): &(f64, f64)| *error >= floor;
    let sound: Vec<_> =
        points_of(shown().filter(|run| run.is_sound()), measure, DiagramRun::cost).filter(known).collect();
    let best: Vec<(f64, f64)> = front(&sound).into_iter().map(|place| sound[place]).collect();
    let of_configuration = |(at, it): (usize, &'_ DiagramConfiguration)| {
        let own = data.runs.iter().filter(|run| run.configuration == at);
        let points: Vec<_> = points_of(own, measure, DiagramRun::cost).filter(known).collect();
        let name = format!("{} {}", it.scheme, it.precision);
        if it.label == data.own {
            (0, format!("{name} (the scene's own)"), points)
        } else {
            (1, name, points)
        }
    };
    let primary = data.configurations.iter().enumerate().filter(|(_, it)| it.is_primary);
    let mut all: Vec<_> = primary.map(of_configuration).filter(|(.., points)| !points.is_empty()).collect();
    let on_front = |points: &[(f64, f64)]| points.iter().filter(|point| best.contains(point)).count();
    let least = |points: &[(f64, f64)]| points.iter().map(|point| point.1).fold(f64::INFINITY, f64::min);
    all.sort_by(|(a_own, _, a), (b_own, _, b)| {
        a_own.cmp(b_own).then(on_front(b).cmp(&on_front(a))).then(least(a).total_cmp(&least(b)))
    });
    let highest = all.iter().flat_map(|(.., points)| points).map(|point| point.1).fold(0.0, f64::max);
    let mut drawn: Vec<ChartPoint> = vec![];
    for (place, (_, name, points)) in all.into_iter().enumerate() {
        let (kind, name) =
            if place < NAMED { ("configuration", name) } else { ("others", "others".to_owned()) };
        drawn.extend(points.into_iter().map(|(cost, error)| (chart, kind, name.clone(), cost, error)));
    }
    drawn.extend(
        best.into_iter().map(|(cost, error)| (chart, "front", "Pareto front".to_owned(), cost, error)),
    );
    let warned = points_of(shown().filter(|run| !run.is_sound()), measure, DiagramRun::cost).filter(known);
    drawn.extend(warned.map(|(cost, error)| (chart, "warned", "warned of".to_owned(), cost, error)));
    let broken = shown().filter(|run| run.outcome.is_err() && highest > 0.0);
    let broken = broken.filter_map(|run| Some(data.of(run).each.as_ref().ok()? / run.step));
    drawn.extend(broken.map(|cost| (chart, "failed", "failed: no error".to_owned(), cost, ABOVE * highest)));
    if measure == Measure::Position && highest > COMPARABLE {
        let ends = drawn
            .iter()
            .map(|it| it.3)
            .fold([f64::INFINITY, 0.0], |[low, high], it| [it.min(low), it.max(high)]);
        let line = ends.map(|cost| (chart, "parted", "parted".to_owned(), cost, COMPARABLE));
        drawn.extend(line);
    }
    drawn
}

/// Distances of a disturbed start and of half the step over time.
pub(super) fn growth(scenes: &NamedDiagrams) -> ResultFrame {
    let all = scenes.iter().flat_map(|(name, data)| {
        let disturbed = format!("start disturbed by 1e-9 {}", data.unit);
        let grown = [(disturbed, &data.growth.separation), ("half the step".to_owned(), &data.growth.error)];
        grown.into_iter().flat_map(move |(series, distances)| {
            let points = data.growth.times.iter().zip(distances).filter(|(_, distance)| **distance > 0.0);
            points.map(move |(time, distance)| (name, series.clone(), *time, *distance))
        })
    });
    FrameBuilder::of(all)
        .text("scene", |(name, ..)| *name)
        .text("series", |(_, series, ..)| series.clone())
        .number("time", 6, |(.., time, _)| *time)
        .number("distance", 6, |(.., distance)| *distance)
        .frame("growth", "Distance of trajectories over time, RMS")
}

/// Errors of the outcomes of a collision by step, with the processor time of a step.
pub(super) fn outcomes(scenes: &NamedDiagrams) -> ResultFrame {
    let of_a_step = |data: &WorkPrecision, label: &str| {
        let own = data.runs.iter().filter(|run| data.of(run).label == label);
        let all: Vec<f64> = own.filter_map(|run| Some(run.cost()? * run.step)).collect();
        (!all.is_empty()).then(|| median(all.into_iter()))
    };
    let all = scenes.iter().flat_map(|(name, data)| {
        let collisions = data.collision.iter().flat_map(|collision| &collision.errors);
        let each = collisions.map(move |it| (data.scheme(&it.choice), it, of_a_step(data, &it.choice)));
        each.map(move |it| (name, it))
    });
    FrameBuilder::of(all)
        .text("scene", |(name, _)| *name)
        .text("integrator", |(_, (scheme, ..))| *scheme)
        .number("step", 6, |(_, (_, it, _))| it.step)
        .number("error of the restitution", 6, |(_, (_, it, _))| above_zero(it.spread[0]))
        .number("error of the deflection", 6, |(_, (_, it, _))| above_zero(it.spread[1]))
        .number("cost", 6, |(_, (_, it, cost))| cost.map(|cost| cost / it.step))
        .frame("outcomes", "Errors of the outcomes of a collision")
}

/// Returns a positive value, as logarithmic axes show no other.
fn above_zero(value: f64) -> Option<f64> {
    Some(value).filter(|value| *value > 0.0)
}
