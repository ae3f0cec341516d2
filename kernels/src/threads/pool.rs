//! Threads of the current `rayon` pool, and the types they share.

use rayon::iter::{IndexedParallelIterator, IntoParallelIterator, ParallelIterator};

pub(super) use std::sync::Arc;
pub(super) use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
pub(super) use std::thread::yield_now;
pub(super) use std::thread_local;

/// Index of this thread in its pool; 0 outside of one.
#[inline]
pub(super) fn index() -> usize {
    rayon::current_thread_index().unwrap_or(0)
}

/// Runs `work` `count` times, each on the next free thread, and returns when all are done.
pub(super) fn on_each(count: usize, work: &(dyn Fn() + Sync)) {
    (0..count).into_par_iter().with_max_len(1).for_each(|_| work());
}

/// Runs `work` on some thread later; nothing waits for it.
pub(super) fn spawn(work: impl FnOnce() + Send + 'static) {
    rayon::spawn(work);
}
