//! The structure that a run has summed up: a chart of each of its files, with the bars.

use crate::report::figure::{Axis, Chart, Figure, Series, Style};
use std::path::Path;
use stripmine_physics::io::regular_file;
use stripmine_physics::structure::{OBSERVABLES, Observable};

/// Longer than any of the files (bytes).
const LONGEST: u64 = 1 << 20;

/// A figure of each file that is there and has rows.
pub(super) fn figures(run: &Path) -> Vec<Figure> {
    OBSERVABLES.iter().filter_map(|observable| figure(run, observable)).collect()
}

fn figure(run: &Path, observable: &Observable) -> Option<Figure> {
    let bytes = regular_file::read(&run.join(observable.file), LONGEST).ok()?;
    let text = String::from_utf8(bytes).ok()?;
    let point = |line: &str| -> Option<(f64, f64, [f64; 2])> {
        let numbers: Vec<f64> = line.split(',').map(str::parse).collect::<Result<_, _>>().ok()?;
        let [over, mean, bar] = numbers[..] else { return None };
        Some((over, mean, [mean - bar, mean + bar]))
    };
    let points: Vec<_> = text.lines().skip(1).map_while(point).collect();
    if points.is_empty() {
        return None;
    }
    let axis = |[label, unit]: [&str; 2]| Axis::linear(label, (!unit.is_empty()).then_some(unit));
    let series = Series::new(observable.name, Style::Joined, 0, points);
    let chart = Chart::of(axis(observable.over), axis(observable.value)).with([series]);
    let name = observable.file.trim_end_matches(".csv");
    Some(chart.figure(name.to_owned(), observable.name.to_owned()).caption(observable.doc))
}
