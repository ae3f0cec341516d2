//! A whole run, which Ctrl-C ends at its next step with a checkpoint.

use crate::computing::computed;
use crate::exceptions;
use crate::pulse::BEAT;
use crate::scene::Checked;
use crate::scratch::Scratch;
use pyo3::exceptions::PyUserWarning;
use pyo3::prelude::*;
use std::ffi::CString;
use std::io;
use std::panic::resume_unwind;
use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::thread;
use stripmine_physics::origin::Origin;
use stripmine_physics::run::{Ending, Existing, Job, RunError, run};

/// The package, for the record.
fn built() -> Origin {
    Origin {
        version: env!("CARGO_PKG_VERSION").to_owned(),
        commit: env!("STRIPMINE_COMMIT").to_owned(),
        dirty: env!("STRIPMINE_DIRTY") == "true",
        target: env!("STRIPMINE_TARGET").to_owned(),
    }
}

/// A folder for the results of a run that nobody has asked to keep.
///
/// # Errors
/// If the system does not let it be made.
pub(crate) fn begin_scratch(py: Python<'_>) -> PyResult<Scratch> {
    Scratch::new()
        .map_err(|cause| exceptions::refused(py, format!("no folder for results can be made: {cause}")))
}

/// Runs a scene into a folder; gives what the command says where it fails.
///
/// # Errors
/// `KeyboardInterrupt` after Ctrl-C, with a checkpoint in the folder.
pub(crate) fn carry_out(
    py: Python<'_>,
    checked: &Checked,
    folder: &Path,
    existing: Existing,
) -> PyResult<Result<(), RunError>> {
    let mut notes = vec![];
    let (ending, signal) = computed(py, || beside(checked, folder, existing, &mut notes))?
        .map_err(|cause| exceptions::refused(py, format!("the threads cannot be had: {cause}")))?;
    for note in notes {
        PyErr::warn(py, &py.get_type::<PyUserWarning>(), &CString::new(note)?, 2)?;
    }
    match signal {
        Some(signal) => Err(signal),
        None => Ok(ending.map(drop)),
    }
}

/// The run in a thread of its own, while this one answers signals: how it ended, and the exception that a signal made.
fn beside(
    checked: &Checked,
    folder: &Path,
    existing: Existing,
    notes: &mut Vec<String>,
) -> io::Result<(Result<Ending, RunError>, Option<PyErr>)> {
    let interrupted = AtomicBool::new(false);
    let (done, waiting) = channel::<()>();
    let work = || {
        // It goes when the run is over, however that ends.
        let _done = done;
        let Checked { prepared, entry, .. } = checked;
        let job = Job { prepared, quantities: entry.quantities, program: &built() };
        run(job, folder, existing, &interrupted, |_, _| {}, |note| notes.push(note.to_owned()))
    };
    thread::scope(|scope| {
        let worker = thread::Builder::new().name("run".to_owned()).spawn_scoped(scope, work)?;
        let mut signal = None;
        while waiting.recv_timeout(BEAT) == Err(RecvTimeoutError::Timeout) {
            if signal.is_none() {
                let answered = Python::try_attach(|py| py.check_signals());
                // Where Python is about to end, the run is too.
                interrupted.store(!matches!(answered, Some(Ok(()))), Ordering::Relaxed);
                signal = answered.and_then(Result::err);
            }
        }
        Ok((worker.join().unwrap_or_else(|panic| resume_unwind(panic)), signal))
    })
}
