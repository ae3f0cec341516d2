//! The state as columns, for checkpoints: in the order of the scene's discs.

use super::search::{Cells, Search};
use super::state::Move;
use super::{Dynamics, Engine, real_column};
use crate::io::checkpoint::Column;
use crate::method::restored::find_column;
use stripmine_kernels::backend::Precision;
use stripmine_kernels::integrator::gear::STATE;
use stripmine_kernels::isa::Element;
use stripmine_kernels::{alone_if, in_pieces};

const SUMS: [&str; 3] = ["Fx", "Fy", "torque"];
const CELL: [&str; 2] = ["cell.column", "cell.row"];
const MADE_AT: [&str; 2] = ["listed.x", "listed.y"];
/// How often lists were made: one entry, whatever the discs.
const LISTS_MADE: &str = "listed.made";

impl<S: Precision, P: Precision, Q: Search<S, P>, D: Dynamics> Engine<S, P, Q, D> {
    /// A column in the scene's order, from a value for each disc, where it is known which disc each of the scene's is.
    fn column<T: Element>(&self, discs: &[u32], value: impl Fn(usize) -> T + Sync) -> Column {
        let mut column = vec![T::default(); self.start.len()];
        alone_if(self.is_small(), || {
            in_pieces(&mut column, |first, piece| {
                piece.iter_mut().zip(&discs[first..]).for_each(|(to, &disc)| *to = value(disc as usize));
            });
        });
        real_column(column.into_iter())
    }

    /// Everything that the next step depends on, by name.
    pub(super) fn saved(&self) -> Vec<(String, Column)> {
        let mut columns = Vec::new();
        let discs = self.disc_of_each();
        for (names, rows) in STATE.iter().zip(&self.state.columns) {
            for (name, column) in names.iter().zip(rows) {
                columns.push((name.label().to_owned(), self.column(&discs, |disc| column[disc])));
            }
        }
        for (name, sum) in SUMS.iter().zip(&self.sums) {
            columns.push(((*name).to_owned(), self.column(&discs, |disc| sum[disc])));
        }
        for (axis, name) in CELL.iter().enumerate() {
            let cell = |disc| self.search.cells().cell(disc).map_or(f64::NAN, |cell| cell[axis] as f64);
            columns.push(((*name).to_owned(), self.column(&discs, cell)));
        }
        if let Some(lists) = self.search.lists() {
            for (axis, name) in MADE_AT.iter().enumerate() {
                let made_at = lists.made_at(axis);
                columns.push(((*name).to_owned(), self.column(&discs, |disc| made_at[disc])));
            }
            columns.push((LISTS_MADE.to_owned(), Column::U64(vec![lists.made()])));
        }
        columns.extend(self.elapsed.crossings.columns());
        columns
    }

    /// Takes up columns that [`columns`](Self::columns) gave after `steps` steps. Where they are not those of these discs, nothing can
    /// be done with the engine any more.
    ///
    /// # Errors
    /// A sentence, if the columns are not those of these discs.
    pub(super) fn take_up(&mut self, steps: u64, columns: &[(String, Column)]) -> Result<(), String> {
        let numbers = self.state.numbers().to_vec();
        for (names, rows) in STATE.iter().zip(&mut self.state.columns) {
            for (name, column) in names.iter().zip(rows) {
                let values = in_order::<S>(columns, name.label(), &numbers)?;
                // The sentinels stay.
                column[..values.len()].copy_from_slice(&values);
            }
        }
        for (name, sum) in SUMS.iter().zip(&mut self.sums) {
            *sum = in_order::<P>(columns, name, &numbers)?;
        }
        let cells =
            [in_order::<f64>(columns, CELL[0], &numbers)?, in_order::<f64>(columns, CELL[1], &numbers)?];
        let counts = self.search.cells().grid().counts;
        let inside =
            |axis: usize, &cell: &f64| (0.0..counts[axis] as f64).contains(&cell) && cell.fract() == 0.0;
        if (0..2).any(|axis| !cells[axis].iter().all(|cell| inside(axis, cell))) {
            return Err("a cell lies outside the lattice".to_owned());
        }
        let made_at = match self.search.lists() {
            Some(_) => Some([
                in_order::<S>(columns, MADE_AT[0], &numbers)?,
                in_order::<S>(columns, MADE_AT[1], &numbers)?,
            ]),
            None => None,
        };
        let lists_made = columns.iter().find(|(name, _)| name == LISTS_MADE).map(|(_, column)| column);
        let lists_made = match lists_made {
            Some(Column::U64(made)) if made.len() == 1 && made[0] < 1 << 53 => made[0],
            _ if made_at.is_some() => return Err(format!("the column {LISTS_MADE} is missing, or no count")),
            _ => 0,
        };
        self.elapsed.crossings.take_up(columns)?;
        (0..numbers.len()).for_each(|disc| self.search.cells_mut().leave(disc));
        for (disc, (&column, &row)) in cells[0].iter().zip(&cells[1]).enumerate() {
            let cell = [column as usize, row as usize];
            let to = Move { disc, cell, place: self.state.place(disc), periods: [0.0; 2] };
            let entered = self.search.cells_mut().enter(&to, &self.state);
            entered.map_err(|_| "two discs are in one cell".to_owned())?;
        }
        self.search.cells_mut().arrange(&self.state);
        // Lists are made of the places at which they were made before, so that they are the same.
        let now: Vec<[f64; 2]> = (0..self.start.len()).map(|disc| self.state.place(disc)).collect();
        // What is taken up is not kept beside the lists.
        drop((cells, numbers));
        if let Some(made_at) = made_at {
            for (axis, places) in made_at.into_iter().enumerate() {
                self.state.columns[axis][0][..places.len()].copy_from_slice(&places);
            }
        }
        let order = self.put_in_order();
        for (disc, before) in order.into_iter().enumerate() {
            self.state.put(disc, now[before as usize]);
        }
        self.search.set_lists_made(lists_made);
        self.elapsed.steps = steps;
        self.give_walls_their_velocity();
        Ok(())
    }
}

/// The column of a name, in the order of the discs in memory, whose numbers in the scene are given.
fn in_order<T: Element>(columns: &[(String, Column)], name: &str, numbers: &[u32]) -> Result<Vec<T>, String> {
    let values = find_column::<T>(columns, name, numbers.len())?;
    Ok(numbers.iter().map(|&number| values[number as usize]).collect())
}
