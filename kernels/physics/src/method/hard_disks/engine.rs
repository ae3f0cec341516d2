//! What every way to find events offers, and what it says of them. All give the same events at the same times, to the bit.

use super::event::{Arena, Bounce, Impact};
use super::operations::Operations;
use crate::method::Snapshot;
use stripmine_kernels::InstructionSet;
use stripmine_kernels::flight::Disc;

/// A way to find events, with the discs under way. Discs are known by their numbers, in the order of their ids.
pub(crate) trait Engine: Send {
    /// How many discs there are.
    fn count(&self) -> usize;

    /// A disc, as it was after its last event.
    fn disc(&self, number: u32) -> &Disc;

    /// The next event, if it comes no later than `until` (time) and before the partners of all discs have been found `most`
    /// times.
    ///
    /// # Errors
    /// [`EngineError`]: what must not be.
    fn next(&mut self, until: f64, most: u64) -> Result<Option<Occurred>, EngineError>;

    /// How often the partners of a disc were found, of all discs together over their number.
    fn rebuilds(&self) -> u64;

    /// What it has done for its events.
    fn operations(&self) -> Operations;

    /// What a checkpoint keeps of it beside the discs, so that it goes on as if there had been none.
    fn snapshot(&self) -> Snapshot;

    /// Takes up discs, by their numbers, and what was kept beside them.
    ///
    /// # Errors
    /// A sentence, if it is not of this engine and these discs.
    fn restore(&mut self, discs: Vec<Disc>, kept: &Snapshot) -> Result<(), String>;

    /// What it says of itself in a summary: names and values.
    fn figures(&self) -> Vec<(&'static str, f64)>;
}

/// What a disc meets.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Partner {
    /// A disc, by its number.
    Disc(u32),
    /// A closed side across an axis.
    Wall(u8),
}

/// What has happened.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Occurred {
    /// When (time).
    pub time: f64,
    /// To which disc, the one with the smaller number of two.
    pub disc: u32,
    pub with: Partner,
    /// Of two discs: how.
    pub(crate) impact: Option<Impact>,
    /// What a wall has done to the disc (mass · length/time); 0 between discs.
    pub(crate) thrust: f64,
    /// Energy given to the discs; below 0 where it is taken.
    pub work: f64,
    /// Action of the flights that end here (energy · time); 0 where the kinetic energy never changes.
    pub action: f64,
    /// Time since the event before, of the disc and of the one that it met.
    pub free: [f64; 2],
}

/// Why the discs stop.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum EngineError {
    /// Two discs have their centres in one cell: they overlap.
    SharedCell([u32; 2]),
    /// A disc is so high that the look-up of cells above a floor takes too many entries.
    TooHigh(u32, usize),
    /// An event lies before one that has happened (time, time).
    BackInTime(u32, f64, f64),
    /// A disc has more others around it than can be listed.
    Crowded(u32, usize),
    /// This processor has no such instructions.
    NoInstructions(InstructionSet),
}

impl Occurred {
    /// Two discs collide, known by their numbers and in any order.
    #[inline]
    pub(crate) fn collision(arena: &Arena, a: (u32, &mut Disc), b: (u32, &mut Disc), time: f64) -> Occurred {
        let ((a, one), (b, other)) = if a.0 < b.0 { (a, b) } else { (b, a) };
        let free = [time - one.time, time - other.time];
        let action =
            if arena.keeps_kinetic { 0.0 } else { arena.action(one, time) + arena.action(other, time) };
        let impact = arena.collide(one, other, time);
        let work = -impact.loss;
        Occurred {
            time,
            disc: a,
            with: Partner::Disc(b),
            impact: Some(impact),
            thrust: 0.0,
            work,
            action,
            free,
        }
    }

    /// A disc meets a closed side across an axis.
    #[inline]
    pub(crate) fn at_wall(arena: &Arena, (number, disc): (u32, &mut Disc), axis: u8, time: f64) -> Occurred {
        let free = [time - disc.time, 0.0];
        let action = if arena.keeps_kinetic { 0.0 } else { arena.action(disc, time) };
        let Bounce { thrust, work } = arena.rebound(disc, number, axis.into(), time);
        Occurred { time, disc: number, with: Partner::Wall(axis), impact: None, thrust, work, action, free }
    }
}
