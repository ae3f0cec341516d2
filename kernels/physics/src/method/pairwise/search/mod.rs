//! Pair search of the fast engine: on a lattice, in sectors, or in Verlet lists.

mod lattice;
mod lists;
mod sectors;

pub(crate) use lattice::LatticeSearch;
pub use lattice::OnConflict;
pub(crate) use lists::{ListSearch, ListedPairs};
pub(crate) use sectors::SectorSearch;

use super::state::{CellMove, MovingDiscs};
use stripmine_kernels::InstructionSet;
use stripmine_kernels::backend::Precision;
use stripmine_kernels::isa::ProgramError;
use stripmine_kernels::law::{Law, ObservationRequest};
use stripmine_kernels::sweep::fast::lattice::CellTaken;
use stripmine_kernels::sweep::fast::{
    CellGrid, DisplacementLimit, Finder, ForceRecords, PositionCopies, RankShare, RowLayout, StateRecords,
    Sweep, SweepReport,
};

/// Cells and the discs in them. Positions are relative to the centre of a disc's cell.
pub(crate) trait SearchCells<S: Precision>: Send + Sync {
    /// Grid of the cells: frame, counts and periodic sides.
    fn grid(&self) -> CellGrid;

    /// Returns column and row of a disc; none if it is in no cell.
    fn cell(&self, disc: usize) -> Option<[usize; 2]>;

    /// Removes a disc from its cell.
    fn leave(&mut self, disc: usize);

    /// Enters a disc into a cell.
    ///
    /// # Errors
    /// [`CellTaken`] if another disc owns the cell.
    fn enter(&mut self, to: &CellMove, state: &MovingDiscs<S>) -> Result<(), CellTaken>;

    /// Updates the position of a disc that stays in its cell.
    fn settle(&mut self, _disc: usize, _place: [f64; 2]) {}

    /// Updates the cells after discs have changed them.
    fn arrange(&mut self, state: &MovingDiscs<S>);

    /// Returns the discs in order of their cells.
    fn order(&self) -> Vec<u32>;

    /// Renumbers: disc `n` becomes what disc `order[n]` was.
    fn renumber(&mut self, order: &[u32]);

    /// True if a cell must hold one disc only.
    fn is_exclusive(&self) -> bool {
        false
    }

    /// Returns the disc in a cell, if cells hold one disc only.
    fn owner(&self, _cell: [usize; 2]) -> Option<usize> {
        None
    }

    /// Returns how many of some discs are in cells owned by another disc, if one disc owns a cell.
    fn shared_cells(&self, _counts: &dyn Fn(usize) -> bool) -> usize {
        0
    }
}

/// Pair search that uses cells.
///
/// The engine is compiled for each search, so that unused parts cost nothing.
pub(crate) trait PairSearch<S: Precision, P: Precision>: Send + Sync {
    /// Type of the cells.
    type Cells: SearchCells<S>;

    /// Returns an empty search with space for `discs` discs and the rows of a rank.
    fn emptied(&self, discs: usize, share: RankShare) -> Self;

    /// Returns the rows of cells that a sweep is built for.
    fn rows(&self) -> RowLayout;

    fn cells(&self) -> &Self::Cells;

    /// Mutable access to the cells.
    fn cells_mut(&mut self) -> &mut Self::Cells;

    /// Returns the displacement limit of discs, and the copies to update when discs move.
    fn displacement_limit(&mut self) -> (DisplacementLimit<'_, S>, Option<PositionCopies<'_>>);

    /// Sweeps all pairs with a law.
    ///
    /// # Errors
    /// [`ProgramError`] if the processor lacks the instructions, or the law needs a quantity that it does not declare.
    fn sweep<L: Law<2> + Sync>(
        &mut self,
        law: &L,
        discs: &StateRecords<S>,
        sums: &mut ForceRecords<P>,
        asked: ObservationRequest,
        set: InstructionSet,
    ) -> Result<SweepReport, ProgramError>;

    /// Computes energy, virial, number and depth of the contacts in the current cells or lists, at positions up to `moved` (length) from those of the
    /// last [`sweep`](Self::sweep). Nothing is changed.
    ///
    /// # Errors
    /// As [`sweep`](Self::sweep).
    fn observe<L: Law<2> + Sync>(
        &self,
        law: &L,
        discs: &StateRecords<f64>,
        moved: f64,
        set: InstructionSet,
    ) -> Result<SweepReport, ProgramError>;

    /// Builds lists, if the search has any, from the current state. Needed whenever discs were renumbered.
    fn make_lists(&mut self, _state: &MovingDiscs<S>) {}

    /// Sets the number of list builds.
    fn set_lists_made(&mut self, _made: u64) {}

    /// Returns the lists, if the search has any.
    fn lists(&self) -> Option<&ListedPairs<S>> {
        None
    }
}

/// Observes the pairs of a finder with the force sweep in double precision, so that nothing more is compiled; the forces are discarded.
fn observed<F: Finder<f64, f64>, L: Law<2> + Sync>(
    law: &L,
    finder: &F,
    share: Option<&RankShare>,
    discs: &StateRecords<f64>,
    set: InstructionSet,
) -> Result<SweepReport, ProgramError> {
    let mut sums = ForceRecords::zeros(0, discs.discs());
    let asked = ObservationRequest { energy: true, ..ObservationRequest::default() };
    Sweep::for_share(finder.rows(), share).run(law, finder, discs, &mut sums, asked, set)
}

/// Returns the rows that a sweep for a finder is built for.
fn rows<S: Precision, P: Precision, F: Finder<S, P>>(finder: &F) -> RowLayout {
    finder.rows()
}
