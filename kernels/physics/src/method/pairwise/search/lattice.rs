//! Pair search on a lattice with at most one disc a cell.

use super::{PairSearch, SearchCells, observed, rows};
use crate::method::pairwise::state::{CellMove, MovingDiscs};
use crate::words::define_words;
use stripmine_kernels::InstructionSet;
use stripmine_kernels::backend::Precision;
use stripmine_kernels::isa::ProgramError;
use stripmine_kernels::law::{Law, ObservationRequest};
use stripmine_kernels::sweep::fast::lattice::{Candidates, CellTaken, Codes, Lattice, Occupancy};
use stripmine_kernels::sweep::fast::{
    CellGrid, DisplacementLimit, ForceRecords, PositionCopies, RankShare, RowLayout, StateRecords, Sweep,
    SweepReport,
};
use stripmine_kernels::sweep::lattice::{LatticeFrame, LatticeShape};

define_words! {
    /// Action for a disc in an occupied lattice cell.
    pub enum OnConflict {
        /// The run stops.
        Stop = "stop",
        /// The disc is kept in a list beside the lattice, and every such disc and step is counted.
        Resolve = "resolve",
    }
}

/// Discs in the cells of a lattice.
pub(crate) struct LatticeCells {
    occupancy: Occupancy,
    on_conflict: OnConflict,
}

impl<S: Precision> SearchCells<S> for LatticeCells {
    fn grid(&self) -> CellGrid {
        self.occupancy.grid()
    }

    fn cell(&self, disc: usize) -> Option<[usize; 2]> {
        self.occupancy.cell(disc)
    }

    fn leave(&mut self, disc: usize) {
        self.occupancy.leave(disc);
    }

    fn enter(&mut self, to: &CellMove, state: &MovingDiscs<S>) -> Result<(), CellTaken> {
        let CellMove { disc, cell, place, .. } = *to;
        let occupancy = &mut self.occupancy;
        let entered = occupancy.enter(disc, cell, place, state.radius(disc));
        let Err(CellTaken(owner)) = entered else { return Ok(()) };
        if self.on_conflict == OnConflict::Stop {
            return entered;
        }
        // The disc with the smallest number owns the cell, so that a state does not depend on its history.
        let mut sharing = disc;
        if state.number(disc) < state.number(owner) {
            occupancy.leave(owner);
            occupancy.enter(disc, cell, place, state.radius(disc))?;
            sharing = owner;
        }
        occupancy.share(sharing, cell, |disc| state.number(disc));
        Ok(())
    }

    fn settle(&mut self, disc: usize, place: [f64; 2]) {
        self.occupancy.update_position(disc, place);
    }

    fn arrange(&mut self, state: &MovingDiscs<S>) {
        let occupancy = &mut self.occupancy;
        // Discs that shared the cell of a departed disc now own it.
        for (disc, cell) in occupancy.shared_cells().to_vec() {
            let disc = disc as usize;
            if occupancy.disc(cell[0], cell[1]).is_none() {
                occupancy.leave(disc);
                let entered = occupancy.enter(disc, cell, state.place(disc), state.radius(disc));
                assert!(entered.is_ok(), "the cell was empty");
            }
        }
        occupancy.repeat_images();
    }

    fn order(&self) -> Vec<u32> {
        self.occupancy.order()
    }

    fn renumber(&mut self, order: &[u32]) {
        self.occupancy.renumber(order);
    }

    fn is_exclusive(&self) -> bool {
        self.on_conflict == OnConflict::Stop
    }

    fn owner(&self, [column, row]: [usize; 2]) -> Option<usize> {
        (self.on_conflict == OnConflict::Stop).then(|| self.occupancy.disc(column, row)).flatten()
    }

    fn shared_cells(&self, counts: &dyn Fn(usize) -> bool) -> usize {
        self.occupancy.shared_cells().iter().filter(|shared| counts(shared.0 as usize)).count()
    }
}

/// Pair search on a lattice.
pub(crate) struct LatticeSearch<P> {
    cells: LatticeCells,
    codes: Codes<P>,
    sweep: Sweep<Candidates>,
    share: Option<RankShare>,
    /// Smallest radius (length).
    smallest: f64,
}

impl<P: Precision> LatticeSearch<P> {
    /// Creates an empty lattice for as many discs as there are radii (length).
    pub(crate) fn new<S: Precision>(
        shape: LatticeShape,
        frame: LatticeFrame,
        on_conflict: OnConflict,
        radii: impl ExactSizeIterator<Item = f64> + Clone,
    ) -> Self {
        let discs = radii.len();
        let smallest = radii.clone().reduce(f64::min);
        let largest = radii.reduce(f64::max);
        let occupancy =
            Occupancy::new(shape, frame, discs, 2.0 * largest.unwrap_or(1.0), smallest != largest);
        let codes = Codes::new(&occupancy, frame);
        let lattice = Lattice { occupancy: &occupancy, codes: &codes, slack: 0.0 };
        let sweep = Sweep::new(rows::<S, P, _>(&lattice));
        let smallest = smallest.unwrap_or(1.0);
        LatticeSearch { cells: LatticeCells { occupancy, on_conflict }, codes, sweep, share: None, smallest }
    }
}

impl<S: Precision, P: Precision> PairSearch<S, P> for LatticeSearch<P> {
    type Cells = LatticeCells;

    fn emptied(&self, discs: usize, share: RankShare) -> Self {
        let occupancy = self.cells.occupancy.empty_copy(discs);
        let codes = Codes::new(&occupancy, occupancy.grid().frame);
        let lattice = Lattice { occupancy: &occupancy, codes: &codes, slack: 0.0 };
        let sweep = Sweep::for_share(rows::<S, P, _>(&lattice), Some(&share));
        let cells = LatticeCells { occupancy, on_conflict: self.cells.on_conflict };
        LatticeSearch { cells, codes, sweep, share: Some(share), smallest: self.smallest }
    }

    fn rows(&self) -> RowLayout {
        rows::<S, P, _>(&Lattice { occupancy: &self.cells.occupancy, codes: &self.codes, slack: 0.0 })
    }

    fn cells(&self) -> &LatticeCells {
        &self.cells
    }

    fn cells_mut(&mut self) -> &mut LatticeCells {
        &mut self.cells
    }

    fn displacement_limit(&mut self) -> (DisplacementLimit<'_, S>, Option<PositionCopies<'_>>) {
        let occupancy = &mut self.cells.occupancy;
        (DisplacementLimit::Cell(occupancy.grid().frame.edge), occupancy.copies())
    }

    fn sweep<L: Law<2> + Sync>(
        &mut self,
        law: &L,
        discs: &StateRecords<S>,
        sums: &mut ForceRecords<P>,
        asked: ObservationRequest,
        set: InstructionSet,
    ) -> Result<SweepReport, ProgramError> {
        let LatticeSearch { cells: LatticeCells { occupancy, .. }, codes, sweep, .. } = self;
        sweep.run(law, &Lattice { occupancy, codes, slack: 0.0 }, discs, sums, asked, set)
    }

    fn observe<L: Law<2> + Sync>(
        &self,
        law: &L,
        discs: &StateRecords<f64>,
        moved: f64,
        set: InstructionSet,
    ) -> Result<SweepReport, ProgramError> {
        let occupancy = &self.cells.occupancy;
        let codes = Codes::new(occupancy, occupancy.grid().frame);
        // Both discs of a pair may have come nearer; no contact distance is below two smallest radii.
        let slack = moved / self.smallest;
        observed(law, &Lattice { occupancy, codes: &codes, slack }, self.share.as_ref(), discs, set)
    }
}
