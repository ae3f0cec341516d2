//! Simulation in progress: the interface that runs use for every method.

use super::clock::{Clock, Until};
use super::failure::PhysicsFailure;
use super::snapshot::Snapshot;
use super::steering::{Change, SteeringError, has_no};
use crate::particles::{Particles, PerParticle};
use serde::Serialize;
use serde_json::{Map, Value};
use std::collections::BTreeMap;
use std::sync::atomic::AtomicBool;
use stripmine_kernels::isa::OpCounts;

/// Warning of a check during a run.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct RunWarning {
    /// The name of the check.
    pub check: &'static str,
    /// Measured value.
    pub value: f64,
    /// Limit.
    pub limit: f64,
    /// Finding and remedy in a sentence.
    pub message: String,
}

/// Simulation in progress. It never prints and never writes a file.
pub trait Simulation: Send {
    /// Advances until the first of some moments is reached, or soon after `interrupted` is set.
    ///
    /// # Errors
    /// [`PhysicsFailure`] says what broke, which particles, where, and what to do. The state is that of the failing step.
    fn advance(&mut self, until: &[Until], interrupted: &AtomicBool) -> Result<(), PhysicsFailure>;

    /// Progress so far.
    fn clock(&self) -> Clock;

    /// The time step (time); none where a method takes no steps.
    fn time_step(&self) -> Option<f64> {
        None
    }

    /// Data of each particle now.
    fn per_particle(&self) -> &dyn PerParticle;

    /// Particles now, positions inside the box.
    fn particles(&self) -> Particles {
        self.per_particle().particles()
    }

    /// Checks what only sums over all particles show; called before every row and at the end.
    ///
    /// # Errors
    /// [`PhysicsFailure`] as of [`advance`](Self::advance), where such a sum is wrong or cannot be computed.
    fn check(&self) -> Result<(), PhysicsFailure> {
        Ok(())
    }

    /// Checks that no rank is lost. Called after sampling the simulation and before writing any sample, because samples lack the particles of a lost
    /// rank.
    ///
    /// # Errors
    /// [`PhysicsFailure`] that names the first rank that was lost.
    fn check_ranks(&self) -> Result<(), PhysicsFailure> {
        Ok(())
    }

    /// Value of each of the method's quantities. Interval means cover the time since the last [`row`](Self::row), or since the start.
    fn observe(&self) -> Vec<f64>;

    /// Values of [`observe`](Self::observe) as a row: the next interval begins here.
    fn row(&mut self) -> Vec<f64> {
        self.observe()
    }

    /// Everything that the future depends on, and all counts: a summary does not depend on the number of sessions.
    fn snapshot(&self) -> Snapshot;

    /// Restores a snapshot that was taken when the clock showed `clock`.
    ///
    /// # Errors
    /// Says why, if the snapshot is not one of this method and scene.
    fn restore(&mut self, clock: Clock, snapshot: Snapshot) -> Result<(), String>;

    /// Changes a quantity now. The integrator, or the search for events, restarts at the present state, and the work of the change is no error of
    /// the energy balance.
    ///
    /// # Errors
    /// [`SteeringError`] if the method has no such quantity or the values do not suit it; then nothing has changed, unless the physics failed.
    fn steer(&mut self, change: &Change) -> Result<(), SteeringError> {
        let remedy = "start another scene with the new values";
        Err(has_no("this method", change.quantity, "its simulations cannot be changed", remedy))
    }

    /// Velocities of the scene's `[[walls]]`, without oscillations (length/time).
    fn wall_velocities(&self) -> Vec<[f64; 2]> {
        vec![]
    }

    /// Seconds spent in each phase since the start or the last reset, by name.
    fn phases(&self) -> BTreeMap<&'static str, f64>;

    /// Resets the seconds spent so far.
    fn reset_phases(&mut self);

    /// Work since the start, in the unit of the method's rates: particle steps, events or interactions.
    fn work(&self) -> f64;

    /// Vector operations of the last step with the vector length; none where they are not counted.
    fn operations(&self) -> Vec<(OpCounts, u64)> {
        vec![]
    }

    /// Entries of the method in `summary.json`.
    fn summary(&self) -> Map<String, Value>;

    /// Operations of the event queue since the start or restart, by kind: predictions, searches and moves. They are the terms of the method's cost
    /// formula, as [`operations`](Self::operations) are those of a step. A restarted run predicts some events again, so the counts belong to a
    /// session and no run writes them. Empty where there are no events.
    fn event_operations(&self) -> Vec<(&'static str, u64)> {
        vec![]
    }

    /// Takes the rows of `events.csv` since the last call, each with its line end.
    fn take_events(&mut self) -> String {
        String::new()
    }

    /// Warnings about what happened during the run.
    fn warnings(&self) -> Vec<RunWarning>;

    /// One-line description of the current state.
    fn in_words(&self) -> String;
}
