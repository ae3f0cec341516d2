//! Work that Ctrl-C ends: it is done in a thread of its own, while the one that asked for it answers signals.

use crate::pulse::BEAT;
use pyo3::prelude::*;
use std::io;
use std::panic::resume_unwind;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::thread;

/// Does work that ends soon after its flag is set; gives what comes out, and the exception that a signal made meanwhile.
///
/// # Errors
/// If the system gives no thread for it; then nothing was done.
pub(crate) fn beside<R: Send>(work: impl FnOnce(&AtomicBool) -> R + Send) -> io::Result<(R, Option<PyErr>)> {
    let interrupted = &AtomicBool::new(false);
    let (done, waiting) = channel::<()>();
    let work = move || {
        // It goes when the work is over, however that ends.
        let _done = done;
        work(interrupted)
    };
    thread::scope(|scope| {
        let worker = thread::Builder::new().name("beside".to_owned()).spawn_scoped(scope, work)?;
        let mut signal = None;
        while waiting.recv_timeout(BEAT) == Err(RecvTimeoutError::Timeout) {
            if signal.is_none() {
                let answered = Python::try_attach(|py| py.check_signals());
                // Where Python is about to end, the work is too.
                interrupted.store(!matches!(answered, Some(Ok(()))), Ordering::Relaxed);
                signal = answered.and_then(Result::err);
            }
        }
        Ok((worker.join().unwrap_or_else(|panic| resume_unwind(panic)), signal))
    })
}
