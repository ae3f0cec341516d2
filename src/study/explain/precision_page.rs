//! The page of the error of a mean over the time that it takes.

use super::precision::{Curve, Precision};
use crate::console::Failure;
use crate::report::figure::{Axis, Chart, Figure, Series, Style};
use crate::report::{Cell, Rows, Section, Table};
use crate::results::Made;
use crate::study::work_precision::front;
use stripmine_physics::number::{counted, significant, with_bar};

/// Errors that are asked for, in parts of the mean, where it is none of about zero.
const WISHES: [f64; 5] = [0.1, 0.03, 0.01, 0.003, 0.001];

/// The page, called `name`, and `again`, the command that makes it.
///
/// # Errors
/// If the dataset is none that JSON can hold.
pub fn made(name: &str, scenes: &[(String, Precision)], again: String) -> Result<Made, Failure> {
    let section = Section::new(name, "Error of a mean against its cost")
        .asks("Which way, step and run length is the cheapest for a wished error of a mean?")
        .expects("The sources state a scheme and a step, and no error.")
        .answers(scenes.iter().map(|(name, data)| answer(name, data)).collect::<Vec<_>>().join(" "))
        .details(scenes.iter().map(|(name, data)| details(name, data)))
        .figures(scenes.iter().flat_map(|(name, data)| figures(name, data)))
        .tables(scenes.iter().flat_map(|(name, data)| [wishes(name, data), measured(name, data)]))
        .again(again)
        .depends_on_host();
    Made::by_name(section, scenes)
}

fn label(curve: &Curve) -> String {
    curve.step.map_or(curve.way.clone(), |step| format!("{}, dt {}", curve.way, significant(step, 3)))
}

/// A point that was drawn: wall seconds, error, and the curve that it is of.
type Drawn<'d> = (f64, f64, &'d Curve);

/// What was drawn and nothing drawn beats, by rising cost. Errors below what the reference is known to say nothing.
fn best(data: &Precision) -> Vec<Drawn<'_>> {
    let all: Vec<Drawn<'_>> = data
        .curves
        .iter()
        .flat_map(|curve| curve.points.iter().map(move |[seconds, error, _]| (*seconds, *error, curve)))
        .filter(|(_, error, _)| *error > 0.5 * data.reference[1])
        .collect();
    let points: Vec<(f64, f64)> = all.iter().map(|(seconds, error, _)| (*seconds, *error)).collect();
    front(&points).into_iter().map(|at| all[at]).collect()
}

fn answer(name: &str, data: &Precision) -> String {
    let best = best(data);
    let Some((seconds, error, curve)) = best.last() else {
        return format!("Of {name} nothing is seen beyond what the reference is known to.");
    };
    let [mean, bar] = data.reference;
    let error = match mean.abs() > bar {
        true => format!("{} %", significant(100.0 * error / mean.abs(), 2)),
        false => significant(*error, 2),
    };
    format!(
        "{} of {name} comes to a root-mean-square error of {error} in {} s after the transient, most cheaply by {}.",
        data.quantity,
        significant(*seconds, 2),
        label(curve)
    )
}

fn details(name: &str, data: &Precision) -> String {
    let [mean, bar] = data.reference;
    let left_out: Vec<String> = data.left_out.iter().map(|(what, why)| format!("{what}: {why}")).collect();
    let without = match left_out.as_slice() {
        [] => String::new(),
        all => format!(" Not measured: {}.", all.join("; ")),
    };
    format!(
        "`{name}`: held against {} ({}); the transient, {} long, counts for none. A point is of at least 6 runs, pieces of one long run, one after \
         the other.{without}",
        with_bar(mean, bar),
        data.reference_step.map_or(data.reference_way.clone(), |step| {
            format!("{}, dt {}", data.reference_way, significant(step, 3))
        }),
        significant(data.transient, 3)
    )
}

fn figures(name: &str, data: &Precision) -> Vec<Figure> {
    let file = name.replace('-', "_");
    let unit = (!data.unit.is_empty()).then_some(data.unit);
    let curves = data.curves.iter().zip(0..).map(|(curve, hue)| {
        let points = curve.points.iter().map(|[seconds, error, _]| (*seconds, *error));
        Series::new(label(curve), Style::Joined, hue, points.collect::<Vec<_>>())
    });
    let curves: Vec<Series> = curves.collect();
    let ends = || data.curves.iter().flat_map(|curve| &curve.points).map(|[seconds, ..]| *seconds);
    let known = 0.5 * data.reference[1];
    let floor = [ends().fold(f64::INFINITY, f64::min), ends().fold(0.0, f64::max)].map(|x| (x, known));
    let reference = (known > 0.0).then(|| Series::new("error of the reference", Style::Dashed, 6, floor));
    let over_time = Chart::of(
        Axis::logarithmic("wall time of a run after the transient", Some("s")),
        Axis::logarithmic(&format!("error of the mean of {}, RMS", data.quantity), unit),
    )
    .with(curves)
    .with(reference)
    .figure(format!("{file}_error_over_time"), format!("{name}: error of a mean over the time that it takes"))
    .caption("A curve falls with the root of the time until the bias of its step is left.");
    let mut figures = vec![over_time];
    let off = |curve: &Curve| {
        let (step, [mean, bar]) = curve.step.zip(curve.mean)?;
        let off = mean - data.reference[0];
        Some((curve.way.clone(), (step, off, [off - bar, off + bar])))
    };
    let by_way: Vec<_> = data.curves.iter().filter_map(off).collect();
    if !by_way.is_empty() {
        let shown = Series::by_name(Style::Points, by_way);
        let of_reference = [-data.reference[1], data.reference[1]];
        let steps = || data.curves.iter().filter_map(|curve| curve.step);
        let ends = [steps().fold(f64::INFINITY, f64::min), steps().fold(0.0, f64::max)];
        let ground = ends.map(|x| (x, 0.0, of_reference));
        let bias = Chart::of(
            Axis::logarithmic("time step", Some("the scene's unit")),
            Axis::linear(&format!("{} less that of the reference", data.quantity), unit),
        )
        .with([Series::new("reference, ± 95 %", Style::Ribbon, 6, ground)])
        .with(shown);
        let title = format!("{name}: what a step takes the mean off by");
        figures.push(bias.figure(format!("{file}_bias"), title).caption("Bars: 95 %."));
    }
    figures
}

/// The cheapest for each wish.
fn wishes(name: &str, data: &Precision) -> Table {
    let best = best(data);
    let mean = data.reference[0].abs();
    let found: Vec<(f64, Option<&Drawn<'_>>)> =
        WISHES.iter().map(|wish| (*wish, best.iter().find(|(_, error, _)| *error <= wish * mean))).collect();
    Rows::of(&found)
        .cell("error, RMS (%)", |(wish, _)| Cell::Short(100.0 * wish))
        .text("cheapest that was drawn", |(_, found)| {
            found.map_or("none: longer than the trials, or below the reference's error".to_owned(), |it| {
                label(it.2)
            })
        })
        .cell("wall time (s)", |(_, found)| found.map_or(Cell::Nothing, |it| Cell::Short(it.0)))
        .table(
            format!("{}_wishes", name.replace('-', "_")),
            format!("{name}: which for which error of {}", data.quantity),
        )
}

fn measured(name: &str, data: &Precision) -> Table {
    let [mean, _] = data.reference;
    Rows::of(&data.curves)
        .text("way", |it| it.way.clone())
        .cell("dt", |it| it.step.map_or(Cell::Nothing, Cell::Short))
        .cell("wall time of a unit of time (s)", |it| Cell::Short(it.cost))
        .cell("mean less the reference", |it| {
            it.mean.map_or(Cell::Nothing, |[own, _]| Cell::Short(own - mean))
        })
        .cell("± (95 %)", |it| it.mean.map_or(Cell::Nothing, |[_, bar]| Cell::Short(bar)))
        .cell("error of the longest run, RMS", |it| {
            it.points.last().map_or(Cell::Nothing, |it| Cell::Short(it[1]))
        })
        .cell("its wall time (s)", |it| it.points.last().map_or(Cell::Nothing, |it| Cell::Short(it[0])))
        .table(
            format!("{}_means", name.replace('-', "_")),
            format!("{name}: {} measured", counted(data.curves.len(), "way and step", "ways and steps")),
        )
}
