//! Engines by ISO99: the next event of each disc, a complete binary tree that finds the first of them, and local times.
//!
//! Two kinds of cells find the partners of a disc, and everything else is the same:
//!
//! - the *reference* searches masks of the exclusive grid, which is filled again before a mask misses a partner. No disc crosses a cell.
//! - *cell crossing* searches linked cells, and a disc that enters a cell is an event. It is the rival of the paper's section 4.

pub mod choice;
pub(crate) mod grid;
mod half_space;
pub(super) mod linked_cells;
mod predicted;
mod tournament;
pub mod trial;

use super::engine::{EngineError, EventEngine, EventObserver, ExecutedEvent, FlyingDiscs};
use super::event::Arena;
use super::operations::Operations;
use crate::domain::BoxSide;
use crate::io::checkpoint::CheckpointColumn;
use crate::method::Snapshot;
use grid::{CellMisfit, DiscCells, ExclusiveGrid, ExclusiveGridSize};
use half_space::HalfSpaceGrid;
use linked_cells::{CellCounts, LinkedCells};
use predicted::{PredictedEvent, WALL};
use stripmine_kernels::flight::{FlyingDisc, Space, collision_time};
use stripmine_kernels::mask::Mask;
use tournament::TournamentTree;

/// Engine over cells of type `C`.
#[derive(Clone, Debug)]
pub(crate) struct TournamentEngine<C> {
    arena: Arena,
    discs: Vec<FlyingDisc>,
    cells: C,
    events: Vec<PredictedEvent>,
    tree: TournamentTree,
    /// Time of the last event, or the time up to which there is none.
    time: f64,
    /// Distance by which two discs may approach before the masks miss a pair (length), at the time `since`.
    slack: f64,
    since: f64,
    /// Largest speed (length/time).
    fastest: f64,
    /// r_NL − 2 σ_max (length): the slack of a new grid.
    whole_slack: f64,
    /// Number of fills of the cells, and of crossings of a cell.
    remaps: u64,
    crossings: u64,
    operations: Operations,
    /// Discs that have lost their partner in the current event.
    lost: Vec<u32>,
    /// Time of the last fill. Speeds are measured in a frame that falls freely from then on, so gravity does not change them.
    filled: f64,
}

/// Checkpoint columns of the cells: a position in the cell of each disc.
const FILLED_AT: [&str; 2] = ["filled.x", "filled.y"];
/// Checkpoint names of the sums of the engine.
const SUMS: [&str; 5] = ["engine.time", "engine.slack", "engine.since", "engine.fastest", "engine.filled"];

/// Safety factor for distances that must not be exceeded.
const ROUNDED_UP: f64 = 1.0 + 1e-9;

/// Takes the discs at a time, over all cells of a box, or over the occupied cells if there is no ceiling.
pub(crate) fn engine(arena: Arena, discs: Vec<FlyingDisc>, mask: &Mask, time: f64) -> Box<dyn EventEngine> {
    let smallest = discs.iter().map(|disc| disc.radius).fold(f64::INFINITY, f64::min);
    let sizes = ExclusiveGridSize::new(&arena.domain, smallest);
    let reach = sizes.reach(mask);
    match arena.domain.sides[1] {
        BoxSide::Open => {
            let cells = HalfSpaceGrid::new(arena.domain, sizes, mask);
            Box::new(TournamentEngine::new(arena, discs, cells, reach, time))
        }
        _ => {
            let cells = ExclusiveGrid::new(arena.domain, sizes, mask);
            Box::new(TournamentEngine::new(arena, discs, cells, reach, time))
        }
    }
}

/// Takes the discs at a time, over linked cells with crossing events.
pub(crate) fn cell_crossing_engine(
    arena: Arena,
    discs: Vec<FlyingDisc>,
    counts: CellCounts,
    time: f64,
) -> Box<dyn EventEngine> {
    let cells = LinkedCells::new(arena.domain, counts);
    // Cells that discs cross hold forever; the reach is finite, as a checkpoint stores it.
    Box::new(TournamentEngine::new(arena, discs, cells, f64::MAX, time))
}

impl<C: DiscCells> TournamentEngine<C> {
    /// Takes the discs at a time; the cells contain every other disc within `reach` (length) of a disc.
    fn new(arena: Arena, discs: Vec<FlyingDisc>, cells: C, reach: f64, time: f64) -> TournamentEngine<C> {
        let largest = discs.iter().map(|disc| disc.radius).fold(0.0, f64::max);
        TournamentEngine {
            cells,
            events: vec![PredictedEvent::NONE; discs.len()],
            tree: TournamentTree::new(discs.len(), |_| f64::INFINITY),
            arena,
            discs,
            time,
            slack: 0.0,
            since: time,
            fastest: 0.0,
            whole_slack: reach - 2.0 * largest,
            remaps: 0,
            crossings: 0,
            operations: Operations::default(),
            lost: vec![],
            filled: time,
        }
    }

    /// Time up to which the masks contain every partner. No later event is predicted.
    fn horizon(&self) -> f64 {
        self.since + self.slack / (2.0 * self.fastest)
    }

    fn execute_event(&mut self, first: u32, event: PredictedEvent) -> ExecutedEvent {
        let PredictedEvent { time, with, .. } = event;
        if with >= WALL {
            let disc = &mut self.discs[first as usize];
            let happened = ExecutedEvent::at_wall(&self.arena, (first, disc), (with - WALL) as u8, time);
            self.update_speed_bound(first);
            self.repredict([first, first]);
            return happened;
        }
        let [a, b] = [first.min(with), first.max(with)];
        let (left, right) = self.discs.split_at_mut(b as usize);
        let pair = ((a, &mut left[a as usize]), (b, &mut right[0]));
        let happened = ExecutedEvent::collision(&self.arena, pair.0, pair.1, time);
        self.update_speed_bound(a);
        self.update_speed_bound(b);
        self.repredict([a, b]);
        happened
    }

    /// Time at which something is due for a disc: its collision, or the crossing of its cell.
    #[inline(always)]
    fn due_time(cells: &C, events: &[PredictedEvent], disc: u32) -> f64 {
        events[disc as usize].time.min(cells.crossing_time(disc))
    }

    /// True if the partner of a collision has had another event since the prediction.
    #[inline(always)]
    fn is_outdated(&self, event: &PredictedEvent) -> bool {
        self.discs.get(event.with as usize).is_some_and(|other| other.events as u32 != event.events)
    }

    /// Applies the dynamic upper cut-off: a new fastest disc shortens the time for which the masks are complete.
    fn update_speed_bound(&mut self, disc: u32) {
        let speed = self.speed(&self.discs[disc as usize]);
        if speed > self.fastest {
            self.slack -= 2.0 * self.fastest * (self.time - self.since);
            self.since = self.time;
            self.fastest = speed;
        }
    }

    /// Speed in the frame that falls freely since the last fill (length/time).
    fn speed(&self, disc: &FlyingDisc) -> f64 {
        let [u, v] = disc.velocity_at(&self.arena.space, self.filled);
        (u * u + v * v).sqrt()
    }

    /// Finds the next events of discs whose motion has changed, and of the discs that expected to meet them.
    fn repredict(&mut self, changed: [u32; 2]) {
        let [a, b] = changed;
        let mut lost = std::mem::take(&mut self.lost);
        let (now, horizon) = (self.time, self.horizon());
        for &disc in if a == b { &changed[..1] } else { &changed[..] } {
            let mut own = self.at_wall(disc);
            self.operations.searches += 1;
            let TournamentEngine { cells, discs, events, tree, arena, operations, .. } = self;
            cells.for_each_around(disc, |other| {
                operations.predictions += 1;
                let time = pair(&arena.space, discs, [disc, other], now, horizon);
                let theirs = PredictedEvent::with_disc(time, other, &discs[other as usize]);
                if theirs.is_before(&own) {
                    own = theirs;
                }
                if other == a || other == b {
                    return;
                }
                let known = events[other as usize];
                let ours = PredictedEvent::with_disc(time, disc, &discs[disc as usize]);
                if known.with == disc {
                    lost.push(other);
                } else if ours.is_before(&known) {
                    Self::replace((cells, events, tree, operations), other, ours);
                }
            });
            self.cells.predict_crossing(&self.arena, disc, &self.discs[disc as usize], now);
            self.renew(disc, own);
        }
        for disc in lost.drain(..) {
            self.repair(disc);
        }
        self.lost = lost;
    }

    /// Finds the next event of a disc whose partner has had another event first.
    fn repair(&mut self, disc: u32) {
        self.operations.searches += 1;
        self.operations.repairs += 1;
        let mut predictions = 0;
        self.cells.for_each_around(disc, |_| predictions += 1);
        self.operations.predictions += predictions;
        self.renew(disc, self.predicted_event(disc));
    }

    /// Moves a disc to the cell that it enters, and predicts its collisions with the discs that it did not see before.
    fn cross(&mut self, disc: u32) {
        let (now, horizon) = (self.time, self.horizon());
        self.crossings += 1;
        self.operations.cell_updates += 1;
        let mut own = self.events[disc as usize];
        self.cells.cross(disc);
        let TournamentEngine { cells, discs, events, tree, arena, operations, .. } = self;
        cells.for_each_entered(disc, |other| {
            operations.predictions += 1;
            let time = pair(&arena.space, discs, [disc, other], now, horizon);
            let theirs = PredictedEvent::with_disc(time, other, &discs[other as usize]);
            if theirs.is_before(&own) {
                own = theirs;
            }
            let ours = PredictedEvent::with_disc(time, disc, &discs[disc as usize]);
            if ours.is_before(&events[other as usize]) {
                Self::replace((cells, events, tree, operations), other, ours);
            }
        });
        self.cells.predict_crossing(&self.arena, disc, &self.discs[disc as usize], now);
        self.renew(disc, own);
    }

    /// Replaces the next event of a disc.
    fn renew(&mut self, disc: u32, event: PredictedEvent) {
        let TournamentEngine { cells, events, tree, operations, .. } = self;
        Self::replace((cells, events, tree, operations), disc, event);
    }

    /// Replaces the next event of a disc, given the parts of the engine that this concerns.
    #[inline(always)]
    fn replace(
        (cells, events, tree, operations): (&C, &mut [PredictedEvent], &mut TournamentTree, &mut Operations),
        disc: u32,
        event: PredictedEvent,
    ) {
        events[disc as usize] = event;
        tree.update(disc, events.len(), |disc| Self::due_time(cells, events, disc));
        operations.queue_moves += 1;
    }

    fn at_wall(&self, disc: u32) -> PredictedEvent {
        let (time, axis) = self.arena.wall(&self.discs[disc as usize]);
        PredictedEvent { time, with: WALL + axis as u32, events: 0 }
    }

    /// Predicts the next event of a disc among all discs around it.
    fn predicted_event(&self, disc: u32) -> PredictedEvent {
        let horizon = self.horizon();
        let mut next = self.at_wall(disc);
        self.cells.for_each_around(disc, |other| {
            let time = pair(&self.arena.space, &self.discs, [disc, other], self.time, horizon);
            let event = PredictedEvent::with_disc(time, other, &self.discs[other as usize]);
            if event.is_before(&next) {
                next = event;
            }
        });
        next
    }

    /// Predicts when each disc leaves its cell, and builds the tree.
    fn begin_tournament(&mut self) {
        for (disc, number) in self.discs.iter().zip(0..) {
            self.cells.predict_crossing(&self.arena, number, disc, self.time);
        }
        let TournamentEngine { cells, events, tree, .. } = self;
        tree.renew(events.len(), |disc| Self::due_time(cells, events, disc));
    }

    /// Fills the cells with the discs at a time, and predicts the next event of each.
    fn remap(&mut self, time: f64) -> Result<(), EngineError> {
        let TournamentEngine { cells, discs, arena, .. } = self;
        let filled = cells.fill(discs.iter().map(|disc| arena.position_at(disc, time)));
        filled.map_err(|why| match why {
            CellMisfit::Shared(pair) => EngineError::SharedCell(pair),
            CellMisfit::TooHigh(disc, blocks) => EngineError::TooHigh(disc, blocks),
        })?;
        self.time = time;
        self.since = time;
        self.slack = self.whole_slack;
        self.filled = time;
        self.fastest = self.discs.iter().map(|disc| self.speed(disc)).fold(0.0, f64::max);
        self.remaps += 1;
        self.operations.cell_updates += self.discs.len() as u64;
        self.operations.searches += self.discs.len() as u64;
        self.operations.queue_moves += self.discs.len() as u64;
        for disc in 0..self.discs.len() as u32 {
            self.events[disc as usize] = self.at_wall(disc);
        }
        let (now, horizon, ahead) = (time, self.horizon(), self.slack / (2.0 * self.fastest));
        let mut events = std::mem::take(&mut self.events);
        let mut predictions = 0;
        let TournamentEngine { cells, discs, arena, .. } = &*self;
        // Visit each pair once, and only if it can meet before the horizon.
        for (number, own) in (0..).zip(discs) {
            let (speed, here) = (self.speed(own), own.at(&arena.space, time));
            cells.for_each_around(number, |other_number| {
                if other_number <= number {
                    return;
                }
                let other = &discs[other_number as usize];
                let [dx, dy] = arena.domain.displacement(here, other.at(&arena.space, time));
                let reach = own.radius + other.radius;
                let near = (reach + (speed + self.speed(other)) * ahead) * ROUNDED_UP;
                if dx * dx + dy * dy > near * near {
                    return;
                }
                predictions += 1;
                let time = pair(&arena.space, discs, [number, other_number], now, horizon);
                for (one, with, disc) in [(number, other_number, other), (other_number, number, own)] {
                    let event = PredictedEvent::with_disc(time, with, disc);
                    if event.is_before(&events[one as usize]) {
                        events[one as usize] = event;
                    }
                }
            });
        }
        self.events = events;
        self.operations.predictions += predictions;
        self.begin_tournament();
        Ok(())
    }
}

impl<C: DiscCells> FlyingDiscs for TournamentEngine<C> {
    fn count(&self) -> usize {
        self.discs.len()
    }

    fn disc(&self, number: u32) -> &FlyingDisc {
        &self.discs[number as usize]
    }
}

impl<C: DiscCells> EventEngine for TournamentEngine<C> {
    fn begin(&mut self) -> Result<(), EngineError> {
        self.remap(self.time)
    }

    fn run(&mut self, until: f64, most: u64, observer: &mut EventObserver<'_>) -> Result<bool, EngineError> {
        loop {
            let first = self.tree.first();
            let event = self.events[first as usize];
            let crossing = self.cells.crossing_time(first);
            let time = event.time.min(crossing);
            // ISO99 (6), with the largest speed kept up to date.
            let horizon = self.horizon();
            if time > until.min(horizon) || time == f64::INFINITY {
                if until <= horizon || self.remaps >= most {
                    return Ok(false);
                }
                // Rounding may put the horizon just before the last event.
                self.remap(horizon.max(self.time))?;
                continue;
            }
            if time < self.time {
                return Err(EngineError::BackInTime(first, time, self.time));
            }
            if crossing <= event.time && self.rebuilds() >= most {
                return Ok(false);
            }
            self.time = time;
            if crossing <= event.time {
                self.cross(first);
                continue;
            }
            if self.is_outdated(&event) {
                self.repair(first);
                continue;
            }
            let executed = self.execute_event(first, event);
            if !observer(&executed, self) {
                return Ok(true);
            }
        }
    }

    fn rebuilds(&self) -> u64 {
        self.remaps + self.crossings / self.discs.len().max(1) as u64
    }

    fn operations(&self) -> Operations {
        self.operations
    }

    fn snapshot(&self) -> Snapshot {
        let mut kept = Snapshot::default();
        for (axis, name) in FILLED_AT.into_iter().enumerate() {
            let along = (0..self.discs.len() as u32).map(|disc| self.cells.centre(disc)[axis]);
            kept.add_column(name, CheckpointColumn::F64(along.collect()));
        }
        let TournamentEngine { time, slack, since, fastest, filled, remaps, crossings, .. } = *self;
        for (name, value) in SUMS.into_iter().zip([time, slack, since, fastest, filled]) {
            kept.add_sum(name, value);
        }
        kept.add_count("engine.remaps", remaps);
        if C::HAS_CROSSINGS {
            kept.add_count("engine.crossings", crossings);
        }
        kept
    }

    fn restore(&mut self, discs: Vec<FlyingDisc>, kept: &Snapshot) -> Result<(), String> {
        let count = discs.len();
        let filled_at = [kept.numbers(FILLED_AT[0], count)?, kept.numbers(FILLED_AT[1], count)?];
        let places = (0..count).map(|disc| filled_at.map(|along| along[disc]));
        self.cells.fill(places).map_err(|_| "two discs are in one cell")?;
        let [time, slack, since, fastest, filled] = SUMS.map(|name| kept.sum(name));
        (self.time, self.slack, self.since, self.fastest) = (time?, slack?, since?, fastest?);
        if self.since > self.time || self.slack > self.whole_slack || self.fastest < 0.0 {
            return Err("the state of the cells (engine.since, engine.slack, engine.fastest) is impossible"
                .to_owned());
        }
        (self.filled, self.remaps) = (filled?, kept.count("engine.remaps")?);
        if C::HAS_CROSSINGS {
            self.crossings = kept.count("engine.crossings")?;
        }
        self.discs = discs;
        self.events = (0..count as u32).map(|disc| self.predicted_event(disc)).collect();
        self.begin_tournament();
        Ok(())
    }

    fn figures(&self) -> Vec<(&'static str, f64)> {
        let mut figures = vec![("remaps", self.remaps as f64), self.cells.figure()];
        if C::HAS_CROSSINGS {
            figures.push(("crossings", self.crossings as f64));
        }
        figures
    }
}

/// Collision time of two discs, given by their numbers.
#[inline(always)]
fn pair(space: &Space, discs: &[FlyingDisc], [disc, other]: [u32; 2], now: f64, horizon: f64) -> f64 {
    let [a, b] = [disc.min(other), disc.max(other)];
    collision_time(space, &discs[a as usize], &discs[b as usize], now, horizon)
}
