//! Trials: runs of a scene that a study makes, observed on the way.

pub(super) mod any_number;
mod failure;
mod known;
mod pairs;
mod sample;
mod stopwatch;

pub(crate) use failure::{Cause, RunFailure};
pub(crate) use known::{Known, Pace, ROWS};
pub(crate) use pairs::{Compared, Paired, TOGETHER, Window, pairs, part, steady};
pub(crate) use sample::{Sample, Span, values};
pub(crate) use stopwatch::Stopwatch;

use crate::results::Meter;
use std::sync::atomic::{AtomicBool, Ordering};
use stripmine_physics::method::{Prepared, Purpose, Simulation, Until};

/// Seconds of a probe at least.
const PROBE: f64 = 2e-3;
/// Seconds that the repeats of a short run take together at least.
const TOGETHER_AT_LEAST: f64 = 1e-3;

/// Clock of trials, and the flag that ends them before their time.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Trial<'t> {
    /// Seconds that they take.
    pub watch: &'t Stopwatch,
    /// Set where a user asks for the end.
    pub stop: &'t AtomicBool,
}

/// Length of a run, and the moments at which it is observed.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Course {
    pub steps: u64,
    /// Looks, evenly spread, the last one at the end.
    pub looks: u64,
    /// Seconds that a step is expected to take.
    pub(crate) each: f64,
}

impl Trial<'_> {
    /// Runs a scene and returns its end. `look` sees it at every look, and before the first step.
    ///
    /// # Errors
    /// [`RunFailure`] if it breaks, or the user asks for the end.
    pub(crate) fn follow(
        &self,
        prepared: &Prepared,
        purpose: Purpose,
        course: Course,
        meter: &Meter<'_>,
        mut look: impl FnMut(&dyn Simulation),
    ) -> Result<Box<dyn Simulation>, RunFailure> {
        let mut simulation = prepared.start(purpose)?;
        let mut done = 0;
        for at in 0..=course.looks {
            let step = course.steps * at / course.looks.max(1);
            self.advance_to_step(simulation.as_mut(), step)?;
            meter.add(course.each * (step - done) as f64);
            done = step;
            look(simulation.as_ref());
        }
        Ok(simulation)
    }

    /// Advances a simulation to a step, counted from its start.
    ///
    /// # Errors
    /// [`RunFailure`] if it breaks, or the user asks for the end.
    pub(crate) fn advance_to_step(
        &self,
        simulation: &mut dyn Simulation,
        step: u64,
    ) -> Result<(), RunFailure> {
        self.watch.during(simulation, |it| it.advance(&[Until::Steps(step)], self.stop))?;
        if self.stop.load(Ordering::Relaxed) { Err(RunFailure::interrupted()) } else { Ok(()) }
    }

    /// Seconds of a step, over the first steps of a run, `most` at most.
    ///
    /// # Errors
    /// [`RunFailure`] if it breaks, or the user asks for the end.
    pub(crate) fn seconds_of_a_step(&self, prepared: &Prepared, most: u64) -> Result<f64, RunFailure> {
        let mut simulation = prepared.start(Purpose::Measurement)?;
        let begun = self.watch.now();
        let mut steps = 1;
        loop {
            self.advance_to_step(simulation.as_mut(), steps)?;
            let spent = self.watch.now() - begun;
            if spent > PROBE || steps >= most {
                return Ok(spent / steps as f64);
            }
            steps = (2 * steps).min(most);
        }
    }

    /// Seconds of a run of some steps without its start; short runs are repeated.
    ///
    /// # Errors
    /// [`RunFailure`] if it breaks, or the user asks for the end.
    pub(crate) fn seconds_of_a_run(&self, prepared: &Prepared, steps: u64) -> Result<f64, RunFailure> {
        let (mut spent, mut runs) = (0.0, 0);
        while spent < TOGETHER_AT_LEAST {
            let mut simulation = prepared.start(Purpose::Measurement)?;
            let begun = self.watch.now();
            self.advance_to_step(simulation.as_mut(), steps)?;
            spent += self.watch.now() - begun;
            runs += 1;
        }
        Ok(spent / f64::from(runs))
    }
}
