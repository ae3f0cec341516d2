//! Joining the other processes, with a timeout. MPI waits silently and forever, also for a process that has ended or runs independently.

use std::sync::mpsc::{RecvTimeoutError, channel};
use std::thread;
use std::time::Duration;

/// Action taken after a waiting time.
pub(super) type TimedAction = Box<dyn FnOnce() + Send>;

/// Runs `work`; while it runs, each action of `acts` is taken after its time, one after the other.
pub(super) fn with_timeouts<T>(work: impl FnOnce() -> T, acts: Vec<(Duration, TimedAction)>) -> T {
    let (working, ended) = channel::<()>();
    let watch = move || {
        for (time, act) in acts {
            if ended.recv_timeout(time) != Err(RecvTimeoutError::Timeout) {
                return;
            }
            act();
        }
    };
    // If no thread can be started, the work is not watched.
    let _ = thread::Builder::new().spawn(watch);
    let done = work();
    drop(working);
    done
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::mpsc::Sender;

    const MOMENT: Duration = Duration::from_millis(1);
    const FOR_EVER: Duration = Duration::from_secs(1 << 30);

    fn says(what: &'static str, to: &Sender<&'static str>) -> TimedAction {
        let to = to.clone();
        Box::new(move || to.send(what).unwrap())
    }

    /// Work that lasts until the last action, and work that ends at once.
    #[test]
    fn long_work_triggers_actions() {
        let (sender, said) = channel();
        let acts = |time| ["notice", "end"].map(|what| (time, says(what, &sender))).into();
        assert_eq!(with_timeouts(|| [(); 2].map(|()| said.recv().unwrap()), acts(MOMENT)), ["notice", "end"]);
        assert_eq!(with_timeouts(|| 3, acts(FOR_EVER)), 3);
        drop(sender);
        assert_eq!(said.recv().ok(), None);
    }
}
