//! Trials: runs of a scene made by a study, observed on the way.

pub(super) mod any_number;
mod failure;
mod mean_error;
mod pairs;
mod sample;
mod stopwatch;

pub(crate) use failure::{FailureCause, RunFailure};
pub(crate) use mean_error::{MeanEstimate, ROWS, RowPace};
pub(crate) use pairs::{
    PairedConfigurations, PairedMeans, TOGETHER, Window, run_pairs, shown_part, steady_bias,
};
pub(crate) use sample::{SampleSpan, TrialSample, values};
pub(crate) use stopwatch::Stopwatch;

use crate::results::ProgressMeter;
use std::sync::atomic::{AtomicBool, Ordering};
use stripmine_physics::method::{Prepared, Simulation, StartPurpose, Until};

/// Shortest timing of a step (s).
const PROBE: f64 = 2e-3;
/// Shortest total time of the repeats of a short run (s).
const TOGETHER_AT_LEAST: f64 = 1e-3;

/// Clock of trials, and the flag that interrupts them.
#[derive(Clone, Copy, Debug)]
pub(crate) struct TrialControl<'t> {
    pub watch: &'t Stopwatch,
    /// Set when the user interrupts.
    pub stop: &'t AtomicBool,
}

/// Length of a run, and its samples.
#[derive(Clone, Copy, Debug)]
pub(crate) struct RunSampling {
    pub steps: u64,
    /// Number of samples, evenly spaced, the last one at the end.
    pub looks: u64,
    /// Expected seconds of a step.
    pub(crate) each: f64,
}

impl TrialControl<'_> {
    /// Runs a scene and returns its final state. `look` is called at every sample, and before the first step.
    ///
    /// # Errors
    /// [`RunFailure`] if it fails, or the user interrupts it.
    pub(crate) fn follow(
        &self,
        prepared: &Prepared,
        purpose: StartPurpose,
        course: RunSampling,
        meter: &ProgressMeter<'_>,
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
    /// [`RunFailure`] if it fails, or the user interrupts it.
    pub(crate) fn advance_to_step(
        &self,
        simulation: &mut dyn Simulation,
        step: u64,
    ) -> Result<(), RunFailure> {
        self.watch.during(simulation, |it| it.advance(&[Until::Steps(step)], self.stop))?;
        if self.stop.load(Ordering::Relaxed) { Err(RunFailure::interrupted()) } else { Ok(()) }
    }

    /// Measures the seconds of a step over the first steps of a run, at most `most`.
    ///
    /// # Errors
    /// [`RunFailure`] if it fails, or the user interrupts it.
    pub(crate) fn seconds_of_a_step(&self, prepared: &Prepared, most: u64) -> Result<f64, RunFailure> {
        let mut simulation = prepared.start(StartPurpose::Measurement)?;
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

    /// Measures the seconds of a run of some steps, without its start; short runs are repeated.
    ///
    /// # Errors
    /// [`RunFailure`] if it fails, or the user interrupts it.
    pub(crate) fn seconds_of_a_run(&self, prepared: &Prepared, steps: u64) -> Result<f64, RunFailure> {
        let (mut spent, mut runs) = (0.0, 0);
        while spent < TOGETHER_AT_LEAST {
            let mut simulation = prepared.start(StartPurpose::Measurement)?;
            let begun = self.watch.now();
            self.advance_to_step(simulation.as_mut(), steps)?;
            spent += self.watch.now() - begun;
            runs += 1;
        }
        Ok(spent / f64::from(runs))
    }
}
