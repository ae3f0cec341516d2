//! Execution of a run: advance, observe, record; checkpoints, interruption, resumption. A run writes a folder of its own: `scene.toml`,
//! `thermo.csv`, `summary.json`, `run.checkpoint`, a list of these files (`run.files`), `changes.csv` if the user changes anything, and the particles in each format
//! ([`FORMATS`](crate::io::FORMATS)) that the scene requests. On request it writes a row for each event (`events.csv`) and averages of the
//! structure.

mod block_means;
mod changes;
mod finished;
mod folder;
pub mod forecast;
mod functions;
mod goal;
mod growing;
mod identity;
mod in_progress;
mod moments;
mod points;
mod recorder;
mod structured;
mod summary;
mod table;
#[cfg(test)]
mod tests;

pub use finished::{FinishedError, FinishedRun, averages_of};
pub use functions::{FunctionPoint, Number, StructureFunction, function_of, functions_of};
pub use identity::{check_scene_of_folder, choices_of_the_run};
pub use in_progress::RunInProgress;
pub use points::{ScenePoint, ScenePoints, points_of};
pub use structured::StructureSummary;
pub use summary::Summary;
pub use table::{TableError, TableReader};

use crate::io::checkpoint::{CheckpointError, WriteError};
use crate::io::growing_file::GrowingFileError;
use crate::io::lock::Lock;
use crate::io::{FileError, FolderError};
use crate::method::{Clock, ObservedQuantity, PhysicsFailure, Prepared, Simulation, StartPurpose, Until};
use crate::number::significant;
use crate::origin::Origin;
use crate::quoted;
use crate::reported::{ErrorClass, FilePlace, Reported};
use crate::scene::{MeanTarget, SceneErrors, Width};
use folder::RUN;
use std::ops::Deref;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

/// Treatment of a folder that contains a run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ExistingRun {
    /// Refuse to write.
    Refuse,
    /// Resume from the newest checkpoint; start if there is none.
    Resume {
        /// True to resume also a run of another version of the program that does not promise the same bits.
        other_version: bool,
    },
    /// Start again; the files of the previous run are lost.
    Overwrite,
}

/// Reason why a run did not complete.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum RunError {
    /// The folder contains a run.
    #[error(
        "{} already contains a run: add --resume to continue it, --overwrite to delete it, or choose another --out",
        quoted::path(.0)
    )]
    Exists(PathBuf),
    /// The folder belongs to others, or another process writes there.
    #[error(transparent)]
    Folder(#[from] FolderError),
    /// The run has passed the end that is asked for.
    #[error(
        "the run in {} has already reached {done}, beyond the {asked} asked for: ask for {done} or more",
        quoted::path(folder)
    )]
    FewerSteps {
        /// Folder of the run.
        folder: PathBuf,
        /// Time, steps or events reached.
        done: Until,
        /// End of the scene.
        asked: Until,
    },
    /// The initial discs are not those of the run.
    #[error(
        "{} was started with other discs than the scene now has ({file}): digest {theirs} then, {ours} now; restore the start, or start again in another folder",
        quoted::path(folder)
    )]
    OtherDiscs {
        /// Folder of the run.
        folder: PathBuf,
        /// Start file, if there is one.
        file: String,
        /// First digits of the digest of the run's discs.
        theirs: String,
        /// First digits of the digest of the scene's discs.
        ours: String,
    },
    /// Another version of the program wrote the run.
    #[error(
        "{} was last written by {theirs}; this is {ours}, which does not promise the same bits: resume with that version, or add --other-version to resume with this one",
        quoted::path(folder)
    )]
    OtherVersion {
        /// Folder of the run.
        folder: PathBuf,
        /// Program of the run.
        theirs: String,
        /// Program that resumes it.
        ours: String,
    },
    /// The scene is not that of the run.
    #[error(
        "{} was run with another scene; its scene.toml has `{theirs}`, the scene given `{ours}` (only [run] and [output] may \
         change on resumption)",
        quoted::path(folder)
    )]
    OtherScene {
        /// Folder of the run.
        folder: PathBuf,
        /// First line that differs, in the folder.
        theirs: String,
        /// Corresponding line of the given scene.
        ours: String,
    },
    /// The scene is invalid.
    #[error(transparent)]
    Scene(#[from] SceneErrors),
    /// The physics broke a precondition during the run.
    #[error(
        "{}\nthe state of that step is the last frame of {}\n  help: {}",
        failure.what_and_when(),
        quoted::path(snapshot),
        failure.remedy
    )]
    Physics {
        /// Failure of the physics.
        failure: PhysicsFailure,
        /// Path of the file with the last frame.
        snapshot: PathBuf,
    },
    /// The physics broke a precondition before anything was written.
    #[error(transparent)]
    Start(PhysicsFailure),
    /// A rank was lost: the state of that step is unknown and in no file.
    #[error(transparent)]
    Lost(PhysicsFailure),
    /// The mean that should end the run did not reach its target error.
    #[error(
        "the run reached its latest end, {bound}, but the mean of {} is {}, not to ± {} (95 %); results are in {}{}",
        target.quantity,
        error.map_or_else(|| "not known".to_owned(), |error| format!("known to ± {error}")),
        target.error,
        quoted::path(folder),
        enough_at.map_or_else(String::new, |time| format!("\n  help: extend the run with --resume to about time {}", significant(time, 2)))
    )]
    Unreached {
        /// Folder of the run.
        folder: PathBuf,
        /// Target error.
        target: MeanTarget,
        /// Latest end.
        bound: Until,
        /// Half-width of the 95 % confidence interval, if there is a mean.
        error: Option<Width>,
        /// Estimated time at which the target would be reached (time), if known.
        enough_at: Option<f64>,
    },
    /// The checkpoint cannot be used.
    #[error(transparent)]
    Checkpoint(#[from] CheckpointError),
    /// The checkpoint is of another program or scene.
    #[error("the checkpoint {}: {reason}", quoted::path(file))]
    Foreign {
        /// Path of the checkpoint.
        file: PathBuf,
        /// Difference found.
        reason: String,
    },
    /// The checkpoint cannot be written.
    #[error(transparent)]
    CheckpointWriting(#[from] WriteError),
    /// A file cannot be read or written.
    #[error(transparent)]
    File(#[from] FileError),
    /// The rows of earlier sessions are invalid.
    #[error(transparent)]
    Rows(#[from] TableError),
    /// The log of changes is invalid.
    #[error(
        "{}, line {line}: {reason}; restore the file, or start again with --overwrite",
        quoted::path(file)
    )]
    Changes {
        /// Path of the log.
        file: PathBuf,
        /// Line, from 1.
        line: u64,
        /// Mistake.
        reason: String,
    },
    /// A growing file of earlier sessions is invalid.
    #[error(transparent)]
    Growing(#[from] GrowingFileError),
}

impl Reported for RunError {
    fn class(&self) -> ErrorClass {
        match self {
            RunError::Scene(errors) => errors.class(),
            RunError::Physics { failure, .. } | RunError::Start(failure) | RunError::Lost(failure) => {
                failure.class()
            }
            RunError::Exists(_)
            | RunError::FewerSteps { .. }
            | RunError::OtherScene { .. }
            | RunError::OtherDiscs { .. }
            | RunError::OtherVersion { .. } => ErrorClass::Usage,
            RunError::Foreign { .. } | RunError::Changes { .. } => ErrorClass::Checkpoint,
            RunError::Unreached { .. } => ErrorClass::Precondition,
            RunError::Folder(error) => error.class(),
            RunError::Rows(error) => error.class(),
            RunError::Checkpoint(error) if error.is_corrupt() => ErrorClass::Checkpoint,
            RunError::Growing(error) if error.is_damage() => ErrorClass::Checkpoint,
            RunError::Checkpoint(_)
            | RunError::Growing(_)
            | RunError::CheckpointWriting(_)
            | RunError::File(_) => ErrorClass::InputOutput,
        }
    }

    fn inner_error(&self) -> Option<&dyn Reported> {
        match self {
            RunError::Scene(errors) => Some(errors),
            RunError::Physics { failure, .. } | RunError::Start(failure) | RunError::Lost(failure) => {
                Some(failure)
            }
            RunError::Rows(error) => Some(error),
            RunError::Folder(error) => Some(error),
            RunError::File(error) => Some(error),
            _ => None,
        }
    }

    fn place(&self) -> Option<FilePlace> {
        match self {
            RunError::Exists(folder)
            | RunError::FewerSteps { folder, .. }
            | RunError::OtherDiscs { folder, .. }
            | RunError::OtherVersion { folder, .. }
            | RunError::OtherScene { folder, .. }
            | RunError::Unreached { folder, .. } => Some(FilePlace::at(folder)),
            RunError::Checkpoint(CheckpointError { file, .. }) | RunError::Foreign { file, .. } => {
                Some(FilePlace::at(file))
            }
            RunError::Changes { file, line, .. } => {
                Some(FilePlace { line: Some(*line as usize), ..FilePlace::at(file) })
            }
            _ => self.inner_error()?.place(),
        }
    }

    fn remedy(&self) -> Option<String> {
        match self {
            RunError::Exists(_) => Some("--resume, --overwrite or another --out".to_owned()),
            _ => self.inner_error()?.remedy(),
        }
    }
}

/// End of a run.
#[derive(Clone, Debug)]
pub enum Ending {
    /// Completed.
    Done(Box<Summary>),
    /// Interrupted after a checkpoint was written.
    Interrupted {
        /// Moment reached.
        clock: Clock,
    },
}

/// Scene to run, with its context.
pub struct RunJob<'j> {
    /// Prepared scene.
    pub prepared: SceneToRun<'j>,
    /// Quantities of its method.
    pub quantities: &'static [ObservedQuantity],
    /// Program that runs it, for the record.
    pub program: &'j Origin,
    /// True if the caller advances the run, beyond the end of the scene, too.
    pub is_open_ended: bool,
}

/// Prepared scene of a run: kept by the caller, or given to the run, which then releases the particles at the start as soon as the simulation
/// has its own.
pub enum SceneToRun<'j> {
    /// Kept.
    Kept(&'j Prepared),
    /// Given.
    Given(Box<Prepared>),
}

impl SceneToRun<'_> {
    fn start(&mut self) -> Result<Box<dyn Simulation>, PhysicsFailure> {
        match self {
            SceneToRun::Kept(prepared) => prepared.start(StartPurpose::Run),
            SceneToRun::Given(prepared) => prepared.start_last(StartPurpose::Run),
        }
    }
}

impl Deref for SceneToRun<'_> {
    type Target = Prepared;

    fn deref(&self) -> &Prepared {
        match self {
            SceneToRun::Kept(prepared) => prepared,
            SceneToRun::Given(prepared) => prepared,
        }
    }
}

impl<'j> From<&'j Prepared> for SceneToRun<'j> {
    fn from(prepared: &'j Prepared) -> Self {
        SceneToRun::Kept(prepared)
    }
}

impl From<Prepared> for SceneToRun<'_> {
    fn from(prepared: Prepared) -> Self {
        SceneToRun::Given(Box::new(prepared))
    }
}

/// Number of progress reports of a run, and the longest interval between two; it has more reports if this is exceeded.
const STRIDES: u64 = 1000;
const LONGEST_STRIDE: Duration = Duration::from_secs(1);

/// Returns true if a run into a folder starts from the beginning, before anything is computed.
///
/// # Errors
/// If the folder belongs to others, or contains a run that must stay.
pub fn starts_from_beginning(folder: &Path, existing: ExistingRun) -> Result<bool, RunError> {
    let holds = RUN.listed_names(folder)?.is_some_and(|names| !names.is_empty());
    if holds {
        drop(Lock::take(&folder.join(RUN.lock))?);
    }
    match existing {
        ExistingRun::Refuse if holds => Err(RunError::Exists(folder.to_owned())),
        ExistingRun::Resume { .. } => Ok(!holds),
        ExistingRun::Refuse | ExistingRun::Overwrite => Ok(true),
    }
}

/// Runs a scene into `folder`. `interrupted` is checked after every step. `progress(done, all)` is called occasionally, and `notice` receives
/// unusual findings on resumption.
///
/// # Errors
/// [`RunError`]; after a failure of the physics, the folder has the state of that step and a summary of the failure.
pub fn run(
    mut job: RunJob<'_>,
    folder: &Path,
    existing: ExistingRun,
    interrupted: &AtomicBool,
    mut progress: impl FnMut(u64, u64),
    notice: impl FnMut(&str),
) -> Result<Ending, RunError> {
    let (mut running, mut simulation) = RunInProgress::open(&mut job, folder, existing, notice)?;
    let job = &job;
    let until = job.prepared.schedule.until;
    let mut strides = STRIDES;
    while !(until.has_been_reached(&simulation.clock()) || running.recorder.has_reached_goal()) {
        if interrupted.load(Ordering::Relaxed) {
            running.checkpoint(simulation.as_ref())?;
            return Ok(Ending::Interrupted { clock: simulation.clock() });
        }
        let moments = [until, stride(until, strides).after(&simulation.clock())];
        let begun = Instant::now();
        running.advance(job, simulation.as_mut(), &moments, interrupted)?;
        if begun.elapsed() > LONGEST_STRIDE {
            strides = strides.saturating_mul(2);
        }
        let (done, all) = until.progress(&simulation.clock());
        progress(done, all);
    }
    let summary = running.finish(job, simulation.as_ref())?;
    if let Some((goal, known)) = running.recorder.missed_goal() {
        let (target, bound) = (goal.target().clone(), until);
        return Err(RunError::Unreached {
            folder: folder.to_owned(),
            target,
            bound,
            error: known.error,
            enough_at: known.enough_at,
        });
    }
    Ok(Ending::Done(Box::new(summary)))
}

/// Interval of a run between two progress reports and checks of the wall clock.
fn stride(until: Until, strides: u64) -> Until {
    match until {
        Until::Steps(steps) => Until::Steps((steps / strides).max(1)),
        Until::Time(time) => Until::Time(time / strides as f64),
        Until::Events(events) => Until::Events((events / strides).max(1)),
    }
}
