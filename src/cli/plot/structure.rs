//! Structure functions of a run: a chart of each file with error bars, or a map for functions of position.

use crate::cli::display::UnitSystem;
use crate::console::warn;
use crate::report::figure::{Chart, ChartAxis, Figure, HeatMap, Picture, Series, Style};
use std::path::Path;
use stripmine_physics::averages::MeanWithBar;
use stripmine_physics::run::{FinishedError, FunctionPoint, StructureFunction, functions_of};
use stripmine_physics::structure::{FunctionArguments, SamplingKind, StructureObservable};

/// Draws a figure of each structure file with rows, and warns about the others.
///
/// # Errors
/// As [`functions_of`].
pub(super) fn figures(run: &Path, units: &UnitSystem) -> Result<Vec<Figure>, FinishedError> {
    let functions = functions_of(std::iter::once(run))?;
    for StructureFunction { name, doubt, .. } in
        functions.iter().filter(|function| function.points.is_empty())
    {
        doubt.iter().for_each(|doubt| warn(format_args!("{name}: {doubt}")));
    }
    let functions = functions.iter().filter(|function| !function.points.is_empty());
    Ok(functions.filter_map(|function| figure(function, units)).collect())
}

fn axis([label, unit]: [&str; 2], units: &UnitSystem) -> ChartAxis {
    ChartAxis::linear(label, (!unit.is_empty()).then_some(units.symbol(unit).as_str()))
}

fn figure(function: &StructureFunction, units: &UnitSystem) -> Option<Figure> {
    let observable = function.observable;
    let axis = |of: [&str; 2]| axis(of, units);
    let name = observable.file.trim_end_matches(".csv").to_owned();
    let figure = match *observable.over {
        // Means of species alone have no axis.
        [.., _] if observable.species() == observable.over.len() => return None,
        [.., over] if observable.species() > 0 => {
            let over = if has_waves_of_species(observable) { ["k", "1/length"] } else { over };
            let chart = Chart::of(axis(over), axis(observable.value));
            chart.with(series_of_species(function)).figure(name, observable.name.to_owned())
        }
        [over] => {
            let series = series(function, observable.name, 0, |point| Some(point.over[0]));
            Chart::of(axis(over), axis(observable.value))
                .with([series])
                .figure(name, observable.name.to_owned())
        }
        _ if is_of_waves(observable) => {
            let along = [0, 1].map(|axis| {
                // The other component is 0.
                let number =
                    move |point: &FunctionPoint| Some(point.over[axis]).filter(|number| *number > 0.0);
                series(function, ["along x", "along y"][axis], axis, number)
            });
            Chart::of(axis(["k", "1/length"]), axis(observable.value))
                .with(along.into_iter().filter(|series| !series.points.is_empty()))
                .figure(name, observable.name.to_owned())
        }
        [x, y] => {
            let axes = [x, y, observable.value].map(axis);
            map(function, axes)?.figure(name, observable.name.to_owned())
        }
        _ => return None,
    };
    Some(match &function.doubt {
        Some(doubt) => figure.caption(format!("{} {doubt}.", observable.doc)),
        None => figure.caption(observable.doc),
    })
}

/// Returns true for functions of wave vectors.
fn is_of_waves(observable: &StructureObservable) -> bool {
    matches!(observable.seen, SamplingKind::Once { over: FunctionArguments::Waves, .. })
}

/// Points of each species or pair of species; those of waves for each axis.
fn series_of_species(function: &StructureFunction) -> impl Iterator<Item = Series> {
    let species = function.observable.species();
    let has_waves = has_waves_of_species(function.observable);
    let axis = move |point: &FunctionPoint| usize::from(has_waves && point.over[species] == 0.0);
    let is_alike = move |a: &FunctionPoint, b: &FunctionPoint| {
        a.over[..species] == b.over[..species] && axis(a) == axis(b)
    };
    let groups = function.points.chunk_by(is_alike);
    groups.enumerate().map(move |(hue, points)| {
        let names: Vec<String> = points[0].over[..species].iter().map(f64::to_string).collect();
        let along = if has_waves { [" along x", " along y"][axis(&points[0])] } else { "" };
        let of = StructureFunction { points: points.to_vec(), ..function.clone() };
        series(&of, &format!("{}{along}", names.join(" and ")), hue, |point| {
            point.over.get(species + axis(point)).copied()
        })
    })
}

/// Returns true for functions of species and wave vectors.
fn has_waves_of_species(observable: &StructureObservable) -> bool {
    observable.over.len() == observable.species() + 2
}

/// Points of a function that have a coordinate, with their error bars if known.
fn series(
    function: &StructureFunction,
    name: &str,
    hue: usize,
    of: impl Fn(&FunctionPoint) -> Option<f64>,
) -> Series {
    let point = |point: &FunctionPoint| {
        let MeanWithBar { value, bar } = point.mean;
        let bar = if bar.is_nan() { 0.0 } else { bar };
        Some((of(point)?, value, [value - bar, value + bar]))
    };
    Series::new(name, Style::Joined, hue, function.points.iter().filter_map(point).collect::<Vec<_>>())
}

/// Map of a function of position, stored row by row on a grid; none if cells are missing.
fn map(function: &StructureFunction, [x, y, value]: [ChartAxis; 3]) -> Option<Picture> {
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
    Some(Picture::Map(HeatMap {
        x: x.between(ends(0, 1)),
        y: y.between(ends(1, columns)),
        value,
        rows: points.chunks(columns).map(|row| row.iter().map(|point| point.mean.value).collect()).collect(),
    }))
}
