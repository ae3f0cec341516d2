//! Fast engine: finds the same events as the reference engine with a neighbour list per disc, collision predictions for a register of
//! partners at a time, and a queue that sorts only the next few events.
//!
//! - A disc has one event: its first collision, its wall, or the renewal of its list.
//! - A collision is stored with the disc that found it. Its partner keeps its own event, which may be later.
//! - If a partner changes its motion, the disc is not predicted again at once, but when its event is due.
//! - Discs are stored in memory in the order of their positions, and are sorted again now and then.
//!
//! Optimisations tried, with the rate relative to that before (2500 discs, ν = 0.1, 0.5 and 0.7; AVX-512, in the last seven rows
//! AVX2; paired rounds, the same events to the bit):
//!
//! | | rate | |
//! |---|---|---|
//! | rows of partners padded, so that no branch depends on their number | 1.03, 1.05, 1.06 | kept |
//! | the next events ordered by counting those before each, level by level | 1.01, 1.03, 1.03 | kept |
//! | no root for the time at which a disc leaves its list if it is still near enough at its next event | 1.02, 1.02, 1.03 | kept |
//! | periods subtracted only if a pair of the register is nearer across a side | 1.00, 1.00, 1.02 | kept: the reference engine gains a fifth |
//! | predictions of both discs of a collision interleaved register by register | 0.97, 0.92, 0.90 | registers spill |
//! | partners' lines loaded whole and transposed in registers | 1.00, 1.00, 0.97 | |
//! | times of expected events read only for partners that collide | 1.00 | |
//! | events sorted as numbers of 128 bits | 1.00 | |
//! | lists of 6, 7, 10 or 13 discs on average instead of 8 | 0.84 to 1.03 | |
//! | a collision stored with the disc that found it alone | 1.08, 1.15, 1.20 | kept |
//! | functions of an event inlined | 1.06, 1.05, 1.06 | kept |
//! | registered positions in slots of cells, compared a row of cells at a time, instead of chains | 1.29, 1.12, 1.05 | kept |
//! | the loop over events inside the function compiled for the instruction set; equal masses cancel | 0.95, 1.03, 1.05 | kept |
//! | with 250 000 discs: prefetched cells of the next renewals, and times of the next partners | 1.12, 1.01, 1.01 | kept |
//! | rows of 8 for lists of 4 or 5 discs on average | 1.02, 0.94, 0.82 | |
//! | times at which both discs of a collision leave their lists, computed together without a branch | 0.94, 0.93, – | |
//! | a renewed list compared with the one before, so that partners in both are not written | 0.95, 0.97, –; 1.08 with 250 000 discs | |

mod cells;
mod checkpoint;
mod grids;
mod leaving;
mod lists;
mod prefetch;
mod queue;

use crate::domain::BoxSide;
use crate::method::Snapshot;
use crate::method::hard_disks::engine::{
    EngineError, EventEngine, EventObserver, ExecutedEvent, FlyingDiscs,
};
use crate::method::hard_disks::event::Arena;
use crate::method::hard_disks::operations::Operations;
use grids::SizeClass;
use leaving::{free_path, leaving_time};
use lists::{DiscNeighbourLists, Radii};
use queue::EventQueue;
use stripmine_kernels::InstructionSet;
use stripmine_kernels::backend::{RegisterTask, Registers, Scalar, dispatch_native};
use stripmine_kernels::flight::{EarliestCollision, FlyingDisc, MOST_PARTNERS, ROW_UNIT, earliest_collision};
use stripmine_kernels::isa::AlignedColumn;

/// Average number of discs in a list.
const LISTED: f64 = 8.0;
/// Events per disc between sorts of the discs by position.
const SORTED_AFTER: u64 = 200;

/// Codes of wall events; other discs are given by their index in memory.
const WALL: [u32; 2] = [u32::MAX - 2, u32::MAX - 1];
/// Code of the renewal of a list.
const RENEWAL: u32 = u32::MAX;

/// Expected next event of a disc.
#[derive(Clone, Copy, Debug)]
struct ExpectedEvent {
    /// Index in memory of another disc, or one of the codes above.
    with: u32,
    /// Event count of the other disc at the prediction. If it is higher when the event is due, the prediction is invalid.
    events: u32,
}

impl ExpectedEvent {
    const RENEWAL: ExpectedEvent = ExpectedEvent { with: RENEWAL, events: 0 };
}

/// Order of a disc's expected event among events at the same time: the numbers of both discs, the smaller one first, or the number
/// of the disc and the code of the event.
#[inline(always)]
fn rank(numbers: &[u32], partners: &[ExpectedEvent], disc: u32) -> [u32; 2] {
    let (own, with) = (numbers[disc as usize], partners[disc as usize].with);
    let other = numbers.get(with as usize).copied().unwrap_or(with);
    if with < WALL[0] { [own.min(other), own.max(other)] } else { [own, with] }
}

/// Fast engine with its discs.
pub(crate) struct Fast {
    arena: Arena,
    set: InstructionSet,
    /// Discs in the order of memory.
    discs: AlignedColumn<FlyingDisc>,
    /// Number of each disc in memory, and index in memory of each number.
    numbers: AlignedColumn<u32>,
    places: Vec<u32>,
    lists: DiscNeighbourLists,
    displacement_limit: f64,
    largest: f64,
    classes: Vec<SizeClass>,
    /// True if all radii are equal.
    alike: bool,
    /// Mean free path (length).
    free_path: f64,
    /// Times of the next events, and their partners.
    queue: EventQueue,
    partners: AlignedColumn<ExpectedEvent>,
    /// Scratch of a prediction: collision times with the discs of the list.
    met: Box<[f64; MOST_PARTNERS]>,
    /// Time of the last event.
    time: f64,
    renewals: u64,
    operations: Operations,
    events: u64,
    /// Event count after which discs are sorted again.
    sorted_until: u64,
}

impl Fast {
    /// Takes the discs at a time; [`begin`](EventEngine::begin) finds their events.
    pub(super) fn new(arena: Arena, discs: Vec<FlyingDisc>, set: InstructionSet, time: f64) -> Fast {
        let count = discs.len();
        let largest = discs.iter().map(|disc| disc.radius).fold(0.0, f64::max);
        let displacement_limit =
            displacement_limit(&arena, discs.iter().map(|disc| disc.radius)).unwrap_or(0.1 * largest);
        let alike = discs.iter().all(|disc| disc.radius == largest);
        Fast {
            lists: DiscNeighbourLists::new(arena.domain, 0, displacement_limit, &[], LISTED, 0),
            classes: SizeClass::of(discs.iter().map(|disc| disc.radius)),
            arena,
            set,
            discs: AlignedColumn::new(0, discs),
            numbers: AlignedColumn::new(1, 0..count as u32),
            places: vec![0; count],
            displacement_limit,
            largest,
            alike,
            free_path: free_path(count as f64, largest, arena.domain.area()),
            queue: EventQueue::new(count),
            partners: AlignedColumn::filled(2, ExpectedEvent::RENEWAL, count),
            met: Box::new([f64::INFINITY; MOST_PARTNERS]),
            time,
            renewals: 0,
            operations: Operations::default(),
            events: 0,
            sorted_until: 0,
        }
    }

    /// Creates lists for `count` discs, with rows of at least `stride` entries.
    fn lists_of(&self, count: usize, stride: usize) -> DiscNeighbourLists {
        // Lists without discs take no memory.
        let classes = if count == 0 { &[] } else { self.classes.as_slice() };
        DiscNeighbourLists::new(self.arena.domain, count, self.displacement_limit, classes, LISTED, stride)
    }

    /// Sorts the discs by position at a time, registers all, and predicts the next event of each.
    fn sort_and_register(&mut self, time: f64) -> Result<(), EngineError> {
        let count = self.discs.len();
        let mut stride = self.lists.stride();
        // The old lists are released first: they are larger than all that sorting takes.
        self.lists = self.lists_of(0, 0);
        self.sort(time);
        loop {
            let mut lists = self.lists_of(count, stride);
            // A disc is registered within the displacement limit, which may have become smaller.
            let positions = self.discs.iter().map(|disc| self.registered(disc, time));
            let registered = lists.begin(Scalar::default(), positions, self.radii());
            self.lists = lists;
            let Err(full) = registered else { break };
            stride = self.lists.stride() + ROW_UNIT;
            if stride > MOST_PARTNERS {
                if self.displacement_limit < 0.02 * self.largest {
                    return Err(EngineError::Crowded(self.numbers[full as usize], MOST_PARTNERS - 1));
                }
                (self.displacement_limit, stride) = (0.7 * self.displacement_limit, 0);
            }
            self.lists = self.lists_of(0, 0);
        }
        self.queue.clear();
        self.partners.fill(ExpectedEvent::RENEWAL);
        self.renewals += count as u64;
        self.operations.cell_updates += count as u64;
        self.sorted_until = self.events + SORTED_AFTER * count as u64;
        let found = dispatch_native(self.set, PredictAllTask { engine: self, time });
        found.map_err(|_| EngineError::NoInstructions(self.set))
    }

    /// Sorts discs in memory by position, by interleaving the bits of their cell coordinates (Morton order).
    fn sort(&mut self, time: f64) {
        let edge = 2.0 * (self.largest + self.displacement_limit);
        let key = |disc: &FlyingDisc| {
            let at = self.arena.position_at(disc, time);
            let [x, y] =
                [0, 1].map(|axis| spread(((at[axis] - self.arena.domain.origin[axis]) / edge) as u32));
            x | y << 1
        };
        let discs = self.numbers.iter().zip(self.discs.iter());
        let mut order: Vec<(u64, u32, u32)> =
            discs.zip(0..).map(|((&number, disc), place)| (key(disc), number, place)).collect();
        order.sort_unstable();
        for (place, &(_, number, _)) in order.iter().enumerate() {
            self.numbers[place] = number;
            self.places[number as usize] = place as u32;
        }
        // In place, cycle by cycle of the permutation: two copies of the discs would be the peak of the memory.
        for begin in 0..order.len() {
            let first = self.discs[begin];
            let mut to = begin;
            loop {
                let from = std::mem::replace(&mut order[to].2, to as u32) as usize;
                if from == to {
                    break;
                }
                self.discs[to] = if from == begin { first } else { self.discs[from] };
                to = from;
            }
        }
    }

    fn radii(&self) -> Radii<'_> {
        Radii { equal: self.alike.then_some(self.largest), discs: &self.discs }
    }

    /// Predicts the next event of a disc at a time.
    #[inline(always)]
    fn predict<R: Registers<Lane = f64>>(&mut self, registers: R, disc: u32, now: f64) {
        let Fast { arena, discs, numbers, lists, queue, partners, met, operations, alike, largest, .. } =
            self;
        let (row, count) = lists.row(disc);
        let radius = alike.then_some(*largest);
        let found = earliest_collision(registers, &arena.space, discs, radius, (disc, row, count), now, met);
        let EarliestCollision { time, partners: first } = found;
        operations.predictions += count as u64;
        operations.searches += 1;
        operations.queue_moves += 1;
        let own = &discs[disc as usize];
        let (mut next, mut with) = (time, RENEWAL);
        if time < f64::INFINITY {
            with = row[first.trailing_zeros() as usize];
            let mut others = first & (first - 1);
            // Of two at one time, the one with the smaller number.
            while others != 0 {
                let other = row[others.trailing_zeros() as usize];
                if numbers[other as usize] < numbers[with as usize] {
                    with = other;
                }
                others &= others - 1;
            }
        }
        let (at_wall, axis) = arena.wall(own);
        if at_wall < next {
            (next, with) = (at_wall, WALL[axis]);
        }
        let leaves = leaving_time(
            arena,
            own,
            lists.registered_position(disc),
            lists.displacement_limit(),
            (now, next),
        );
        if leaves < next {
            (next, with) = (leaves, RENEWAL);
        }
        let events = discs.get(with as usize).map_or(0, |other| other.events as u32);
        partners[disc as usize] = ExpectedEvent { with, events };
        queue.set(disc, next, |disc| rank(numbers, partners, disc));
    }

    /// Renews the list of a disc at a time. Returns false if the list was full and all lists were rebuilt with more space.
    #[inline(always)]
    fn renew<R: Registers<Lane = f64>>(
        &mut self,
        registers: R,
        disc: u32,
        time: f64,
    ) -> Result<bool, EngineError> {
        let place = self.registered(&self.discs[disc as usize], time);
        self.renewals += 1;
        self.operations.cell_updates += 1;
        let Fast { lists, discs, alike, largest, .. } = self;
        let radii = Radii { equal: alike.then_some(*largest), discs };
        match lists.renew(registers.single(), disc, place, radii) {
            Ok(()) => Ok(true),
            Err(_) => self.sort_and_register(time).map(|()| false),
        }
    }

    /// Position at which a disc is registered: ahead of it by its expected flight before it leaves its list or collides.
    #[inline(always)]
    fn registered(&self, disc: &FlyingDisc, time: f64) -> [f64; 2] {
        let ([x, y], [u, v]) = (disc.at(&self.arena.space, time), disc.velocity_at(&self.arena.space, time));
        let speed = (u * u + v * v).sqrt();
        let flight = 0.9 * self.displacement_limit.min(self.free_path);
        let flight = if speed > 0.0 { flight / speed } else { 0.0 };
        let ahead = [x + flight * u, y + flight * v];
        let domain = &self.arena.domain;
        domain.wrapped([0, 1].map(|axis| match domain.sides[axis] {
            BoxSide::Periodic(_) => ahead[axis],
            _ => ahead[axis].clamp(domain.origin[axis], domain.origin[axis] + domain.length(axis)),
        }))
    }

    /// Implements [`EventEngine::run`] for a register type.
    #[inline(always)]
    fn run_on<R: Registers<Lane = f64>>(
        &mut self,
        registers: R,
        until: f64,
        most: u64,
        observer: &mut EventObserver<'_>,
    ) -> Result<bool, EngineError> {
        let most = most.saturating_mul(self.discs.len() as u64);
        loop {
            let Fast { queue, numbers, partners, .. } = self;
            let first = queue.first(registers, |disc| rank(numbers, partners, disc));
            let Some((time, first)) = first else { return Ok(false) };
            if time > until {
                return Ok(false);
            }
            if self.discs.len() > prefetch::OUT_OF_REACH {
                self.prefetch_next_events();
            }
            if time < self.time {
                return Err(EngineError::BackInTime(self.numbers[first as usize], time, self.time));
            }
            // Discs whose motion or list has changed; a single disc is listed twice.
            let ExpectedEvent { with, events } = self.partners[first as usize];
            let (changed, happened) = match with {
                RENEWAL => {
                    if self.renewals >= most {
                        return Ok(false);
                    }
                    if !self.renew(registers, first, time)? {
                        continue;
                    }
                    ([first; 2], None)
                }
                wall if wall >= WALL[0] => {
                    let number = self.numbers[first as usize];
                    let disc = &mut self.discs[first as usize];
                    let axis = (wall - WALL[0]) as u8;
                    ([first; 2], Some(ExecutedEvent::at_wall(&self.arena, (number, disc), axis, time)))
                }
                other => {
                    let (low, high) = (first.min(other), first.max(other));
                    let (left, right) = self.discs.split_at_mut(high as usize);
                    let (a, b) = (&mut left[low as usize], &mut right[0]);
                    let met = if other < first { &a } else { &b };
                    if met.events as u32 == events {
                        let [p, q] = [low, high].map(|disc| self.numbers[disc as usize]);
                        let happened = ExecutedEvent::collision(&self.arena, (p, a), (q, b), time);
                        ([first, other], Some(happened))
                    } else {
                        // The partner has changed its motion since the prediction.
                        self.operations.repairs += 1;
                        ([first; 2], None)
                    }
                }
            };
            let is_one = changed[0] == changed[1];
            for disc in changed.into_iter().take(if is_one { 1 } else { 2 }) {
                self.predict(registers, disc, time);
            }
            if let Some(happened) = happened {
                self.time = time;
                self.events += 1;
                if self.events > self.sorted_until {
                    self.sort_and_register(time)?;
                }
                if !observer(&happened, self) {
                    return Ok(true);
                }
            }
        }
    }
}

impl FlyingDiscs for Fast {
    fn count(&self) -> usize {
        self.discs.len()
    }

    fn disc(&self, number: u32) -> &FlyingDisc {
        &self.discs[self.places[number as usize] as usize]
    }
}

impl EventEngine for Fast {
    fn begin(&mut self) -> Result<(), EngineError> {
        self.sort_and_register(self.time)
    }

    fn run(&mut self, until: f64, most: u64, observer: &mut EventObserver<'_>) -> Result<bool, EngineError> {
        let set = self.set;
        let mut ended = Ok(false);
        let task = EventLoopTask { engine: self, until, most, observer, ended: &mut ended };
        dispatch_native(set, task).map_err(|_| EngineError::NoInstructions(set))?;
        ended
    }

    fn rebuilds(&self) -> u64 {
        self.renewals / self.discs.len().max(1) as u64
    }

    fn operations(&self) -> Operations {
        self.operations
    }

    fn snapshot(&self) -> Snapshot {
        self.engine_snapshot()
    }

    fn restore(&mut self, discs: Vec<FlyingDisc>, kept: &Snapshot) -> Result<(), String> {
        self.take_up(discs, kept)
    }

    fn figures(&self) -> Vec<(&'static str, f64)> {
        let count = self.discs.len().max(1);
        let listed: usize = (0..self.discs.len() as u32).map(|disc| self.lists.of(disc).len()).sum();
        vec![
            ("renewals_a_disc", self.renewals as f64 / count as f64),
            ("listed", listed as f64 / count as f64),
            ("displacement_limit", self.displacement_limit),
        ]
    }
}

/// Largest displacement from the registered position (length); none if the box is too small for lists.
pub(crate) fn displacement_limit(arena: &Arena, radii: impl Iterator<Item = f64> + Clone) -> Option<f64> {
    lists::displacement_limit(&arena.domain, radii, LISTED)
}

/// The loop over events, compiled for an instruction set.
struct EventLoopTask<'e, 'o> {
    engine: &'e mut Fast,
    until: f64,
    most: u64,
    observer: &'e mut EventObserver<'o>,
    ended: &'e mut Result<bool, EngineError>,
}

impl RegisterTask<f64> for EventLoopTask<'_, '_> {
    #[inline(always)]
    fn on<R: Registers<Lane = f64>>(self, registers: R) {
        *self.ended = self.engine.run_on(registers, self.until, self.most, self.observer);
    }
}

/// Task that predicts the next event of every disc from a time on.
struct PredictAllTask<'e> {
    engine: &'e mut Fast,
    time: f64,
}

impl RegisterTask<f64> for PredictAllTask<'_> {
    #[inline(always)]
    fn on<R: Registers<Lane = f64>>(self, registers: R) {
        for disc in 0..self.engine.discs.len() as u32 {
            self.engine.predict(registers, disc, self.time);
        }
    }
}

/// Spreads the bits of a number, with a zero after each.
fn spread(number: u32) -> u64 {
    let mut bits = u64::from(number);
    for (shift, mask) in [
        (16, 0x0000_FFFF_0000_FFFF_u64),
        (8, 0x00FF_00FF_00FF_00FF),
        (4, 0x0F0F_0F0F_0F0F_0F0F),
        (2, 0x3333_3333_3333_3333),
        (1, 0x5555_5555_5555_5555),
    ] {
        bits = (bits | bits << shift) & mask;
    }
    bits
}
