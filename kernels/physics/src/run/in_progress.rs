//! Run in progress: a simulation and its recorder, advanced piece by piece.

use super::recorder::{OfTheStart, RunRecorder};
use super::{ExistingRun, RunError, RunJob, Summary, starts_from_beginning};
use crate::io::checkpoint::NAME;
use crate::method::{Change, Clock, PhysicsFailure, Simulation, SteeringError, Until};
use crate::signals::{self, HoldGuard};
use std::path::Path;
use std::sync::atomic::AtomicBool;
use std::time::Instant;

/// Record of a run in its folder: rows, frames, checkpoints and changes of a simulation that the caller owns.
pub struct RunInProgress {
    pub(super) recorder: RunRecorder,
    pub(super) from: Clock,
    start: Instant,
    /// A signal ends the run with a checkpoint.
    _held: HoldGuard,
}

impl RunInProgress {
    /// Starts a simulation whose run is recorded in `folder`, or resumes the run there. `notice` receives unusual findings on resumption.
    ///
    /// # Errors
    /// [`RunError`] if the folder belongs to others, the start breaks a precondition, or the run cannot be resumed.
    pub fn open(
        job: &mut RunJob<'_>,
        folder: &Path,
        existing: ExistingRun,
        notice: impl FnMut(&str),
    ) -> Result<(RunInProgress, Box<dyn Simulation>), RunError> {
        job.prepared.memory.fits("scene")?;
        // Refusals come before expensive work.
        starts_from_beginning(folder, existing)?;
        let of_the_start = OfTheStart::new(job, folder);
        let mut simulation = job.prepared.start().map_err(RunError::Start)?;
        let job = &*job;
        // An interrupted start would leave a folder without a checkpoint; a resumed run has one.
        let held = (!matches!(existing, ExistingRun::Resume { .. })).then(signals::hold);
        let recorder = RunRecorder::open(folder, existing, (job, of_the_start), simulation.as_mut())?;
        recorder.new_notes().iter().map(String::as_str).for_each(notice);
        let (from, _held) = (simulation.clock(), held.unwrap_or_else(signals::hold));
        Ok((RunInProgress { recorder, from, start: Instant::now(), _held }, simulation))
    }

    /// Writes a simulation into a folder, which becomes that of a run: a row, a frame and a checkpoint.
    ///
    /// # Errors
    /// [`RunError`] if the folder contains a run that must stay, or cannot be written.
    pub fn save(
        job: &RunJob<'_>,
        folder: &Path,
        existing: ExistingRun,
        simulation: &mut dyn Simulation,
    ) -> Result<(), RunError> {
        let of_the_start = OfTheStart::new(job, folder);
        let (clock, state) = (simulation.clock(), simulation.snapshot());
        let mut recorder = RunRecorder::open(folder, existing, (job, of_the_start), simulation)?;
        // Its row has begun another interval of means: saving must not change the simulation.
        let file = folder.join(NAME);
        simulation.restore(clock, state).map_err(|reason| RunError::Foreign { file, reason })?;
        recorder.checkpoint(simulation)
    }

    /// Starts a simulation in the state of the newest checkpoint in a folder, in which nothing is changed.
    ///
    /// # Errors
    /// [`RunError`] if there is no checkpoint, or it is of another scene or version.
    pub fn restored(
        job: &mut RunJob<'_>,
        folder: &Path,
        other_version: bool,
    ) -> Result<Box<dyn Simulation>, RunError> {
        job.prepared.memory.fits("scene")?;
        let of_the_start = OfTheStart::new(job, folder);
        let mut simulation = job.prepared.start().map_err(RunError::Start)?;
        of_the_start.restore(folder, simulation.as_mut(), other_version)?;
        Ok(simulation)
    }

    /// Advances until one of some moments is reached or anything is due, and writes what is due. Changes of an earlier session are made again at their
    /// moments. Returns soon after `interrupted` is set.
    ///
    /// # Errors
    /// [`RunError`]; after a failure of the physics, the folder has the state of that step and a summary of the failure.
    pub fn advance(
        &mut self,
        job: &RunJob<'_>,
        simulation: &mut dyn Simulation,
        until: &[Until],
        interrupted: &AtomicBool,
    ) -> Result<(), RunError> {
        let RunInProgress { recorder, .. } = self;
        let mut moments = until.to_vec();
        moments.extend(recorder.due());
        moments.extend(recorder.changes.next_moment(&simulation.clock()));
        let advanced = simulation.advance(&moments, interrupted);
        recorder.log(simulation)?;
        let is_over = job.prepared.schedule.until.has_been_reached(&simulation.clock());
        let failed = match advanced.and_then(|()| if is_over { simulation.check() } else { Ok(()) }) {
            Ok(()) => match recorder.write_due_outputs(simulation) {
                Err(RunError::Lost(failure)) => Some(failure),
                written => written?,
            },
            Err(failure) => Some(failure),
        };
        let failed = match failed {
            None => recorder.repeat_changes(simulation)?,
            failed => failed,
        };
        failed.map_or(Ok(()), |failure| self.fail(job, simulation, failure))
    }

    /// Changes a quantity of the simulation, and logs the change.
    ///
    /// # Errors
    /// The outer error if the log cannot be written, or the physics fails; the inner one for a refused change.
    pub fn change(
        &mut self,
        job: &RunJob<'_>,
        simulation: &mut dyn Simulation,
        change: &Change,
    ) -> Result<Result<(), SteeringError>, RunError> {
        match self.recorder.change(simulation, change)? {
            Err(SteeringError::Failed(failure)) => self.fail(job, simulation, failure).map(Ok),
            changed => Ok(changed),
        }
    }

    /// Writes a checkpoint.
    ///
    /// # Errors
    /// [`RunError`] if it cannot be written.
    pub fn checkpoint(&mut self, simulation: &dyn Simulation) -> Result<(), RunError> {
        self.recorder.checkpoint(simulation)
    }

    /// Ends the run: writes a last checkpoint, the last frame and the summary.
    ///
    /// # Errors
    /// [`RunError`] if they cannot be written.
    pub fn finish(&mut self, job: &RunJob<'_>, simulation: &dyn Simulation) -> Result<Summary, RunError> {
        let summary = self.summary(job, simulation, None);
        self.recorder.finish(simulation, summary)
    }

    /// Writes the state and the summary of a failure.
    fn fail(
        &mut self,
        job: &RunJob<'_>,
        simulation: &dyn Simulation,
        failure: PhysicsFailure,
    ) -> Result<(), RunError> {
        let summary = self.summary(job, simulation, Some(&failure));
        self.recorder.write_failure(simulation, summary)?;
        simulation.check_ranks().map_err(RunError::Lost)?;
        Err(RunError::Physics { failure, snapshot: self.recorder.trajectory_path() })
    }

    fn summary(
        &self,
        job: &RunJob<'_>,
        simulation: &dyn Simulation,
        failure: Option<&PhysicsFailure>,
    ) -> Summary {
        let seconds = self.start.elapsed().as_secs_f64();
        Summary::of(job, simulation, self.recorder.averages(), self.from, seconds, failure)
    }
}
