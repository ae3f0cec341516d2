//! Progress data of every simulation with steps.

use super::{Crossings, Timings};
use crate::method::Clock;

/// Steps done, periods crossed, seconds spent.
#[derive(Clone, Debug)]
pub struct Elapsed {
    /// Time step (time).
    pub dt: f64,
    /// Steps since the start of the scene.
    pub steps: u64,
    /// Steps after which the integrator began: 0, or those of the last [change](crate::method::Change).
    pub(crate) begun: u64,
    /// Periods that discs have crossed.
    pub crossings: Crossings,
    /// Seconds spent in each phase.
    pub(crate) timings: Timings,
}

impl Elapsed {
    /// Progress at the start.
    pub fn new(dt: f64, crossings: Crossings) -> Self {
        Elapsed { dt, steps: 0, begun: 0, crossings, timings: Timings::default() }
    }

    /// Progress at the start of particles whose periods are not counted.
    pub fn of_steps(dt: f64) -> Self {
        Elapsed::new(dt, Crossings::default())
    }

    /// Time since the start of the scene.
    pub fn time(&self) -> f64 {
        self.steps as f64 * self.dt
    }

    /// True if the integrator begins here: the state is corrected.
    pub(crate) fn is_beginning(&self) -> bool {
        self.steps == self.begun
    }

    /// Progress as a clock.
    pub fn clock(&self) -> Clock {
        Clock { steps: self.steps, time: self.time(), events: 0 }
    }
}
