//! Interface of the engines that find events. All engines give the same events at the same times, to the bit.

use super::event::{Arena, DiscCollision, WallBounce};
use super::operations::Operations;
use crate::method::Snapshot;
use stripmine_kernels::InstructionSet;
use stripmine_kernels::flight::FlyingDisc;

/// Discs of an engine, numbered in the order of their ids.
pub(crate) trait FlyingDiscs {
    /// Number of discs.
    fn count(&self) -> usize;

    /// Returns a disc in its state after its last event.
    fn disc(&self, number: u32) -> &FlyingDisc;
}

/// Receives each event with the discs after it, and returns true if the engine shall go on.
pub(crate) type EventObserver<'o> = dyn FnMut(&ExecutedEvent, &dyn FlyingDiscs) -> bool + 'o;

/// Event-driven engine, which owns the moving discs.
pub(crate) trait EventEngine: FlyingDiscs + Send {
    /// Finds the next event of each disc. Called once, before anything else.
    ///
    /// # Errors
    /// [`EngineError`] if a disc has more neighbours than a list can hold, or discs cannot be assigned to cells.
    fn begin(&mut self) -> Result<(), EngineError>;

    /// Executes events until the observer stops the engine, and returns true then. Returns false as soon as no event is left that comes no
    /// later than `until` (time) and before all discs have had their partners searched `most` times.
    ///
    /// # Errors
    /// [`EngineError`] if a precondition of the engine is broken.
    fn run(&mut self, until: f64, most: u64, observer: &mut EventObserver<'_>) -> Result<bool, EngineError>;

    /// Executes the next event, if [`run`](Self::run) would.
    ///
    /// # Errors
    /// [`EngineError`] if a precondition of the engine is broken.
    fn next(&mut self, until: f64, most: u64) -> Result<Option<ExecutedEvent>, EngineError> {
        let mut executed = None;
        self.run(until, most, &mut |event, _| {
            executed = Some(*event);
            false
        })?;
        Ok(executed)
    }

    /// Number of partner searches per disc.
    fn rebuilds(&self) -> u64;

    /// Counts of the operations so far.
    fn operations(&self) -> Operations;

    /// State beside the discs that a checkpoint needs for a bitwise resumption.
    fn snapshot(&self) -> Snapshot;

    /// Restores discs, in the order of their numbers, and the state of a checkpoint.
    ///
    /// # Errors
    /// A message if the state does not belong to this engine and these discs.
    fn restore(&mut self, discs: Vec<FlyingDisc>, kept: &Snapshot) -> Result<(), String>;

    /// Names and values of the engine for the summary of a run.
    fn figures(&self) -> Vec<(&'static str, f64)>;
}

/// Partner of a disc in an event.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum EventPartner {
    /// Disc, by number.
    Disc(u32),
    /// Closed side across an axis.
    Wall(u8),
}

/// Event that has been executed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct ExecutedEvent {
    /// Time of the event.
    pub time: f64,
    /// Number of the disc; of two discs the smaller number.
    pub disc: u32,
    pub with: EventPartner,
    /// Collision data, for two discs.
    pub(crate) impact: Option<DiscCollision>,
    /// Momentum given by a wall (mass · length/time); 0 between discs.
    pub(crate) thrust: f64,
    /// Energy given to the discs; negative if taken.
    pub work: f64,
    /// Action of the flights that end in the event (energy · time); 0 if the kinetic energy is constant.
    pub action: f64,
    /// Time since the previous event of the disc and of its partner.
    pub free: [f64; 2],
}

/// Failure of an engine.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum EngineError {
    /// Two discs have their centres in one cell, so they overlap.
    SharedCell([u32; 2]),
    /// A disc is so high above the floor that the cell look-up needs too many entries.
    TooHigh(u32, usize),
    /// An event is earlier than the last one (time, time).
    BackInTime(u32, f64, f64),
    /// A disc has more neighbours than a list can hold.
    Crowded(u32, usize),
    /// The processor lacks the instruction set.
    NoInstructions(InstructionSet),
}

impl ExecutedEvent {
    /// Collides two discs, given with their numbers in any order.
    #[inline(always)]
    pub(crate) fn collision(
        arena: &Arena,
        a: (u32, &mut FlyingDisc),
        b: (u32, &mut FlyingDisc),
        time: f64,
    ) -> ExecutedEvent {
        let ((a, one), (b, other)) = if a.0 < b.0 { (a, b) } else { (b, a) };
        let free = [time - one.time, time - other.time];
        let action =
            if arena.keeps_kinetic { 0.0 } else { arena.action(one, time) + arena.action(other, time) };
        let impact = arena.collide(one, other, time);
        let work = -impact.loss;
        ExecutedEvent {
            time,
            disc: a,
            with: EventPartner::Disc(b),
            impact: Some(impact),
            thrust: 0.0,
            work,
            action,
            free,
        }
    }

    /// Reflects a disc from a closed side across an axis.
    #[inline]
    pub(crate) fn at_wall(
        arena: &Arena,
        (number, disc): (u32, &mut FlyingDisc),
        axis: u8,
        time: f64,
    ) -> ExecutedEvent {
        let free = [time - disc.time, 0.0];
        let action = if arena.keeps_kinetic { 0.0 } else { arena.action(disc, time) };
        let WallBounce { thrust, work } = arena.rebound(disc, number, axis.into(), time);
        ExecutedEvent {
            time,
            disc: number,
            with: EventPartner::Wall(axis),
            impact: None,
            thrust,
            work,
            action,
            free,
        }
    }
}
