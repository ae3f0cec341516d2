//! The pictures of a scene.

use super::super::conclusions::short;
use super::super::dataset::{Run, Way, WorkPrecision};
use super::super::front::front;
use super::super::measures::Measure;
use crate::report::figure::{Axis, Band, Chart, Figure, Picture, Point, Series, Style};
use crate::statistics::median;
use crate::study::collision::{Collision, OUTCOMES};
use crate::study::growth::COMPARABLE;
use crate::study::observables::Observables;

/// The hue of what belongs to no series.
const INK: usize = 6;

/// The pictures of a scene whose files begin with its name.
pub fn of(name: &str, data: &WorkPrecision) -> Vec<Figure> {
    let file = name.replace('-', "_");
    let mut figures = vec![
        diagram(&file, name, data, Measure::Position),
        diagram(&file, name, data, Measure::Energy),
        costs(&file, name, data),
        clocks(&file, name, data),
        growth(&file, name, data),
    ];
    if let Some(collision) = &data.collision {
        figures.push(outcomes(&file, name, data, collision));
        figures
            .extend((0..OUTCOMES.len()).map(|which| outcome_over_cost(&file, name, data, collision, which)));
    }
    figures.push(data.observables.as_ref().and_then(|all| means(&file, name, data, all)));
    // A chart without a point is no chart.
    let is_drawn = |figure: &Figure| match &figure.picture {
        Picture::Chart(chart) => chart.series.iter().any(|series| !series.points.is_empty()),
        _ => true,
    };
    figures.into_iter().flatten().filter(is_drawn).collect()
}

/// The place of a name among those that occur.
fn place(names: impl Iterator<Item = String>, name: &str) -> usize {
    let mut known: Vec<String> = vec![];
    for other in names {
        if !known.contains(&other) {
            known.push(other);
        }
    }
    known.iter().position(|other| other == name).unwrap_or(0)
}

fn axis_of_cost() -> Axis {
    Axis::logarithmic("processor time for a unit of simulated time", Some("s"))
}

fn axis_of_error(measure: Measure, unit: &str) -> Axis {
    match measure {
        Measure::Position => Axis::logarithmic("error of positions, RMS", Some(unit)),
        _ => Axis::logarithmic(measure.name(), None),
    }
}

/// A point of a run that came to its end, with the spread of nothing: costs lie along x, and bars stand on y.
fn point(run: &Run, measure: Measure, cost: impl Fn(&Run) -> Option<f64>) -> Option<(f64, f64)> {
    Some((cost(run)?, run.error(measure)?)).filter(|(_, error)| *error > 0.0)
}

/// A series for each way that `is_shown`: one hue a scheme, or a cost.
fn series<'d>(
    data: &'d WorkPrecision,
    measure: Measure,
    is_shown: impl Fn(&Way) -> bool + 'd,
    name: impl Fn(&Way) -> String + 'd,
    hue: impl Fn(&Way) -> usize + 'd,
    cost: impl Fn(&Run) -> Option<f64> + Copy + 'd,
) -> impl Iterator<Item = Series> + 'd {
    let shown = data.ways.iter().enumerate().filter(move |(_, way)| is_shown(way));
    shown.filter_map(move |(at, way)| {
        let own = data.runs.iter().filter(|run| run.way == at);
        let mut points: Vec<_> = own.filter_map(|run| point(run, measure, cost)).collect();
        points.sort_by(|a, b| a.0.total_cmp(&b.0));
        (!points.is_empty()).then(|| Series::new(name(way), Style::Joined, hue(way), points))
    })
}

/// Runs that broke, in a band above all errors, where they would cost as much as their first steps say.
fn broken(data: &WorkPrecision, is_shown: impl Fn(&Way) -> bool, shown: &[Series]) -> Option<(Series, Band)> {
    let highest = shown.iter().flat_map(|series| &series.points).map(|point| point.y).reduce(f64::max)?;
    let broken = data.runs.iter().filter(|run| run.outcome.is_err() && is_shown(&data.ways[run.way]));
    let points = broken.filter_map(|run| Some((data.ways[run.way].each? / run.step, 10.0 * highest)));
    let mut points: Vec<_> = points.collect();
    points.sort_by(|a, b| a.0.total_cmp(&b.0));
    let band = Band::of_y("", [4.0 * highest, 25.0 * highest]);
    (!points.is_empty()).then(|| (Series::new("failed: no error", Style::Points, INK, points), band))
}

/// Ways that have a name of their own in a picture; the others are grey.
const NAMED: usize = 4;

/// Error over cost, for every scheme and precision with the scene's own search and execution.
fn diagram(file: &str, name: &str, data: &WorkPrecision, measure: Measure) -> Option<Figure> {
    let is_shown = |way: &Way| way.is_primary;
    let schemes = || data.ways.iter().map(|way| way.scheme.clone());
    let floor = data.reference.floor.get(&measure).copied().unwrap_or(0.0);
    let mut all: Vec<(&Way, Series)> = data
        .ways
        .iter()
        .filter(|way| is_shown(way))
        .filter_map(|way| {
            let mut own = series(
                data,
                measure,
                |it| it.label == way.label,
                |way| format!("{} {}", way.scheme, way.digits),
                move |way| place(schemes(), &way.scheme),
                Run::cost,
            );
            let mut own = own.next()?;
            // Below the reference's own error nothing is known.
            own.points.retain(|point| point.y >= floor);
            (!own.points.is_empty()).then_some((way, own))
        })
        .collect();
    // The front goes through points that are drawn, and against which nothing speaks.
    let sound: Vec<(f64, f64)> = data
        .runs
        .iter()
        .filter(|run| run.is_sound() && is_shown(&data.ways[run.way]))
        .filter_map(|run| point(run, measure, Run::cost))
        .filter(|(_, error)| *error >= floor)
        .collect();
    let best: Vec<(f64, f64)> = front(&sound).into_iter().map(|place| sound[place]).collect();
    let on_front = |it: &Series| it.points.iter().filter(|point| best.contains(&(point.x, point.y))).count();
    // Those of the front first, then the scene's own, then the most accurate.
    let least = |it: &Series| it.points.iter().map(|point| point.y).fold(f64::INFINITY, f64::min);
    all.sort_by(|(a_way, a), (b_way, b)| {
        let own = |way: &Way| way.label == data.own;
        on_front(b).cmp(&on_front(a)).then(own(b_way).cmp(&own(a_way))).then(least(a).total_cmp(&least(b)))
    });
    let others: Vec<Point> = all.iter().skip(NAMED).flat_map(|(_, it)| it.points.clone()).collect();
    let unnamed = all.iter().skip(NAMED).map(|(_, it)| it.name.as_str()).collect::<Vec<_>>().join(", ");
    let mut all: Vec<Series> = all.into_iter().take(NAMED).map(|(_, it)| it).collect();
    let parted = all.iter().flat_map(|it| &it.points).any(|point| point.y > COMPARABLE)
        && measure == Measure::Position;
    all.push(Series::new("others", Style::Points, INK, others));
    let failed = broken(data, is_shown, &all);
    all.push(Series::new("Pareto front", Style::Line, INK, best));
    let highest = all.iter().flat_map(|it| &it.points).map(|point| point.y).fold(0.0, f64::max);
    let (of, error) = match measure {
        Measure::Position => ("position", "error"),
        _ => ("energy", "error of the energy"),
    };
    let mut chart = Chart::of(axis_of_cost(), axis_of_error(measure, &data.unit));
    if parted {
        chart = chart.band(Band::of_y("", [COMPARABLE, 2.0 * highest]));
    }
    if let Some((series, band)) = failed {
        all.push(series);
        chart = chart.band(band);
    }
    let said = [
        format!(
            "{} particles over a time of {}; the scene's own step is {}, along each line it doubles from point to point.",
            data.particles,
            short(data.duration),
            short(data.step)
        ),
        if unnamed.is_empty() { String::new() } else { format!(" Others: {unnamed}.") },
        if parted {
            " On the ground: parted by more than a tenth of a radius.".to_owned()
        } else {
            String::new()
        },
        if floor > 0.0 {
            format!(" The reference itself errs by {}; what errs less is not drawn.", short(floor))
        } else {
            String::new()
        },
        format!(
            " Cost: the median of the repeats, which differ by {:.0} % in the middle; search and execution as the scene has them ({}). The front \
             is over the ways that are drawn and against which nothing speaks.",
            100.0 * spread(data),
            data.ways.iter().find(|way| way.is_primary).map_or("", |way| &way.cost)
        ),
    ];
    Some(
        chart
            .with(all.into_iter().filter(|series| !series.points.is_empty()))
            .figure(format!("{file}_{of}"), format!("{name}: {error} over cost"))
            .caption(said.concat()),
    )
}

/// By how much the repeats of a run differ, in parts of the shortest: the median over the runs.
fn spread(data: &WorkPrecision) -> f64 {
    let of = |run: &Run| {
        let [least, most] = [f64::min, f64::max].map(|end| run.costs.iter().copied().reduce(end));
        Some(most? / least? - 1.0)
    };
    median(data.runs.iter().filter_map(of))
}

/// The same for every search and execution, in the scene's own scheme and precision.
fn costs(file: &str, name: &str, data: &WorkPrecision) -> Option<Figure> {
    let is_shown = |way: &Way| way.is_own_arithmetic;
    let names = || data.ways.iter().map(|way| way.cost.clone());
    let all: Vec<Series> = series(
        data,
        Measure::Position,
        is_shown,
        |way| way.cost.clone(),
        move |way| place(names(), &way.cost),
        Run::cost,
    )
    .collect();
    (all.len() > 1).then(|| {
        Chart::of(axis_of_cost(), axis_of_error(Measure::Position, &data.unit))
            .with(all)
            .figure(format!("{file}_searches"), format!("{name}: the same error, found in other ways"))
            .caption(format!(
                "The scene's own integrator and precision ({}) with every search and execution: errors are equal but for rounding, costs are \
                 not.",
                data.own
            ))
    })
}

/// Error over clock periods, for the ways whose operations are counted.
fn clocks(file: &str, name: &str, data: &WorkPrecision) -> Option<Figure> {
    let machine = data.machine.as_ref()?;
    let schemes = || data.ways.iter().map(|way| way.scheme.clone());
    let counted =
        |way: &Way| data.runs.iter().any(|run| data.ways[run.way].label == way.label && run.clocks.is_some());
    let all = series(
        data,
        Measure::Position,
        counted,
        |way| way.label.clone(),
        move |way| place(schemes(), &way.scheme),
        |run| run.clocks,
    );
    Some(
        Chart::of(
            Axis::logarithmic("cost of a unit of simulated time", Some("clock periods")),
            axis_of_error(Measure::Position, &data.unit),
        )
        .with(all)
        .figure(format!("{file}_clocks"), format!("{name}: error over clock periods"))
        .caption(format!(
            "By the paper's clock of {machine}, n + D for each operation counted. Ways whose work depends on the data are not in it: they have \
             no fixed program to count. Executions of one program have the same clock periods."
        )),
    )
}

/// How a disturbance and the error of the scene's own step grow.
fn growth(file: &str, name: &str, data: &WorkPrecision) -> Option<Figure> {
    let grown = &data.growth;
    let over_time = |values: &[f64]| -> Vec<(f64, f64)> {
        let points = grown.times.iter().copied().zip(values.iter().copied());
        points.filter(|(_, distance)| *distance > 0.0).collect()
    };
    let rate = grown.rate.map_or("No exponential growth is seen".to_owned(), |rate| {
        format!("The distance grows as exp({} t)", short(rate))
    });
    let disturbed = format!("start disturbed by 1e-9 {}", data.unit);
    Some(
        Chart::of(
            Axis::linear("time", data.time_unit.as_deref()),
            Axis::logarithmic("distance, RMS", Some(&data.unit)),
        )
        .series(disturbed, Style::Line, 0, over_time(&grown.separation))
        .series("half the step", Style::Dashed, 1, over_time(&grown.error))
        .figure(format!("{file}_growth"), format!("{name}: how long trajectories are comparable"))
        .caption(format!("{rate}; compared is a time of {}.", short(data.duration))),
    )
}

/// Errors of what comes out of a collision over the step.
fn outcomes(file: &str, name: &str, data: &WorkPrecision, collision: &Collision) -> Option<Figure> {
    let scheme = |label: &str| data.ways.iter().find(|way| way.label == label).map_or("", |way| &way.scheme);
    let schemes = || data.ways.iter().map(|way| way.scheme.clone());
    let mut labels: Vec<&str> = collision.errors.iter().map(|error| error.choice.as_str()).collect();
    labels.dedup();
    let of = |label: &&str| {
        let own = collision.errors.iter().filter(|error| error.choice == **label);
        let points = own.map(|error| (error.step, error.spread[0])).filter(|(_, error)| *error > 0.0);
        Series::new(scheme(label), Style::Joined, place(schemes(), scheme(label)), points)
    };
    Some(
        Chart::of(
            Axis::logarithmic("step", data.time_unit.as_deref()),
            Axis::logarithmic("error of the restitution", None),
        )
        .with(labels.iter().map(of))
        .figure(format!("{file}_{}", OUTCOMES[0]), format!("{name}: error of the restitution over the step"))
        .caption(format!(
            "{} starts, each a part of a step later than the one before: root of the mean square over them. Means are in the table.",
            collision.phases
        )),
    )
}

/// Errors of what comes out of a collision over the cost, by the processor time that a step of the same way takes.
fn outcome_over_cost(
    file: &str,
    name: &str,
    data: &WorkPrecision,
    collision: &Collision,
    which: usize,
) -> Option<Figure> {
    let schemes = || data.ways.iter().map(|way| way.scheme.clone());
    let mut all = vec![];
    for (at, way) in data.ways.iter().enumerate() {
        let own = data.runs.iter().filter(|run| run.way == at);
        let of_a_step: Vec<f64> = own.filter_map(|run| Some(run.cost()? * run.step)).collect();
        if of_a_step.is_empty() {
            continue;
        }
        let of_a_step = median(of_a_step.into_iter());
        let errors = collision.errors.iter().filter(|error| error.choice == way.label);
        let points = errors.map(|error| (of_a_step / error.step, error.spread[which]));
        let points = points.filter(|(_, error)| *error > 0.0);
        all.push(Series::new(&way.scheme, Style::Joined, place(schemes(), &way.scheme), points));
    }
    all.retain(|series| !series.points.is_empty());
    let (outcome, unit) = (OUTCOMES[which], [None, Some("rad")][which]);
    Some(
        Chart::of(axis_of_cost(), Axis::logarithmic(&format!("error of the {outcome}"), unit))
            .with(all)
            .figure(format!("{file}_{outcome}_cost"), format!("{name}: error of the {outcome} over the cost"))
            .caption(format!(
                "Root of the mean square over {} starts, each a part of a step later than the one before. The cost is that of the scene's steps.",
                collision.phases
            )),
    )
}

/// Differences of a mean over time: full where they count, hollow where the error bar reaches zero.
fn means(file: &str, name: &str, data: &WorkPrecision, all: &Observables) -> Option<Figure> {
    let observable = &all.comparisons.first()?.observable;
    let way = |label: &str| data.ways.iter().find(|way| way.label == label);
    let schemes = || data.ways.iter().map(|way| way.scheme.clone());
    let mut labels: Vec<&str> = all.comparisons.iter().map(|it| it.choice.as_str()).collect();
    labels.sort_unstable();
    labels.dedup();
    let digits = data.ways.iter().find(|way| way.label == data.reference.ways[0]).map(|way| &way.digits);
    let in_full = labels.into_iter().filter(|label| way(label).map(|way| &way.digits) == digits);
    let mut series = vec![];
    for label in in_full {
        let Some(way) = way(label) else { continue };
        // Full and hollow markers of one way have one name, that of those that there are.
        let mut name = way.scheme.clone();
        for reaches_zero in [false, true] {
            let own = all.comparisons.iter().filter(|it| {
                it.choice == label && it.observable == *observable && it.reaches_zero() == reaches_zero
            });
            let points = own.map(|it| {
                let [size, bar] = [100.0 * it.difference, 100.0 * it.bar];
                (it.step, size, [size - bar, size + bar])
            });
            let hue = place(schemes(), &way.scheme);
            let own = Series::new(name.clone(), Style::Points, hue, points);
            if !own.points.is_empty() {
                name.clear();
                series.push(own);
            }
        }
    }
    Some(
        Chart::of(Axis::logarithmic("step", data.time_unit.as_deref()), Axis::linear("difference", Some("%")))
            .with(series)
            .figure(format!("{file}_means"), format!("{name}: mean {observable}, off the reference's"))
            .caption(format!(
                "Means over the second half of a time of {}, {} seeds; bars hold the difference in 95 of 100 studies. Hollow: no significant \
                 difference.",
                short(all.duration),
                data.seeds.len()
            )),
    )
}
