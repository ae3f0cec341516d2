//! Rows of numbers that a law reads by their number.

use crate::isa::Array;
use std::sync::Arc;

/// Rows of four numbers, numbered from 1. A law reads them by number, lane by lane, with [`Env::lookup`](super::Env::lookup).
///
/// Copies share the rows. Numbers are in double precision; a sweep rounds them to its own.
#[derive(Clone, Debug, PartialEq)]
pub struct LawTable(Arc<[[f64; LawTable::COLUMNS]]>);

impl LawTable {
    /// Numbers of a row.
    pub const COLUMNS: usize = 4;

    /// Arrays of the columns in programs.
    pub const ARRAYS: [Array; LawTable::COLUMNS] =
        [Array::Table0, Array::Table1, Array::Table2, Array::Table3];

    /// Table of some rows.
    pub fn new(rows: Vec<[f64; LawTable::COLUMNS]>) -> LawTable {
        LawTable(rows.into())
    }

    /// All rows.
    pub fn rows(&self) -> &[[f64; LawTable::COLUMNS]] {
        &self.0
    }

    /// Numbers of some columns in the row of a number, rounded towards zero; NaN if no row has it.
    #[inline(always)]
    pub fn numbers<const N: usize>(&self, columns: [usize; N], number: f64) -> [f64; N] {
        match (number as usize).checked_sub(1).and_then(|row| self.0.get(row)) {
            Some(row) => columns.map(|column| row[column]),
            None => [f64::NAN; N],
        }
    }

    /// Columns, for the arrays of a program.
    pub fn columns(&self) -> [Vec<f64>; LawTable::COLUMNS] {
        std::array::from_fn(|column| self.0.iter().map(|row| row[column]).collect())
    }
}
