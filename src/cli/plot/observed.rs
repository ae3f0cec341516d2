//! Observables of a run: `thermo.csv` as charts, and one line for each in the terminal.

use super::means::ColumnMeans;
use crate::cli::display::UnitSystem;
use crate::frame::{FormattedTable, FrameBuilder, TableCell};
use crate::report::figure::{Chart, ChartAxis, Figure, Series, Style};
use crate::report::terminal;
use crate::statistics::quantile;
use std::collections::BTreeMap;
use std::path::Path;
use stripmine_physics::method::{Methods, observed_quantities};
use stripmine_physics::number::significant;
use stripmine_physics::quoted::quoted;
use stripmine_physics::reported::{ErrorClass, Reported};
use stripmine_physics::run::{TableError, TableReader};
use stripmine_physics::words::suggestion;

/// Most curves of a chart that can be told apart.
const CURVES: usize = 5;
/// Least range of a curve relative to its chart; below it the curve looks like a straight line.
const FLAT: f64 = 0.2;
/// Fraction of the values ignored at either end of a curve's range, so that a short peak does not fill the chart.
const PEAKS: f64 = 0.05;
/// Most points of a curve.
const POINTS: usize = 2000;
/// Length of a curve in the terminal (characters), and the shortest where other columns need the space.
const SMALL: usize = 16;
const SHORT: usize = 6;
/// Significant digits of a value in the terminal.
const DIGITS: usize = 4;

/// Errors of reading observables.
#[derive(Debug, thiserror::Error)]
pub(super) enum ObservableError {
    /// No column of that name.
    #[error("unknown column {}; expected one of: {}{}", quoted(name), known.join(", "), suggestion(name, known.iter().map(String::as_str)))]
    NoColumn {
        /// The requested column.
        name: String,
        /// The columns of the table.
        known: Vec<String>,
    },
    /// The table cannot be read.
    #[error(transparent)]
    Table(#[from] TableError),
}

impl Reported for ObservableError {
    fn class(&self) -> ErrorClass {
        match self {
            ObservableError::NoColumn { .. } => ErrorClass::Usage,
            ObservableError::Table(error) => error.class(),
        }
    }

    fn inner_error(&self) -> Option<&dyn Reported> {
        match self {
            ObservableError::NoColumn { .. } => None,
            ObservableError::Table(error) => Some(error),
        }
    }
}

/// Contents of `thermo.csv`.
pub(super) struct ObservableTable {
    columns: Vec<String>,
    rows: Vec<Vec<f64>>,
    /// Means of the columns; none if no method of this version has them.
    means: Option<ColumnMeans>,
}

/// Curves of one chart: each column with its range.
struct CurveGroup {
    curves: Vec<(usize, [f64; 2])>,
}

impl CurveGroup {
    /// Returns true if one more curve fits, and every curve keeps a visible range.
    fn can_take(&self, ends: [f64; 2]) -> bool {
        let all = || self.curves.iter().map(|(_, ends)| *ends).chain([ends]);
        let low = all().map(|[low, _]| low).fold(f64::INFINITY, f64::min);
        let high = all().map(|[_, high]| high).fold(f64::NEG_INFINITY, f64::max);
        self.curves.len() < CURVES && all().all(|[from, to]| to - from >= FLAT * (high - low))
    }

    fn columns(&self) -> Vec<usize> {
        self.curves.iter().map(|(column, _)| *column).collect()
    }
}

/// Requested column with its unit.
pub(super) struct SelectedColumn {
    column: usize,
    unit: &'static str,
}

impl ObservableTable {
    pub(super) fn read(path: &Path, methods: Methods) -> Result<ObservableTable, ObservableError> {
        let mut table = TableReader::open(path)?;
        let mut rows = vec![];
        while let Some(row) = table.next_row()? {
            rows.push(row);
        }
        if rows.is_empty() {
            return Err(table.without_rows().into());
        }
        let columns = table.columns().to_vec();
        let means = ColumnMeans::of(&columns, &rows, methods);
        Ok(ObservableTable { columns, rows, means })
    }

    fn column(&self, column: usize) -> impl Iterator<Item = f64> {
        self.rows.iter().map(move |row| row[column])
    }

    fn time(&self) -> usize {
        self.columns.iter().position(|column| column == "time").unwrap_or_default()
    }

    pub(super) fn selected_columns(
        &self,
        names: &[String],
        methods: Methods,
    ) -> Result<Vec<SelectedColumn>, ObservableError> {
        let quantities = observed_quantities(methods, &self.columns).unwrap_or_default();
        let of = |column: usize| {
            let name = &self.columns[column];
            let unit = quantities.iter().find(|quantity| quantity.name == name).map_or("", |it| it.unit);
            SelectedColumn { column, unit }
        };
        if names.is_empty() {
            let changes = |column: &usize| {
                let first = self.rows[0][*column];
                self.column(*column).any(|value| value != first)
            };
            let all = 0..self.columns.len();
            let shown = all.filter(|&column| !["step", "time"].contains(&self.columns[column].as_str()));
            return Ok(shown.filter(changes).map(of).collect());
        }
        let find = |name: &String| match self.columns.iter().position(|column| column == name) {
            Some(column) => Ok(of(column)),
            None => Err(ObservableError::NoColumn {
                name: name.clone(),
                known: self.columns.iter().map(|column| quoted(column)).collect(),
            }),
        };
        names.iter().map(find).collect()
    }

    /// Charts of a few curves each, all of one unit and of similar range.
    pub(super) fn figures(&self, wanted: &[SelectedColumn], system: &UnitSystem) -> Vec<Figure> {
        let mut units: BTreeMap<&str, Vec<CurveGroup>> = BTreeMap::new();
        for it in wanted {
            let ends = self.column_range(it.column);
            let groups = units.entry(it.unit).or_default();
            match groups.iter_mut().find(|group| group.can_take(ends)) {
                Some(group) => group.curves.push((it.column, ends)),
                None => groups.push(CurveGroup { curves: vec![(it.column, ends)] }),
            }
        }
        let of = |(unit, groups): (&str, Vec<CurveGroup>)| -> Vec<Figure> {
            let unit = system.symbol(unit);
            groups.iter().map(|group| self.figure(&unit, &group.columns(), system)).collect()
        };
        units.into_iter().flat_map(of).collect()
    }

    /// Range of a column, short peaks excluded.
    fn column_range(&self, column: usize) -> [f64; 2] {
        let mut values: Vec<f64> = self.column(column).collect();
        values.sort_by(f64::total_cmp);
        [PEAKS, 1.0 - PEAKS].map(|part| quantile(&values, part).unwrap_or(0.0))
    }

    fn figure(&self, unit: &str, columns: &[usize], system: &UnitSystem) -> Figure {
        let names: Vec<String> = columns.iter().map(|&column| quoted(&self.columns[column])).collect();
        let every = self.rows.len().div_ceil(POINTS);
        let time = self.time();
        let words: Vec<String> = names.iter().map(|name| name.replace('_', " ")).collect();
        let said: Vec<String> = columns
            .iter()
            .zip(&words)
            .map(|(&column, name)| match self.mean_description(column) {
                Some(mean) => format!("{name}: {mean}"),
                None => name.clone(),
            })
            .collect();
        let series = columns.iter().zip(&said).enumerate().map(|(hue, (&column, said))| {
            let points = self.rows.iter().step_by(every).map(|row| (row[time], row[column]));
            Series::new(said.clone(), Style::Line, hue, points)
        });
        let label = if let [name] = words.as_slice() { name } else { "value" };
        let [_, of_time] = system.at_axes();
        let chart = Chart::of(
            ChartAxis::linear("time", Some(of_time.as_str())),
            ChartAxis::linear(label, (!unit.is_empty()).then_some(unit)),
        )
        .with(series);
        let columns: Vec<&str> = columns.iter().map(|&column| self.columns[column].as_str()).collect();
        let ribbons = self.means.iter().flat_map(|means| means.ribbons(&columns));
        let before = self.means.iter().filter_map(|means| means.transient_band(&columns));
        before
            .fold(chart.with(ribbons), Chart::band)
            .figure(names.join("-").replace('_', "-"), words.join(", "))
            .caption(format!(
                "From thermo.csv, with means and 95 % intervals as in `average`. {}.",
                said.join("; ")
            ))
    }

    /// Short description of a column's mean.
    fn mean_description(&self, column: usize) -> Option<String> {
        self.means.as_ref()?.mean_text(&self.columns[column])
    }

    /// Table with a row for each column: first, last and mean.
    pub(super) fn numbers_table(&self, wanted: &[SelectedColumn]) -> FormattedTable {
        let number = |value: Option<f64>| value.map_or(String::new(), |value| significant(value, DIGITS));
        let names: Vec<&str> = wanted.iter().map(|it| self.columns[it.column].as_str()).collect();
        FrameBuilder::of(wanted)
            .text("quantity", |it| quoted(&self.columns[it.column]))
            .text("first", |it| number(self.column(it.column).next()))
            .text("last", |it| number(self.column(it.column).last()))
            .text("mean ± 95 %", |it| {
                self.means
                    .as_ref()
                    .map_or_else(String::new, |means| means.brief_text(&self.columns[it.column]))
            })
            .table("plot", "Observables over time")
            .notes(self.means.iter().flat_map(|means| means.reasons(&names)))
    }

    /// Table with a row for each column and its curve, as long as 80 columns of a terminal allow.
    pub(super) fn terminal_table(&self, wanted: &[SelectedColumn]) -> FormattedTable {
        let mut table = self.numbers_table(wanted);
        let left = terminal::NARROW.saturating_sub(terminal::width_of(&table) + terminal::BESIDE);
        table.columns.push("curve".to_owned());
        for (row, it) in table.rows.iter_mut().zip(wanted) {
            let values: Vec<f64> = self.column(it.column).collect();
            row.push(TableCell::Text(sparkline(&values, left.clamp(SHORT, SMALL))));
        }
        table
    }
}

/// Curve of a few block characters, scaled from the smallest to the largest value.
fn sparkline(values: &[f64], length: usize) -> String {
    const STEPS: [char; 8] = ['▁', '▂', '▃', '▄', '▅', '▆', '▇', '█'];
    let low = values.iter().copied().fold(f64::INFINITY, f64::min);
    let high = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let count = values.len().min(length);
    let of = |at: usize| {
        let value = values[at * (values.len() - 1) / (count - 1).max(1)];
        let share = if high > low { (value - low) / (high - low) } else { 0.0 };
        STEPS[((share * 8.0) as usize).min(7)]
    };
    (0..count).map(of).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sparklines_span_smallest_to_largest() {
        assert_eq!(sparkline(&[0.0, 1.0, 2.0, 4.0], SMALL), "▁▃▅█");
        assert_eq!(sparkline(&[3.0], SMALL), "▁");
        assert_eq!(sparkline(&[1.0; 100], 7).chars().count(), 7);
    }

    #[test]
    fn curves_of_a_chart_have_similar_ranges() {
        let columns = ["time", "kinetic", "temperature", "elastic", "px", "py", "far"].map(str::to_owned);
        let row = |t: f64| vec![t, 680.0 * t, 0.7 * t, 200.0 * t, 1e-15 * t, 2e-15 * t, 1e9 + 300.0 * t];
        let observed =
            ObservableTable { columns: columns.to_vec(), rows: vec![row(0.0), row(1.0)], means: None };
        let wanted: Vec<SelectedColumn> =
            (1..7).map(|column| SelectedColumn { column, unit: "energy" }).collect();
        let system = UnitSystem::Other("reduced".to_owned());
        let figures = observed.figures(&wanted, &system);
        let names: Vec<String> = figures.into_iter().map(|figure| figure.name).collect();
        assert_eq!(names, ["kinetic-elastic", "temperature", "px-py", "far"]);
        // Small numbers keep their significant digits in the terminal.
        let small = observed.terminal_table(&wanted);
        assert_eq!(small.rows[3][2], TableCell::Text("1e-15".to_owned()));
    }
}
