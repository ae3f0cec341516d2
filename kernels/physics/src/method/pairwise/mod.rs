//! Fast engine for discs that interact in pairs and move step by step: law × search × integrator.
//!
//! A method provides a [`PairSystem`], which defines what moves and where; [`Dynamics`], which choose the pair law and the scheme; and a
//! [`PairSearch`](search::PairSearch). Its step is then
//!
//! ```text
//! advance    correct the previous step and predict the next one, in one pass over the discs    engine.rs
//!            update cells or lists: only discs beyond a limit are checked                      cells.rs
//! forces     the forces of all pairs, each pair visited once                                  engine.rs, search/
//! ```
//!
//! followed by whatever the method itself counts and checks after each of the two. Positions are relative to the centres of cells, so that single
//! precision suffices in large boxes. No sum depends on the number of threads or the order of the discs in memory.

mod cells;
mod columns;
mod compiled;
mod crossings;
mod disc_names;
mod elapsed;
mod engine;
mod forces;
mod observing;
mod ranked;
mod removal;
mod restart;
mod saved;
pub(crate) mod search;
mod state;
mod state_form;
mod stepping;
mod timings;
mod unwrapped;
mod walls;

pub(crate) use columns::real_column;
use compiled::CompiledDynamics;
pub(super) use crossings::Crossings;
pub(super) use disc_names::outside;
pub(crate) use disc_names::{NameableDiscs, conflict, not_finite};
pub use elapsed::Elapsed;
pub(super) use engine::PairEngine;
pub(crate) use forces::PairForcesTask;
pub(super) use ranked::begin;
pub(crate) use state::StateSize;
pub(crate) use state_form::{CarriedQuery, CarriedState};
pub(crate) use stepping::{GravityWork, RemovableDiscs, SteppingDiscs};
pub use timings::{HaloTraffic, Phase, Timings};
pub(crate) use unwrapped::{unwrapped, wrapped};
pub use walls::{PlaneMotion, PlaneWall, PlaneWalls};
pub(crate) use walls::{WallDrive, WallGrid, WallTouch, WallTracks, each_touch, touching_disc};

use crate::domain::Domain;
use std::sync::Arc;
use stripmine_kernels::integrator::{Inertia, Scheme};
use stripmine_kernels::law::Law;
use stripmine_kernels::noise::NoiseSource;

/// System of discs: what moves, and where.
#[derive(Clone, Debug)]
pub(crate) struct PairSystem {
    /// The box.
    pub domain: Domain,
    /// Time step (time).
    pub dt: f64,
    /// Acceleration of gravity (length/time²).
    pub gravity: [f64; 2],
    /// Degrees of freedom of a disc: 2, or 3 if discs rotate.
    pub freedoms: usize,
    /// Mass and inertia that forces and torques are divided by.
    pub inertia: Inertia,
    /// Moment of inertia of a disc of mass and radius 1.
    pub inertia_factor: f64,
    /// Radius of every disc (length), if all are equal.
    pub radius: Option<f64>,
    /// Farthest distance (length) at which a pair acts.
    pub reach: f64,
    /// Longest displacement in a step (length); discs that move farther are reported.
    pub longest_step: f64,
    /// True if discs may cross any number of periods in a step; otherwise a disc that moves farther than a period is outside.
    pub(crate) crosses_any: bool,
    /// True for the axes along which crossed periods are counted.
    pub(crate) followed: [bool; 2],
    /// Random numbers, for a scheme that draws some.
    pub noise: NoiseSource,
    /// Frequency of sorting.
    pub sort: SortSchedule,
}

/// Frequency of sorting discs by cell. No sum depends on it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum SortSchedule {
    /// As soon as a quarter of the discs has changed cells.
    WhenNeeded,
    /// At every step, as in LAN17.
    EveryStep,
}

/// Law and integrator that move discs.
pub(crate) trait Dynamics: Send + Sync {
    /// Applies a task to the pair law.
    fn with_law<W: LawTask>(&self, work: W) -> W::Output;

    /// Applies a task to the integrator.
    fn with_scheme<W: SchemeTask>(&self, work: W) -> W::Output;

    /// Returns the prescribed motion of discs that no force moves at a time; none if they are at rest.
    fn prescribed(&self, _time: f64) -> Option<PrescribedMotion> {
        None
    }

    /// Returns the plane walls, if there are any.
    fn walls(&self) -> Option<&Arc<PlaneWalls>> {
        None
    }

    /// Applies a task to the law between discs and plane walls, if there are any.
    fn with_wall_law<W: LawTask>(&self, _work: W) -> Option<W::Output> {
        None
    }
}

/// Prescribed motion, the same for all discs that no force moves.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct PrescribedMotion {
    /// Displacement from the start (length).
    pub(crate) displacement: [f64; 2],
    /// Velocity (length/time).
    pub velocity: [f64; 2],
}

/// Task for a law, generic over its compiled variants.
pub(crate) trait LawTask {
    /// Result.
    type Output;
    /// Runs the task.
    fn with<L: Law<2> + Send + Sync + 'static>(self, law: L) -> Self::Output;
}

/// Task for an integrator.
pub(crate) trait SchemeTask {
    /// Result.
    type Output;
    /// Runs the task.
    fn with<C: Scheme>(self, scheme: C) -> Self::Output;
}
