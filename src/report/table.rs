//! A table, before it is known where it will be read.

use serde::{Deserialize, Serialize};

/// What stands in a place of a table.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum Cell {
    /// Words.
    Text(String),
    /// A count.
    Count(u64),
    /// A measured or computed number, and the number of decimals that are shown.
    Number(f64, usize),
    /// Nothing: the source has no such entry.
    Nothing,
}

impl Cell {
    /// As a person reads it: thousands set apart.
    pub fn for_reading(&self) -> String {
        match self {
            Cell::Text(text) => text.clone(),
            Cell::Count(count) => grouped(&count.to_string()),
            Cell::Number(value, decimals) => {
                let text = format!("{value:.decimals$}");
                match text.split_once('.') {
                    Some((whole, fraction)) => format!("{}.{fraction}", grouped(whole)),
                    None => grouped(&text),
                }
            }
            Cell::Nothing => "–".to_owned(),
        }
    }

    /// As a program reads it: all digits, nothing else.
    pub fn for_machines(&self) -> String {
        match self {
            Cell::Text(text) => text.clone(),
            Cell::Count(count) => count.to_string(),
            Cell::Number(value, _) => value.to_string(),
            Cell::Nothing => String::new(),
        }
    }

    /// Whether it is set flush right.
    pub fn is_number(&self) -> bool {
        !matches!(self, Cell::Text(_))
    }
}

impl From<&str> for Cell {
    fn from(text: &str) -> Self {
        Cell::Text(text.to_owned())
    }
}

impl From<u64> for Cell {
    fn from(count: u64) -> Self {
        Cell::Count(count)
    }
}

/// Digits in groups of three, set apart by thin blanks.
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
pub struct Table {
    /// A name for files, in lower case.
    pub name: String,
    /// What it shows.
    pub title: String,
    /// Column headings, with units.
    pub columns: Vec<String>,
    /// Rows, each as long as the headings.
    pub rows: Vec<Vec<Cell>>,
    /// What a reader must also know.
    pub notes: Vec<String>,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_grouped_for_people_and_whole_for_machines() {
        assert_eq!(Cell::Number(1_234_567.891, 2).for_reading(), "1\u{202f}234\u{202f}567.89");
        assert_eq!(Cell::Number(-123_456.0, 0).for_reading(), "-123\u{202f}456");
        assert_eq!(Cell::Count(999).for_reading(), "999");
        assert_eq!(Cell::Number(0.1 + 0.2, 1).for_machines(), "0.30000000000000004");
        assert_eq!(Cell::Nothing.for_machines(), "");
    }
}
