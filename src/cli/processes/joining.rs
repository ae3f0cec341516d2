//! Processes that join the others: MPI waits for all of them without end and without a word, also for one that has ended or was asked for something that it does alone.

use std::sync::mpsc::{RecvTimeoutError, channel};
use std::thread;
use std::time::Duration;

/// What is done after a time of waiting.
pub(super) type Act = Box<dyn FnOnce() + Send>;

/// Does some work, and meanwhile, one after the other, what is to be done where it takes longer than some times.
pub(super) fn watched<T>(work: impl FnOnce() -> T, acts: Vec<(Duration, Act)>) -> T {
    let (working, ended) = channel::<()>();
    let watch = move || {
        for (time, act) in acts {
            if ended.recv_timeout(time) != Err(RecvTimeoutError::Timeout) {
                return;
            }
            act();
        }
    };
    // Without a thread nobody watches.
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

    fn says(what: &'static str, to: &Sender<&'static str>) -> Act {
        let to = to.clone();
        Box::new(move || to.send(what).unwrap())
    }

    /// Work that goes on until the last act has been done, and work that is done at once.
    #[test]
    fn what_takes_long_is_watched() {
        let (sender, said) = channel();
        let acts = |time| ["notice", "end"].map(|what| (time, says(what, &sender))).into();
        assert_eq!(watched(|| [(); 2].map(|()| said.recv().unwrap()), acts(MOMENT)), ["notice", "end"]);
        assert_eq!(watched(|| 3, acts(FOR_EVER)), 3);
        drop(sender);
        assert_eq!(said.recv().ok(), None);
    }
}
