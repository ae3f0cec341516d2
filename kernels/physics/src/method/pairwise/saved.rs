//! Engine state as columns for checkpoints, in the order of the scene's discs.

use super::search::{PairSearch, SearchCells};
use super::state::CellMove;
use super::{PairEngine, real_column};
use crate::io::checkpoint::CheckpointColumn;
use crate::method::restored::find_column;
use stripmine_kernels::backend::Precision;
use stripmine_kernels::integrator::gear::STATE;
use stripmine_kernels::isa::Element;
use stripmine_kernels::{in_pieces, single_threaded_if};

const SUMS: [&str; 3] = ["Fx", "Fy", "torque"];
pub(super) const CELL: [&str; 2] = ["cell.column", "cell.row"];
const MADE_AT: [&str; 2] = ["listed.x", "listed.y"];
/// Number of list builds: one entry, whatever the number of discs.
const LISTS_MADE: &str = "listed.made";

/// Origin of a column of the discs.
#[derive(Clone, Copy, Debug)]
pub(super) enum ColumnSource {
    /// A derivative of a degree of freedom.
    State(usize, usize),
    /// The force along an axis, or the torque.
    Sum(usize),
    /// Column or row of the cell.
    Cell(usize),
    /// Position of the disc along an axis when the lists were built.
    MadeAt(usize),
}

impl ColumnSource {
    fn name(self) -> &'static str {
        match self {
            ColumnSource::State(freedom, k) => STATE[freedom][k].label(),
            ColumnSource::Sum(freedom) => SUMS[freedom],
            ColumnSource::Cell(axis) => CELL[axis],
            ColumnSource::MadeAt(axis) => MADE_AT[axis],
        }
    }
}

impl<S: Precision, P: Precision, Q: PairSearch<S, P>> PairEngine<S, P, Q> {
    /// Builds a column with an entry for each of some discs.
    fn column<T: Element>(&self, discs: &[u32], value: impl Fn(usize) -> T + Sync) -> CheckpointColumn {
        let mut column = vec![T::default(); discs.len()];
        single_threaded_if(self.is_small(), || {
            in_pieces(&mut column, |first, piece| {
                piece.iter_mut().zip(&discs[first..]).for_each(|(to, &disc)| *to = value(disc as usize));
            });
        });
        real_column(column.into_iter())
    }

    /// Everything that the next step depends on, by name, in the scene's order.
    pub(super) fn saved(&self) -> Vec<(String, CheckpointColumn)> {
        let mut columns = self.columns_of(&self.indices_by_number());
        columns.extend(self.columns_of_all());
        columns
    }

    /// Columns shared by all discs: the number of list builds, and the crossed periods.
    pub(super) fn columns_of_all(&self) -> impl Iterator<Item = (String, CheckpointColumn)> {
        let made = self
            .search
            .lists()
            .map(|lists| (LISTS_MADE.to_owned(), CheckpointColumn::U64(vec![lists.made()])));
        made.into_iter().chain(self.elapsed.crossings.columns())
    }

    /// Columns of values of each disc, with an entry for each of some discs.
    pub(super) fn columns_of(&self, discs: &[u32]) -> Vec<(String, CheckpointColumn)> {
        self.sources()
            .into_iter()
            .map(|source| (source.name().to_owned(), self.column_of(source, discs)))
            .collect()
    }

    /// Origins of the columns of the discs, in order.
    pub(super) fn sources(&self) -> Vec<ColumnSource> {
        let state = self.state.carried().map(|(freedom, k)| ColumnSource::State(freedom, k));
        let lists = if self.search.lists().is_some() { &[0, 1][..] } else { &[] };
        let others = [0, 1, 2].map(ColumnSource::Sum).into_iter().chain([0, 1].map(ColumnSource::Cell));
        state.chain(others).chain(lists.iter().map(|&axis| ColumnSource::MadeAt(axis))).collect()
    }

    /// Column of one origin.
    pub(super) fn column_of(&self, source: ColumnSource, discs: &[u32]) -> CheckpointColumn {
        match source {
            ColumnSource::State(freedom, k) => {
                self.column(discs, |disc| self.state.derivative((freedom, k), disc))
            }
            ColumnSource::Sum(freedom) => self.column(discs, |disc| self.sums.of(disc)[freedom]),
            ColumnSource::Cell(axis) => {
                let cell = |disc| self.search.cells().cell(disc);
                self.column(discs, |disc| cell(disc).map_or(f64::NAN, |cell| cell[axis] as f64))
            }
            ColumnSource::MadeAt(axis) => {
                let made_at = self.search.lists().map_or(&[][..], |lists| lists.made_at(axis));
                self.column(discs, |disc| made_at[disc])
            }
        }
    }

    /// Restores columns that [`saved`](Self::saved) returned after `steps` steps. After an error the engine is unusable.
    ///
    /// # Errors
    /// Says why, if the columns are not those of these discs.
    pub(super) fn restore_state(
        &mut self,
        steps: u64,
        columns: &[(String, CheckpointColumn)],
    ) -> Result<(), String> {
        let numbers = self.state.numbers().to_vec();
        let made = match (self.search.lists(), columns.iter().find(|(name, _)| name == LISTS_MADE)) {
            (None, _) => 0,
            (Some(_), Some((_, CheckpointColumn::U64(made)))) if made.len() == 1 && made[0] < 1 << 53 => {
                made[0]
            }
            _ => return Err(format!("the column {LISTS_MADE} is missing or not a count")),
        };
        self.elapsed.crossings.restore_counts(columns)?;
        self.restore_discs(columns, numbers, self.start.len())?;
        self.search.set_lists_made(made);
        self.elapsed.steps = steps;
        self.update_wall_velocity();
        Ok(())
    }

    /// Restores columns that [`columns_of`](Self::columns_of) returned; `entries` maps each disc in memory to its entry, of `length` in all.
    ///
    /// # Errors
    /// As [`restore_state`](Self::restore_state).
    pub(super) fn restore_discs(
        &mut self,
        columns: &[(String, CheckpointColumn)],
        entries: Vec<u32>,
        length: usize,
    ) -> Result<(), String> {
        let in_order = OrderedEntries { columns, entries, length };
        for of in self.state.carried().collect::<Vec<_>>() {
            let values = in_order.of::<S>(STATE[of.0][of.1].label())?;
            let discs = values.into_iter().enumerate();
            discs.for_each(|(disc, value)| self.state.set_derivative(of, disc, value));
        }
        for (sum, name) in SUMS.iter().enumerate() {
            let values = in_order.of::<P>(name)?;
            values.into_iter().enumerate().for_each(|(disc, value)| self.sums.set(sum, disc, value));
        }
        let cells = [in_order.of::<f64>(CELL[0])?, in_order.of::<f64>(CELL[1])?];
        let counts = self.search.cells().grid().counts;
        let inside =
            |axis: usize, &cell: &f64| (0.0..counts[axis] as f64).contains(&cell) && cell.fract() == 0.0;
        if (0..2).any(|axis| !cells[axis].iter().all(|cell| inside(axis, cell))) {
            return Err("a cell is outside the lattice".to_owned());
        }
        let made_at = match self.search.lists() {
            Some(_) => Some([in_order.of::<S>(MADE_AT[0])?, in_order.of::<S>(MADE_AT[1])?]),
            None => None,
        };
        (0..self.state.len()).for_each(|disc| self.search.cells_mut().leave(disc));
        for (disc, (&column, &row)) in cells[0].iter().zip(&cells[1]).enumerate() {
            let cell = [column as usize, row as usize];
            let to = CellMove { disc, cell, place: self.state.place(disc), periods: [0.0; 2] };
            let entered = self.search.cells_mut().enter(&to, &self.state);
            entered.map_err(|_| "two discs are in one cell".to_owned())?;
        }
        self.search.cells_mut().arrange(&self.state);
        // Rebuild the lists at the positions of their original build, so that they are the same.
        let now: Vec<[f64; 2]> = (0..self.state.len()).map(|disc| self.state.place(disc)).collect();
        // Free the columns before building the lists.
        drop((cells, in_order));
        if let Some(made_at) = made_at {
            for (axis, places) in made_at.into_iter().enumerate() {
                let discs = places.into_iter().enumerate();
                discs.for_each(|(disc, along)| self.state.set_derivative((axis, 0), disc, along));
            }
        }
        let order = self.sort_by_cell();
        for (disc, before) in order.into_iter().enumerate() {
            self.state.put(disc, now[before as usize]);
        }
        Ok(())
    }
}

/// Columns, with the entry of each disc in memory.
struct OrderedEntries<'c> {
    columns: &'c [(String, CheckpointColumn)],
    entries: Vec<u32>,
    length: usize,
}

impl OrderedEntries<'_> {
    /// Returns the named column in the order of the discs in memory.
    fn of<T: Element>(&self, name: &str) -> Result<Vec<T>, String> {
        let values = find_column::<T>(self.columns, name, self.length)?;
        Ok(self.entries.iter().map(|&entry| values[entry as usize]).collect())
    }
}
