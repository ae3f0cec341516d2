//! Part of one rank: its discs, nearby discs of its neighbours, and their processing by order of the first rank.
//!
//! ```text
//! discs in memory    owned | of other ranks, near these | walls, on every rank
//! ```
//!
//! The discs stay the same between two *migrations*. Owned discs may meanwhile move some rows beyond the rank's own ([`BandLayout`]); the sweep allows
//! for that, and when one has moved farther, all ranks redistribute their discs. Neighbours' discs receive positions and velocities from their own
//! rank at every step, and then change cells as they do there.

use super::layout::BandLayout;
use super::wire::{
    CrossedPeriods, DiscRecord, ForcesReport, NamedColumns, RankOrder, RankSample, StepReport, entries,
};
use crate::method::PhysicsFailure;
use crate::method::pairwise::cells::CellChange;
use crate::method::pairwise::search::{PairSearch, SearchCells};
use crate::method::pairwise::{NameableDiscs, PairEngine, Phase, PrescribedMotion, SteppingDiscs};
use crate::ranks::{Parcel, RankError, Ranks, numbers};
use serde::{Deserialize, Serialize};
use std::collections::{HashMap, HashSet};
use std::ops::Range;
use std::time::Instant;
use stripmine_kernels::backend::Precision;
use stripmine_kernels::isa::{Element, ProgramError};
use stripmine_kernels::law::ObservationRequest;
use stripmine_kernels::sweep::fast::{
    BandReport, PassReport, RankShare, RecordEntry, RowLayout, StateRecords,
};

/// Part of a rank, or its failure with the rank that must report it.
pub(super) type PartStart = Result<Box<dyn RankPart>, (Box<dyn Ranks>, PhysicsFailure)>;

/// Part of a rank, independent of precision and search.
pub(super) trait RankPart: Send {
    /// Connection to the other ranks.
    fn ranks(&self) -> &dyn Ranks;

    /// Engine with its discs.
    fn engine(&self) -> &dyn SteppingDiscs;

    /// Mutable access to the engine.
    fn engine_mut(&mut self) -> &mut dyn SteppingDiscs;

    /// Prescribed motion of discs that no force moves, if they move.
    fn prescribed(&self) -> Option<PrescribedMotion>;

    /// Columns of values of each disc, without entries, and columns shared by all discs.
    fn columns(&self) -> [NamedColumns; 2];

    /// Executes an order; returns this rank's answer for the first rank.
    fn execute_order(&mut self, order: RankOrder) -> Result<Parcel, RankError>;

    /// Takes a sample for the first rank.
    fn take_sample(&self, what: RankSample) -> Result<Parcel, RankError>;
}

/// Part of a rank with an engine of some precisions and search.
pub(super) struct RankWorker<S, P, Q> {
    pub(super) ranks: Box<dyn Ranks>,
    pub(super) engine: PairEngine<S, P, Q>,
    pub(super) layout: BandLayout,
    /// Discs by their numbers in the scene, rising: those sent to the ranks below and above, and those received from them.
    pub(super) to: [Vec<u32>; 2],
    pub(super) from: [Vec<u32>; 2],
    /// Indices of these discs in memory after the sort counted in `ordered`.
    to_in_memory: [Vec<u32>; 2],
    from_in_memory: [Vec<u32>; 2],
    /// Longest range in memory without discs to be sent: most of those that move.
    inner: Range<usize>,
    ordered: u64,
    /// Rows of discs at the last migration, for discs that have changed cells since.
    pub(super) homes: HashMap<u32, usize>,
}

impl<S: Precision, P: Precision, Q: PairSearch<S, P>> RankWorker<S, P, Q> {
    /// Takes its part of the start; `engine` has no discs yet.
    ///
    /// # Errors
    /// Returns the failure, with the connection needed to report it.
    pub(super) fn new(
        ranks: Box<dyn Ranks>,
        engine: PairEngine<S, P, Q>,
    ) -> Result<Self, (Box<dyn Ranks>, PhysicsFailure)> {
        let rows = engine.search.rows();
        let is_periodic = engine.search.cells().grid().periodic[1];
        let layout = BandLayout::new(rows, is_periodic, &vec![1; rows.bands().len()], ranks.count());
        let none = || [vec![], vec![]];
        let mut worker = RankWorker {
            ranks,
            engine,
            layout,
            to: none(),
            from: none(),
            to_in_memory: none(),
            from_in_memory: none(),
            inner: 0..0,
            ordered: 0,
            homes: HashMap::new(),
        };
        let start = worker.engine.start.clone();
        // Its rank reports a disc outside all rows when it places it.
        let row = |number: usize| worker.engine.row_at(start.all()[number].planar_position()).unwrap_or(0);
        let rows: Vec<u32> = (0..start.len()).map(|number| row(number) as u32).collect();
        worker.take_share(&rows);
        if let Err(failure) = worker.engine.place_discs() {
            return Err((worker.ranks, failure));
        }
        worker.index_exchanged_discs();
        Ok(worker)
    }

    /// Finds the indices in memory of the discs that are sent and received.
    pub(super) fn index_exchanged_discs(&mut self) {
        let numbers = self.engine.state.numbers();
        let mut wanted = vec![0_u64; self.engine.start.len().div_ceil(64)];
        let all = || self.to.iter().chain(&self.from).flatten();
        all().for_each(|&number| wanted[number as usize / 64] |= 1 << (number % 64));
        let is_wanted = |number: &u32| wanted[*number as usize / 64] >> (number % 64) & 1 == 1;
        let in_memory: HashMap<u32, u32> =
            numbers.iter().copied().zip(0..).filter(|(number, _)| is_wanted(number)).collect();
        let places = |numbers: &Vec<u32>| numbers.iter().map(|number| in_memory[number]).collect();
        self.to_in_memory = self.to.each_ref().map(places);
        self.from_in_memory = self.from.each_ref().map(places);
        self.inner = longest_inner_range(&self.to_in_memory, self.engine.state.moving());
        self.ordered = self.engine.orders;
    }

    /// Makes one step; returns the report for the first rank.
    pub(super) fn advance(&mut self) -> Result<StepReport, RankError> {
        self.engine.sort_if_due();
        self.reindex_if_sorted();
        let passed = self.pass()?;
        let (kept, far) = match passed {
            Ok(passed) => {
                self.engine.finish_advance();
                let mut timings = self.engine.elapsed.timings;
                let kept = timings.time(Phase::Index, || self.update_cells_or_lists(&passed.left))?;
                self.engine.elapsed.timings = timings;
                (kept, passed.far)
            }
            Err(error) => (Err(error.into()), vec![]),
        };
        // Lists may have been rebuilt.
        self.reindex_if_sorted();
        Ok(self.report(kept, &far))
    }

    /// Finds the indices again if the discs were sorted since.
    fn reindex_if_sorted(&mut self) {
        if self.ordered != self.engine.orders {
            self.index_exchanged_discs();
        }
    }

    /// Updates all cells; returns the report for the first rank.
    pub(super) fn settle(&mut self) -> StepReport {
        let moved = self.engine.settle_all();
        self.reindex_if_sorted();
        self.report(moved, &[])
    }

    /// Updates cells or lists after a step: all ranks rebuild their lists, or none.
    fn update_cells_or_lists(
        &mut self,
        left: &[u32],
    ) -> Result<Result<Vec<CellChange>, PhysicsFailure>, RankError> {
        if self.engine.search.lists().is_none() {
            return Ok(self.engine.update_cells(left));
        }
        let stale = self.engine.is_stale(left);
        let own = match stale {
            Ok(false) => ListState::Fresh,
            Ok(true) => ListState::Stale,
            Err(_) => ListState::Failed,
        };
        let all = self.ranks.gather_messages(own)?;
        let said = self.ranks.broadcast_message(all.into_iter().max())?;
        Ok(match stale {
            Err(failure) => Err(failure),
            Ok(_) if said == ListState::Stale => self.engine.rebuild_lists(),
            Ok(_) => Ok(vec![]),
        })
    }

    /// Reports discs that changed cells and discs that moved far.
    fn report(&mut self, moved: Result<Vec<CellChange>, PhysicsFailure>, far: &[u32]) -> StepReport {
        let (moved, failure) = moved.map_or_else(|failure| (vec![], Some(failure)), |moved| (moved, None));
        // Crossings of walls are not counted.
        let grains = self.engine.start.grain_count();
        let crosses = |it: &&CellChange| it.periods != [0.0; 2] && (it.number as usize) < grains;
        let crossed = moved.iter().filter(crosses).map(|it| (it.number as usize, it.periods)).collect();
        let mut has_strayed = false;
        for &CellChange { number, rows: [from, to], .. } in &moved {
            let home = *self.homes.entry(number).or_insert(from);
            has_strayed |= self.layout.has_strayed(home, to);
        }
        StepReport {
            failure,
            far: far.iter().map(|&disc| self.record(disc)).collect(),
            crossed,
            has_strayed,
            shared_cells: self.engine.search.cells().shared_cells(&|disc| self.is_reported_here(disc)),
        }
    }

    /// Describes a disc for other ranks.
    fn record(&self, disc: u32) -> DiscRecord {
        let (engine, disc) = (&self.engine, disc as usize);
        DiscRecord {
            number: engine.number(disc),
            is_grain: disc < engine.state.grains(),
            id: engine.id(disc),
            position: engine.position(disc),
            velocity: engine.velocity(disc),
            radius: engine.radius(disc),
        }
    }

    /// True if this rank reports a disc: one that it owns, or a wall in its rows.
    fn is_reported_here(&self, disc: usize) -> bool {
        let engine = &self.engine;
        let in_own_rows = || {
            let row = engine.search.cells().cell(disc).map_or(0, |cell| cell[1]);
            self.layout.owner(row) == self.ranks.rank()
        };
        disc < engine.state.moving() || disc >= engine.state.grains() && in_own_rows()
    }

    /// Discs that this rank reports.
    fn reported_discs(&self) -> Vec<u32> {
        let discs = 0..self.engine.state.len();
        discs.filter(|&disc| self.is_reported_here(disc)).map(|disc| disc as u32).collect()
    }

    /// Advances the discs by one step, first those that neighbours need: the others advance while these messages are sent.
    fn pass(&mut self) -> Result<Result<PassReport, ProgramError>, RankError> {
        debug_assert_eq!(self.ordered, self.engine.orders, "indices of discs in memory are out of date");
        let RankWorker { ranks, engine, .. } = self;
        let moving = engine.state.moving();
        let inner = self.inner.clone();
        let outer = [0..inner.start, inner.end..moving].map(|discs| engine.pass(discs));
        let [first, last] = match outer {
            [Ok(first), Ok(last)] => [first, last],
            // All ranks have these instructions, or none.
            [Err(error), _] | [_, Err(error)] => return Ok(Err(error)),
        };
        let begun = Instant::now();
        let parcels = self.to_in_memory.each_ref().map(|discs| of_discs(&engine.state.records, discs));
        parcels.iter().for_each(|parcel| engine.elapsed.timings.sent(parcel.0.len() as u64));
        let (mut between, mut hidden) = (Ok(PassReport::default()), 0.0);
        let heard = ranks.halo(parcels, &mut || {
            let begun = Instant::now();
            between = engine.pass(inner.clone());
            hidden = begun.elapsed().as_secs_f64();
        })?;
        for ((from, parcel), discs) in ranks.neighbours().into_iter().zip(&heard).zip(&self.from_in_memory) {
            put_discs((from, parcel), &mut engine.state.records, discs)?;
            for &disc in discs {
                let disc = disc as usize;
                let place = engine.state.place(disc);
                engine.search.cells_mut().settle(disc, place);
            }
        }
        self.engine.elapsed.timings.add(Phase::Halo, begun.elapsed().as_secs_f64() - hidden);
        Ok(between.map(|between| first.joined_with(between).joined_with(last)))
    }

    /// Computes all forces; returns the report for the first rank.
    pub(super) fn compute_forces(&mut self, asked: ObservationRequest) -> ForcesReport {
        let met = self.engine.compute_forces(asked);
        let (met, failure) =
            met.map_or_else(|failure| (Default::default(), Some(failure)), |met| (met, None));
        let deep = met.deep.iter().map(|pair| pair.map(|disc| self.record(disc))).collect();
        ForcesReport { distributed: Ok(()), failure, bands: met.of_bands, deep }
    }

    /// Packs some values of each disc that this rank reports.
    pub(super) fn each_own<const N: usize>(&self, of: impl Fn(usize) -> [f64; N]) -> Parcel {
        let discs = self.reported_discs();
        let numbers = Parcel::of_numbers(discs.iter().flat_map(|&disc| of(disc as usize)));
        Parcel::of(&(self.numbers(&discs), numbers))
    }

    /// Packs position, angle and their rates of each disc at the end of the step.
    pub(super) fn standing(&self) -> Parcel {
        let (engine, discs) = (&self.engine, self.reported_discs());
        let mut numbers = Vec::with_capacity(6 * discs.len());
        engine.for_each_row_of(&discs, |disc, [[x, u], [y, v], [angle, omega]]| {
            let [x, y] = engine.absolute_position(disc, [*x, *y]);
            numbers.extend([x, y, *angle, *u, *v, *omega]);
        });
        Parcel::of(&(self.numbers(&discs), Parcel::of_numbers(numbers)))
    }

    /// Packs the entries of a column of the state.
    pub(super) fn column(&self, place: usize) -> Parcel {
        let (discs, source) = (self.reported_discs(), self.engine.sources()[place]);
        let entries = entries(&self.engine.column_of(source, &discs));
        Parcel::of(&(self.numbers(&discs), Parcel::of_numbers(entries)))
    }

    /// Numbers of these discs in the scene.
    pub(super) fn numbers(&self, discs: &[u32]) -> Vec<u32> {
        discs.iter().map(|&disc| self.engine.number(disc as usize) as u32).collect()
    }

    /// Discs of this rank that belong to no cell or have a value that is not finite.
    pub(super) fn unfit(&self) -> Vec<usize> {
        let own: HashSet<u32> = self.numbers(&self.reported_discs()).into_iter().collect();
        self.engine.unfit_discs().into_iter().filter(|&number| own.contains(&(number as u32))).collect()
    }

    /// Sweeps its bands at the end of the step.
    pub(super) fn contacts(&self) -> Result<Vec<BandReport>, RankError> {
        debug_assert_eq!(self.ordered, self.engine.orders, "indices of discs in memory are out of date");
        let mut corrected = self.engine.corrected_discs();
        let parcels = self.to_in_memory.each_ref().map(|discs| of_discs(&corrected.records, discs));
        let heard = self.ranks.halo(parcels, &mut || {})?;
        let neighbours = self.ranks.neighbours();
        for ((from, parcel), discs) in neighbours.into_iter().zip(&heard).zip(&self.from_in_memory) {
            put_discs((from, parcel), &mut corrected.records, discs)?;
        }
        Ok(self.engine.contacts_met(&corrected).of_bands)
    }

    /// Number of pairs listed by its rows.
    pub(super) fn listed(&self) -> usize {
        let rows = self.layout.share(self.ranks.rank()).rows;
        self.engine.search.lists().map_or(0, |lists| lists.entries_of(rows))
    }

    /// Adds the periods that discs of other ranks have crossed. The first rank knows them from their reports.
    pub(super) fn add_reported_crossings(&mut self, crossed: &[(usize, CrossedPeriods)]) {
        let own = self.ranks.rank();
        for &(rank, (number, periods)) in crossed {
            if own > 0 && rank != own {
                self.engine.elapsed.crossings.add(number, periods);
            }
        }
    }
}

/// State of the lists after a step. The largest reported by any rank applies to all.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
enum ListState {
    Fresh,
    Stale,
    Failed,
}

/// Entries of records that a sweep reads and that change.
fn swept_entries<T: Element>(records: &StateRecords<T>) -> &'static [RecordEntry] {
    use RecordEntry::{Omega, Vx, Vy, X, Y};
    if records.has(Omega) { &[X, Y, Vx, Vy, Omega] } else { &[X, Y, Vx, Vy] }
}

/// Packs the swept entries of some discs.
fn of_discs<T: Element>(records: &StateRecords<T>, discs: &[u32]) -> Parcel {
    let entries = swept_entries(records).iter();
    let numbers = entries.flat_map(|&entry| discs.iter().map(move |&disc| records.get(entry, disc as usize)));
    Parcel::of_numbers(numbers.map(|number| number.to_f64()))
}

/// Stores the entries received from a rank in records.
fn put_discs<T: Element>(
    (from, parcel): (usize, &Parcel),
    records: &mut StateRecords<T>,
    discs: &[u32],
) -> Result<(), RankError> {
    let entries = swept_entries(records);
    let mut numbers = numbers(&parcel.0, from, entries.len() * discs.len())?;
    for &entry in entries {
        let received = discs.iter().zip(numbers.by_ref());
        received.for_each(|(&disc, number)| records.set(entry, disc as usize, T::from_f64(number)));
    }
    Ok(())
}

/// Longest range in memory of moving discs that contains none to be sent. Discs are sorted by rows, so this is nearly all of them.
fn longest_inner_range(told: &[Vec<u32>; 2], moving: usize) -> Range<usize> {
    let mut told: Vec<usize> = told.iter().flatten().map(|&disc| disc as usize).collect();
    told.sort_unstable();
    let before = [0].into_iter().chain(told.iter().map(|disc| disc + 1));
    let behind = told.iter().copied().chain([moving]);
    before.zip(behind).map(|(start, end)| start..end.max(start)).max_by_key(Range::len).unwrap_or(0..0)
}

/// Share of all rows, for a search without discs.
pub(super) fn all_rows(rows: RowLayout) -> RankShare {
    RankShare { rows: 0..rows.count, margin: 0 }
}
