//! Means over the keys of a scan: one table as text, as CSV and as JSON.

use super::grid::{labels, number, value_text};
use crate::cli::display::UnitSystem;
use crate::console::{CommandFailure, FailureReport};
use crate::frame::{FrameColumn, FrameValue, ResultFrame, Role, csv};
use crate::report::{FormattedTable, FrameBuilder, terminal};
use serde::Serialize;
use stripmine_physics::averages::{Average, AverageOutcome, Estimate, RunAverages};
use stripmine_physics::method::{ObservedQuantity, QuantityKind};
use stripmine_physics::number::{count_with_noun, significant, with_error_bar};
use stripmine_physics::scene::{MistakeKind, SceneErrors, Spot};
use stripmine_physics::words::nearest;
use toml::Value;

/// Significant digits of a key's value in the terminal.
const DIGITS: usize = 6;

/// Means over keys.
#[derive(Clone, Debug, Serialize)]
pub(in crate::cli) struct KeyTable {
    pub(in crate::cli) keys: Vec<TableKey>,
    pub(in crate::cli) points: Vec<TablePoint>,
}

/// Key with its unit; empty for pure numbers and words.
#[derive(Clone, Debug, Serialize)]
pub(in crate::cli) struct TableKey {
    /// Section and name.
    pub(in crate::cli) key: String,
    pub(in crate::cli) unit: &'static str,
}

/// Runs with the same values of all keys.
#[derive(Clone, Debug, Serialize)]
pub(in crate::cli) struct TablePoint {
    /// Value of each key; none where the scene lacks the key.
    pub(in crate::cli) values: Vec<Option<Value>>,
    pub(in crate::cli) folders: Vec<String>,
    /// Means of all runs; none if a run has failed before its end.
    pub(in crate::cli) averages: Option<RunAverages>,
    /// First failure of a run.
    pub(in crate::cli) failure: Option<FailureReport>,
}

/// Quantity that has a mean at a point of a table.
#[derive(Clone, Debug)]
pub(super) struct TableQuantity {
    /// Index among the averages of a point.
    place: usize,
    /// Name of its column: `rate_of_collisions` for the rate of a counter.
    pub(super) column: String,
    /// Name of the quantity.
    pub(super) name: &'static str,
    pub(super) unit: String,
}

impl TablePoint {
    /// Outcome of a quantity; none without averages.
    pub(super) fn outcome(&self, quantity: &TableQuantity) -> Option<&AverageOutcome> {
        Some(&self.averages.as_ref()?.quantities.get(quantity.place)?.outcome)
    }

    /// Text of a key's value; empty where the scene lacks the key.
    pub(super) fn value_text(&self, key: usize) -> String {
        self.values[key].as_ref().map_or_else(String::new, value_text)
    }
}

impl KeyTable {
    /// Quantities that have a mean, or are constant, at a point.
    pub(super) fn quantities(&self) -> Vec<TableQuantity> {
        let Some(first) = self.points.iter().find_map(|point| point.averages.as_ref()) else { return vec![] };
        let all = first.quantities.iter().enumerate().map(|(place, Average { quantity, of, unit, .. })| {
            let column = if *of == "rate" { format!("rate_of_{quantity}") } else { (*quantity).to_owned() };
            TableQuantity { place, column, name: quantity, unit: unit.clone() }
        });
        all.filter(|quantity| self.points.iter().any(|point| mean(point.outcome(quantity)).is_some()))
            .collect()
    }

    /// Table with a column for each key, three for each quantity, and the failure.
    pub(super) fn frame(&self) -> ResultFrame {
        let column = |name: String, unit: &str, role| {
            let unit = (!unit.is_empty()).then(|| unit.to_owned());
            FrameColumn { doc: name.clone(), name, unit, role, digits: None }
        };
        let quantities = self.quantities();
        let mut columns: Vec<FrameColumn> =
            self.keys.iter().map(|key| column(key.key.clone(), key.unit, Role::Words)).collect();
        for TableQuantity { column: name, unit, .. } in &quantities {
            columns.push(column(name.clone(), unit, Role::Number));
            columns.push(column(format!("{name}_error_95"), unit, Role::Number));
            columns.push(column(format!("{name}_standard_error"), unit, Role::Number));
        }
        columns.push(column("runs".to_owned(), "", Role::Count));
        columns.push(column("failure".to_owned(), "", Role::Words));
        let cell = |value: Option<f64>| value.map_or(FrameValue::Nothing, FrameValue::Number);
        let row = |point: &TablePoint| {
            let mut row: Vec<FrameValue> =
                (0..self.keys.len()).map(|key| key_cell(point.values[key].as_ref())).collect();
            for quantity in &quantities {
                let outcome = point.outcome(quantity);
                let error = |of: fn(&Estimate) -> f64| match outcome {
                    Some(AverageOutcome::Mean(estimate)) => Some(of(estimate)),
                    _ => None,
                };
                row.extend([mean(outcome), error(|it| it.bar), error(|it| it.standard_error)].map(cell));
            }
            row.push(FrameValue::Count(point.folders.len() as u64));
            row.push(
                point.failure.as_ref().map_or(FrameValue::Nothing, |it| FrameValue::Words(one_line(it))),
            );
            row
        };
        let rows = self.points.iter().map(row).collect();
        ResultFrame { name: "scan".to_owned(), title: self.title(), columns, rows }
    }

    /// Table as comma-separated values.
    ///
    /// # Errors
    /// If it cannot be formatted.
    pub(in crate::cli) fn csv(&self) -> Result<String, CommandFailure> {
        let mut bytes = vec![];
        csv::write(&self.frame(), &mut bytes).map_err(CommandFailure::writing("CSV"))?;
        Ok(String::from_utf8_lossy(&bytes).into_owned())
    }

    pub(super) fn title(&self) -> String {
        let keys: Vec<&str> = self.keys.iter().map(|key| key.key.as_str()).collect();
        format!("Means ± 95 % over {}", keys.join(" and "))
    }

    /// Text for the terminal: the quantities `of`, or as many of `main` and then the others as fit into 80 columns; and a note.
    pub(in crate::cli) fn text(
        &self,
        of: &[String],
        main: &[&str],
        units: &UnitSystem,
        note: String,
    ) -> String {
        terminal::render(&self.terminal_table(of, main, units).note(note))
    }

    fn terminal_table(&self, of: &[String], main: &[&str], units: &UnitSystem) -> FormattedTable {
        let mut known = self.quantities();
        let rank = |names: &[&str], it: &TableQuantity| {
            names.iter().position(|name| *name == it.name).unwrap_or(names.len())
        };
        let shown = if of.is_empty() {
            let constant = |it: &TableQuantity| {
                self.points.iter().all(|point| !matches!(point.outcome(it), Some(AverageOutcome::Mean(_))))
            };
            // A line of [[flux]] is there to be counted: its number comes first.
            let is_count = |it: &TableQuantity| it.name.starts_with("flux_") && it.name.ends_with("_count");
            known.sort_by_key(|it| (constant(it), !is_count(it), rank(main, it)));
            let mut width: usize = self.key_columns(units).iter().map(|cells| width_of(cells)).sum();
            let fits = |it: &TableQuantity| {
                width += width_of(&self.cells(it, units));
                width <= terminal::NARROW
            };
            known.iter().cloned().take_while(fits).collect::<Vec<_>>()
        } else {
            let names: Vec<&str> = of.iter().map(String::as_str).collect();
            known.sort_by_key(|it| rank(&names, it));
            known.iter().filter(|it| names.contains(&it.name)).cloned().collect()
        };
        let mut rows = FrameBuilder::of(0..self.points.len());
        let columns = self.key_columns(units).into_iter().chain(shown.iter().map(|it| self.cells(it, units)));
        for cells in columns {
            rows = rows.text(cells[0].clone(), |row| cells[row + 1].clone());
        }
        let left: Vec<&str> =
            known.iter().map(|it| it.name).filter(|name| shown.iter().all(|it| it.name != *name)).collect();
        let more = format!("Not shown (--of shows them, --json and CSV have all): {}.", left.join(", "));
        let failures = self.points.iter().filter_map(|point| {
            Some(format!("{}: {}", self.point_text(point), one_line(point.failure.as_ref()?)))
        });
        rows.table("scan", self.title()).notes((!left.is_empty()).then_some(more)).notes(failures)
    }

    /// Heading and texts of each key.
    fn key_columns(&self, units: &UnitSystem) -> Vec<Vec<String>> {
        let headings = self.key_headings(units).into_iter().enumerate();
        let short = |point: &TablePoint, at: usize| match point.values[at].as_ref().and_then(number) {
            Some(number) => significant(number, DIGITS),
            None => point.value_text(at),
        };
        let texts = |at: usize| self.points.iter().map(move |point| short(point, at));
        headings.map(|(at, heading)| std::iter::once(heading).chain(texts(at)).collect()).collect()
    }

    /// Short name of each key with its unit.
    pub(super) fn key_headings(&self, units: &UnitSystem) -> Vec<String> {
        let labels = self.labels().into_iter().zip(&self.keys);
        labels.map(|(label, key)| with_unit(&label.replace('_', " "), &units.symbol(key.unit))).collect()
    }

    fn labels(&self) -> Vec<String> {
        labels(&self.keys.iter().map(|key| key.key.as_str()).collect::<Vec<_>>())
    }

    /// Values of a point in words: `packing_fraction = 0.3, restitution = 0.9`.
    fn point_text(&self, point: &TablePoint) -> String {
        let labels = self.labels();
        let texts =
            labels.iter().enumerate().map(|(at, label)| format!("{label} = {}", point.value_text(at)));
        texts.collect::<Vec<_>>().join(", ")
    }

    /// Heading and texts of a quantity.
    fn cells(&self, quantity: &TableQuantity, units: &UnitSystem) -> Vec<String> {
        let heading = with_unit(&quantity.column.replace('_', " "), &units.symbol(&quantity.unit));
        let text = |point: &TablePoint| match point.outcome(quantity) {
            Some(AverageOutcome::Mean(Estimate { mean, bar, .. })) => with_error_bar(*mean, *bar),
            Some(AverageOutcome::Constant { mean }) => significant(*mean, 6),
            Some(AverageOutcome::TooShort { .. }) => "too short".to_owned(),
            Some(AverageOutcome::Changing { .. }) => "changing".to_owned(),
            Some(AverageOutcome::Undefined | AverageOutcome::Kept { .. }) => "–".to_owned(),
            None => "failed".to_owned(),
        };
        std::iter::once(heading).chain(self.points.iter().map(text)).collect()
    }

    /// Number of points with a failure.
    pub(super) fn failed(&self) -> usize {
        self.points.iter().filter(|point| point.failure.is_some()).count()
    }

    /// Sentence on the number of points and runs.
    pub(in crate::cli) fn extent(&self) -> String {
        let runs: usize = self.points.iter().map(|point| point.folders.len()).sum();
        let points = count_with_noun(self.points.len(), "point", "points");
        format!("{points}, {}", count_with_noun(runs, "run", "runs"))
    }
}

/// Checks the names of `--of`.
///
/// # Errors
/// Every name that is no quantity with a mean.
pub(in crate::cli) fn check_names(of: &[String], quantities: &[ObservedQuantity]) -> Result<(), SceneErrors> {
    let has_mean = |it: &&ObservedQuantity| !matches!(it.kind, QuantityKind::Time | QuantityKind::Kept);
    let known: Vec<&str> = quantities.iter().filter(has_mean).map(|it| it.name).collect();
    let wrong = of.iter().filter(|name| !known.contains(&name.as_str())).map(|name| {
        let spot = Spot { file: format!("--of {name}"), place: None };
        let mut error = spot.error(MistakeKind::Unknown, "no quantity with a mean has this name");
        error.expected = Some(known.join(", "));
        error.suggestion = nearest(name, known.iter().copied()).map(|near| format!("did you mean {near}?"));
        error
    });
    SceneErrors::ok_if_empty(wrong.collect())
}

/// Value of a mean, or of a constant.
pub(super) fn mean(outcome: Option<&AverageOutcome>) -> Option<f64> {
    match outcome? {
        AverageOutcome::Mean(Estimate { mean, .. }) | AverageOutcome::Constant { mean } => Some(*mean),
        _ => None,
    }
}

fn key_cell(value: Option<&Value>) -> FrameValue {
    match value {
        None => FrameValue::Nothing,
        Some(value) => match number(value) {
            Some(number) => FrameValue::Number(number),
            None => FrameValue::Words(value_text(value)),
        },
    }
}

/// Longest line of a heading or text (characters), with its padding: headings are broken at blanks.
fn width_of(cells: &[String]) -> usize {
    let heading = cells[0].split(' ').map(|word| word.chars().count()).max();
    let texts = cells[1..].iter().map(|text| text.chars().count());
    texts.chain(heading).max().unwrap_or_default() + terminal::BESIDE
}

fn with_unit(name: &str, unit: &str) -> String {
    if unit.is_empty() { name.to_owned() } else { format!("{name} ({unit})") }
}

/// Message of a failure without line ends.
fn one_line(failure: &FailureReport) -> String {
    failure.message.lines().map(str::trim).collect::<Vec<_>>().join("; ")
}
