//! Threads that wait awake never deadlock, and a stage ends when all of it is done. `loom` explores the source file
//! `kernels/src/threads/waiting.rs` in every interleaving of its threads, up to one or two preemptions.

#[path = "../src/threads/waiting.rs"]
mod waiting;

/// Replaces `kernels/src/threads/pool.rs` by a pool of [`WORKERS`] that behaves as rayon's where it matters. A waiting worker
/// takes other work from the queue meanwhile, and a thread from outside sleeps until all of its work is done.
mod pool {
    use loom::sync::{Condvar, Mutex};
    use std::cell::Cell;
    use std::collections::VecDeque;
    use std::mem::transmute;

    pub(crate) use loom::sync::Arc;
    pub(crate) use loom::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
    pub(crate) use loom::thread::yield_now;
    pub(crate) use loom::thread_local;

    pub(crate) const WORKERS: usize = 2;

    type Task = Box<dyn FnOnce() + Send>;

    #[derive(Default)]
    struct Queue {
        tasks: VecDeque<Task>,
        is_closed: bool,
    }

    loom::lazy_static! {
        static ref QUEUE: Mutex<Queue> = Mutex::new(Queue::default());
        static ref CHANGED: Condvar = Condvar::new();
    }
    loom::thread_local! {
        static WORKER: Cell<Option<usize>> = Cell::new(None);
    }

    fn push(task: Task) {
        QUEUE.lock().unwrap().tasks.push_back(task);
        CHANGED.notify_all();
    }

    fn work_until(is_over: impl Fn(&Queue) -> bool, next: fn(&mut VecDeque<Task>) -> Option<Task>) {
        loop {
            let mut queue = QUEUE.lock().unwrap();
            let task = loop {
                if is_over(&queue) {
                    return;
                }
                match next(&mut queue.tasks) {
                    Some(task) => break task,
                    None => queue = CHANGED.wait(queue).unwrap(),
                }
            };
            drop(queue);
            task();
        }
    }

    /// Runs `work` beside a pool, which is closed after it.
    pub(crate) fn with(work: impl FnOnce()) {
        let workers: Vec<_> = (0..WORKERS)
            .map(|number| {
                loom::thread::spawn(move || {
                    WORKER.with(|worker| worker.set(Some(number)));
                    work_until(|queue| queue.is_closed && queue.tasks.is_empty(), VecDeque::pop_front);
                })
            })
            .collect();
        work();
        QUEUE.lock().unwrap().is_closed = true;
        CHANGED.notify_all();
        workers.into_iter().for_each(|worker| worker.join().unwrap());
    }

    pub(crate) fn index() -> usize {
        WORKER.with(Cell::get).unwrap_or(0)
    }

    pub(crate) fn spawn(work: impl FnOnce() + Send + 'static) {
        push(Box::new(work));
    }

    pub(crate) fn on_each(count: usize, work: &(dyn Fn() + Sync)) {
        // SAFETY: this function returns only when every task that has the reference is done.
        let work: &'static (dyn Fn() + Sync) = unsafe { transmute(work) };
        let left = Arc::new(AtomicUsize::new(count));
        let task = || {
            let left = Arc::clone(&left);
            move || {
                work();
                // Under the lock: a thread between two checks of the queue would miss the change and sleep.
                let _queue = QUEUE.lock().unwrap();
                left.fetch_sub(1, Ordering::AcqRel);
                CHANGED.notify_all();
            }
        };
        let is_worker = WORKER.with(Cell::get).is_some();
        (usize::from(is_worker)..count).for_each(|_| push(Box::new(task())));
        if is_worker {
            task()();
            // Newest first: those are its own.
            work_until(|_| left.load(Ordering::Acquire) == 0, VecDeque::pop_back);
        } else {
            work_until(|_| left.load(Ordering::Acquire) == 0, |_| None);
        }
    }
}

use loom::sync::atomic::{AtomicUsize, Ordering};
use pool::WORKERS;
use waiting::{keep_awake, run_stages};

/// Explores all interleavings with at most this many preemptions of threads that did not have to wait.
fn explored(interruptions: usize, work: impl Fn() + Sync + Send + 'static) {
    let mut builder = loom::model::Builder::new();
    builder.preemption_bound = Some(interruptions);
    builder.check(move || pool::with(&work));
}

/// Parts in stages: each runs once, and none before the previous stage is done.
fn stages(parts: usize) {
    let done = [AtomicUsize::new(0), AtomicUsize::new(0)];
    run_stages(WORKERS, [2, parts], &|stage, _| {
        if stage == 1 {
            assert_eq!(done[0].load(Ordering::Relaxed), parts);
        }
        done[stage].fetch_add(1, Ordering::Relaxed);
    });
    assert_eq!(done.map(|it| it.load(Ordering::Relaxed)), [parts; 2]);
}

#[test]
fn stages_follow_each_other_under_loom() {
    explored(2, || stages(2));
}

#[test]
fn awake_threads_are_released() {
    explored(2, || {
        keep_awake(WORKERS - 1, || ());
        keep_awake(WORKERS - 1, || run_stages(WORKERS, [1, 2], &|_, _| ()));
    });
}

fn simulation() {
    keep_awake(WORKERS - 1, || run_stages(WORKERS, [1, 2], &|_, _| ()));
}

/// Two simulations beside the pool keep workers awake, and then have parts for them. Unless they release them, both workers stay
/// with simulations that wait for them.
#[test]
fn two_simulations_do_not_deadlock() {
    explored(1, || {
        let other = loom::thread::spawn(simulation);
        simulation();
        other.join().unwrap();
    });
}

/// One of the two is in the pool.
#[test]
fn simulations_inside_and_outside_do_not_deadlock() {
    explored(2, || {
        pool::spawn(simulation);
        simulation();
    });
}
