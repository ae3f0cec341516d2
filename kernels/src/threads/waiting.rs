//! Threads that wait for each other without sleeping.
//!
//! `kernels/tests/waiting.rs` explores this file with `loom`, in every interleaving of a few threads: everything it shares with
//! other threads comes from `pool`.

use super::pool::{Arc, AtomicBool, AtomicUsize, Ordering, index, on_each, spawn, thread_local, yield_now};
use std::cell::RefCell;

/// Runs every part once in every stage. A thread begins with its own share, the same in every call, so that its data are still in
/// its cache. Then it takes parts that others have left.
///
/// A thread without parts spins until the others finish: a sleeping one would have to be woken for the next stage or call, which
/// takes longer. Only running parts are waited for, so no thread waits for one that waits.
pub(crate) fn run_stages(threads: usize, [stages, parts]: [usize; 2], work: &(dyn Fn(usize, usize) + Sync)) {
    if parts <= 1 {
        // Nothing to share: the other threads are left alone.
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

/// Counts on drop, also after a panic.
struct Done<'a>(&'a AtomicUsize);

impl Drop for Done<'_> {
    #[inline]
    fn drop(&mut self) {
        self.0.fetch_add(1, Ordering::Release);
    }
}

/// Spins until `holds` returns true.
#[inline]
fn wait_for(holds: impl Fn() -> bool) {
    while !holds() {
        yield_now();
    }
}

thread_local! {
    /// Flag that ends the waiting of the threads that this thread keeps awake.
    #[allow(clippy::missing_const_for_thread_local, reason = "loom's has no such form")]
    static KEPT: RefCell<Option<Arc<AtomicBool>>> = RefCell::new(None);
}

/// Ends the waiting of the threads that this thread keeps awake: it needs them, or is done.
#[inline]
fn release() {
    if let Some(kept) = KEPT.with(RefCell::take) {
        kept.store(true, Ordering::Release);
    }
}

/// Releases on drop, also after a panic.
struct Release;

impl Drop for Release {
    #[inline]
    fn drop(&mut self) {
        release();
    }
}

/// Runs `work` on one thread while the others spin. When `work` itself has parts for them, they are released. Otherwise a thread
/// that waits for its parts to be taken, and keeps others awake meanwhile, could wait for one that does the same.
pub(crate) fn keep_awake<R>(others: usize, work: impl FnOnce() -> R) -> R {
    if others == 0 {
        return work();
    }
    let kept = Arc::new(AtomicBool::new(false));
    for _ in 0..others {
        let kept = Arc::clone(&kept);
        // Nothing waits for these: on a busy machine one may begin only when all is over, and then ends at once.
        spawn(move || wait_for(|| kept.load(Ordering::Acquire)));
    }
    // Threads kept awake so far now wait for this call.
    release();
    KEPT.with(|own| own.replace(Some(kept)));
    let _release = Release;
    work()
}
