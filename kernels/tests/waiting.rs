//! Threads that wait awake never wait for each other for ever: the code itself, run again and again by several simulations beside a pool
//! and in it, each part taking a time of its own. A search through a model of it would not see what the code does otherwise.

use std::ops::Range;
use std::sync::mpsc::{Sender, channel};
use std::time::Duration;
use stripmine_kernels::{keep_awake, over_pieces, reordered};

/// Rounds of each arrangement, each with other times.
const ROUNDS: u64 = 150;
/// Entries of four pieces and a rest.
const ENTRIES: usize = 70_000;
/// No round takes as long: who is not back by then waits for ever.
const PATIENCE: Duration = Duration::from_secs(60);

/// Times as they come: Numerical Recipes' generator, whose high bits are the good ones.
struct Times(u64);

impl Times {
    fn pass(&mut self) {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        match self.0 >> 61 {
            0 => std::thread::sleep(Duration::from_micros(self.0 >> 57)),
            1 | 2 => std::thread::yield_now(),
            _ => (0..self.0 >> 54).for_each(|_| std::hint::spin_loop()),
        }
    }
}

/// What a simulation does between two looks: parts for one thread while the others are kept awake, parts for all within them and after.
fn simulation(calls: u64, seed: u64) -> usize {
    let mut times = Times(seed);
    let piece = |piece: Range<usize>| {
        Times(seed ^ piece.start as u64).pass();
        piece.len()
    };
    let mut sum = 0;
    for _ in 0..calls {
        times.pass();
        sum += keep_awake(|| {
            times.pass();
            let within: usize = over_pieces(0..ENTRIES, piece).into_iter().sum();
            times.pass();
            within
        });
        sum += over_pieces(0..ENTRIES, piece).into_iter().sum::<usize>();
    }
    let order: Vec<u32> = (0..ENTRIES as u32).rev().collect();
    let sum = sum + reordered(&order, &order)[0] as usize;
    // Nothing for the others to do before the end: they must be let go all the same.
    keep_awake(|| times.pass());
    sum
}

/// What comes out of every simulation.
fn expected(calls: u64) -> usize {
    2 * calls as usize * ENTRIES
}

/// `outside` simulations on threads of their own and `inside` on those of the pool that is spawned into.
fn begin(
    outside: u64,
    inside: u64,
    calls: u64,
    round: u64,
    done: &Sender<usize>,
    pool: Option<&rayon::ThreadPool>,
) {
    for number in 0..outside + inside {
        let (done, seed) = (done.clone(), 1000 * round + number);
        let work = move || {
            // Who listens has given up where it cannot be sent.
            let _sent = done.send(simulation(calls, seed));
        };
        match (number < outside, pool) {
            (true, _) => drop(std::thread::spawn(work)),
            (false, Some(pool)) => pool.spawn(work),
            (false, None) => rayon::spawn(work),
        }
    }
}

/// Every simulation of every round comes back.
fn all_come_back(outside: u64, inside: u64, calls: u64, pool: Option<&rayon::ThreadPool>) {
    for round in 0..ROUNDS {
        let (done, back) = channel();
        begin(outside, inside, calls, round, &done, pool);
        for _ in 0..outside + inside {
            let got = back.recv_timeout(PATIENCE);
            assert_eq!(
                got,
                Ok(expected(calls)),
                "round {round}: {outside} + {inside} simulations wait for each other"
            );
        }
    }
}

/// Simulations beside the pool and in it, alone and beside each other.
#[test]
fn no_thread_waits_for_ever() {
    // Those outside use the pool of the process, which is as small as it can be and have others to wait for.
    rayon::ThreadPoolBuilder::new().num_threads(2).build_global().unwrap();
    for (outside, inside, calls) in [(1, 0, 2), (2, 0, 2), (3, 0, 1), (0, 2, 2), (1, 1, 1), (2, 2, 1)] {
        all_come_back(outside, inside, calls, None);
    }
    for (workers, inside, calls) in [(2, 3, 1), (3, 2, 1), (4, 3, 2)] {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(workers).build().unwrap();
        all_come_back(0, inside, calls, Some(&pool));
    }
}
