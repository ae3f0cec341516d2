//! Runs of a scene for a study, made now or recalled from its journal.

use super::trial::{RunFailure, RunSampling, TrialControl};
use super::{StudyError, Subject};
use crate::results::{Journal, ProgressMeter};
use serde::Serialize;
use serde::de::DeserializeOwned;
use stripmine_physics::method::{Prepared, Simulation, StartPurpose};
use stripmine_physics::signals;

/// Most steps of a timing run.
const PROBED: u64 = 4096;

/// State of a study.
pub(crate) struct StudyRuns<'r> {
    pub(crate) subject: &'r Subject,
    pub(crate) trial: TrialControl<'r>,
    pub journal: &'r Journal,
    pub(crate) meter: &'r ProgressMeter<'r>,
}

impl StudyRuns<'_> {
    /// Returns the result of a run, or its failure: from the journal, if a finished run `fits`; otherwise from a new run, which is recorded.
    ///
    /// # Errors
    /// [`StudyError::Interrupted`], which is not recorded, and [`StudyError::Journal`].
    pub(crate) fn recall<T: Serialize + DeserializeOwned>(
        &self,
        key: &str,
        fits: impl FnOnce(&T) -> bool,
        run: impl FnOnce() -> Result<T, RunFailure>,
    ) -> Result<Result<T, RunFailure>, StudyError> {
        let fits = |found: &Result<T, RunFailure>| found.as_ref().map_or(true, fits);
        self.journal.recall(key, fits, || match run() {
            Err(failure) if failure.is_interruption() => {
                signals::await_end();
                Err(StudyError::Interrupted)
            }
            finished => Ok(finished),
        })
    }

    /// Runs a scene and returns its final state; `look` is called at every sample, and before the first step.
    ///
    /// # Errors
    /// [`RunFailure`] if it fails, or the user interrupts it.
    pub(crate) fn follow(
        &self,
        scene: &Prepared,
        purpose: StartPurpose,
        course: RunSampling,
        look: impl FnMut(&dyn Simulation),
    ) -> Result<Box<dyn Simulation>, RunFailure> {
        self.trial.follow(scene, purpose, course, self.meter, look)
    }

    /// Measures the seconds of a step over the first steps of a scene.
    ///
    /// # Errors
    /// [`RunFailure`] if it fails, or the user interrupts it.
    pub(crate) fn probe(&self, scene: &Prepared) -> Result<f64, RunFailure> {
        self.trial.seconds_of_a_step(scene, self.subject.steps.min(PROBED))
    }
}
