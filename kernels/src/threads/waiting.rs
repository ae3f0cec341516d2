//! Threads that wait for each other without falling asleep.
//!
//! `kernels/tests/waiting.rs` has this very file explored by `loom`, in every order in which a few threads can take their turns: what it
//! takes from `pool` is all that it shares with other threads.

use super::pool::{Arc, AtomicBool, AtomicUsize, Ordering, index, on_each, spawn, thread_local, yield_now};
use std::cell::RefCell;

/// Every part once in every stage. A thread begins with a share that is always its own, so that what it worked on before
/// is still in its cache, and then takes what others have left.
///
/// A thread that finds nothing left spins until the others are done with their last parts: one that sleeps has to be woken for the
/// next stage, or for the next call, and that takes longer. All that is waited for is being worked on, so that no thread waits for one
/// that waits.
pub(crate) fn each(threads: usize, [stages, parts]: [usize; 2], work: &(dyn Fn(usize, usize) + Sync)) {
    if parts <= 1 {
        // Nothing to share: the others are left as they are.
        (0..stages).for_each(|stage| (0..parts).for_each(|part| work(stage, part)));
        return;
    }
    release();
    let taken: Vec<AtomicBool> = (0..stages * parts).map(|_| AtomicBool::new(false)).collect();
    let done: Vec<AtomicUsize> = (0..stages).map(|_| AtomicUsize::new(0)).collect();
    on_each(threads.min(parts), &|| {
        let first = index() * parts / threads;
        for (stage, done) in done.iter().enumerate() {
            let own_first = (first..parts).chain(0..first);
            own_first.filter(|&part| !taken[stage * parts + part].swap(true, Ordering::Relaxed)).for_each(
                |part| {
                    let _done = Done(done);
                    work(stage, part);
                },
            );
            wait_for(|| done.load(Ordering::Acquire) == parts);
        }
    });
}

/// Counts when it goes, even if that is because of a panic.
struct Done<'a>(&'a AtomicUsize);

impl Drop for Done<'_> {
    #[inline]
    fn drop(&mut self) {
        self.0.fetch_add(1, Ordering::Release);
    }
}

/// Stays awake until something holds.
#[inline]
fn wait_for(holds: impl Fn() -> bool) {
    while !holds() {
        yield_now();
    }
}

thread_local! {
    /// Set when those that this thread keeps awake may go.
    #[allow(clippy::missing_const_for_thread_local, reason = "loom's has no such form")]
    static KEPT: RefCell<Option<Arc<AtomicBool>>> = RefCell::new(None);
}

/// Lets those go that this thread keeps awake: it needs them, or is done.
#[inline]
fn release() {
    if let Some(kept) = KEPT.with(RefCell::take) {
        kept.store(true, Ordering::Release);
    }
}

/// Releases when it goes, even if that is because of a panic.
struct Release;

impl Drop for Release {
    #[inline]
    fn drop(&mut self) {
        release();
    }
}

/// What `work` gives, done by one thread while others spin. Once `work` has parts for them itself they are let go: else a thread
/// that waited for its parts to be taken, and kept others awake meanwhile, could wait for one that does the same.
pub(crate) fn keep_awake<R>(others: usize, work: impl FnOnce() -> R) -> R {
    if others == 0 {
        return work();
    }
    let kept = Arc::new(AtomicBool::new(false));
    for _ in 0..others {
        let kept = Arc::clone(&kept);
        // Nothing waits for these: on a busy machine one may begin only when all is over, and finds that it may go.
        spawn(move || wait_for(|| kept.load(Ordering::Acquire)));
    }
    // The threads that were kept awake already wait for this one now.
    release();
    KEPT.with(|own| own.replace(Some(kept)));
    let _release = Release;
    work()
}
