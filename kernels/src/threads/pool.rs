//! The threads of the current `rayon` pool, and what they share.

use rayon::iter::{IndexedParallelIterator, IntoParallelIterator, ParallelIterator};

pub(super) use std::sync::Arc;
pub(super) use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
pub(super) use std::thread::yield_now;
pub(super) use std::thread_local;

/// The number of this thread in its pool; 0 outside of one.
#[inline]
pub(super) fn index() -> usize {
    rayon::current_thread_index().unwrap_or(0)
}

/// Does `work` a number of times, each on the thread that comes to it, and comes back when all are done.
pub(super) fn on_each(count: usize, work: &(dyn Fn() + Sync)) {
    (0..count).into_par_iter().with_max_len(1).for_each(|_| work());
}

/// Has a thread do `work` some time; nothing waits for it.
pub(super) fn spawn(work: impl FnOnce() + Send + 'static) {
    rayon::spawn(work);
}
