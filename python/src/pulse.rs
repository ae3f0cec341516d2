//! Flags that are raised some twenty times a second: who computes for long comes up then and looks whether Ctrl-C was pressed.

use std::io;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError, Weak};
use std::thread;
use std::time::Duration;

/// How long between two beats.
pub(crate) const BEAT: Duration = Duration::from_millis(50);

/// The flags that are raised, while they are in use.
static FLAGS: Mutex<Vec<Weak<AtomicBool>>> = Mutex::new(vec![]);

/// A flag that is raised at every beat, as long as it lives.
///
/// # Errors
/// If the system gives no thread for it.
pub(crate) fn flag() -> io::Result<Arc<AtomicBool>> {
    let flag = Arc::new(AtomicBool::new(false));
    let mut flags = flags();
    if flags.is_empty() {
        thread::Builder::new().name("pulse".to_owned()).spawn(beat)?;
    }
    flags.push(Arc::downgrade(&flag));
    Ok(flag)
}

/// Beats until there is no flag any more.
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
