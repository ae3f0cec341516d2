//! Handling of signals by the command.
//!
//! Interruption (Ctrl-C) and termination end the process with exit code 130 at once, from the thread of their handler. Computations need not poll a
//! flag, so no loop can forget to. Work that must not be interrupted is protected explicitly. Files that belong together are written in `whole`,
//! after which the process ends. A run is in `hold` from its first file, checks `asked` after every step, and leaves a checkpoint. A second signal
//! ends the process at once, whatever is held.
//!
//! Reaching the limit of file sizes is a write error, not a signal. A program that uses the library installs no handler, and then this module does
//! nothing.

use std::io;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, MutexGuard, OnceLock, PoisonError, mpsc};
use std::time::Duration;

/// Exit code of a process that was interrupted or terminated.
pub const INTERRUPTED: u8 = 130;

/// Longest time for the last words; a stopped terminal never takes them.
const PATIENCE: Duration = Duration::from_millis(300);

/// End of the process.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ProcessEnd {
    /// Every file is complete.
    Whole,
    /// Forced by a second signal: a file may be incomplete.
    Forced,
}

type LastWords = Box<dyn Fn(ProcessEnd) + Send + Sync>;

static LAST_WORDS: OnceLock<LastWords> = OnceLock::new();
static ASKED: AtomicBool = AtomicBool::new(false);
/// Number of holders. The thread that ends the process keeps the lock, so that no new hold begins.
static HOLDERS: Mutex<usize> = Mutex::new(0);

/// Installs the handlers, once in a process. `last_words` is called before the process ends.
///
/// # Errors
/// The system's error.
pub fn install(last_words: impl Fn(ProcessEnd) + Send + Sync + 'static) -> io::Result<()> {
    LAST_WORDS.get_or_init(|| Box::new(last_words));
    ignoring(|| ctrlc::set_handler(handle_signal).map_err(io::Error::other))
}

/// Installs handlers and ignores two signals: the limit of file sizes, and the end of the terminal if the process was started with it ignored
/// (`nohup`). The handlers would undo the latter.
#[cfg(unix)]
fn ignoring(handlers: impl FnOnce() -> io::Result<()>) -> io::Result<()> {
    use nix::sys::signal::{SigHandler, Signal, signal};
    // SAFETY: an ignored signal runs no code.
    let ignore = |which| unsafe { signal(which, SigHandler::SigIgn) };
    ignore(Signal::SIGXFSZ)?;
    let before = ignore(Signal::SIGHUP)?;
    handlers()?;
    if matches!(before, SigHandler::SigIgn) {
        ignore(Signal::SIGHUP)?;
    }
    Ok(())
}

#[cfg(not(unix))]
fn ignoring(handlers: impl FnOnce() -> io::Result<()>) -> io::Result<()> {
    handlers()
}

/// Flag set by a signal that arrived during a hold.
pub fn interruption_flag() -> &'static AtomicBool {
    &ASKED
}

/// Guard during which a first signal does not end the process; its holder reacts to the signal.
#[derive(Debug)]
pub struct HoldGuard(());

/// Holds the process until the guard is dropped.
pub fn hold() -> HoldGuard {
    *holders() += 1;
    HoldGuard(())
}

impl Drop for HoldGuard {
    fn drop(&mut self) {
        *holders() -= 1;
    }
}

/// Runs work that must not be interrupted, and ends the process afterwards if a signal has arrived. Failed work does not end it: its error is
/// returned to the user.
///
/// # Errors
/// Errors of the work.
pub fn run_protected<R, E>(work: impl FnOnce() -> Result<R, E>) -> Result<R, E> {
    let held = hold();
    let done = work()?;
    drop(held);
    let holders = holders();
    if *holders == 0 && ASKED.load(Ordering::SeqCst) {
        end(ProcessEnd::Whole);
    }
    Ok(done)
}

/// Waits for the end of the process if a signal is ending it.
pub fn await_end() {
    drop(holders());
}

fn holders() -> MutexGuard<'static, usize> {
    HOLDERS.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Handles a signal, on the handler's thread.
fn handle_signal() {
    let holders = holders();
    let first = !ASKED.swap(true, Ordering::SeqCst);
    match (*holders, first) {
        (0, _) => end(ProcessEnd::Whole),
        (_, false) => end(ProcessEnd::Forced),
        (_, true) => {}
    }
}

/// Ends the process; the caller holds the lock of the holders.
fn end(how: ProcessEnd) -> ! {
    let (done, waiting) = mpsc::channel();
    let words = move || {
        LAST_WORDS.get().inspect(|say| say(how));
        done.send(())
    };
    // Without another thread there are no last words.
    if std::thread::Builder::new().spawn(words).is_ok() {
        #[expect(
            clippy::let_underscore_must_use,
            reason = "the process ends now, with or without the last words"
        )]
        let _ = waiting.recv_timeout(PATIENCE);
    }
    std::process::exit(INTERRUPTED.into())
}

#[cfg(all(test, unix))]
mod tests {
    use super::*;
    use nix::sys::signal::{Signal, raise};
    use std::process::Command;

    fn say(words: &str) {
        eprintln!("{words}");
    }

    fn interrupted_once() {
        raise(Signal::SIGINT).unwrap();
        while !interruption_flag().load(Ordering::SeqCst) {
            std::thread::yield_now();
        }
    }

    /// Ends the process or hangs.
    fn interrupted_for_good() -> ! {
        raise(Signal::SIGTERM).unwrap();
        loop {
            std::thread::yield_now();
        }
    }

    fn whole_work() {
        let _ = run_protected::<_, ()>(|| {
            interrupted_once();
            say("written");
            Ok(())
        });
        say("went on");
    }

    fn failing_work() {
        let failed = run_protected::<(), _>(|| {
            interrupted_once();
            Err("full")
        });
        assert_eq!(failed, Err("full"));
        say("went on");
        interrupted_for_good();
    }

    fn two_signals() {
        let _held = hold();
        interrupted_once();
        say("held");
        interrupted_for_good();
    }

    /// Each role runs in a process of its own, which is this test again: a process has one set of handlers and ends once.
    #[test]
    fn held_work_finishes_unless_signalled_twice() {
        const ROLE: &str = "STRIPMINE_TEST_OF_SIGNALS";
        let roles: [(&str, fn(), &str); 3] = [
            ("whole work", whole_work, "written\nended Whole\n"),
            ("failing work", failing_work, "went on\nended Whole\n"),
            ("two signals", two_signals, "held\nended Forced\n"),
        ];
        if let Ok(role) = std::env::var(ROLE) {
            install(|end| say(&format!("ended {end:?}"))).unwrap();
            return roles.iter().filter(|(name, ..)| *name == role).for_each(|(_, work, _)| work());
        }
        let name = "signals::tests::held_work_finishes_unless_signalled_twice";
        for (role, _, words) in roles {
            let mut child = Command::new(std::env::current_exe().unwrap());
            let output = child.args(["--exact", name, "--nocapture"]).env(ROLE, role).output().unwrap();
            assert_eq!(output.status.code(), Some(INTERRUPTED.into()), "{role}");
            let said = String::from_utf8_lossy(&output.stderr);
            assert!(said.ends_with(words), "{role}: {said}");
        }
    }
}
