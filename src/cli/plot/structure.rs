//! The structure that a run has summed up: a chart of each of its files, with the bars, or a map where it is one of places.

use crate::report::figure::{Axis, Chart, Figure, Map, Picture, Series, Style};
use std::path::Path;
use stripmine_physics::run::{Function, Point, functions_of};

/// A figure of each file that is there and has rows.
pub(super) fn figures(run: &Path) -> Vec<Figure> {
    functions_of(std::iter::once(run)).iter().filter_map(figure).collect()
}

fn axis([label, unit]: [&str; 2]) -> Axis {
    Axis::linear(label, (!unit.is_empty()).then_some(unit))
}

fn figure(function: &Function) -> Option<Figure> {
    let observable = function.observable;
    let name = observable.file.trim_end_matches(".csv").to_owned();
    let figure = match *observable.over {
        [over] => {
            let point = |Point { over, mean, bar }: &Point| (over[0], *mean, [mean - bar, mean + bar]);
            let points: Vec<_> = function.points.iter().map(point).collect();
            let series = Series::new(observable.name, Style::Joined, 0, points);
            Chart::of(axis(over), axis(observable.value))
                .with([series])
                .figure(name, observable.name.to_owned())
        }
        [x, y] => map(function, [axis(x), axis(y)])?.figure(name, observable.name.to_owned()),
        _ => return None,
    };
    Some(figure.caption(observable.doc))
}

/// A function of places on a whole grid, which it has row by row; none where some of its cells are missing.
fn map(function: &Function, [x, y]: [Axis; 2]) -> Option<Picture> {
    let points = &function.points;
    let first = points.first()?;
    let columns = points.iter().take_while(|point| point.over[1] == first.over[1]).count();
    if points.len() < 2 * columns || !points.len().is_multiple_of(columns) || columns < 2 {
        return None;
    }
    let ends = |axis: usize, step: usize| {
        let [first, second, last] = [0, step, points.len() - 1].map(|at| points[at].over[axis]);
        let half = 0.5 * (second - first);
        [first - half, last + half]
    };
    Some(Picture::Map(Map {
        x: x.between(ends(0, 1)),
        y: y.between(ends(1, columns)),
        value: axis(function.observable.value),
        rows: points.chunks(columns).map(|row| row.iter().map(|point| point.mean).collect()).collect(),
    }))
}
