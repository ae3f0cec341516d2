//! Computing without the interpreter's lock: other Python threads continue, and a panic becomes an exception. A process that was
//! forked after the first computation is rejected, since it would wait forever for threads that it does not have.

use crate::exceptions;
use pyo3::prelude::*;
use std::any::Any;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::atomic::{AtomicBool, Ordering};

/// Set once this process has computed, and so has threads.
static HAS_COMPUTED: AtomicBool = AtomicBool::new(false);
/// Set in a process that was forked from one with threads.
static IS_FORKED: AtomicBool = AtomicBool::new(false);

/// Marks a forked child process; called first in the child.
#[pyfunction]
pub(crate) fn _forked() {
    IS_FORKED.store(HAS_COMPUTED.load(Ordering::Relaxed), Ordering::Relaxed);
}

/// Computes without blocking other Python threads.
///
/// # Errors
/// If the process was forked from one that had computed, or the program panics.
pub(crate) fn computed<R: Send>(py: Python<'_>, work: impl FnOnce() -> R + Send) -> PyResult<R> {
    if IS_FORKED.load(Ordering::Relaxed) {
        let message = "this process was forked from one that had computed, and has none of its threads\n  \
                       help: start processes with multiprocessing.get_context(\"spawn\")";
        return Err(exceptions::refused(py, message));
    }
    HAS_COMPUTED.store(true, Ordering::Relaxed);
    let done = py.detach(|| catch_unwind(AssertUnwindSafe(work)));
    done.map_err(|said| exceptions::fault(py, words(said.as_ref())))
}

/// Message of a panic.
fn words(said: &(dyn Any + Send)) -> &str {
    let text = said.downcast_ref::<String>().map(String::as_str);
    text.or_else(|| said.downcast_ref::<&str>().copied()).unwrap_or("no message")
}
