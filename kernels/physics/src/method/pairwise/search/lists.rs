//! Pair search by Verlet lists, rebuilt whenever a disc has moved half the skin.

use super::{PairSearch, observed, rows};
use crate::method::pairwise::state::MovingDiscs;
use stripmine_kernels::InstructionSet;
use stripmine_kernels::backend::Precision;
use stripmine_kernels::in_pieces;
use stripmine_kernels::isa::{AlignedColumn, ProgramError};
use stripmine_kernels::law::{Law, ObservationRequest};
use stripmine_kernels::sweep::fast::{
    CellGrid, DisplacementLimit, ForceRecords, PairBuffer, PositionCopies, RankShare, RecordEntry, RowLayout,
    Sectors, StateRecords, Sweep, SweepReport, VerletList,
};

/// Verlet lists, and the sectors of the discs when they were built.
pub(crate) struct ListSearch<S, P> {
    sectors: Sectors,
    sweep: Sweep<PairBuffer<P>>,
    share: Option<RankShare>,
    listed: ListedPairs<S>,
}

/// First alignment number of the positions at the build; columns of the state and sums have smaller ones.
const MADE_AT: usize = 28;

/// Lists with the positions at which they were built.
pub(crate) struct ListedPairs<S> {
    list: Option<VerletList>,
    skin: f64,
    /// Positions when the lists were built.
    made_at: [AlignedColumn<S>; 2],
    made: u64,
}

impl<S: Precision, P: Precision> ListSearch<S, P> {
    /// Creates a search without lists, for `discs` discs whose pairs act up to a distance `reach` (length). Listed pairs may be farther apart by
    /// `skin` (length); sectors are wide enough for both.
    pub(crate) fn new(grid: CellGrid, discs: usize, reach: f64, skin: f64) -> Self {
        let sectors = Sectors::new(grid, discs, reach);
        let sweep = Sweep::new(rows::<S, P, _>(&sectors));
        let listed = ListedPairs { list: None, skin, made_at: Default::default(), made: 0 };
        ListSearch { sectors, sweep, share: None, listed }
    }
}

impl<S: Precision, P: Precision> PairSearch<S, P> for ListSearch<S, P> {
    type Cells = Sectors;

    fn emptied(&self, discs: usize, share: RankShare) -> Self {
        let sectors = self.sectors.empty_copy(discs);
        let sweep = Sweep::for_share(rows::<S, P, _>(&sectors), Some(&share));
        let ListedPairs { skin, made, .. } = self.listed;
        let listed = ListedPairs { list: None, skin, made_at: Default::default(), made };
        ListSearch { sectors, sweep, share: Some(share), listed }
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
        let [x, y] = &self.listed.made_at;
        (DisplacementLimit::From { positions: [x, y], distance: 0.5 * self.listed.skin }, None)
    }

    fn sweep<L: Law<2> + Sync>(
        &mut self,
        law: &L,
        discs: &StateRecords<S>,
        sums: &mut ForceRecords<P>,
        asked: ObservationRequest,
        set: InstructionSet,
    ) -> Result<SweepReport, ProgramError> {
        match &self.listed.list {
            Some(list) => self.sweep.run(law, list, discs, sums, asked, set),
            None => Ok(SweepReport::default()),
        }
    }

    fn observe<L: Law<2> + Sync>(
        &self,
        law: &L,
        discs: &StateRecords<f64>,
        _: f64,
        set: InstructionSet,
    ) -> Result<SweepReport, ProgramError> {
        match &self.listed.list {
            Some(list) => observed(law, list, self.share.as_ref(), discs, set),
            None => Ok(SweepReport::default()),
        }
    }

    fn make_lists(&mut self, state: &MovingDiscs<S>) {
        let ListSearch { sectors, listed, .. } = self;
        let records = &state.records;
        for (axis, made_at) in listed.made_at.iter_mut().enumerate() {
            if made_at.len() != records.discs() {
                *made_at = AlignedColumn::zeros(MADE_AT + axis, records.discs());
            }
            in_pieces(made_at, |first, piece| {
                let discs = (first..).zip(piece);
                discs.for_each(|(disc, made_at)| *made_at = records.get(RecordEntry::of(axis, 0), disc));
            });
        }
        // Free the old list first: it is as large as the new one.
        listed.list = None;
        listed.list = Some(VerletList::new(sectors, records, listed.skin));
        listed.made += 1;
    }

    fn set_lists_made(&mut self, made: u64) {
        self.listed.made = made;
    }

    fn lists(&self) -> Option<&ListedPairs<S>> {
        Some(&self.listed)
    }
}

impl<S: Precision> ListedPairs<S> {
    /// Number of listed pairs.
    pub(crate) fn entries(&self) -> usize {
        self.list.as_ref().map_or(0, VerletList::entries)
    }

    /// Number of listed pairs in some rows of sectors.
    pub(crate) fn entries_of(&self, rows: std::ops::Range<usize>) -> usize {
        self.list.as_ref().map_or(0, |list| list.entries_in_rows(rows))
    }

    /// Number of list builds.
    pub(crate) fn made(&self) -> u64 {
        self.made
    }

    /// Largest gap of a listed pair (length).
    pub(crate) fn skin(&self) -> f64 {
        self.skin
    }

    /// Positions of the discs along an axis when the lists were built.
    pub(crate) fn made_at(&self, axis: usize) -> &[S] {
        &self.made_at[axis]
    }

    /// True if a disc has moved farther from there than half the skin.
    pub(crate) fn has_strayed(&self, disc: usize, place: [f64; 2]) -> bool {
        let [dx, dy] = [0, 1].map(|axis| place[axis] - self.made_at[axis][disc].to_f64());
        dx * dx + dy * dy > 0.25 * self.skin * self.skin
    }
}
