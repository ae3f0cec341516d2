//! Computing beside Python: other threads of Python go on meanwhile, a fault becomes an exception, and a process that was forked off threads
//! that have computed is refused instead of waiting for them for ever.

use crate::exceptions;
use pyo3::prelude::*;
use std::any::Any;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::atomic::{AtomicBool, Ordering};

/// Whether this process has computed, and with that has threads.
static HAS_COMPUTED: AtomicBool = AtomicBool::new(false);
/// Whether it was forked off one that had.
static IS_FORKED: AtomicBool = AtomicBool::new(false);

/// What a child process does first.
#[pyfunction]
pub(crate) fn _forked() {
    IS_FORKED.store(HAS_COMPUTED.load(Ordering::Relaxed), Ordering::Relaxed);
}

/// Computes without holding up other threads of Python.
///
/// # Errors
/// If the process was forked off one that had computed, or the program is at fault.
pub(crate) fn computed<R: Send>(py: Python<'_>, work: impl FnOnce() -> R + Send) -> PyResult<R> {
    if IS_FORKED.load(Ordering::Relaxed) {
        let message = "this process was forked off one that had computed, and its threads are not here\n  \
                       help: start processes by multiprocessing.get_context(\"spawn\")";
        return Err(exceptions::refused(py, message));
    }
    HAS_COMPUTED.store(true, Ordering::Relaxed);
    let done = py.detach(|| catch_unwind(AssertUnwindSafe(work)));
    done.map_err(|said| exceptions::fault(py, words(said.as_ref())))
}

/// What a panic says.
fn words(said: &(dyn Any + Send)) -> &str {
    let text = said.downcast_ref::<String>().map(String::as_str);
    text.or_else(|| said.downcast_ref::<&str>().copied()).unwrap_or("it does not say why")
}
