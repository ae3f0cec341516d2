//! Flags raised twenty times a second. A long computation pauses when its flag is raised, and checks for Ctrl-C.

use std::io;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError, Weak};
use std::thread;
use std::time::Duration;

/// Interval between two beats.
pub(crate) const BEAT: Duration = Duration::from_millis(50);

/// Flags in use.
static FLAGS: Mutex<Vec<Weak<AtomicBool>>> = Mutex::new(vec![]);

/// Makes a flag that is raised at every beat, as long as it lives.
///
/// # Errors
/// If no thread can be started.
pub(crate) fn flag() -> io::Result<Arc<AtomicBool>> {
    let flag = Arc::new(AtomicBool::new(false));
    let mut flags = flags();
    if flags.is_empty() {
        thread::Builder::new().name("pulse".to_owned()).spawn(beat)?;
    }
    flags.push(Arc::downgrade(&flag));
    Ok(flag)
}

/// Raises all flags at every beat, until none is left.
fn beat() {
    loop {
        thread::sleep(BEAT);
        let mut flags = flags();
        let raised = |flag: &Weak<AtomicBool>| {
            flag.upgrade().inspect(|flag| flag.store(true, Ordering::Relaxed)).is_some()
        };
        flags.retain(raised);
        if flags.is_empty() {
            return;
        }
    }
}

fn flags() -> MutexGuard<'static, Vec<Weak<AtomicBool>>> {
    FLAGS.lock().unwrap_or_else(PoisonError::into_inner)
}
