//! Everything that the future of a simulation depends on, as a checkpoint keeps it.

use super::restored::{MOST, find_count, find_counts, find_sum};
use crate::io::checkpoint::{Column, Counter};
use std::collections::BTreeMap;

/// Everything that the future of a simulation depends on, and everything that it counts from the start on.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Snapshot {
    /// Counts and sums, by name.
    pub counters: BTreeMap<String, Counter>,
    /// Columns, by name.
    pub columns: Vec<(String, Column)>,
}

impl Snapshot {
    pub(crate) fn add_count(&mut self, name: &str, count: u64) {
        self.counters.insert(name.to_owned(), Counter::Count(count));
    }

    /// Adds a sum, of which all bits are kept.
    pub(crate) fn add_sum(&mut self, name: &str, sum: f64) {
        self.counters.insert(name.to_owned(), Counter::Sum(sum));
    }

    pub(crate) fn add_column(&mut self, name: &str, column: Column) {
        self.columns.push((name.to_owned(), column));
    }

    /// The count of a name.
    ///
    /// # Errors
    /// A sentence, if it is missing.
    pub fn count(&self, name: &str) -> Result<u64, String> {
        self.count_at_most(name, MOST)
    }

    /// The count of a name, at most `most`.
    ///
    /// # Errors
    /// A sentence, if it is missing or larger.
    pub(crate) fn count_at_most(&self, name: &str, most: u64) -> Result<u64, String> {
        find_count(&self.counters, name, most)
    }

    /// The sum of a name.
    ///
    /// # Errors
    /// A sentence, if it is missing or no finite number.
    pub fn sum(&self, name: &str) -> Result<f64, String> {
        find_sum(&self.counters, name)
    }

    /// A time of a name, which may be without end.
    ///
    /// # Errors
    /// A sentence, if it is missing or no number.
    pub fn time(&self, name: &str) -> Result<f64, String> {
        match self.counters.get(name) {
            Some(Counter::Sum(time)) if !time.is_nan() => Ok(*time),
            _ => Err(format!("the time {name} is missing, or no number")),
        }
    }

    /// A column of times, which may be without end, if it has that number of them.
    ///
    /// # Errors
    /// A sentence, if it is missing or one is no number.
    pub fn times(&self, name: &str, length: usize) -> Result<&[f64], String> {
        match self.column(name) {
            Some(Column::F64(times)) if times.len() == length && !times.iter().any(|time| time.is_nan()) => {
                Ok(times)
            }
            _ => Err(format!("the column {name} is missing, or not of {length} times")),
        }
    }

    /// The column of a name, of finite numbers in double precision, if it has that number of them.
    ///
    /// # Errors
    /// A sentence, if it is missing or one is not finite.
    pub fn numbers(&self, name: &str, length: usize) -> Result<&[f64], String> {
        match self.column(name) {
            Some(Column::F64(values)) if values.len() == length => {
                match values.iter().position(|value| !value.is_finite()) {
                    None => Ok(values),
                    Some(at) => Err(format!("entry {at} of the column {name} is no finite number")),
                }
            }
            _ => Err(format!("the column {name} is missing, or not of {length} numbers")),
        }
    }

    /// The column of a name, of whole numbers of 64 bits, if it has that number of them.
    ///
    /// # Errors
    /// A sentence, if it is missing.
    pub fn counts(&self, name: &str, length: usize) -> Result<&[u64], String> {
        self.counts_at_most(name, length, u64::MAX)
    }

    /// The same, with none of them above `most`.
    ///
    /// # Errors
    /// A sentence, if it is missing or one is larger.
    pub(crate) fn counts_at_most(&self, name: &str, length: usize, most: u64) -> Result<&[u64], String> {
        find_counts(&self.columns, name, length, most)
    }

    /// The column of a name, of whole numbers of 32 bits, if it has that number of them.
    ///
    /// # Errors
    /// A sentence, if it is missing.
    pub(crate) fn codes(&self, name: &str, length: usize) -> Result<&[u32], String> {
        match self.column(name) {
            Some(Column::U32(values)) if values.len() == length => Ok(values),
            _ => Err(format!("the column {name} is missing")),
        }
    }

    fn column(&self, name: &str) -> Option<&Column> {
        self.columns.iter().find(|(there, _)| there == name).map(|(_, column)| column)
    }
}
