//! State of a simulation as a checkpoint stores it.

use super::restored::{MOST, find_count, find_counts, find_sum};
use crate::io::checkpoint::{CheckpointColumn, CheckpointCounter};
use std::collections::BTreeMap;

/// Everything that the future of a simulation depends on, and everything counted since the start.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Snapshot {
    /// Counts and sums, by name.
    pub counters: BTreeMap<String, CheckpointCounter>,
    /// Columns, by name.
    pub columns: Vec<(String, CheckpointColumn)>,
}

impl Snapshot {
    pub(crate) fn add_count(&mut self, name: &str, count: u64) {
        self.counters.insert(name.to_owned(), CheckpointCounter::Count(count));
    }

    /// Adds a sum, stored to the last bit.
    pub(crate) fn add_sum(&mut self, name: &str, sum: f64) {
        self.counters.insert(name.to_owned(), CheckpointCounter::Sum(sum));
    }

    pub(crate) fn add_column(&mut self, name: &str, column: CheckpointColumn) {
        self.columns.push((name.to_owned(), column));
    }

    /// Returns the named count.
    ///
    /// # Errors
    /// Says that it is missing.
    pub fn count(&self, name: &str) -> Result<u64, String> {
        self.count_at_most(name, MOST)
    }

    /// Returns the named count if it is at most `most`.
    ///
    /// # Errors
    /// Says that it is missing or larger.
    pub(crate) fn count_at_most(&self, name: &str, most: u64) -> Result<u64, String> {
        find_count(&self.counters, name, most)
    }

    /// Returns the named sum.
    ///
    /// # Errors
    /// Says that it is missing or not finite.
    pub fn sum(&self, name: &str) -> Result<f64, String> {
        find_sum(&self.counters, name)
    }

    /// Returns the named time, which may be infinite.
    ///
    /// # Errors
    /// Says that it is missing or not a number.
    pub fn time(&self, name: &str) -> Result<f64, String> {
        match self.counters.get(name) {
            Some(CheckpointCounter::Sum(time)) if !time.is_nan() => Ok(*time),
            _ => Err(format!("the time {name} is missing or not a number")),
        }
    }

    /// Returns the named column of times, which may be infinite, if it has this length.
    ///
    /// # Errors
    /// Says that it is missing, or holds what is not a number.
    pub fn times(&self, name: &str, length: usize) -> Result<&[f64], String> {
        match self.column(name) {
            Some(CheckpointColumn::F64(times))
                if times.len() == length && !times.iter().any(|time| time.is_nan()) =>
            {
                Ok(times)
            }
            _ => Err(format!("the column {name} is missing or does not hold {length} times")),
        }
    }

    /// Returns the named column of finite doubles if it has this length.
    ///
    /// # Errors
    /// Says that it is missing, or which entry is not finite.
    pub fn numbers(&self, name: &str, length: usize) -> Result<&[f64], String> {
        match self.column(name) {
            Some(CheckpointColumn::F64(values)) if values.len() == length => {
                match values.iter().position(|value| !value.is_finite()) {
                    None => Ok(values),
                    Some(at) => Err(format!("entry {at} of the column {name} is not finite")),
                }
            }
            _ => Err(format!("the column {name} is missing or does not hold {length} numbers")),
        }
    }

    /// Returns the named column of 64-bit counts if it has this length.
    ///
    /// # Errors
    /// Says that it is missing.
    pub fn counts(&self, name: &str, length: usize) -> Result<&[u64], String> {
        self.counts_at_most(name, length, u64::MAX)
    }

    /// Returns the named column of 64-bit counts if it has this length and no count above `most`.
    ///
    /// # Errors
    /// Says that it is missing, or which count is larger.
    pub(crate) fn counts_at_most(&self, name: &str, length: usize, most: u64) -> Result<&[u64], String> {
        find_counts(&self.columns, name, length, most)
    }

    /// Returns the named column of 32-bit codes if it has this length.
    ///
    /// # Errors
    /// Says that it is missing.
    pub(crate) fn codes(&self, name: &str, length: usize) -> Result<&[u32], String> {
        match self.column(name) {
            Some(CheckpointColumn::U32(values)) if values.len() == length => Ok(values),
            _ => Err(format!("the column {name} is missing")),
        }
    }

    fn column(&self, name: &str) -> Option<&CheckpointColumn> {
        self.columns.iter().find(|(there, _)| there == name).map(|(_, column)| column)
    }
}
