//! Everything that the future of a simulation depends on, as a checkpoint keeps it.

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
    /// Adds a count.
    pub fn add_count(&mut self, name: &str, count: u64) {
        self.counters.insert(name.to_owned(), Counter::Count(count));
    }

    /// Adds a sum, of which all bits are kept.
    pub fn add_sum(&mut self, name: &str, sum: f64) {
        self.counters.insert(name.to_owned(), Counter::Sum(sum));
    }

    /// Adds a column.
    pub fn add_column(&mut self, name: &str, column: Column) {
        self.columns.push((name.to_owned(), column));
    }

    /// The count of a name.
    ///
    /// # Errors
    /// A sentence, if it is missing.
    pub fn count(&self, name: &str) -> Result<u64, String> {
        match self.counters.get(name) {
            Some(Counter::Count(count)) => Ok(*count),
            _ => Err(format!("the counter {name} is missing")),
        }
    }

    /// The sum of a name.
    ///
    /// # Errors
    /// A sentence, if it is missing.
    pub fn sum(&self, name: &str) -> Result<f64, String> {
        match self.counters.get(name) {
            Some(Counter::Sum(sum)) => Ok(*sum),
            _ => Err(format!("the sum {name} is missing")),
        }
    }

    /// The column of a name, of numbers in double precision, if it has so many.
    ///
    /// # Errors
    /// A sentence, if it is missing.
    pub fn numbers(&self, name: &str, length: usize) -> Result<&[f64], String> {
        match self.column(name) {
            Some(Column::F64(values)) if values.len() == length => Ok(values),
            _ => Err(format!("the column {name} is missing")),
        }
    }

    /// The column of a name, of whole numbers of 64 bits, if it has so many.
    ///
    /// # Errors
    /// A sentence, if it is missing.
    pub fn counts(&self, name: &str, length: usize) -> Result<&[u64], String> {
        match self.column(name) {
            Some(Column::U64(values)) if values.len() == length => Ok(values),
            _ => Err(format!("the column {name} is missing")),
        }
    }

    /// The column of a name, of whole numbers of 32 bits, if it has so many.
    ///
    /// # Errors
    /// A sentence, if it is missing.
    pub fn codes(&self, name: &str, length: usize) -> Result<&[u32], String> {
        match self.column(name) {
            Some(Column::U32(values)) if values.len() == length => Ok(values),
            _ => Err(format!("the column {name} is missing")),
        }
    }

    fn column(&self, name: &str) -> Option<&Column> {
        self.columns.iter().find(|(there, _)| there == name).map(|(_, column)| column)
    }
}
