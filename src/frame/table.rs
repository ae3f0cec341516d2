//! Tables for reading: cells under headings.

use super::{Digits, FrameValue};
use serde::{Deserialize, Serialize};
use stripmine_physics::number::{significant, with_power_of_ten};

/// Content of a cell of a table.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum TableCell {
    /// Words.
    Text(String),
    /// A count.
    Count(u64),
    /// A measured or computed number, and the number of decimals shown.
    Number(f64, usize),
    /// A number of any size, shown with two digits.
    Short(f64),
    /// A number with its error, which the table's note explains, and the number of decimals shown.
    WithError {
        /// The number.
        value: f64,
        /// Its error.
        error: f64,
        /// Decimals of both.
        decimals: usize,
    },
    /// Lowest and highest of several numbers, and the number of decimals shown.
    Range([f64; 2], usize),
    /// The median of several numbers, with their range.
    Spread {
        /// The median.
        value: f64,
        /// Lowest and highest value.
        range: [f64; 2],
        /// Decimals of all.
        decimals: usize,
    },
    /// Empty: the source has no such entry.
    Nothing,
}

impl TableCell {
    /// A number with its error; a plain number where it has none.
    pub(crate) fn with_error(value: f64, error: Option<f64>, decimals: usize) -> TableCell {
        match error {
            Some(error) => TableCell::WithError { value, error, decimals },
            None => TableCell::Number(value, decimals),
        }
    }

    /// Formats the cell for reading, with grouped thousands.
    pub(crate) fn formatted_text(&self) -> String {
        match self {
            TableCell::Text(text) => text.clone(),
            TableCell::Count(count) => grouped(&count.to_string()),
            TableCell::Number(value, decimals) => decimal(*value, *decimals),
            TableCell::Short(value) => short(*value),
            TableCell::WithError { value, error, decimals } => {
                format!("{} ± {}", decimal(*value, *decimals), decimal(*error, *decimals))
            }
            TableCell::Range([lowest, highest], decimals) => {
                format!("{} to {}", decimal(*lowest, *decimals), decimal(*highest, *decimals))
            }
            TableCell::Spread { value, range, decimals } => {
                let range = TableCell::Range(*range, *decimals).formatted_text();
                format!("{} ({range})", decimal(*value, *decimals))
            }
            TableCell::Nothing => "–".to_owned(),
        }
    }

    /// True if it is right-aligned.
    pub fn is_number(&self) -> bool {
        !matches!(self, TableCell::Text(_))
    }
}

impl TableCell {
    /// Combines the columns of one heading to a cell: number, count, error, lowest, highest, words.
    pub(super) fn of(parts: [Option<FrameValue>; 6], digits: Option<Digits>) -> TableCell {
        let decimals = match digits {
            Some(Digits::Decimals(decimals)) => decimals,
            _ => 0,
        };
        match parts {
            [Some(FrameValue::Number(value)), _, Some(FrameValue::Number(error)), ..] => {
                TableCell::WithError { value, error, decimals }
            }
            [
                Some(FrameValue::Number(value)),
                _,
                _,
                Some(FrameValue::Number(lowest)),
                Some(FrameValue::Number(highest)),
                _,
            ] => TableCell::Spread { value, range: [lowest, highest], decimals },
            [Some(FrameValue::Number(value)), ..] if digits == Some(Digits::Short) => TableCell::Short(value),
            [Some(FrameValue::Number(value)), ..] => TableCell::Number(value, decimals),
            [_, Some(FrameValue::Count(count)), ..] => TableCell::Count(count),
            [_, _, _, Some(FrameValue::Number(lowest)), Some(FrameValue::Number(highest)), _] => {
                TableCell::Range([lowest, highest], decimals)
            }
            [.., Some(FrameValue::Words(words))] => TableCell::Text(words),
            _ => TableCell::Nothing,
        }
    }
}

impl From<&str> for TableCell {
    fn from(text: &str) -> Self {
        TableCell::Text(text.to_owned())
    }
}

impl From<String> for TableCell {
    fn from(text: String) -> Self {
        TableCell::Text(text)
    }
}

impl From<u64> for TableCell {
    fn from(count: u64) -> Self {
        TableCell::Count(count)
    }
}

/// Converts none to an empty cell.
impl<T: Into<TableCell>> From<Option<T>> for TableCell {
    fn from(value: Option<T>) -> Self {
        value.map_or(TableCell::Nothing, Into::into)
    }
}

/// Formats a number with decimals and grouped thousands.
fn decimal(value: f64, decimals: usize) -> String {
    let text = format!("{value:.decimals$}");
    match text.split_once('.') {
        Some((whole, fraction)) => format!("{}.{fraction}", grouped(whole)),
        None => grouped(&text),
    }
}

/// Formats a number with two digits, with a power of ten where it is small or large.
fn short(value: f64) -> String {
    match value.abs() {
        0.0 => "0".to_owned(),
        1e-2..1e4 => significant(value, 2),
        _ => with_power_of_ten(value, 2),
    }
}

/// Groups digits by three, separated by thin spaces.
fn grouped(digits: &str) -> String {
    let (sign, digits) = digits.split_at(usize::from(digits.starts_with('-')));
    let mut out = sign.to_owned();
    for (i, digit) in digits.chars().enumerate() {
        if i > 0 && (digits.len() - i).is_multiple_of(3) {
            out.push('\u{202f}');
        }
        out.push(digit);
    }
    out
}

/// A titled table with notes below.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct FormattedTable {
    /// Name for files, in lower case.
    pub name: String,
    pub title: String,
    pub columns: Vec<String>,
    /// Rows, each as long as the headings.
    pub rows: Vec<Vec<TableCell>>,
    /// Notes that a reader needs.
    pub(crate) notes: Vec<String>,
}

impl FormattedTable {
    /// The table without some columns.
    pub(crate) fn without(mut self, headings: &[&str]) -> FormattedTable {
        let stays: Vec<bool> = self.columns.iter().map(|it| !headings.contains(&it.as_str())).collect();
        let mut kept = stays.iter().cycle();
        self.columns.retain(|_| kept.next() == Some(&true));
        for row in &mut self.rows {
            let mut kept = stays.iter().cycle();
            row.retain(|_| kept.next() == Some(&true));
        }
        self
    }

    pub(crate) fn note(self, note: impl Into<String>) -> FormattedTable {
        self.notes([note])
    }

    pub(crate) fn notes(mut self, notes: impl IntoIterator<Item = impl Into<String>>) -> FormattedTable {
        self.notes.extend(notes.into_iter().map(Into::into));
        self
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_grouped_for_people() {
        assert_eq!(TableCell::Number(1_234_567.891, 2).formatted_text(), "1\u{202f}234\u{202f}567.89");
        assert_eq!(TableCell::Number(-123_456.0, 0).formatted_text(), "-123\u{202f}456");
        assert_eq!(TableCell::Count(999).formatted_text(), "999");
        let with_error = TableCell::WithError { value: 1234.56, error: 0.26, decimals: 1 };
        assert_eq!(with_error.formatted_text(), "1\u{202f}234.6 ± 0.3");
        assert_eq!(TableCell::Range([0.18, 0.43], 2).formatted_text(), "0.18 to 0.43");
        let spread = TableCell::Spread { value: 1.71, range: [1.28, 2.02], decimals: 1 };
        assert_eq!(spread.formatted_text(), "1.7 (1.3 to 2.0)");
        assert_eq!(
            [4.2e-4, 0.031, 12.0].map(|it| TableCell::Short(it).formatted_text()),
            ["4.2·10⁻⁴", "0.031", "12"]
        );
    }
}
