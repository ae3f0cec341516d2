//! Changes of a recorded simulation, and states that are restored without a record.

use super::{EVENT_COUNT, OfTheStart, RunRecorder, take_count, unless_rank_lost};
use crate::io::checkpoint::{Checkpoint, LatestCheckpoint, NAME, read_latest};
use crate::method::{Change, Clock, PhysicsFailure, Simulation, Snapshot, SteeringError};
use crate::run::RunError;
use crate::run::changes::CHANGES;
use std::path::Path;

impl OfTheStart {
    /// Restores the newest checkpoint in a folder, in which nothing is changed.
    ///
    /// # Errors
    /// [`RunError`] if there is none, or it is of another scene or version.
    pub(in crate::run) fn restore(
        &self,
        folder: &Path,
        simulation: &mut dyn Simulation,
        other_version: bool,
    ) -> Result<(), RunError> {
        let Some(LatestCheckpoint { file, mut checkpoint }) = read_latest(folder)? else {
            let (file, reason) = (folder.join(NAME), "there is none".to_owned());
            return Err(RunError::Foreign { file, reason });
        };
        let events = take_count(&mut checkpoint, EVENT_COUNT);
        let clock = Clock { steps: checkpoint.step, time: checkpoint.time, events };
        self.identity.check(folder, &checkpoint, clock, other_version)?;
        let Checkpoint { counters, columns, .. } = checkpoint;
        let restored = simulation.restore(clock, Snapshot { counters, columns });
        unless_rank_lost(simulation, restored)?.map_err(|reason| RunError::Foreign { file, reason })
    }
}

impl RunRecorder {
    /// Makes a change and logs it.
    ///
    /// # Errors
    /// The outer error if the log cannot be written; the inner one for a refused change or a failure.
    pub(in crate::run) fn change(
        &mut self,
        simulation: &mut dyn Simulation,
        change: &Change,
    ) -> Result<Result<(), SteeringError>, RunError> {
        let clock = simulation.clock();
        if let Some(later) = self.changes.last_pending() {
            let reason =
                format!("the run was changed at {later} before it was interrupted, and this is {clock}");
            let remedy =
                "advance to there, which makes those changes again; or delete the later lines of changes.csv";
            return Ok(Err(SteeringError::refused(reason, remedy)));
        }
        let changed = simulation.steer(change);
        if changed.is_ok() {
            self.folder.claim([CHANGES], false)?;
            self.changes.append(&clock, change)?;
            self.changes.made += 1;
            self.checkpointed = None;
        }
        Ok(changed)
    }

    /// Makes the changes of an earlier session that are due; returns a failure of the physics.
    pub(in crate::run) fn repeat_changes(
        &mut self,
        simulation: &mut dyn Simulation,
    ) -> Result<Option<PhysicsFailure>, RunError> {
        let clock = simulation.clock();
        while let Some(change) = self.changes.take_due(&clock) {
            match simulation.steer(&change) {
                Ok(()) => {}
                Err(SteeringError::Failed(failure)) => return Ok(Some(failure)),
                Err(refused) => {
                    let (file, line) = (self.folder.file(CHANGES), self.changes.made + 2);
                    return Err(RunError::Changes { file, line, reason: refused.to_string() });
                }
            }
            self.changes.made += 1;
            self.checkpointed = None;
        }
        Ok(None)
    }
}
