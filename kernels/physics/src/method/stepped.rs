//! Simulation loop shared by all methods with a time step.
//!
//! ```text
//! a run      holds a dyn Simulation
//! Stepped    the loop over steps, the clock, checkpoints: once, here
//! Stepwise   interface of a method: how to step, what to observe, what to report at the end
//! state      data that a step changes: discs visited in pairs (pairwise), discs on a lattice (lattice_md), bodies (nbody)
//! ```

use super::clock::{Clock, Until};
use super::failure::PhysicsFailure;
use super::observed::values;
use super::pairwise::Elapsed;
use super::simulation::{RunWarning, Simulation};
use super::snapshot::Snapshot;
use super::steering::{Change, Steering, SteeringError, WORK_OF_CHANGES, has_no};
use super::{MethodObservable, PerParticle, RANK_ENDED};
use crate::io::checkpoint::CheckpointColumn;
use serde_json::{Map, Value, json};
use std::collections::BTreeMap;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Instant;
use stripmine_kernels::isa::OpCounts;

/// State that steps change.
pub trait SteppedState: Send {
    /// Steps, periods and seconds so far.
    fn elapsed(&self) -> &Elapsed;

    /// Its particles.
    fn per_particle(&self) -> &dyn PerParticle;

    /// Checks that no rank is lost: samples taken since then lack its particles.
    ///
    /// # Errors
    /// [`PhysicsFailure`] that names the first rank that was lost.
    fn check_ranks(&self) -> Result<(), PhysicsFailure> {
        Ok(())
    }

    /// Everything that the next step depends on, by name.
    fn columns(&self) -> Vec<(String, CheckpointColumn)>;
}

/// Method with a time step. Its functions take the whole simulation: the state and what the method stores beside it.
pub trait Stepwise: Send + Sized {
    /// State that steps change.
    type State: SteppedState;
    /// Observation of a moment.
    type Seen: 'static;
    /// Evaluation of each quantity from the observation.
    const OBSERVABLES: &'static [MethodObservable<Self::Seen>];

    /// Makes one step. Returns true if it was made: an interrupted step leaves the previous state.
    ///
    /// # Errors
    /// As [`Simulation::advance`].
    fn step(run: &mut Stepped<Self>, interrupted: &AtomicBool) -> Result<bool, PhysicsFailure>;

    /// Applies a function to the observation of this moment.
    fn with_observation<R>(run: &Stepped<Self>, work: impl FnOnce(&Self::Seen) -> R) -> R;

    /// Values of the quantities that the scene has of its own.
    fn own_values(_run: &Stepped<Self>) -> Vec<f64> {
        vec![]
    }

    /// As [`Simulation::wall_velocities`].
    fn wall_velocities(_run: &Stepped<Self>) -> Vec<[f64; 2]> {
        vec![]
    }

    /// As [`Simulation::per_particle`], where the method has more data than the state.
    fn per_particle(run: &Stepped<Self>) -> &dyn PerParticle {
        run.state.per_particle()
    }

    /// As [`Simulation::check`].
    ///
    /// # Errors
    /// As there.
    fn check(_run: &Stepped<Self>) -> Result<(), PhysicsFailure> {
        Ok(())
    }

    /// Adds to the columns of the state what else the future depends on, and all counts.
    fn save_into(run: &Stepped<Self>, kept: &mut Snapshot);

    /// As [`Simulation::restore`], after the clock has been checked to count steps.
    ///
    /// # Errors
    /// As there.
    fn restore(run: &mut Stepped<Self>, clock: Clock, snapshot: Snapshot) -> Result<(), String>;

    /// Makes a change whose values are checked, and restarts the integrator; returns the work of the change (energy).
    ///
    /// # Errors
    /// As [`Simulation::steer`].
    fn change(_run: &mut Stepped<Self>, change: &Change) -> Result<f64, SteeringError> {
        let remedy = "start another scene with the new values";
        Err(has_no("this method", change.quantity, "its simulations cannot be changed", remedy))
    }

    /// Takes up the changes of a checkpoint, before its state is [restored](Self::restore). The integrator last began after `begun` steps.
    ///
    /// # Errors
    /// Says why, if this simulation has no such quantity.
    fn take_up(_run: &mut Stepped<Self>, steering: &Steering, begun: u64) -> Result<(), String> {
        let is_unchanged = (*steering, begun) == (Steering::default(), 0);
        if is_unchanged { Ok(()) } else { Err("it has changes, which this method does not make".to_owned()) }
    }

    /// As [`Simulation::phases`].
    fn phases(run: &Stepped<Self>) -> BTreeMap<&'static str, f64> {
        BTreeMap::from([("steps", run.seconds)])
    }

    /// Resets the times of [`phases`](Self::phases), except [`Stepped::seconds`].
    fn reset_phases(_run: &mut Stepped<Self>) {}

    /// As [`Simulation::work`].
    fn work(run: &Stepped<Self>) -> f64;

    /// As [`Simulation::operations`].
    fn operations(_run: &Stepped<Self>) -> Vec<(OpCounts, u64)> {
        vec![]
    }

    /// As [`Simulation::summary`].
    fn summary(run: &Stepped<Self>) -> Vec<(&'static str, Value)>;

    /// As [`Simulation::take_events`].
    fn take_events(_run: &mut Stepped<Self>) -> String {
        String::new()
    }

    /// As [`Simulation::warnings`].
    fn warnings(_run: &Stepped<Self>) -> Vec<RunWarning> {
        vec![]
    }

    /// As [`Simulation::in_words`].
    fn in_words(run: &Stepped<Self>) -> String;
}

/// Simulation of a method with a time step.
pub struct Stepped<M: Stepwise> {
    /// State that steps change.
    pub state: M::State,
    /// Data of the method beside the state.
    pub method: M,
    /// Seconds spent on steps.
    pub seconds: f64,
    /// Changes so far.
    pub(crate) steering: Steering,
}

/// Name of the step at which the integrator last began, in a checkpoint.
const BEGUN: &str = "steered.begun";

impl<M: Stepwise> Stepped<M> {
    /// Simulation of a state.
    pub fn new(state: M::State, method: M) -> Self {
        Stepped { state, method, seconds: 0.0, steering: Steering::default() }
    }

    /// Progress so far.
    pub fn clock(&self) -> Clock {
        self.state.elapsed().clock()
    }

    fn step_until(&mut self, until: &[Until], interrupted: &AtomicBool) -> Result<(), PhysicsFailure> {
        while !until.iter().any(|moment| moment.has_been_reached(&self.clock())) {
            if interrupted.load(Ordering::Relaxed) || !M::step(self, interrupted)? {
                break;
            }
        }
        Ok(())
    }

    /// Returns a sample, or none where a rank is lost.
    fn unless_rank_lost<T>(&self, seen: T) -> Option<T> {
        self.state.check_ranks().ok().map(|()| seen)
    }
}

impl<M: Stepwise> Simulation for Stepped<M> {
    fn advance(&mut self, until: &[Until], interrupted: &AtomicBool) -> Result<(), PhysicsFailure> {
        let begun = Instant::now();
        let done = self.step_until(until, interrupted);
        self.seconds += begun.elapsed().as_secs_f64();
        match (self.state.check_ranks(), done) {
            // The state was ended to continue with fewer particles, and that failed.
            (Err(ended), Err(failure)) if ended.kind != RANK_ENDED => Err(failure),
            // A step may fail because the particles of a rank are missing: report the loss first.
            (ranks, done) => ranks.and(done),
        }
    }

    fn clock(&self) -> Clock {
        Stepped::clock(self)
    }

    fn time_step(&self) -> Option<f64> {
        Some(self.state.elapsed().dt)
    }

    fn per_particle(&self) -> &dyn PerParticle {
        M::per_particle(self)
    }

    fn check(&self) -> Result<(), PhysicsFailure> {
        M::check(self)
    }

    fn check_ranks(&self) -> Result<(), PhysicsFailure> {
        self.state.check_ranks()
    }

    fn observe(&self) -> Vec<f64> {
        let mut seen = M::with_observation(self, |seen| values(M::OBSERVABLES, seen));
        seen.extend(M::own_values(self));
        self.unless_rank_lost(seen).unwrap_or_else(|| vec![f64::NAN; M::OBSERVABLES.len()])
    }

    fn snapshot(&self) -> Snapshot {
        let mut kept = Snapshot { columns: self.state.columns(), ..Snapshot::default() };
        M::save_into(self, &mut kept);
        self.steering.keep(&mut kept);
        if self.state.elapsed().begun > 0 {
            kept.add_count(BEGUN, self.state.elapsed().begun);
        }
        self.unless_rank_lost(kept).unwrap_or_default()
    }

    fn restore(&mut self, clock: Clock, snapshot: Snapshot) -> Result<(), String> {
        clock.check_step_clock(self.state.elapsed().dt)?;
        let is_begun = snapshot.counters.contains_key(BEGUN);
        let begun = if is_begun { snapshot.count_at_most(BEGUN, clock.steps)? } else { 0 };
        self.steering = Steering::of(&snapshot)?;
        let steering = self.steering;
        M::take_up(self, &steering, begun)?;
        M::restore(self, clock, snapshot)
    }

    fn wall_velocities(&self) -> Vec<[f64; 2]> {
        M::wall_velocities(self)
    }

    fn steer(&mut self, change: &Change) -> Result<(), SteeringError> {
        change.check(&self.particles(), M::wall_velocities(self).len())?;
        let work = M::change(self, change)?;
        self.steering.add(change, work);
        Ok(())
    }

    fn phases(&self) -> BTreeMap<&'static str, f64> {
        M::phases(self)
    }

    fn reset_phases(&mut self) {
        self.seconds = 0.0;
        M::reset_phases(self);
    }

    fn work(&self) -> f64 {
        M::work(self)
    }

    fn operations(&self) -> Vec<(OpCounts, u64)> {
        M::operations(self)
    }

    fn summary(&self) -> Map<String, Value> {
        let is_changed = self.steering != Steering::default() || self.state.elapsed().begun > 0;
        let work = is_changed.then(|| (WORK_OF_CHANGES, json!(self.steering.work)));
        let entries = M::summary(self).into_iter().chain(work);
        let entries = entries.map(|(name, value)| (name.to_owned(), value)).collect();
        self.unless_rank_lost(entries).unwrap_or_default()
    }

    fn take_events(&mut self) -> String {
        M::take_events(self)
    }

    fn warnings(&self) -> Vec<RunWarning> {
        self.unless_rank_lost(M::warnings(self)).unwrap_or_default()
    }

    fn in_words(&self) -> String {
        self.unless_rank_lost(M::in_words(self)).unwrap_or_default()
    }
}
