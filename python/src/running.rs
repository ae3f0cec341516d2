//! Whole runs, which Ctrl-C ends at the next step with a checkpoint.

use crate::checked::CheckedScene;
use crate::computing::computed;
use crate::exceptions;
use crate::interruption::beside;
use crate::scratch::Scratch;
use pyo3::exceptions::PyUserWarning;
use pyo3::prelude::*;
use std::ffi::CString;
use std::path::Path;
use std::sync::atomic::AtomicBool;
use stripmine_physics::origin::Origin;
use stripmine_physics::run::{ExistingRun, RunError, RunJob, run};

/// Version and commit of the package, recorded with runs.
pub(crate) fn built() -> Origin {
    Origin {
        version: env!("CARGO_PKG_VERSION").to_owned(),
        commit: env!("STRIPMINE_COMMIT").to_owned(),
        dirty: env!("STRIPMINE_DIRTY") == "true",
        target: env!("STRIPMINE_TARGET").to_owned(),
    }
}

/// Makes a temporary folder for the results of a run.
///
/// # Errors
/// If it cannot be made.
pub(crate) fn begin_scratch(py: Python<'_>) -> PyResult<Scratch> {
    Scratch::new()
        .map_err(|cause| exceptions::refused(py, format!("a temporary folder cannot be made: {cause}")))
}

/// Runs a scene into a folder; the inner result has the failure of the run.
///
/// # Errors
/// `KeyboardInterrupt` after Ctrl-C, with a checkpoint in the folder.
pub(crate) fn carry_out(
    py: Python<'_>,
    checked: &CheckedScene,
    folder: &Path,
    existing: ExistingRun,
) -> PyResult<Result<(), RunError>> {
    let CheckedScene { prepared, entry, .. } = checked;
    let quantities = prepared.quantities(entry);
    let job =
        RunJob { prepared: prepared.into(), quantities, program: &built(), is_open_ended: false };
    let mut notes = vec![];
    let notice = |note: &str| notes.push(note.to_owned());
    let work = |interrupted: &AtomicBool| run(job, folder, existing, interrupted, |_, _| {}, notice);
    let (ending, signal) =
        computed(py, || beside(work))?.map_err(|cause| exceptions::without_threads(py, &cause))?;
    warn(py, notes)?;
    match signal {
        Some(signal) => Err(signal),
        None => Ok(ending.map(drop)),
    }
}

/// Treatment of a folder that contains a run, from arguments.
///
/// # Errors
/// `Error` if they contradict each other.
pub(crate) fn existing(
    py: Python<'_>,
    [resume, overwrite, other_version]: [bool; 3],
) -> PyResult<ExistingRun> {
    match (resume, overwrite) {
        (true, true) => Err(exceptions::refused(py, "resume and overwrite exclude each other")),
        (false, _) if other_version => Err(exceptions::refused(py, "other_version needs resume=True")),
        (true, _) => Ok(ExistingRun::Resume { other_version }),
        (_, true) => Ok(ExistingRun::Overwrite),
        _ => Ok(ExistingRun::Refuse),
    }
}

/// Passes notes on as warnings.
pub(crate) fn warn(py: Python<'_>, notes: Vec<String>) -> PyResult<()> {
    for note in notes {
        PyErr::warn(py, &py.get_type::<PyUserWarning>(), &CString::new(note)?, 2)?;
    }
    Ok(())
}
