//! The part of one rank: its discs, those of its neighbours that stand near them, and what is done with them when the first rank says so.
//!
//! ```text
//! discs in memory    moved here | of other ranks, near these | walls, on every rank
//! ```
//!
//! Between two *migrations* it is always the same discs. Those that are moved here may meanwhile go some rows beyond the rank's own ones
//! ([`Layout`]); the sweep is made for that, and when one has gone farther, all ranks deal out their discs again. Neighbours' discs get their places and velocities
//! from their own rank at every step, and then change cells as these do there.

use super::layout::Layout;
use super::wire::{Record, entries, put_band, put_failure};
use crate::io::checkpoint::Column;
use crate::method::Failure;
use crate::method::pairwise::cells::Moved;
use crate::method::pairwise::observing::Corrected;
use crate::method::pairwise::search::{Cells, Search};
use crate::method::pairwise::{Dynamics, Engine, Named, Phase, Stepping};
use crate::ranks::{Gone, Parcel, Ranks, Reader};
use std::collections::HashMap;
use std::ops::Range;
use std::time::Instant;
use stripmine_kernels::backend::Precision;
use stripmine_kernels::isa::ProgramError;
use stripmine_kernels::law::Asked;
use stripmine_kernels::sweep::fast::{Passed, Rows, Share};

/// Columns by their names.
pub(super) type Columns = Vec<(String, Column)>;

/// The part of a rank, or why it has none and who is to say so.
pub(super) type Part<S, P, Q, D> = Result<Worker<S, P, Q, D>, (Box<dyn Ranks>, Failure)>;

/// The part of a rank.
pub(super) struct Worker<S, P, Q, D> {
    pub(super) ranks: Box<dyn Ranks>,
    pub(super) engine: Engine<S, P, Q, D>,
    pub(super) layout: Layout,
    /// Discs by their numbers in the scene, rising: those to tell the ranks below and above of, and those that these tell of.
    pub(super) to: [Vec<u32>; 2],
    pub(super) from: [Vec<u32>; 2],
    /// The same by their places in memory, of when the discs were put in order that often.
    to_in_memory: [Vec<u32>; 2],
    from_in_memory: [Vec<u32>; 2],
    /// The discs that lie in memory between those to be told of: most of those that move.
    inner: Range<usize>,
    ordered: u64,
    /// In which rows discs were at the last migration that have changed cells since.
    pub(super) homes: HashMap<u32, usize>,
}

impl<S: Precision, P: Precision, Q: Search<S, P>, D: Dynamics> Worker<S, P, Q, D> {
    /// Takes its part of the start; `engine` has no discs yet.
    ///
    /// # Errors
    /// The failure, and the rank, which is to say so.
    pub(super) fn new(
        ranks: Box<dyn Ranks>,
        engine: Engine<S, P, Q, D>,
    ) -> Result<Self, (Box<dyn Ranks>, Failure)> {
        let rows = engine.search.rows();
        let is_periodic = engine.search.cells().grid().periodic[1];
        let layout = Layout::new(rows, is_periodic, &vec![1; rows.bands().len()], ranks.count());
        let none = || [vec![], vec![]];
        let mut worker = Worker {
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
        // One that is in no row is named by its rank when it takes its place.
        let row = |number: usize| worker.engine.row_at(start.all()[number].place()).unwrap_or(0);
        let rows: Vec<u32> = (0..start.len()).map(|number| row(number) as u32).collect();
        worker.take_part(&rows);
        if let Err(failure) = worker.engine.take_their_places() {
            return Err((worker.ranks, failure));
        }
        worker.look_up();
        Ok(worker)
    }

    /// Looks up where in memory the discs are that are told of.
    pub(super) fn look_up(&mut self) {
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
        self.inner = inner_of(&self.to_in_memory, self.engine.state.moving());
        self.ordered = self.engine.orders;
    }

    /// One step on; what the first rank is to know of it.
    pub(super) fn advance(&mut self) -> Result<Parcel, Gone> {
        self.engine.put_in_order_if_due();
        self.look_up_again();
        let passed = self.pass()?;
        let (kept, far) = match passed {
            Ok(passed) => {
                self.engine.has_passed();
                let mut timings = self.engine.elapsed.timings;
                let kept = timings.time(Phase::Index, || self.keep(&passed.left))?;
                self.engine.elapsed.timings = timings;
                (kept, passed.far)
            }
            Err(error) => (Err(error.into()), vec![]),
        };
        // Lists were made again, perhaps.
        self.look_up_again();
        Ok(self.report(kept, &far))
    }

    /// Looks up where discs are in memory, where they were put in order since.
    fn look_up_again(&mut self) {
        if self.ordered != self.engine.orders {
            self.look_up();
        }
    }

    /// Brings all cells up to date; what the first rank is to know of it.
    pub(super) fn settle(&mut self) -> Parcel {
        let moved = self.engine.settle_all();
        self.look_up_again();
        self.report(moved, &[])
    }

    /// Cells or lists after a step: lists are made again by all ranks or by none.
    fn keep(&mut self, left: &[u32]) -> Result<Result<Vec<Moved>, Failure>, Gone> {
        if self.engine.search.lists().is_none() {
            return Ok(self.engine.keep_in_cells(left));
        }
        // The largest that a rank says holds for all.
        const FRESH: usize = 0;
        const STALE: usize = 1;
        const FAILED: usize = 2;
        let stale = self.engine.is_stale(left);
        let mut own = Parcel::new();
        own.push(stale.as_ref().map_or(FAILED, |&stale| if stale { STALE } else { FRESH }));
        let all = self.ranks.gather(own)?;
        let said = all.into_iter().max_by_key(|parcel| parcel.read().count());
        let said = self.ranks.tell(said)?.read().count();
        Ok(match stale {
            Err(failure) => Err(failure),
            Ok(_) if said == STALE => self.engine.list_again(),
            Ok(_) => Ok(vec![]),
        })
    }

    /// What became of discs that change cells, and discs that moved far.
    pub(super) fn report(&mut self, moved: Result<Vec<Moved>, Failure>, far: &[u32]) -> Parcel {
        let mut parcel = Parcel::new();
        put_failure(moved.as_ref().err(), &mut parcel);
        let moved = moved.unwrap_or_default();
        parcel.push(far.len());
        far.iter().for_each(|&disc| self.record(disc as usize).put(&mut parcel));
        // Walls cross nothing that is counted.
        let grains = self.engine.start.grain_count();
        let crosses = |it: &&Moved| it.periods != [0.0; 2] && (it.number as usize) < grains;
        let crossed: Vec<&Moved> = moved.iter().filter(crosses).collect();
        parcel.push(crossed.len());
        for &&Moved { number, periods, .. } in &crossed {
            parcel.push(number as usize);
            parcel.numbers(periods);
        }
        let mut has_strayed = false;
        for &Moved { number, rows: [from, to], .. } in &moved {
            let home = *self.homes.entry(number).or_insert(from);
            has_strayed |= self.layout.has_strayed(home, to);
        }
        parcel.push(usize::from(has_strayed));
        parcel.push(self.engine.search.cells().shared_cells(&|disc| self.is_own(disc)));
        parcel
    }

    /// A disc as others know it.
    pub(super) fn record(&self, disc: usize) -> Record {
        let engine = &self.engine;
        Record {
            number: engine.number(disc),
            is_grain: disc < engine.state.grains(),
            id: engine.id(disc),
            position: engine.position(disc),
            velocity: engine.velocity(disc),
            radius: engine.radius(disc),
        }
    }

    /// Whether this rank speaks for a disc: for those that it moves, and for walls in its rows.
    fn is_own(&self, disc: usize) -> bool {
        let engine = &self.engine;
        let in_own_rows = || {
            let row = engine.search.cells().cell(disc).map_or(0, |cell| cell[1]);
            self.layout.owner(row) == self.ranks.rank()
        };
        disc < engine.state.moving() || disc >= engine.state.grains() && in_own_rows()
    }

    /// The discs that it speaks for.
    fn own(&self) -> Vec<u32> {
        let discs = 0..self.engine.state.len();
        discs.filter(|&disc| self.is_own(disc)).map(|disc| disc as u32).collect()
    }

    /// Moves the discs one step on, those first of which the neighbours are told: while these messages are under way all others move.
    fn pass(&mut self) -> Result<Result<Passed, ProgramError>, Gone> {
        debug_assert_eq!(self.ordered, self.engine.orders, "places of discs in memory are those of before");
        let Worker { ranks, engine, .. } = self;
        let moving = engine.state.moving();
        let inner = self.inner.clone();
        let outer = [0..inner.start, inner.end..moving].map(|discs| engine.pass(discs));
        let [first, last] = match outer {
            [Ok(first), Ok(last)] => [first, last],
            // Every rank has these instructions, or none has.
            [Err(error), _] | [_, Err(error)] => return Ok(Err(error)),
        };
        let begun = Instant::now();
        let parcels = self.to_in_memory.each_ref().map(|discs| {
            let mut parcel = Parcel::new();
            for column in engine.state.swept() {
                parcel.numbers(discs.iter().map(|&disc| column[disc as usize].to_f64()));
            }
            parcel
        });
        parcels.iter().for_each(|parcel| engine.elapsed.timings.sent(8 * parcel.0.len() as u64));
        let (mut between, mut hidden) = (Ok(Passed::default()), 0.0);
        let heard = ranks.halo(parcels, &mut || {
            let begun = Instant::now();
            between = engine.pass(inner.clone());
            hidden = begun.elapsed().as_secs_f64();
        })?;
        for (parcel, discs) in heard.iter().zip(&self.from_in_memory) {
            let mut reader = parcel.read();
            for column in self.engine.state.swept_mut() {
                discs.iter().for_each(|&disc| column[disc as usize] = S::from_f64(reader.number()));
            }
            for &disc in discs {
                let disc = disc as usize;
                let place = self.engine.state.place(disc);
                self.engine.search.cells_mut().settle(disc, place);
            }
        }
        self.engine.elapsed.timings.add(Phase::Halo, begun.elapsed().as_secs_f64() - hidden);
        Ok(between.map(|between| first.and(between).and(last)))
    }

    /// All forces; what the first rank is to know of them.
    pub(super) fn compute_forces(&mut self, asked: Asked) -> Result<Parcel, Gone> {
        let met = self.engine.compute_forces(asked);
        let mut parcel = Parcel::new();
        put_failure(met.as_ref().err(), &mut parcel);
        let met = met.unwrap_or_default();
        parcel.push(met.of_bands.len());
        met.of_bands.iter().for_each(|band| put_band(band, &mut parcel));
        parcel.push(met.deep.len());
        for disc in met.deep.iter().flatten() {
            self.record(*disc as usize).put(&mut parcel);
        }
        Ok(parcel)
    }

    /// The discs that it speaks for, each with what is asked of it.
    pub(super) fn each_own(&self, what: What) -> Parcel {
        let discs = self.own();
        let mut parcel = Parcel::new();
        let engine = &self.engine;
        parcel.counts(discs.iter().map(|&disc| engine.number(disc as usize) as u64));
        match what {
            What::Standing => {
                let columns = [0, 1, 2].map(|freedom| {
                    let turns = freedom < engine.system.freedoms;
                    if turns { engine.corrected_column(freedom) } else { [vec![], vec![]] }
                });
                for &disc in &discs {
                    let disc = disc as usize;
                    let [values, rates] = [0, 1]
                        .map(|k| [0, 1, 2].map(|it: usize| columns[it][k].get(disc).copied().unwrap_or(0.0)));
                    let position = engine.seen_from_origin(disc, [values[0], values[1]]);
                    parcel.numbers(position.into_iter().chain([values[2]]).chain(rates));
                }
            }
            What::Column(place) => {
                parcel.numbers(entries(&engine.column_of(engine.sources()[place], &discs)));
            }
            What::Forces => {
                discs.iter().for_each(|&disc| parcel.numbers(engine.force_on(disc as usize)));
            }
            What::Velocities => {
                discs.iter().for_each(|&disc| parcel.numbers(engine.velocity(disc as usize)));
            }
        }
        parcel
    }

    /// Those of its discs that belong to no cell, or of which a number is not finite.
    pub(super) fn unfit(&self) -> Parcel {
        let own: std::collections::HashSet<usize> =
            self.own().into_iter().map(|disc| self.engine.number(disc as usize)).collect();
        let unfit = self.engine.unfit_discs().into_iter().filter(|number| own.contains(number));
        let unfit: Vec<u64> = unfit.map(|number| number as u64).collect();
        let mut parcel = Parcel::new();
        parcel.counts(unfit.into_iter());
        parcel
    }

    /// What its bands meet at the end of the step.
    pub(super) fn contacts(&self) -> Result<Parcel, Gone> {
        debug_assert_eq!(self.ordered, self.engine.orders, "places of discs in memory are those of before");
        let mut corrected = self.engine.corrected_discs();
        let parcels = self.to_in_memory.each_ref().map(|discs| {
            let mut parcel = Parcel::new();
            discs
                .iter()
                .for_each(|&disc| parcel.numbers(of_corrected(&mut corrected, disc).map(|value| *value)));
            parcel
        });
        let heard = self.ranks.halo(parcels, &mut || {})?;
        for (parcel, discs) in heard.iter().zip(&self.from_in_memory) {
            let mut reader = parcel.read();
            for &disc in discs {
                of_corrected(&mut corrected, disc).for_each(|value| *value = reader.number());
            }
        }
        let met = self.engine.contacts_met(&corrected);
        let mut parcel = Parcel::new();
        parcel.push(met.of_bands.len());
        met.of_bands.iter().for_each(|band| put_band(band, &mut parcel));
        Ok(parcel)
    }

    /// Pairs that its rows have listed.
    pub(super) fn listed(&self) -> Parcel {
        let rows = self.layout.share(self.ranks.rank()).rows;
        let mut parcel = Parcel::new();
        parcel.push(self.engine.search.lists().map_or(0, |lists| lists.entries_of(rows)));
        parcel
    }

    /// Periods that discs of other ranks have crossed. The first rank knows of them from their reports.
    pub(super) fn hear_of_crossings(&mut self, reader: &mut Reader<'_>) {
        let own = self.ranks.rank();
        let count = reader.count();
        for _ in 0..count {
            let (rank, number) = (reader.count(), reader.count());
            let periods = reader.numbers();
            if own > 0 && rank != own {
                self.engine.elapsed.crossings.add(number, periods);
            }
        }
    }
}

/// The most that lie in memory beside each other, of some discs that move, and are none of those told of. Discs lie there by their rows, so these are all
/// but a few.
fn inner_of(told: &[Vec<u32>; 2], moving: usize) -> Range<usize> {
    let mut told: Vec<usize> = told.iter().flatten().map(|&disc| disc as usize).collect();
    told.sort_unstable();
    let before = [0].into_iter().chain(told.iter().map(|disc| disc + 1));
    let behind = told.iter().copied().chain([moving]);
    before.zip(behind).map(|(start, end)| start..end.max(start)).max_by_key(Range::len).unwrap_or(0..0)
}

/// What a sweep reads of a corrected disc.
fn of_corrected(corrected: &mut Corrected, disc: u32) -> impl Iterator<Item = &mut f64> {
    let disc = disc as usize;
    let Corrected { place, velocity, omega, .. } = corrected;
    place.iter_mut().chain(velocity).map(move |along| &mut along[disc]).chain(omega.get_mut(disc))
}

/// What may be asked of each disc.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum What {
    /// Position, angle, and the rates of the three, at the end of the step.
    Standing,
    /// One of the columns that the next step depends on, by its place among them: with all of them at once, the first rank would hold them three times.
    Column(usize),
    /// Force along x and y and torque.
    Forces,
    /// The velocity that the last predictor left.
    Velocities,
}

/// All rows, for a search that holds no discs yet.
pub(super) fn all_rows(rows: Rows) -> Share {
    Share { rows: 0..rows.count, margin: 0 }
}
