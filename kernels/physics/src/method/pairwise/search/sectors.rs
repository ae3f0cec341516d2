//! Pair search in sectors, which hold any number of discs.

use super::{PairSearch, SearchCells, observed, rows};
use crate::method::pairwise::state::{CellMove, MovingDiscs};
use stripmine_kernels::InstructionSet;
use stripmine_kernels::backend::Precision;
use stripmine_kernels::isa::ProgramError;
use stripmine_kernels::law::{Law, ObservationRequest};
use stripmine_kernels::sweep::fast::lattice::CellTaken;
use stripmine_kernels::sweep::fast::{
    CellGrid, DisplacementLimit, ForceRecords, PairBuffer, PositionCopies, RankShare, RowLayout, Sectors,
    StateRecords, Sweep, SweepReport,
};

impl<S: Precision> SearchCells<S> for Sectors {
    fn grid(&self) -> CellGrid {
        *Sectors::grid(self)
    }

    fn cell(&self, disc: usize) -> Option<[usize; 2]> {
        Sectors::cell(self, disc)
    }

    fn leave(&mut self, disc: usize) {
        Sectors::leave(self, disc);
    }

    fn enter(&mut self, to: &CellMove, _: &MovingDiscs<S>) -> Result<(), CellTaken> {
        Sectors::enter(self, to.disc, to.cell);
        Ok(())
    }

    fn arrange(&mut self, state: &MovingDiscs<S>) {
        Sectors::arrange(self, |disc| state.number(disc));
    }

    fn order(&self) -> Vec<u32> {
        Sectors::order(self)
    }

    fn renumber(&mut self, order: &[u32]) {
        Sectors::renumber(self, order);
    }
}

/// Pair search in sectors.
pub(crate) struct SectorSearch<P> {
    sectors: Sectors,
    sweep: Sweep<PairBuffer<P>>,
    share: Option<RankShare>,
}

impl<P: Precision> SectorSearch<P> {
    /// Creates empty sectors for `discs` discs whose pairs act up to a distance `reach` (length).
    pub(crate) fn new<S: Precision>(grid: CellGrid, discs: usize, reach: f64) -> Self {
        let sectors = Sectors::new(grid, discs, reach);
        let sweep = Sweep::new(rows::<S, P, _>(&sectors));
        SectorSearch { sectors, sweep, share: None }
    }
}

impl<S: Precision, P: Precision> PairSearch<S, P> for SectorSearch<P> {
    type Cells = Sectors;

    fn emptied(&self, discs: usize, share: RankShare) -> Self {
        let sectors = self.sectors.empty_copy(discs);
        let sweep = Sweep::for_share(rows::<S, P, _>(&sectors), Some(&share));
        SectorSearch { sectors, sweep, share: Some(share) }
    }

    fn rows(&self) -> RowLayout {
        rows::<S, P, _>(&self.sectors)
    }

    fn cells(&self) -> &Sectors {
        &self.sectors
    }

    fn cells_mut(&mut self) -> &mut Sectors {
        &mut self.sectors
    }

    fn displacement_limit(&mut self) -> (DisplacementLimit<'_, S>, Option<PositionCopies<'_>>) {
        (DisplacementLimit::Cell(self.sectors.grid().frame.edge), None)
    }

    fn sweep<L: Law<2> + Sync>(
        &mut self,
        law: &L,
        discs: &StateRecords<S>,
        sums: &mut ForceRecords<P>,
        asked: ObservationRequest,
        set: InstructionSet,
    ) -> Result<SweepReport, ProgramError> {
        self.sweep.run(law, &self.sectors, discs, sums, asked, set)
    }

    fn observe<L: Law<2> + Sync>(
        &self,
        law: &L,
        discs: &StateRecords<f64>,
        _: f64,
        set: InstructionSet,
    ) -> Result<SweepReport, ProgramError> {
        observed(law, &self.sectors, self.share.as_ref(), discs, set)
    }
}
