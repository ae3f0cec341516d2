//! A simulation under way, as runs see those of every method.

use super::clock::{Clock, Until};
use super::failure::Failure;
use super::snapshot::Snapshot;
use crate::particles::{Particles, PerParticle};
use serde::Serialize;
use serde_json::{Map, Value};
use std::collections::BTreeMap;
use std::sync::atomic::AtomicBool;
use stripmine_kernels::isa::OpCounts;

/// Finding of a check along a run.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct RunWarning {
    /// The name of the check.
    pub check: &'static str,
    /// What was found.
    pub value: f64,
    /// What it is held against.
    pub limit: f64,
    /// What was found, in a sentence with what to do.
    pub message: String,
}

/// A simulation under way. It never prints and never writes a file.
pub trait Simulation: Send {
    /// Goes on until the first of some moments has come, or `interrupted` is set; soon after that in either case.
    ///
    /// # Errors
    /// [`Failure`] says what broke, which particles, where, and what to do; the state is that of the failing step.
    fn advance(&mut self, until: &[Until], interrupted: &AtomicBool) -> Result<(), Failure>;

    /// How far it has come.
    fn clock(&self) -> Clock;

    /// The time step (time); none where a method takes no steps.
    fn time_step(&self) -> Option<f64> {
        None
    }

    /// Data of each particle as it stands.
    fn per_particle(&self) -> &dyn PerParticle;

    /// The particles as they stand, positions inside the box.
    fn particles(&self) -> Particles {
        self.per_particle().particles()
    }

    /// Holds the state against what only sums over all particles show; asked before every row, and at the end.
    ///
    /// # Errors
    /// [`Failure`] as of [`advance`](Self::advance), where such a sum is wrong, or cannot be had.
    fn check(&self) -> Result<(), Failure> {
        Ok(())
    }

    /// Checks that no rank is lost, where there are several: asked after a look at the simulation and before anything of it is written, for a
    /// look lacks the particles of a rank that is lost.
    ///
    /// # Errors
    /// [`Failure`] that names the first rank that was lost.
    fn check_ranks(&self) -> Result<(), Failure> {
        Ok(())
    }

    /// A value for each of the method's quantities; means over an interval are of the time since the last [`row`](Self::row), or since the
    /// start.
    fn observe(&self) -> Vec<f64>;

    /// What [`observe`](Self::observe) gives, as a row: the next interval begins here.
    fn row(&mut self) -> Vec<f64> {
        self.observe()
    }

    /// Everything that the future depends on, and what has been counted: a summary is the same in however many sessions.
    fn snapshot(&self) -> Snapshot;

    /// Takes up a snapshot that was made when the clock showed `clock`.
    ///
    /// # Errors
    /// A sentence, if the snapshot is not one of this method and scene.
    fn restore(&mut self, clock: Clock, snapshot: Snapshot) -> Result<(), String>;

    /// Seconds spent in each phase since the start or the last reset, by name.
    fn phases(&self) -> BTreeMap<&'static str, f64>;

    /// Forgets the seconds spent so far.
    fn reset_phases(&mut self);

    /// Work since the start, in the unit of the method's rates: particle steps, events or interactions.
    fn work(&self) -> f64;

    /// Operations of the last step on whole vectors, with the elements of each vector; none where they are not counted.
    fn operations(&self) -> Vec<(OpCounts, u64)> {
        vec![]
    }

    /// What there is to be said at the end: the method's own entries of `summary.json`.
    fn summary(&self) -> Map<String, Value>;

    /// Predictions, searches and moves in the queue that events have cost since it was started or taken up, by kind: the terms of the
    /// method's cost formula, as [`operations`](Self::operations) are those of a step. One that is taken up predicts some events again, so
    /// the counts are of a session, and no run writes them. Empty where there are no events.
    fn event_operations(&self) -> Vec<(&'static str, u64)> {
        vec![]
    }

    /// The rows of `events.csv` since this was last asked, each with its end of line.
    fn take_events(&mut self) -> String {
        String::new()
    }

    /// What happened on the way that seldom means well.
    fn warnings(&self) -> Vec<RunWarning>;

    /// The last state, in a line.
    fn in_words(&self) -> String;
}
