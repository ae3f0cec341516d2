//! Discs that act in pairs and move step by step, as fast as it goes: law × search × integrator.
//!
//! A method gives a [`System`], which says what moves and where, [`Dynamics`], which name the pair law and the scheme, and a
//! [`Search`](search::Search). Its step is then
//!
//! ```text
//! advance    correct the step before and predict the next one, in one pass over the discs     engine.rs
//!            bring cells or lists up to date: only discs beyond a limit are looked at         cells.rs
//! meet       the forces of all pairs, each pair met once                                      engine.rs, search/
//! ```
//!
//! and whatever the method itself counts and judges after each of the two. Positions are seen from the centres of cells, so
//! that single precision holds in large boxes. No sum depends on the numbers of threads or the order of the discs in memory.

mod carried;
mod cells;
mod columns;
mod compiled;
mod crossings;
mod elapsed;
mod engine;
mod forces;
mod losing;
mod named;
mod observing;
mod ranked;
mod saved;
pub(crate) mod search;
mod state;
mod stepping;
mod timings;
mod unwrapped;

pub(crate) use carried::{Carried, CarriedBy};
pub(crate) use columns::real_column;
use compiled::Compiled;
pub(super) use crossings::Crossings;
pub use elapsed::Elapsed;
pub(super) use engine::Engine;
pub(crate) use forces::ToReach;
pub(super) use named::outside;
pub(crate) use named::{Named, conflict, not_finite};
pub(super) use ranked::begin;
pub(crate) use stepping::{Losing, Stepping, Work};
pub use timings::{Halo, Phase, Timings};
pub(crate) use unwrapped::{unwrapped, wrapped};

use crate::domain::Domain;
use stripmine_kernels::integrator::{Inertia, Scheme};
use stripmine_kernels::law::Law;
use stripmine_kernels::noise::NoiseSource;

/// What moves, and where.
#[derive(Clone, Debug)]
pub(crate) struct System {
    /// The box.
    pub domain: Domain,
    /// Time step (time).
    pub dt: f64,
    /// Acceleration of gravity (length/time²).
    pub gravity: [f64; 2],
    /// Degrees of freedom of a disc: 2, or 3 where discs turn.
    pub freedoms: usize,
    /// What forces and torques are divided by.
    pub inertia: Inertia,
    /// Moment of inertia of a disc of mass and radius 1.
    pub inertia_factor: f64,
    /// The radius of every disc (length), where discs are alike.
    pub radius: Option<f64>,
    /// Farthest distance (length) at which a pair acts.
    pub reach: f64,
    /// Discs that move farther in a step (length) are listed.
    pub longest_step: f64,
    /// Whether discs may cross any number of periods in a step; else one that goes farther than a period is outside.
    pub(crate) crosses_any: bool,
    /// Along which axes it is followed how many periods discs cross.
    pub(crate) followed: [bool; 2],
    /// The random numbers, for a scheme that draws some.
    pub noise: NoiseSource,
    /// When discs are put in the order of their cells.
    pub sort: Sort,
}

/// When discs are put in the order of their cells. No sum depends on it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Sort {
    /// As soon as a quarter of them has changed cells.
    WhenNeeded,
    /// At every step, as the source of 2017 does.
    EveryStep,
}

/// By what discs move.
pub(crate) trait Dynamics: Send + Sync {
    /// Does something with the pair law.
    fn with_law<W: WithLaw>(&self, work: W) -> W::Output;

    /// Does something with the integrator.
    fn with_scheme<W: WithScheme>(&self, work: W) -> W::Output;

    /// How the discs that no force moves stand at a time; none where they rest at their places.
    fn prescribed(&self, _time: f64) -> Option<Prescribed> {
        None
    }
}

/// Prescribed motion, the same for all discs that no force moves.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Prescribed {
    /// From their places at the start (length).
    pub(crate) displacement: [f64; 2],
    /// Velocity (length/time).
    pub velocity: [f64; 2],
}

/// Something done with a law, whichever of its compiled variants that is.
pub(crate) trait WithLaw {
    /// What comes of it.
    type Output;
    /// Does it.
    fn with<L: Law<2> + Send + Sync + 'static>(self, law: L) -> Self::Output;
}

/// Something done with an integrator, whichever that is.
pub(crate) trait WithScheme {
    /// What comes of it.
    type Output;
    /// Does it.
    fn with<C: Scheme>(self, scheme: C) -> Self::Output;
}
