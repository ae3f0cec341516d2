//! Rows of a law's table in registers and in programs.

use crate::backend::{GROUP, Registers};
use crate::isa::{Element, Machine, Slot};
use crate::law::LawTable;

/// Loads numbers of rows lane by lane.
#[inline(always)]
pub(super) fn rows_in_registers<R: Registers, const N: usize>(
    registers: R,
    table: &LawTable,
    columns: [usize; N],
    number: R::V,
) -> [R::V; N] {
    const { assert!(R::LANES <= GROUP) }
    let mut numbers = [R::Lane::default(); GROUP];
    // SAFETY: there is space for GROUP >= LANES numbers.
    unsafe { registers.store(numbers.as_mut_ptr(), number) };
    let mut loaded = [[R::Lane::default(); GROUP]; N];
    for (lane, number) in numbers.iter().enumerate().take(R::LANES) {
        let row = table.numbers(columns, number.to_f64());
        for (column, value) in loaded.iter_mut().zip(row) {
            column[lane] = R::Lane::from_f64(value);
        }
    }
    // SAFETY: each column has GROUP >= LANES numbers.
    loaded.each_ref().map(|column| unsafe { registers.load(column.as_ptr()) })
}

/// Gathers numbers of rows from the arrays of the table's columns.
#[inline(always)]
pub(super) fn rows_in_program<M: Machine, const N: usize>(
    m: M,
    columns: [usize; N],
    number: M::V,
) -> [M::V; N] {
    let (index, none) = (m.to_index(number), m.uniform(f64::NAN));
    columns.map(|column| m.gather(Slot::<f64>::new(LawTable::ARRAYS[column]), index, none))
}
