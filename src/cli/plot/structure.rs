//! The structure that a run has summed up: a chart of each of its files, with the bars.

use crate::report::figure::{Axis, Chart, Figure, Series, Style};
use std::path::Path;
use stripmine_physics::run::{Function, functions_of};

/// A figure of each file that is there and has rows.
pub(super) fn figures(run: &Path) -> Vec<Figure> {
    functions_of(std::iter::once(run)).iter().map(figure).collect()
}

fn figure(function: &Function) -> Figure {
    let observable = function.observable;
    let point = |&[over, mean, bar]: &[f64; 3]| (over, mean, [mean - bar, mean + bar]);
    let axis = |[label, unit]: [&str; 2]| Axis::linear(label, (!unit.is_empty()).then_some(unit));
    let points: Vec<_> = function.points.iter().map(point).collect();
    let series = Series::new(observable.name, Style::Joined, 0, points);
    let chart = Chart::of(axis(observable.over), axis(observable.value)).with([series]);
    let name = observable.file.trim_end_matches(".csv");
    chart.figure(name.to_owned(), observable.name.to_owned()).caption(observable.doc)
}
