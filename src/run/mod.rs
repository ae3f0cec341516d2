//! A run: advance, observe, record; checkpoints, interruption, resumption. What it writes is a folder:
//! `scene.toml`, `thermo.csv`, `trajectory.xyz`, `summary.json`, `run.checkpoint` and, on request, LAMMPS files.

mod assemble;

mod recorder;
mod summary;
mod work;

pub use assemble::{assemble, assemble_following_energy, model};
pub use summary::Summary;
pub use work::Balance;

use crate::io::FileError;
use crate::io::checkpoint::{CheckpointError, WriteError};
use crate::io::extxyz::TrajectoryError;
use crate::io::table_file::TableFileError;
use crate::method::{Failure, Method};
use crate::scene::{Checked, Document, SceneErrors};
use recorder::Recorder;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};

/// What to do with a folder that holds a run already.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Existing {
    /// Refuse.
    Refuse,
    /// Go on from its newest checkpoint.
    Resume,
    /// Begin anew; what was there is lost.
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
    /// The folder holds nothing to go on from.
    #[error("{} holds no checkpoint to resume from; leave out --resume to begin", .0.display())]
    NothingToResume(PathBuf),
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
    /// The trajectory.
    #[error(transparent)]
    Trajectory(#[from] TrajectoryError),
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

/// Runs a scene into `folder`. `interrupted` is looked at after every step; `progress(step, steps)` now and then.
///
/// # Errors
/// [`RunError`]; where the physics broke, the folder holds the state of that step and a summary that says so.
pub fn run(
    document: Document,
    folder: &Path,
    existing: Existing,
    interrupted: &AtomicBool,
    mut progress: impl FnMut(u64, u64),
) -> Result<Ending, RunError> {
    let checked = document.check()?;
    let mut method = assemble_following_energy(&checked).map_err(RunError::Start)?;
    let mut recorder = match existing {
        Existing::Resume => Recorder::resume(folder, &checked, method.as_mut())?,
        _ if existing == Existing::Refuse && Recorder::is_run(folder) => {
            return Err(RunError::Exists(folder.to_owned()));
        }
        _ => Recorder::begin(folder, &checked, method.as_ref())?,
    };
    let steps = checked.scene.run.steps;
    let stride = (steps / 1000).max(1);
    let start = std::time::Instant::now();
    while method.steps() < steps {
        if interrupted.load(Ordering::Relaxed) {
            recorder.checkpoint(method.as_ref())?;
            return Ok(Ending::Interrupted { step: method.steps() });
        }
        if let Err(failure) = method.step() {
            recorder.last_frame(method.as_ref())?;
            let energy = recorder.balance(method.as_ref());
            let summary = summarize(&checked, method.as_ref(), energy, start, Some(&failure));
            recorder.summary(&summary)?;
            return Err(RunError::Physics { failure, snapshot: recorder.trajectory_path() });
        }
        recorder.after_step(method.as_ref())?;
        if method.steps().is_multiple_of(stride) {
            progress(method.steps(), steps);
        }
    }
    recorder.checkpoint(method.as_ref())?;
    recorder.final_files(method.as_ref())?;
    let energy = recorder.balance(method.as_ref());
    let summary = summarize(&checked, method.as_ref(), energy, start, None);
    recorder.summary(&summary)?;
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
