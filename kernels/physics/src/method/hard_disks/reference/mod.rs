//! Reference engine (ISO99): local minima over masks of the exclusive grid, a complete binary tree, local times, and no
//! cell-crossing events.

pub mod choice;
pub(crate) mod grid;
mod half_space;
mod tournament;

use super::engine::{EngineError, EventEngine, EventObserver, EventPartner, ExecutedEvent, FlyingDiscs};
use super::event::Arena;
use super::operations::Operations;
use crate::domain::BoxSide;
use crate::io::checkpoint::CheckpointColumn;
use crate::method::Snapshot;
use grid::{CellMisfit, DiscCells, ExclusiveGrid, ExclusiveGridSize};
use half_space::HalfSpaceGrid;
use stripmine_kernels::flight::{FlyingDisc, Space, collision_time};
use stripmine_kernels::mask::Mask;
use tournament::TournamentTree;

/// Predicted next event of a disc.
#[derive(Clone, Copy, Debug, PartialEq)]
struct PredictedEvent {
    /// Time of the event; infinite if none.
    time: f64,
    with: EventPartner,
}

impl PredictedEvent {
    /// No event.
    const NONE: PredictedEvent = PredictedEvent { time: f64::INFINITY, with: EventPartner::Wall(0) };

    /// True if it precedes another event of the same disc; of two at one time, the one with the smaller partner comes first.
    #[inline(always)]
    fn is_before(&self, other: &PredictedEvent) -> bool {
        self.time < other.time || self.time == other.time && self.with < other.with
    }
}

/// Engine over cells of type `C`.
#[derive(Clone, Debug)]
pub(crate) struct ReferenceEngine<C> {
    arena: Arena,
    discs: Vec<FlyingDisc>,
    grid: C,
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
    /// Number of fills of the grid.
    remaps: u64,
    operations: Operations,
    /// Discs that have lost their partner in the current event.
    lost: Vec<u32>,
    /// Time of the last fill. Speeds are measured in a frame that falls freely from then on, so gravity does not change them.
    filled: f64,
    /// Speeds of the discs at the last fill (length/time).
    speeds: Vec<f64>,
}

/// Checkpoint columns of the positions at the last fill.
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
            Box::new(ReferenceEngine::new(arena, discs, cells, reach, time))
        }
        _ => {
            let cells = ExclusiveGrid::new(arena.domain, sizes, mask);
            Box::new(ReferenceEngine::new(arena, discs, cells, reach, time))
        }
    }
}

impl<C: DiscCells> ReferenceEngine<C> {
    /// Takes the discs at a time; the cells contain every other disc within `reach` (length) of a disc.
    fn new(arena: Arena, discs: Vec<FlyingDisc>, grid: C, reach: f64, time: f64) -> ReferenceEngine<C> {
        let largest = discs.iter().map(|disc| disc.radius).fold(0.0, f64::max);
        ReferenceEngine {
            grid,
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
            operations: Operations::default(),
            lost: vec![],
            filled: time,
            speeds: vec![],
        }
    }

    /// Time up to which the masks contain every partner. No later event is predicted.
    fn horizon(&self) -> f64 {
        self.since + self.slack / (2.0 * self.fastest)
    }

    fn execute_event(&mut self, first: u32, event: PredictedEvent) -> ExecutedEvent {
        let PredictedEvent { time, with } = event;
        match with {
            EventPartner::Wall(axis) => {
                let disc = &mut self.discs[first as usize];
                let happened = ExecutedEvent::at_wall(&self.arena, (first, disc), axis, time);
                self.update_speed_bound(first);
                self.repredict([first, first]);
                happened
            }
            EventPartner::Disc(other) => {
                let [a, b] = [first.min(other), first.max(other)];
                let (left, right) = self.discs.split_at_mut(b as usize);
                let pair = ((a, &mut left[a as usize]), (b, &mut right[0]));
                let happened = ExecutedEvent::collision(&self.arena, pair.0, pair.1, time);
                self.update_speed_bound(a);
                self.update_speed_bound(b);
                self.repredict([a, b]);
                happened
            }
        }
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
            let ReferenceEngine { grid, discs, events, tree, arena, operations, .. } = self;
            for other in grid.around(disc) {
                operations.predictions += 1;
                let time = pair(&arena.space, discs, [disc, other], now, horizon);
                let theirs = PredictedEvent { time, with: EventPartner::Disc(other) };
                if theirs.is_before(&own) {
                    own = theirs;
                }
                if other == a || other == b {
                    continue;
                }
                let known = events[other as usize];
                let ours = PredictedEvent { time, with: EventPartner::Disc(disc) };
                if known.with == EventPartner::Disc(disc) {
                    lost.push(other);
                } else if ours.is_before(&known) {
                    events[other as usize] = ours;
                    tree.update(other, events.len(), |disc| events[disc as usize].time);
                    operations.queue_moves += 1;
                }
            }
            self.renew(disc, own);
        }
        for disc in lost.drain(..) {
            self.operations.searches += 1;
            self.operations.repairs += 1;
            self.operations.predictions += self.grid.around(disc).count() as u64;
            self.renew(disc, self.predicted_event(disc));
        }
        self.lost = lost;
    }

    /// Replaces the next event of a disc.
    fn renew(&mut self, disc: u32, event: PredictedEvent) {
        let ReferenceEngine { events, tree, .. } = self;
        events[disc as usize] = event;
        tree.update(disc, events.len(), |disc| events[disc as usize].time);
        self.operations.queue_moves += 1;
    }

    fn at_wall(&self, disc: u32) -> PredictedEvent {
        let (time, axis) = self.arena.wall(&self.discs[disc as usize]);
        PredictedEvent { time, with: EventPartner::Wall(axis as u8) }
    }

    /// Predicts the next event of a disc among all discs in its mask.
    fn predicted_event(&self, disc: u32) -> PredictedEvent {
        let horizon = self.horizon();
        self.grid.around(disc).fold(self.at_wall(disc), |next, other| {
            let time = pair(&self.arena.space, &self.discs, [disc, other], self.time, horizon);
            let event = PredictedEvent { time, with: EventPartner::Disc(other) };
            if event.is_before(&next) { event } else { next }
        })
    }

    /// Assigns the discs to the cells of their positions (length).
    fn fill(&mut self, places: Vec<[f64; 2]>) -> Result<(), EngineError> {
        self.grid.fill(places).map_err(|why| match why {
            CellMisfit::Shared(pair) => EngineError::SharedCell(pair),
            CellMisfit::TooHigh(disc, blocks) => EngineError::TooHigh(disc, blocks),
        })
    }

    /// Fills the grid with the discs at a time, and predicts the next event of each.
    fn remap(&mut self, time: f64) -> Result<(), EngineError> {
        self.fill(self.discs.iter().map(|disc| self.arena.position_at(disc, time)).collect())?;
        self.time = time;
        self.since = time;
        self.slack = self.whole_slack;
        self.filled = time;
        let mut speeds = std::mem::take(&mut self.speeds);
        speeds.clear();
        speeds.extend(self.discs.iter().map(|disc| self.speed(disc)));
        self.fastest = speeds.iter().copied().fold(0.0, f64::max);
        self.speeds = speeds;
        self.remaps += 1;
        self.operations.cell_updates += self.discs.len() as u64;
        self.operations.searches += self.discs.len() as u64;
        self.operations.queue_moves += self.discs.len() as u64;
        for disc in 0..self.discs.len() as u32 {
            self.events[disc as usize] = self.at_wall(disc);
        }
        let (now, horizon, ahead) = (time, self.horizon(), self.slack / (2.0 * self.fastest));
        let ReferenceEngine { grid, discs, events, arena, speeds, operations, .. } = self;
        // Visit each pair once, and only if it can meet before the horizon.
        for disc in 0..discs.len() as u32 {
            let (own, speed, here) =
                (&discs[disc as usize], speeds[disc as usize], grid.position_at_fill(disc));
            for other in grid.around(disc).filter(|&other| other > disc) {
                let [dx, dy] = arena.domain.displacement(here, grid.position_at_fill(other));
                let reach = own.radius + discs[other as usize].radius;
                let near = (reach + (speed + speeds[other as usize]) * ahead) * ROUNDED_UP;
                if dx * dx + dy * dy > near * near {
                    continue;
                }
                operations.predictions += 1;
                let time = pair(&arena.space, discs, [disc, other], now, horizon);
                for (one, with) in [(disc, other), (other, disc)] {
                    let event = PredictedEvent { time, with: EventPartner::Disc(with) };
                    if event.is_before(&events[one as usize]) {
                        events[one as usize] = event;
                    }
                }
            }
        }
        let events = &self.events;
        self.tree.renew(events.len(), |disc| events[disc as usize].time);
        Ok(())
    }
}

impl<C: DiscCells> FlyingDiscs for ReferenceEngine<C> {
    fn count(&self) -> usize {
        self.discs.len()
    }

    fn disc(&self, number: u32) -> &FlyingDisc {
        &self.discs[number as usize]
    }
}

impl<C: DiscCells> EventEngine for ReferenceEngine<C> {
    fn begin(&mut self) -> Result<(), EngineError> {
        self.remap(self.time)
    }

    fn run(&mut self, until: f64, most: u64, observer: &mut EventObserver<'_>) -> Result<bool, EngineError> {
        loop {
            let first = self.tree.first();
            let event = self.events[first as usize];
            // ISO99 (6), with the largest speed kept up to date.
            let horizon = self.horizon();
            if event.time > until.min(horizon) {
                if until <= horizon || self.remaps >= most {
                    return Ok(false);
                }
                // Rounding may put the horizon just before the last event.
                self.remap(horizon.max(self.time))?;
                continue;
            }
            if event.time < self.time {
                return Err(EngineError::BackInTime(first, event.time, self.time));
            }
            self.time = event.time;
            let executed = self.execute_event(first, event);
            if !observer(&executed, self) {
                return Ok(true);
            }
        }
    }

    fn rebuilds(&self) -> u64 {
        self.remaps
    }

    fn operations(&self) -> Operations {
        self.operations
    }

    fn snapshot(&self) -> Snapshot {
        let mut kept = Snapshot::default();
        for (axis, name) in FILLED_AT.into_iter().enumerate() {
            let along = (0..self.discs.len() as u32).map(|disc| self.grid.position_at_fill(disc)[axis]);
            kept.add_column(name, CheckpointColumn::F64(along.collect()));
        }
        let ReferenceEngine { time, slack, since, fastest, filled, remaps, .. } = *self;
        for (name, value) in SUMS.into_iter().zip([time, slack, since, fastest, filled]) {
            kept.add_sum(name, value);
        }
        kept.add_count("engine.remaps", remaps);
        kept
    }

    fn restore(&mut self, discs: Vec<FlyingDisc>, kept: &Snapshot) -> Result<(), String> {
        let count = discs.len();
        let filled_at = [kept.numbers(FILLED_AT[0], count)?, kept.numbers(FILLED_AT[1], count)?];
        let places = (0..count).map(|disc| filled_at.map(|along| along[disc]));
        self.fill(places.collect()).map_err(|_| "two discs are in one cell")?;
        let [time, slack, since, fastest, filled] = SUMS.map(|name| kept.sum(name));
        (self.time, self.slack, self.since, self.fastest) = (time?, slack?, since?, fastest?);
        (self.filled, self.remaps) = (filled?, kept.count("engine.remaps")?);
        self.discs = discs;
        self.events = (0..count as u32).map(|disc| self.predicted_event(disc)).collect();
        let events = &self.events;
        self.tree.renew(events.len(), |disc| events[disc as usize].time);
        Ok(())
    }

    fn figures(&self) -> Vec<(&'static str, f64)> {
        vec![("remaps", self.remaps as f64), self.grid.figure()]
    }
}

/// Collision time of two discs, given by their numbers.
#[inline(always)]
fn pair(space: &Space, discs: &[FlyingDisc], [disc, other]: [u32; 2], now: f64, horizon: f64) -> f64 {
    let [a, b] = [disc.min(other), disc.max(other)];
    collision_time(space, &discs[a as usize], &discs[b as usize], now, horizon)
}
