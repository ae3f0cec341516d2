//! The state of a simulation as columns, for checkpoints.

use super::LatticeMd;
use crate::io::checkpoint::CheckpointColumn;
use crate::method::pairwise::real_column;
use crate::method::restored::find_column;
use stripmine_kernels::backend;
use stripmine_kernels::isa::Array;

/// Columns of the neighbour lists' state: positions when the lists were built.
const MADE_AT: [&str; 2] = ["listed.x", "listed.y"];
/// Number of builds of the lists, and pairs visited in the last step.
const LIST_COUNTS: &str = "listed.counts";

impl<S: backend::Precision, P: backend::Precision> LatticeMd<S, P> {
    /// True if the next step depends on the discs' previous cells: positions are measured in them, or crossings are derived from the change of cell.
    fn keeps_cells(&self) -> bool {
        self.model.is_anchored::<S>() || self.elapsed.crossings.is_followed()
    }

    /// Everything that the next step depends on, by name.
    pub(super) fn saved(&self) -> Vec<(String, CheckpointColumn)> {
        let column = |values: &[S]| real_column(values.iter().copied());
        let arrays = self.arrays.states().map(|(array, values)| (array.label().to_owned(), column(values)));
        let cells = self.keeps_cells().then(|| {
            let cells = self.arrays.cell().iter().map(|&cell| f64::from(cell));
            (Array::DiscCell.label().to_owned(), real_column(cells))
        });
        let crossings = self.elapsed.crossings.columns();
        let mut columns: Vec<(String, CheckpointColumn)> = arrays.chain(cells).chain(crossings).collect();
        if let Some(rival) = &self.rival {
            for (name, values) in MADE_AT.into_iter().zip(rival.made_at()) {
                columns.push((name.to_owned(), CheckpointColumn::F64(values)));
            }
            // Doubles are exact up to 2⁵³, far beyond any count.
            let counts = vec![rival.rebuilds as f64, rival.met.pairs as f64];
            columns.push((LIST_COUNTS.to_owned(), CheckpointColumn::F64(counts)));
        }
        columns
    }

    /// Restores columns that [`saved`](Self::saved) returned.
    pub(super) fn restore_columns(&mut self, columns: &[(String, CheckpointColumn)]) -> Result<(), String> {
        let expected: Vec<Array> = self.arrays.states().map(|(array, _)| array).collect();
        for array in expected {
            let to = self.arrays.state_mut(array).unwrap_or(&mut []);
            to.copy_from_slice(&find_column::<S>(columns, array.label(), to.len())?);
        }
        if self.keeps_cells() {
            self.restore_cells(columns)?;
        }
        self.elapsed.crossings.restore_counts(columns)?;
        if let Some(rival) = &mut self.rival {
            let discs = self.start.len();
            let of = |axis: usize| find_column(columns, MADE_AT[axis], discs);
            let (made_at, counts) = ([of(0)?, of(1)?], find_column::<f64>(columns, LIST_COUNTS, 2)?);
            if counts.iter().any(|&count| count.fract() != 0.0 || !(0.0..=2f64.powi(53)).contains(&count)) {
                return Err(format!("the column {LIST_COUNTS} holds a number that is not a count"));
            }
            rival.restore_lists(&self.model, made_at, counts[0] as u64, counts[1] as u64);
        }
        Ok(())
    }

    /// Restores the cells of discs; if the run so far did not need them, they follow from the positions.
    fn restore_cells(&mut self, columns: &[(String, CheckpointColumn)]) -> Result<(), String> {
        let label = Array::DiscCell.label();
        let is_kept = columns.iter().any(|(name, _)| name == label);
        if !is_kept && !self.model.is_anchored::<S>() && self.model.counts_crossings_for_motion_alone() {
            let [x, y] = [Array::X0, Array::Y0].map(|array| self.arrays.state(array).unwrap_or(&[]).to_vec());
            for (disc, (x, y)) in x.into_iter().zip(y).enumerate() {
                self.arrays.cell_mut()[disc] = self.model.anchored([x.to_f64(), y.to_f64()]).0;
            }
            return Ok(());
        }
        let cells = find_column::<f64>(columns, label, self.arrays.cell().len())?;
        let most = self.model.shape.padded() as f64;
        if let Some(cell) = cells.iter().find(|&&cell| !(1.0..=most).contains(&cell) || cell.fract() != 0.0) {
            return Err(format!("the column {label} holds {cell}, which is not a cell of the lattice"));
        }
        self.arrays.cell_mut().iter_mut().zip(cells).for_each(|(to, cell)| *to = cell as u32);
        Ok(())
    }
}
