//! Charts of a scan: each quantity with its error bars over the first key, a series for each value of the others.

use super::grid::number;
use super::table::{KeyTable, TablePoint, TableQuantity, mean};
use crate::cli::display::UnitSystem;
use crate::report::figure::{Chart, ChartAxis, Figure, Series, SeriesPoint, Style};
use stripmine_physics::averages::{AverageOutcome, Estimate};
use stripmine_physics::quoted::quoted;

/// Largest number of series, so that their colours and markers differ.
const MOST_SERIES: usize = 7;

/// Charts of all quantities whose mean has an error at a point.
pub(super) fn figures(table: &KeyTable, units: &UnitSystem) -> Vec<Figure> {
    let has_error = |quantity: &TableQuantity| {
        table.points.iter().any(|it| matches!(it.outcome(quantity), Some(AverageOutcome::Mean(_))))
    };
    let drawn = table.quantities().into_iter().filter(has_error);
    drawn.map(|quantity| figure(table, &quantity, units)).collect()
}

/// File name of a quantity's chart.
pub(super) fn file_name(quantity: &str) -> String {
    format!("{quantity}.svg")
}

fn figure(table: &KeyTable, quantity: &TableQuantity, units: &UnitSystem) -> Figure {
    let headings = table.key_headings(units);
    let words = quantity.column.replace('_', " ");
    let unit = units.symbol(&quantity.unit);
    let label = |point: &TablePoint| -> String {
        let others =
            (1..table.keys.len()).map(|key| format!("{} = {}", headings[key], point.value_text(key)));
        others.collect::<Vec<_>>().join(", ")
    };
    let mut labels: Vec<String> = vec![];
    for point in table.points.iter().filter(|point| mean(point.outcome(quantity)).is_some()) {
        let label = label(point);
        if !labels.contains(&label) {
            labels.push(label);
        }
    }
    let count = labels.len();
    // Of many series some are shown, evenly spaced, the first and the last among them.
    let shown = |at: usize| at * (count - 1) / (MOST_SERIES - 1).min(count - 1).max(1);
    let shown: Vec<&String> = (0..count.min(MOST_SERIES)).map(|at| &labels[shown(at)]).collect();
    let numbers: Option<Vec<f64>> =
        table.points.iter().map(|point| number(point.values[0].as_ref()?)).collect();
    let mut names: Vec<String> = vec![];
    for point in &table.points {
        let name = quoted(&point.value_text(0));
        if !names.contains(&name) {
            names.push(name);
        }
    }
    let place = |row: usize, point: &TablePoint| match &numbers {
        Some(numbers) => numbers[row],
        None => {
            names.iter().position(|name| *name == quoted(&point.value_text(0))).unwrap_or_default() as f64
        }
    };
    let series = shown.iter().enumerate().map(|(hue, name)| {
        let own = table.points.iter().enumerate().filter(|(_, point)| label(point) == **name);
        let points = own.filter_map(|(row, point)| {
            let outcome = point.outcome(quantity);
            let spread = match outcome {
                Some(AverageOutcome::Mean(Estimate { mean, bar, .. })) => Some([mean - bar, mean + bar]),
                _ => None,
            };
            Some(SeriesPoint { spread, ..SeriesPoint::at(place(row, point), mean(outcome)?) })
        });
        let mut points: Vec<SeriesPoint> = points.collect();
        points.sort_by(|a, b| a.x.total_cmp(&b.x));
        Series::new(quoted(name), Style::Joined, hue, points)
    });
    let x = match numbers {
        Some(_) => ChartAxis::linear(&headings[0], None),
        None => ChartAxis::names(&headings[0], names.clone()),
    };
    let left_out = match count - shown.len() {
        0 => String::new(),
        left => format!(" {left} of {count} series are not drawn."),
    };
    Chart::of(x, ChartAxis::linear(&words, (!unit.is_empty()).then_some(unit.as_str())))
        .with(series)
        .figure(quantity.name, format!("{words} over {}", headings[0]))
        .caption(format!("Means with 95 % intervals.{left_out}"))
}
