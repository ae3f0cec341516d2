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
mod crossings;
mod elapsed;
mod engine;
mod forces;
mod losing;
mod named;
mod observing;
mod ranked;
mod saved;
pub mod search;
mod state;
mod stepping;
mod timings;
mod unwrapped;

pub use carried::{Carried, CarriedBy};
pub use columns::real_column;
pub use crossings::Crossings;
pub use elapsed::Elapsed;
pub use engine::Engine;
pub use forces::ToReach;
pub use named::{Named, conflict, not_finite, outside};
pub use ranked::{begin, halo_rows};
pub use stepping::{Losing, Stepping, Work};
pub use timings::{Halo, Phase, Timings};
pub use unwrapped::{unwrapped, wrapped};

use crate::domain::Domain;
use stripmine_kernels::integrator::{Inertia, Scheme};
use stripmine_kernels::law::Law;
use stripmine_kernels::noise::NoiseSource;

/// What moves, and where.
#[derive(Clone, Debug)]
pub struct System {
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
    pub crosses_any: bool,
    /// Along which axes it is followed how many periods discs cross.
    pub followed: [bool; 2],
    /// The random numbers, for a scheme that draws some.
    pub noise: NoiseSource,
    /// When discs are put in the order of their cells.
    pub sort: Sort,
}

/// When discs are put in the order of their cells. No sum depends on it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Sort {
    /// As soon as a quarter of them has changed cells.
    WhenNeeded,
    /// At every step, as the source of 2017 does.
    EveryStep,
}

/// By what discs move.
pub trait Dynamics: Send + Sync {
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
pub struct Prescribed {
    /// From their places at the start (length).
    pub displacement: [f64; 2],
    /// Velocity (length/time).
    pub velocity: [f64; 2],
}

/// Something done with a law, whichever of its compiled variants that is.
pub trait WithLaw {
    /// What comes of it.
    type Output;
    /// Does it.
    fn with<L: Law<2> + Send + Sync + 'static>(self, law: L) -> Self::Output;
}

/// Something done with an integrator, whichever that is.
pub trait WithScheme {
    /// What comes of it.
    type Output;
    /// Does it.
    fn with<C: Scheme>(self, scheme: C) -> Self::Output;
}
