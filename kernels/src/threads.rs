//! Work cut into parts, on the threads of the current `rayon` pool.
//!
//! Parts are called through a pointer, so that the pool's machinery is compiled once and not for every kind of work.

use rayon::iter::{IndexedParallelIterator, IntoParallelIterator, ParallelIterator};
use std::ops::Range;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, PoisonError};

/// What `work` makes of each of the parts, in their order; one part after the other if there is but one thread.
pub(crate) fn on_threads<T: Send, R: Send>(
    parts: impl IntoIterator<Item = T>,
    work: impl Fn(T) -> R + Sync,
) -> Vec<R> {
    if rayon::current_num_threads() == 1 {
        return parts.into_iter().map(work).collect();
    }
    let slots: Vec<Mutex<(Option<T>, Option<R>)>> =
        parts.into_iter().map(|part| Mutex::new((Some(part), None))).collect();
    each(slots.len(), &|number| {
        let mut slot = slots[number].lock().unwrap_or_else(PoisonError::into_inner);
        slot.1 = slot.0.take().map(&work);
    });
    let made =
        |slot: Mutex<(Option<T>, Option<R>)>| slot.into_inner().unwrap_or_else(PoisonError::into_inner).1;
    slots.into_iter().filter_map(made).collect()
}

/// Every part once. A thread begins with a share that is always its own, so that what it worked on before is still in its
/// cache, and then takes what others have left.
fn each(parts: usize, work: &(dyn Fn(usize) + Sync)) {
    let taken: Vec<AtomicBool> = (0..parts).map(|_| AtomicBool::new(false)).collect();
    let threads = rayon::current_num_threads();
    (0..threads.min(parts)).into_par_iter().with_max_len(1).for_each(|_| {
        let first = rayon::current_thread_index().unwrap_or(0) * parts / threads;
        let own_first = (first..parts).chain(0..first);
        own_first.filter(|&part| !taken[part].swap(true, Ordering::Relaxed)).for_each(work);
    });
}

/// A range in pieces of `length`, the last one perhaps shorter.
pub(crate) fn pieces(range: Range<usize>, length: usize) -> impl Iterator<Item = Range<usize>> {
    let end = range.end;
    range.step_by(length).map(move |start| start..(start + length).min(end))
}
