//! The picture of a map.

use super::super::dataset::{Stability, over_seeds};
use super::super::outcome::Class;
use crate::report::figure::{Axis, Chart, Figure, Point, Series, Style};
use crate::study::work_precision::conclusions::short;
use stripmine_physics::method::Beyond;

/// The hue of what was measured, and of theory.
const INK: usize = 6;

/// The hue and with it the marker of a class.
fn hue(class: Class) -> usize {
    match class {
        Class::Works => 5,
        Class::Silent => 1,
        Class::EnergyLoss => 4,
        Class::EnergyGrowth => 3,
        Class::Penetration => 2,
        Class::MaskOutrun => 0,
        Class::SharedCell => 7,
        Class::ParticleLost => 9,
        Class::NonFinite => 10,
        Class::Stopped => 11,
        Class::Refused => 6,
    }
}

/// The map: a marker for what became of each place, edges with bars over the seeds, and theory.
pub fn map(name: &str, data: &Stability) -> Figure {
    let classes = Class::ALL.into_iter().map(|class| of_class(data, class));
    let edges = [("edge of what works", Style::Line), ("edge of what comes to an end", Style::Dashed)];
    let edges = edges.into_iter().enumerate();
    let edges = edges.map(|(which, (name, style))| Series::new(name, style, INK, edge(data, which)));
    let [low, high] = [data.steps[0], data.steps[data.steps.len() - 1]];
    let limits = data.limits.iter().enumerate().map(|(place, limit)| {
        let style = if limit.beyond == Beyond::Unstable { Style::Line } else { Style::Dashed };
        let shown = limit.points.iter().copied().filter(|(_, step)| low <= *step && *step <= high);
        Series::new(format!("theory: {}", limit.name), style, place, shown)
    });
    let marks = data.marks.iter();
    let marks =
        marks.map(|(at, what)| Series::new(what, Style::Dashed, INK, [low, high].map(|step| (*at, step))));
    let ends = [data.values[0], data.values[data.values.len() - 1]];
    let own = Series::new("the scene's own step", Style::Dashed, 2, ends.map(|value| (value, data.step)));
    let all = classes.chain(edges).chain(limits).chain(marks).chain([own]);
    let unit = (!data.parameter.unit.is_empty()).then_some(data.parameter.unit);
    let x = match data.parameter.is_logarithmic {
        true => Axis::logarithmic(data.parameter.label, unit),
        false => Axis::linear(data.parameter.label, unit),
    };
    let title = format!("{name}: where it works, over the step and the {}", data.parameter.label);
    Chart::of(x, Axis::logarithmic("step", Some("reduced")))
        .with(all.filter(|series| !series.points.is_empty()))
        .figure(format!("{}_stability", name.replace('-', "_")), title)
        .caption(format!(
            "{} × {} runs of a time of {}, {}; bisected edges from {} seeds, bars from the lowest to the highest. The scene's own step is {}.",
            data.values.len(),
            data.steps.len(),
            short(data.duration),
            data.way,
            data.seeds.len(),
            short(data.step)
        ))
}

fn of_class(data: &Stability, class: Class) -> Series {
    let places = data.values.iter().zip(&data.map).flat_map(|(value, cells)| {
        let own = data.steps.iter().zip(cells).filter(|(_, cell)| cell.class == class);
        own.map(|(step, _)| (*value, *step))
    });
    Series::new(class.name(), Style::Points, hue(class), places)
}

/// The edge of what works (0) or of what comes to an end (1).
fn edge(data: &Stability, which: usize) -> Vec<Point> {
    let at = data.values.iter().zip(&data.boundaries).filter_map(|(&value, boundary)| {
        let [middle, low, high] = over_seeds([&boundary.works, &boundary.ends][which])?;
        Some(Point { x: value, y: middle, spread: (which == 0).then_some([low, high]) })
    });
    at.collect()
}
