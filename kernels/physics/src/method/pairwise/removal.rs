//! Continuation of a run after particles were thrown out of the box.

use super::PairEngine;
use super::cells::CellChange;
use super::search::PairSearch;
use crate::method::PhysicsFailure;
use stripmine_kernels::backend::Precision;

impl<S: Precision, P: Precision, Q: PairSearch<S, P>> PairEngine<S, P, Q> {
    /// Returns the particles, by their numbers in the scene and rising, that belong to no cell or have a value that is not finite.
    pub(super) fn unfit_discs(&self) -> Vec<usize> {
        let is_finite = |disc: usize| {
            let state =
                (0..2).flat_map(|axis| self.state.row(axis, disc)).all(|value| value.to_f64().is_finite());
            state && self.sums.of(disc).iter().all(|sum| sum.to_f64().is_finite())
        };
        let is_unfit = |&disc: &usize| !is_finite(disc) || self.is_outside(disc);
        let mut unfit: Vec<usize> =
            (0..self.state.len()).filter(is_unfit).map(|disc| self.state.number(disc)).collect();
        unfit.sort_unstable();
        unfit
    }

    /// Updates all cells from the predicted positions, before their forces are computed.
    ///
    /// # Errors
    /// [`PhysicsFailure`] if a particle belongs to no cell.
    pub(super) fn settle_all(&mut self) -> Result<Vec<CellChange>, PhysicsFailure> {
        let looked = self.search_cells(0..self.state.len());
        let moves = self.changes_of(vec![looked])?;
        let moved = self.change_cells(&moves)?;
        self.sort_by_cell();
        self.awaits_forces = true;
        Ok(moved)
    }
}
