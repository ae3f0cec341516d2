//! A run: advance, observe, record; checkpoints, interruption, resumption. What it writes is a folder of its own:
//! `scene.toml`, `thermo.csv`, `summary.json`, `run.checkpoint`, a list of all this (`run.files`), the particles in each format
//! ([`FORMATS`](crate::io::FORMATS)) that the scene asks for and, on request, a row for each event (`events.csv`) and what is summed up
//! of the structure.

mod block_means;
mod finished;
mod folder;
pub mod forecast;
mod functions;
mod goal;
mod growing;
mod identity;
mod moments;
mod recorder;
mod structured;
mod summary;
mod table;
#[cfg(test)]
mod tests;

pub use finished::{Finished, FinishedError, averages_of};
pub use functions::{Function, Number, Point, function_of, functions_of};
pub use identity::chosen_otherwise;
pub use structured::Summed;
pub use summary::Summary;
pub use table::{TableError, TableReader};

use crate::io::checkpoint::{CheckpointError, WriteError};
use crate::io::growing_file::GrowingFileError;
use crate::io::lock::Lock;
use crate::io::{FileError, FolderError};
use crate::method::{Clock, Failure, Prepared, Purpose, Quantity, Until};
use crate::number::significant;
use crate::origin::Origin;
use crate::quoted;
use crate::reported::{Class, FilePlace, Reported};
use crate::scene::{SceneErrors, Target, Width};
use crate::signals;
use folder::RUN;
use recorder::Recorder;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

/// What to do with a folder that holds a run already.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Existing {
    /// Refuse.
    Refuse,
    /// Go on from its newest checkpoint; begin where there is none.
    Resume {
        /// Also where another version of the program, which does not promise the same bits, began it.
        other_version: bool,
    },
    /// Begin from the start; what the run there wrote is lost.
    Overwrite,
}

/// Why a run did not come to its end.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum RunError {
    /// The folder holds a run.
    #[error(
        "{} holds a run already: add --resume to go on with it, --overwrite to lose it, or choose another --out",
        quoted::path(.0)
    )]
    Exists(PathBuf),
    /// The folder is another's, or another process writes there.
    #[error(transparent)]
    Folder(#[from] FolderError),
    /// More is done than asked for.
    #[error(
        "the run in {} has come to {done} already, and {asked} is asked for: ask for {done} or more",
        quoted::path(folder)
    )]
    FewerSteps {
        /// The folder.
        folder: PathBuf,
        /// How far the run has come.
        done: Until,
        /// The end of the scene.
        asked: Until,
    },
    /// The discs at the start are not those of the run.
    #[error(
        "{} was begun with other discs than the scene now has at its start ({file}): digest {theirs} then, {ours} now; give the start back its contents, or begin again in another folder",
        quoted::path(folder)
    )]
    OtherDiscs {
        /// The folder.
        folder: PathBuf,
        /// The start file, if there is one.
        file: String,
        /// Beginning of the digest of the run's discs.
        theirs: String,
        /// Beginning of the digest of those of the scene.
        ours: String,
    },
    /// The program is not the one of the run.
    #[error(
        "{} was last written by {theirs}; this is {ours}, which does not promise the same bits: go on with that one, or with this one nevertheless by --other-version",
        quoted::path(folder)
    )]
    OtherVersion {
        /// The folder.
        folder: PathBuf,
        /// The program of the run.
        theirs: String,
        /// This program.
        ours: String,
    },
    /// The scene is not the one of the run.
    #[error(
        "{} was run with another scene; its scene.toml says `{theirs}`, the scene given `{ours}` (only [run] and [output] may \
         change on resumption)",
        quoted::path(folder)
    )]
    OtherScene {
        /// The folder.
        folder: PathBuf,
        /// The first line that differs, in the folder.
        theirs: String,
        /// The same line of the scene given.
        ours: String,
    },
    /// The scene.
    #[error(transparent)]
    Scene(#[from] SceneErrors),
    /// The physics.
    #[error(
        "{}\nthe state of that step is the last frame of {}\n  help: {}",
        failure.what(),
        quoted::path(snapshot),
        failure.remedy
    )]
    Physics {
        /// What broke.
        failure: Failure,
        /// Where the last frame is.
        snapshot: PathBuf,
    },
    /// The physics of the first moment, before anything was written.
    #[error(transparent)]
    Start(Failure),
    /// A rank was lost: the state of that step is not known, and is in no file.
    #[error(transparent)]
    Lost(Failure),
    /// The mean that should end the run is not known well enough at its latest end.
    #[error(
        "{bound} is over, and the mean of {} is {}, not to ± {} (95 %); what was found is in {}{}",
        target.quantity,
        error.map_or_else(|| "not known".to_owned(), |error| format!("known to ± {error}")),
        target.error,
        quoted::path(folder),
        enough_at.map_or_else(String::new, |time| format!("\n  help: go on with --resume to about time {}", significant(time, 2)))
    )]
    Unreached {
        /// The folder of the run.
        folder: PathBuf,
        /// What was asked for.
        target: Target,
        /// The latest end.
        bound: Until,
        /// The half width of the interval of 95 %, if there is a mean.
        error: Option<Width>,
        /// About when it would be reached (time), if anything tells.
        enough_at: Option<f64>,
    },
    /// A checkpoint that cannot be used.
    #[error(transparent)]
    Checkpoint(#[from] CheckpointError),
    /// A checkpoint of another program or scene.
    #[error("the checkpoint {}: {reason}", quoted::path(file))]
    Foreign {
        /// The checkpoint.
        file: PathBuf,
        /// What does not fit.
        reason: String,
    },
    /// A checkpoint that cannot be written.
    #[error(transparent)]
    CheckpointWriting(#[from] WriteError),
    /// A file.
    #[error(transparent)]
    File(#[from] FileError),
    /// The rows of earlier sessions.
    #[error(transparent)]
    Rows(#[from] TableError),
    /// A file of earlier sessions that grows.
    #[error(transparent)]
    Growing(#[from] GrowingFileError),
}

impl Reported for RunError {
    fn class(&self) -> Class {
        match self {
            RunError::Scene(errors) => errors.class(),
            RunError::Physics { failure, .. } | RunError::Start(failure) | RunError::Lost(failure) => {
                failure.class()
            }
            RunError::Exists(_)
            | RunError::FewerSteps { .. }
            | RunError::OtherScene { .. }
            | RunError::OtherDiscs { .. }
            | RunError::OtherVersion { .. } => Class::Usage,
            RunError::Foreign { .. } => Class::Checkpoint,
            RunError::Unreached { .. } => Class::Precondition,
            RunError::Folder(error) => error.class(),
            RunError::Rows(error) => error.class(),
            RunError::Checkpoint(error) if error.is_corrupt() => Class::Checkpoint,
            RunError::Growing(error) if error.is_damage() => Class::Checkpoint,
            RunError::Checkpoint(_)
            | RunError::Growing(_)
            | RunError::CheckpointWriting(_)
            | RunError::File(_) => Class::InputOutput,
        }
    }

    fn passed_on(&self) -> Option<&dyn Reported> {
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
            _ => self.passed_on()?.place(),
        }
    }

    fn remedy(&self) -> Option<String> {
        match self {
            RunError::Exists(_) => Some("--resume, --overwrite or another --out".to_owned()),
            _ => self.passed_on()?.remedy(),
        }
    }
}

/// How a run ended.
#[derive(Clone, Debug)]
pub enum Ending {
    /// All steps are done.
    Done(Box<Summary>),
    /// Interrupted; a checkpoint was written.
    Interrupted {
        /// How far it has come.
        clock: Clock,
    },
}

/// What is run, and by whom.
#[derive(Clone, Copy)]
pub struct Job<'j> {
    /// The scene.
    pub prepared: &'j Prepared,
    /// What its method observes.
    pub quantities: &'static [Quantity],
    /// The program that runs it, for the record.
    pub program: &'j Origin,
}

/// At most this part of a run goes by without a word of its progress; a smaller one where that takes longer than a second.
const STRIDES: u64 = 1000;
const LONGEST_STRIDE: Duration = Duration::from_secs(1);

/// Whether a run into a folder begins at the start, as far as the folder tells before anything is computed.
///
/// # Errors
/// If the folder is another's, or holds a run that is to stay.
pub fn begins(folder: &Path, existing: Existing) -> Result<bool, RunError> {
    let holds = RUN.listed(folder)?.is_some_and(|names| !names.is_empty());
    if holds {
        drop(Lock::take(&folder.join(RUN.lock))?);
    }
    match existing {
        Existing::Refuse if holds => Err(RunError::Exists(folder.to_owned())),
        Existing::Resume { .. } => Ok(!holds),
        Existing::Refuse | Existing::Overwrite => Ok(true),
    }
}

/// Runs a scene into `folder`. `interrupted` is looked at after every step; `progress(done, all)` hears now and then how much
/// of the way is done; `notice` hears what is out of the ordinary about going on with a run.
///
/// # Errors
/// [`RunError`]; where the physics broke, the folder holds the state of that step and a summary that says so.
pub fn run(
    job: Job<'_>,
    folder: &Path,
    existing: Existing,
    interrupted: &AtomicBool,
    mut progress: impl FnMut(u64, u64),
    notice: impl FnMut(&str),
) -> Result<Ending, RunError> {
    let prepared = job.prepared;
    prepared.memory.fits("scene")?;
    // What would be refused in the end is refused before anything takes its time.
    begins(folder, existing)?;
    let mut simulation = prepared.start(Purpose::Run).map_err(RunError::Start)?;
    // A beginning that is cut off would leave a folder without a checkpoint; a run that is resumed has one.
    let held = (!matches!(existing, Existing::Resume { .. })).then(signals::hold);
    let mut recorder = Recorder::open(folder, existing, job, simulation.as_mut())?;
    let _held = held.unwrap_or_else(signals::hold);
    recorder.new_notes().iter().map(String::as_str).for_each(notice);
    let until = prepared.schedule.until;
    let from = simulation.clock();
    let mut strides = STRIDES;
    let start = Instant::now();
    while !(until.has_come(&simulation.clock()) || recorder.has_reached_its_goal()) {
        if interrupted.load(Ordering::Relaxed) {
            recorder.checkpoint(simulation.as_ref())?;
            return Ok(Ending::Interrupted { clock: simulation.clock() });
        }
        let mut moments = vec![until, stride(until, strides).after(&simulation.clock())];
        moments.extend(recorder.due());
        let begun = Instant::now();
        let advanced = simulation.advance(&moments, interrupted);
        if begun.elapsed() > LONGEST_STRIDE {
            strides = strides.saturating_mul(2);
        }
        recorder.log(simulation.as_mut())?;
        let is_over = until.has_come(&simulation.clock());
        let failed = match advanced.and_then(|()| if is_over { simulation.check() } else { Ok(()) }) {
            Ok(()) => match recorder.write_what_is_due(simulation.as_mut()) {
                Err(RunError::Lost(failure)) => Some(failure),
                written => written?,
            },
            Err(failure) => Some(failure),
        };
        if let Some(failure) = failed {
            let seconds = start.elapsed().as_secs_f64();
            let averages = recorder.averages();
            let summary = Summary::of(job, simulation.as_ref(), averages, from, seconds, Some(&failure));
            recorder.fail(simulation.as_ref(), summary)?;
            simulation.check_ranks().map_err(RunError::Lost)?;
            return Err(RunError::Physics { failure, snapshot: recorder.trajectory_path() });
        }
        let (done, all) = until.progress(&simulation.clock());
        progress(done, all);
    }
    let seconds = start.elapsed().as_secs_f64();
    let summary = Summary::of(job, simulation.as_ref(), recorder.averages(), from, seconds, None);
    let summary = recorder.finish(simulation.as_ref(), summary)?;
    if let Some((goal, known)) = recorder.missed_goal() {
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

/// How far a run goes between two words of its progress, and looks at the wall clock.
fn stride(until: Until, strides: u64) -> Until {
    match until {
        Until::Steps(steps) => Until::Steps((steps / strides).max(1)),
        Until::Time(time) => Until::Time(time / strides as f64),
        Until::Events(events) => Until::Events((events / strides).max(1)),
    }
}
