//! Whether the threads that wait awake (`kernels/src/threads.rs`) can wait for each other for ever.
//!
//! A model of that file on a pool like rayon's, in which every order of events is tried: workers take jobs in any order, also
//! while they wait for shares that others have, as rayon's do. What a thread does between two things that others can see is one
//! move. Whatever order is taken, some thread can move until all is done; as moves only ever lead forward, all comes to its end.
//! The model holds for the order of events, not for what the memory shows when: that is the business of `Acquire` and `Release`
//! there, and of the mutexes around the parts.

use std::collections::HashSet;

const PARTS: usize = 2;
const STAGES: usize = 2;

/// Work on the stack of a thread.
#[derive(Clone, PartialEq, Eq, PartialOrd, Ord, Hash)]
enum Frame {
    /// `wait_for` of one that `keep_awake` spawned.
    Awake { until: usize },
    /// `keep_awake` of a simulation: spawn, call `each` that many times, release.
    Simulation { calls: usize, entered: bool },
    /// `each` of the thread that called it, or what it became in the pool: waits for its shares.
    Each { call: usize },
    /// The body that `each` gives every thread.
    Share { call: usize, stage: usize, working: bool },
}

/// A call of `each`.
#[derive(Clone, PartialEq, Eq, Hash)]
struct Call {
    taken: [usize; STAGES],
    done: [usize; STAGES],
    /// Shares that have not returned.
    shares: usize,
}

/// Threads, jobs that wait for one, and what they share.
#[derive(Clone, PartialEq, Eq, Hash)]
struct State {
    /// Those of the pool first.
    stacks: Vec<Vec<Frame>>,
    /// What `KEPT` is on each thread.
    kept: Vec<Option<usize>>,
    queue: Vec<Frame>,
    calls: Vec<Call>,
    /// Whether those that are kept awake may go.
    released: Vec<bool>,
}

/// How a model differs from the file.
#[derive(Clone, Copy)]
struct Rules {
    workers: usize,
    /// Whether `each` lets those go that its thread keeps awake.
    releases_first: bool,
}

impl State {
    /// `outside` simulations on threads of their own, and `inside` ones that are jobs of the pool.
    fn new(rules: Rules, outside: usize, inside: usize, calls: usize) -> State {
        let simulation = Frame::Simulation { calls, entered: false };
        let idle = std::iter::repeat_n(vec![], rules.workers);
        let stacks: Vec<Vec<Frame>> =
            idle.chain(std::iter::repeat_n(vec![simulation.clone()], outside)).collect();
        State {
            kept: vec![None; stacks.len()],
            stacks,
            queue: vec![simulation; inside],
            calls: vec![],
            released: vec![],
        }
    }

    fn is_over(&self) -> bool {
        self.stacks.iter().all(Vec::is_empty) && self.queue.is_empty()
    }

    fn release(&mut self, thread: usize) {
        if let Some(flag) = self.kept[thread].take() {
            self.released[flag] = true;
        }
    }

    /// The states after one move of a thread; none where it waits.
    fn moves(&self, thread: usize, rules: Rules) -> Vec<State> {
        let mut next = self.clone();
        let of_pool = thread < rules.workers;
        let Some(frame) = self.stacks[thread].last().cloned() else {
            return if of_pool { self.takes_a_job(thread) } else { vec![] };
        };
        let stack = &mut next.stacks[thread];
        match frame {
            Frame::Awake { until } if self.released[until] => _ = stack.pop(),
            Frame::Awake { .. } => return vec![],
            Frame::Simulation { calls, entered: false } => {
                *stack.last_mut().unwrap() = Frame::Simulation { calls, entered: true };
                let flag = next.released.len();
                next.released.push(false);
                next.queue.extend(std::iter::repeat_n(Frame::Awake { until: flag }, rules.workers - 1));
                next.release(thread);
                next.kept[thread] = Some(flag);
            }
            Frame::Simulation { calls: 0, .. } => {
                stack.pop();
                next.release(thread);
            }
            Frame::Simulation { calls, entered } => {
                *stack.last_mut().unwrap() = Frame::Simulation { calls: calls - 1, entered };
                let call = next.calls.len();
                stack.push(Frame::Each { call });
                let shares = rules.workers.min(PARTS);
                next.calls.push(Call { taken: [0; STAGES], done: [0; STAGES], shares });
                if rules.releases_first {
                    next.release(thread);
                }
                let share = Frame::Share { call, stage: 0, working: false };
                if of_pool {
                    next.queue.extend(std::iter::repeat_n(share.clone(), shares - 1));
                    next.stacks[thread].push(share);
                } else {
                    next.queue.extend(std::iter::repeat_n(share, shares));
                }
            }
            Frame::Each { call } if self.calls[call].shares == 0 => _ = stack.pop(),
            // A thread of the pool looks for other work meanwhile.
            Frame::Each { .. } if of_pool => return self.takes_a_job(thread),
            Frame::Each { .. } => return vec![],
            Frame::Share { call, stage, working } => {
                let of_call = &mut next.calls[call];
                let top = stack.last_mut().unwrap();
                if working {
                    of_call.done[stage] += 1;
                    *top = Frame::Share { call, stage, working: false };
                } else if of_call.taken[stage] < PARTS {
                    of_call.taken[stage] += 1;
                    *top = Frame::Share { call, stage, working: true };
                } else if of_call.done[stage] < PARTS {
                    return vec![];
                } else if stage + 1 < STAGES {
                    *top = Frame::Share { call, stage: stage + 1, working: false };
                } else {
                    of_call.shares -= 1;
                    stack.pop();
                }
            }
        }
        next.queue.sort_unstable();
        vec![next]
    }

    fn takes_a_job(&self, thread: usize) -> Vec<State> {
        let different =
            (0..self.queue.len()).filter(|&job| job == 0 || self.queue[job] != self.queue[job - 1]);
        let taken = different.map(|job| {
            let mut next = self.clone();
            let frame = next.queue.remove(job);
            next.stacks[thread].push(frame);
            next
        });
        taken.collect()
    }
}

/// How many states there are, and whether one is among them in which all wait though not all is done.
fn explored(rules: Rules, start: State) -> (usize, bool) {
    let mut seen = HashSet::from([start.clone()]);
    let mut open = vec![start];
    let mut stuck = false;
    while let Some(state) = open.pop() {
        let next: Vec<State> =
            (0..state.stacks.len()).flat_map(|thread| state.moves(thread, rules)).collect();
        stuck |= next.is_empty() && !state.is_over();
        for state in next {
            if seen.insert(state.clone()) {
                open.push(state);
            }
        }
    }
    (seen.len(), stuck)
}

/// Simulations beside the pool and in it, alone and beside each other.
#[test]
fn no_thread_waits_for_ever() {
    for (workers, outside, inside, calls) in
        [(2, 1, 0, 2), (3, 1, 0, 2), (2, 2, 0, 2), (2, 0, 2, 2), (2, 1, 1, 1), (2, 0, 3, 1), (3, 0, 2, 1)]
    {
        let rules = Rules { workers, releases_first: true };
        let (states, stuck) = explored(rules, State::new(rules, outside, inside, calls));
        println!("{workers} workers, {outside} + {inside} simulations of {calls} calls: {states} states");
        assert!(!stuck && states > 100, "{workers} workers, {outside} + {inside} simulations, {calls} calls");
    }
}

/// The hang that there was: two that keep the same threads awake, and need them.
#[test]
fn the_model_sees_the_hang_where_parts_do_not_release_first() {
    let rules = Rules { workers: 2, releases_first: false };
    assert!(explored(rules, State::new(rules, 2, 0, 1)).1);
}
