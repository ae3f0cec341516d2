//! Parallel work: parts on the threads of the current `rayon` pool.
//!
//! [`waiting`] implements how threads wait for each other.
//!
//! Parts are called through a pointer, so that the machinery of the pool is compiled once and not for every kind of work.

mod pool;
mod waiting;

use std::cell::Cell;
use std::ops::Range;
use std::sync::atomic::AtomicU32;
use std::sync::{Mutex, MutexGuard, PoisonError};
use waiting::run_stages;

thread_local! {
    /// True if this thread does all parts itself.
    static ALONE: Cell<bool> = const { Cell::new(false) };
}

/// Number of threads that share parts.
#[inline]
pub(crate) fn threads() -> usize {
    if ALONE.get() { 1 } else { rayon::current_num_threads() }
}

/// Runs `work`. If it is `little`, this thread does all of its parts, because others would only begin when it is done. No result
/// depends on the threads.
#[inline]
pub fn single_threaded_if<R>(little: bool, work: impl FnOnce() -> R) -> R {
    /// Restores the previous value, also after a panic.
    struct Before(bool);

    impl Drop for Before {
        #[inline]
        fn drop(&mut self) {
            ALONE.set(self.0);
        }
    }

    let _before = Before(ALONE.get());
    if little {
        ALONE.set(true);
    }
    work()
}

/// Applies `work` to each of the parts and returns the results in their order; a single thread does them one after the other.
#[inline]
pub(crate) fn on_threads<T: Send, R: Send>(
    parts: impl IntoIterator<Item = T>,
    work: impl Fn(T) -> R + Sync,
) -> Vec<R> {
    if threads() == 1 {
        return parts.into_iter().map(work).collect();
    }
    let slots: Vec<Mutex<(Option<T>, Option<R>)>> =
        parts.into_iter().map(|part| Mutex::new((Some(part), None))).collect();
    run_stages(threads(), [1, slots.len()], &|_, number| {
        let mut slot = locked(&slots[number]);
        slot.1 = slot.0.take().map(&work);
    });
    let made =
        |slot: Mutex<(Option<T>, Option<R>)>| slot.into_inner().unwrap_or_else(PoisonError::into_inner).1;
    slots.into_iter().filter_map(made).collect()
}

/// Applies `work` to every part once in each of the stages: a stage begins when all parts of the previous one are done.
///
/// # Errors
/// One of the errors of `work`. The other parts of that stage are still processed, and the later stages too if there is more than
/// one thread.
#[inline]
pub(crate) fn in_stages<T: Send, E: Send>(
    parts: &mut [T],
    stages: usize,
    work: impl Fn(&mut T, usize) -> Result<(), E> + Sync,
) -> Result<(), E> {
    if threads() == 1 {
        return (0..stages).try_for_each(|stage| parts.iter_mut().try_for_each(|part| work(part, stage)));
    }
    let slots: Vec<Mutex<&mut T>> = parts.iter_mut().map(Mutex::new).collect();
    let failure = Mutex::new(None);
    run_stages(threads(), [stages, slots.len()], &|stage, number| {
        if let Err(cause) = work(&mut locked(&slots[number]), stage) {
            locked(&failure).get_or_insert(cause);
        }
    });
    failure.into_inner().unwrap_or_else(PoisonError::into_inner).map_or(Ok(()), Err)
}

#[inline]
fn locked<T>(slot: &Mutex<T>) -> MutexGuard<'_, T> {
    slot.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Runs `work` on one thread while the others wait awake for the next parts, because waking them would take longer than `work`.
/// When `work` itself has parts for them, they stop waiting.
pub fn keep_awake<R>(work: impl FnOnce() -> R) -> R {
    waiting::keep_awake(threads() - 1, work)
}

/// Entries of a column per piece, where an entry takes some nanoseconds. Short columns stay on one thread, which finishes before
/// another would begin.
pub(crate) const PIECE: usize = 16_384;

/// Applies `work` to each piece of a range and returns the results in their order. The pieces depend on the range alone.
#[inline]
pub fn over_pieces<R: Send>(range: Range<usize>, work: impl Fn(Range<usize>) -> R + Sync) -> Vec<R> {
    on_threads(pieces(range, PIECE), work)
}

/// Applies `work` to every piece of a column, with the index of its first entry.
#[inline]
pub fn in_pieces<T: Send>(column: &mut [T], work: impl Fn(usize, &mut [T]) + Sync) {
    let parts = column.chunks_mut(PIECE).enumerate();
    on_threads(parts, |(number, piece)| work(number * PIECE, piece));
}

/// Entries per part, where an entry takes some ten nanoseconds or more.
const PART: usize = 2048;

/// Applies `work` to each part of a range and returns the results in their order, for entries that take longer than in
/// [`over_pieces`]. The parts depend on the range alone.
#[inline]
pub fn over_parts<R: Send>(range: Range<usize>, work: impl Fn(Range<usize>) -> R + Sync) -> Vec<R> {
    on_threads(pieces(range, PART), work)
}

/// Applies `work` to every part of several columns, with the number of its first record, and returns the results in their order. A
/// record is a number of entries side by side in each column.
#[inline]
pub(crate) fn in_record_parts<T: Send, R: Send, const N: usize>(
    columns: [&mut [T]; N],
    entries: usize,
    work: impl Fn(usize, [&mut [T]; N]) -> R + Sync,
) -> Vec<R> {
    let records = columns.iter().map(|column| column.len() / entries).max().unwrap_or(0);
    let mut pieces = columns.map(|column| column.chunks_mut(PART * entries));
    let parts = (0..records)
        .step_by(PART)
        .map(|first| (first, pieces.each_mut().map(|pieces| pieces.next().unwrap_or_default())));
    on_threads(parts, |(first, part)| work(first, part))
}

/// A column in another order: the new entry `n` is the old entry `order[n]`.
///
/// # Panics
/// If `order` names an entry that does not exist.
#[inline]
pub fn reordered<T: Copy + Default + Send + Sync>(column: &[T], order: &[u32]) -> Vec<T> {
    let mut now = vec![T::default(); order.len()];
    reorder_into(&mut now, column, order);
    now
}

/// Sets entry `n` of `now` to entry `order[n]` of `column`.
///
/// # Panics
/// If `order` names an entry that does not exist, or is too short.
#[inline]
pub fn reorder_into<T: Copy + Send + Sync>(now: &mut [T], column: &[T], order: &[u32]) {
    in_pieces(now, |first, piece| {
        let before = &order[first..first + piece.len()];
        piece.iter_mut().zip(before).for_each(|(to, &before)| *to = column[before as usize]);
    });
}

/// True if one thread does all pieces of a column.
#[inline]
pub(crate) fn is_single_threaded(length: usize) -> bool {
    length <= PIECE || threads() == 1
}

/// View of a column that several threads may write.
#[inline]
pub(crate) fn shared(column: &mut [u32]) -> &[AtomicU32] {
    let column: *mut [u32] = column;
    // SAFETY: an AtomicU32 has the size and alignment of a u32; the address is that of a slice that is borrowed exclusively for
    // the life of the result, and only the result accesses it.
    unsafe { &*(column as *const [AtomicU32]) }
}

/// Cuts a range into pieces of `length`; the last one may be shorter.
#[inline]
pub(crate) fn pieces(range: Range<usize>, length: usize) -> impl Iterator<Item = Range<usize>> {
    let end = range.end;
    range.step_by(length).map(move |start| start..(start + length).min(end))
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::Arc;
    use std::sync::atomic::{AtomicUsize, Ordering};

    fn on<R: Send>(threads: usize, work: impl FnOnce() -> R + Send) -> R {
        rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap().install(work)
    }

    #[test]
    fn stages_run_one_after_the_other() {
        for threads in [1, 2, 3, 8] {
            let counts: [AtomicUsize; 3] = Default::default();
            let mut parts = vec![0_usize; 37];
            let stages = |part: &mut usize, stage: usize| {
                assert_eq!(*part, stage);
                assert!(stage == 0 || counts[stage - 1].load(Ordering::SeqCst) == 37);
                *part += 1;
                counts[stage].fetch_add(1, Ordering::SeqCst);
                Ok::<(), ()>(())
            };
            on(threads, || in_stages(&mut parts, 3, stages)).unwrap();
            assert!(parts.iter().all(|&part| part == 3));
        }
    }

    #[test]
    fn failures_and_ordered_results_are_returned() {
        for threads in [1, 4] {
            let odd = |part: &mut usize, _: usize| if *part == 5 { Err("five") } else { Ok(()) };
            let mut parts: Vec<usize> = (0..9).collect();
            assert_eq!(on(threads, || in_stages(&mut parts, 2, odd)), Err("five"));
            let squares = on(threads, || on_threads(0..100, |n: usize| n * n));
            assert!(squares.iter().enumerate().all(|(n, &square)| square == n * n));
            assert_eq!(on(threads, || keep_awake(|| 7)), 7);
        }
    }

    #[test]
    fn little_work_is_done_by_one_thread() {
        let who = || on_threads(0..50, |_: usize| std::thread::current().id());
        let found = on(3, || single_threaded_if(true, || (std::thread::current().id(), who())));
        assert!(found.1.iter().all(|id| *id == found.0));
        assert_eq!(on(3, || single_threaded_if(false, threads)), 3);
        // The setting is restored at the end, also after a panic.
        let broken = || on(1, || single_threaded_if(true, || panic!("on purpose")));
        assert!(std::panic::catch_unwind(broken).is_err());
        assert_eq!(
            on(2, || {
                single_threaded_if(true, || ());
                threads()
            }),
            2
        );
    }

    #[test]
    fn reordering_does_not_depend_on_threads() {
        let entries = 5 * PIECE as u32 / 2;
        let column: Vec<u32> = (0..entries).map(|entry| entry.wrapping_mul(77)).collect();
        let order: Vec<u32> = (0..entries).rev().collect();
        let expected: Vec<u32> = column.iter().rev().copied().collect();
        for threads in [1, 2, 3] {
            let sums = |piece: Range<usize>| column[piece].iter().map(|&entry| u64::from(entry)).sum::<u64>();
            assert_eq!(on(threads, || reordered(&column, &order)), expected);
            assert_eq!(on(threads, || over_pieces(0..column.len(), sums)).len(), 3);
        }
    }

    #[test]
    fn callers_sharing_awake_threads_do_not_deadlock() {
        let others = rayon::current_num_threads().max(2);
        let both = Arc::new(std::sync::Barrier::new(others));
        let (sender, finished) = std::sync::mpsc::channel();
        for _ in 0..others {
            let (both, sender) = (Arc::clone(&both), sender.clone());
            // These are not the pool's own threads. All of those are awake once every caller is here and some time has passed;
            // then every caller has parts for them, as when lists are rebuilt.
            std::thread::spawn(move || {
                let parts = || {
                    both.wait();
                    std::thread::sleep(std::time::Duration::from_millis(50));
                    on_threads(0..4, |n: usize| n)
                };
                sender.send(keep_awake(parts)).unwrap();
            });
        }
        let patience = std::time::Duration::from_secs(60);
        for _ in 0..others {
            assert_eq!(
                finished.recv_timeout(patience),
                Ok(vec![0, 1, 2, 3]),
                "deadlock: the callers wait for each other"
            );
        }
    }

    #[test]
    fn a_panic_leaves_no_thread_waiting() {
        let broken = || on(3, || on_threads(0..20, |n: usize| assert!(n != 11, "eleven")));
        assert!(std::panic::catch_unwind(broken).is_err());
        let broken = || on(3, || keep_awake(|| panic!("on purpose")));
        assert!(std::panic::catch_unwind(broken).is_err());
    }
}
