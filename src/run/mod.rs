//! A run: advance, observe, record; checkpoints, interruption, resumption. What it writes is a folder of its own:
//! `scene.toml`, `thermo.csv`, `trajectory.xyz`, `summary.json`, `run.checkpoint`, a list of all this (`run.files`) and, on
//! request, LAMMPS files.

mod assemble;
mod folder;
mod frames;
mod identity;
pub mod memory;
mod recorder;
mod summary;
mod work;

pub use assemble::{assemble, assemble_following_energy, model};
pub use folder::FolderError;
pub use summary::Summary;
pub use work::Balance;

use crate::io::FileError;
use crate::io::checkpoint::{CheckpointError, WriteError};
use crate::io::growing_file::GrowingFileError;
use crate::io::table_file::TableFileError;
use crate::method::{Failure, Method};
use crate::scene::{Checked, Document, SceneErrors};
use crate::signals;
use recorder::Recorder;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};

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
        .0.display()
    )]
    Exists(PathBuf),
    /// The folder is another's, or another process writes there.
    #[error(transparent)]
    Folder(#[from] FolderError),
    /// More steps are done than asked for.
    #[error(
        "the run in {} has done {done} steps already, and {asked} are asked for: ask for run.steps={done} or more",
        folder.display()
    )]
    FewerSteps {
        /// The folder.
        folder: PathBuf,
        /// Steps done.
        done: u64,
        /// Steps of the scene.
        asked: u64,
    },
    /// The discs at the start are not those of the run.
    #[error(
        "{} was begun with other discs than the scene now has at its start ({file}): digest {theirs} then, {ours} now; give the start back its contents, or begin again in another folder",
        folder.display()
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
        folder.display()
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
        folder.display()
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
    #[error("{failure}\nthe state of that step is the last frame of {}", snapshot.display())]
    Physics {
        /// What broke.
        failure: Failure,
        /// Where the last frame is.
        snapshot: PathBuf,
    },
    /// The physics of the first moment, before anything was written.
    #[error(transparent)]
    Start(Failure),
    /// A checkpoint that cannot be used.
    #[error(transparent)]
    Checkpoint(#[from] CheckpointError),
    /// A checkpoint of another program or scene.
    #[error("the checkpoint {}: {reason}", file.display())]
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
    /// The table of observables.
    #[error(transparent)]
    Table(#[from] TableFileError),
    /// The frames.
    #[error(transparent)]
    Frames(#[from] GrowingFileError),
}

impl RunError {
    /// Whether what lies in the folder has been damaged since it was written.
    pub fn is_damage(&self) -> bool {
        match self {
            RunError::Checkpoint(error) => error.is_corrupt(),
            RunError::Table(error) => error.is_damage(),
            RunError::Frames(error) => error.is_damage(),
            RunError::Folder(error) => matches!(error, FolderError::List { .. }),
            RunError::Foreign { .. } => true,
            _ => false,
        }
    }

    /// Whether the request is refused, for what lies in the folder already or for who else writes there.
    pub fn is_refusal(&self) -> bool {
        match self {
            RunError::Folder(error) => error.is_refusal(),
            RunError::Exists(_)
            | RunError::FewerSteps { .. }
            | RunError::OtherScene { .. }
            | RunError::OtherDiscs { .. }
            | RunError::OtherVersion { .. } => true,
            _ => false,
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
        /// Steps done.
        step: u64,
    },
}

/// Runs a scene into `folder`. `interrupted` is looked at after every step; `progress(step, steps)` now and then; `notice`
/// hears what is out of the ordinary about going on with a run.
///
/// # Errors
/// [`RunError`]; where the physics broke, the folder holds the state of that step and a summary that says so.
pub fn run(
    document: Document,
    folder: &Path,
    existing: Existing,
    interrupted: &AtomicBool,
    mut progress: impl FnMut(u64, u64),
    notice: impl FnMut(&str),
) -> Result<Ending, RunError> {
    let checked = document.check()?;
    memory::foreseen(&checked).fits("scene")?;
    // What would be refused in the end is refused before anything takes its time.
    folder::listed(folder)?;
    let mut method = assemble_following_energy(&checked).map_err(RunError::Start)?;
    // A beginning that is cut off would leave a folder without a checkpoint; a run that is resumed has one.
    let held = (!matches!(existing, Existing::Resume { .. })).then(signals::hold);
    let mut recorder = Recorder::open(folder, existing, &checked, method.as_mut())?;
    let _held = held.unwrap_or_else(signals::hold);
    recorder.new_notes().iter().map(String::as_str).for_each(notice);
    let steps = checked.scene.run.steps;
    let stride = (steps / 1000).max(1);
    let start = std::time::Instant::now();
    while method.steps() < steps {
        if interrupted.load(Ordering::Relaxed) {
            recorder.checkpoint(method.as_ref())?;
            return Ok(Ending::Interrupted { step: method.steps() });
        }
        let failed = match method.step() {
            Ok(()) => recorder.after_step(method.as_ref())?,
            Err(failure) => Some(failure),
        };
        if let Some(failure) = failed {
            let energy = recorder.balance(method.as_ref());
            let summary = summarize(&checked, method.as_ref(), energy, start, Some(&failure));
            recorder.fail(method.as_ref(), summary)?;
            return Err(RunError::Physics { failure, snapshot: recorder.trajectory_path() });
        }
        if method.steps().is_multiple_of(stride) {
            progress(method.steps(), steps);
        }
    }
    let energy = recorder.balance(method.as_ref());
    let summary = summarize(&checked, method.as_ref(), energy, start, None);
    let summary = recorder.finish(method.as_ref(), summary)?;
    Ok(Ending::Done(Box::new(summary)))
}

fn summarize(
    checked: &Checked,
    method: &dyn Method,
    energy: Balance,
    start: std::time::Instant,
    failure: Option<&Failure>,
) -> Summary {
    Summary::of(checked, method, energy, start.elapsed().as_secs_f64(), failure)
}
