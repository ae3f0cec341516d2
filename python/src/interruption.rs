//! Work that Ctrl-C can end: it runs in a separate thread while the calling thread handles signals.

use crate::pulse::BEAT;
use pyo3::prelude::*;
use std::io;
use std::panic::resume_unwind;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::thread;

/// Runs work that ends soon after its flag is set. Returns its result, and the exception that a signal raised meanwhile.
///
/// # Errors
/// If no thread can be started; then nothing was done.
pub(crate) fn beside<R: Send>(work: impl FnOnce(&AtomicBool) -> R + Send) -> io::Result<(R, Option<PyErr>)> {
    let interrupted = &AtomicBool::new(false);
    let (done, waiting) = channel::<()>();
    let work = move || {
        // Dropped when the work ends, however it ends.
        let _done = done;
        work(interrupted)
    };
    thread::scope(|scope| {
        let worker = thread::Builder::new().name("beside".to_owned()).spawn_scoped(scope, work)?;
        let mut signal = None;
        while waiting.recv_timeout(BEAT) == Err(RecvTimeoutError::Timeout) {
            if signal.is_none() {
                let answered = Python::try_attach(|py| py.check_signals());
                // If the interpreter is shutting down, the work ends too.
                interrupted.store(!matches!(answered, Some(Ok(()))), Ordering::Relaxed);
                signal = answered.and_then(Result::err);
            }
        }
        Ok((worker.join().unwrap_or_else(|panic| resume_unwind(panic)), signal))
    })
}
