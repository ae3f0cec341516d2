//! Pair search in sectors, which hold any number of discs.

use super::{Cells, Search, observed, rows};
use crate::method::pairwise::state::{Move, State};
use stripmine_kernels::InstructionSet;
use stripmine_kernels::backend::Precision;
use stripmine_kernels::isa::ProgramError;
use stripmine_kernels::law::{Asked, Law};
use stripmine_kernels::sweep::fast::lattice::Taken;
use stripmine_kernels::sweep::fast::{
    Copies, Discs, DisplacementLimit, Grid, Met, Rows, Sectors, Share, Sweep, Touches,
};

impl<S: Precision> Cells<S> for Sectors {
    fn grid(&self) -> Grid {
        *Sectors::grid(self)
    }

    fn cell(&self, disc: usize) -> Option<[usize; 2]> {
        Sectors::cell(self, disc)
    }

    fn leave(&mut self, disc: usize) {
        Sectors::leave(self, disc);
    }

    fn enter(&mut self, to: &Move, _: &State<S>) -> Result<(), Taken> {
        Sectors::enter(self, to.disc, to.cell);
        Ok(())
    }

    fn arrange(&mut self, state: &State<S>) {
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
    sweep: Sweep<Touches<P>>,
    share: Option<Share>,
}

impl<P: Precision> SectorSearch<P> {
    /// Creates empty sectors for `discs` discs whose pairs act up to a distance `reach` (length).
    pub(crate) fn new<S: Precision>(grid: Grid, discs: usize, reach: f64) -> Self {
        let sectors = Sectors::new(grid, discs, reach);
        let sweep = Sweep::new(rows::<S, P, _>(&sectors));
        SectorSearch { sectors, sweep, share: None }
    }
}

impl<S: Precision, P: Precision> Search<S, P> for SectorSearch<P> {
    type Cells = Sectors;

    fn emptied(&self, discs: usize, share: Share) -> Self {
        let sectors = self.sectors.emptied(discs);
        let sweep = Sweep::of_share(rows::<S, P, _>(&sectors), Some(&share));
        SectorSearch { sectors, sweep, share: Some(share) }
    }

    fn rows(&self) -> Rows {
        rows::<S, P, _>(&self.sectors)
    }

    fn cells(&self) -> &Sectors {
        &self.sectors
    }

    fn cells_mut(&mut self) -> &mut Sectors {
        &mut self.sectors
    }

    fn displacement_limit(&mut self) -> (DisplacementLimit<'_, S>, Option<Copies<'_>>) {
        (DisplacementLimit::Cell(self.sectors.grid().frame.edge), None)
    }

    fn sweep<L: Law<2> + Sync>(
        &mut self,
        law: &L,
        discs: &Discs<'_, S>,
        sums: [&mut [P]; 3],
        asked: Asked,
        set: InstructionSet,
    ) -> Result<Met, ProgramError> {
        self.sweep.run(law, &self.sectors, discs, sums, asked, set)
    }

    fn observe<L: Law<2> + Sync>(
        &self,
        law: &L,
        discs: &Discs<'_, f64>,
        _: f64,
        set: InstructionSet,
    ) -> Result<Met, ProgramError> {
        observed(law, &self.sectors, self.share.as_ref(), discs, set)
    }
}
