//! Rests: places within a run at which whoever times it may look up. They lie at the same places whenever a program runs
//! over as many elements, so that what lies between two of them can be compared with itself, run by run.

use std::cell::Cell;

thread_local! {
    static LISTENER: Cell<Option<fn(Rest)>> = const { Cell::new(None) };
}

/// Where a run rests.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Rest {
    /// Before work that has a number.
    Begins(usize),
    /// Within a program.
    Within,
    /// After work that has a number.
    Ends(usize),
}

/// Does some work, and tells `listener` of every rest of what this thread does meanwhile.
pub fn listening<T>(listener: fn(Rest), work: impl FnOnce() -> T) -> T {
    /// The listener before, which listens on even where the work breaks off.
    struct Before(Option<fn(Rest)>);
    impl Drop for Before {
        fn drop(&mut self) {
            LISTENER.set(self.0);
        }
    }
    let _before = Before(LISTENER.replace(Some(listener)));
    work()
}

/// Rests, if anybody listens.
#[inline]
pub fn rest(rest: Rest) {
    if let Some(listener) = LISTENER.get() {
        listener(rest);
    }
}

/// Whether anybody listens on this thread.
pub(crate) fn heard() -> bool {
    LISTENER.get().is_some()
}

/// Elements times operations between two rests: some dozens of microseconds.
pub(crate) const SPAN: usize = 1 << 17;
/// A pass over at least this many elements may end in a rest; passes over fewer are too short to be asked.
const LONG: usize = 4096;

/// What an interpreted run has done since its last rest.
#[derive(Debug)]
pub(crate) struct Rests {
    heard: bool,
    /// Elements times passes.
    done: usize,
}

impl Rests {
    /// Of a run that begins.
    pub(crate) fn new() -> Rests {
        Rests { heard: heard(), done: 0 }
    }

    /// Whether to ask after every pass over this many elements, and not only after all of a strip.
    #[inline(always)]
    pub(crate) fn after_passes(&self, elements: usize) -> bool {
        self.heard && elements >= LONG
    }

    /// Something was done; rests where it was enough.
    #[inline(never)]
    pub(crate) fn after(&mut self, done: usize) {
        self.done += done;
        if self.heard && self.done >= SPAN {
            self.done = 0;
            rest(Rest::Within);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::isa::{Array, Machine, Memory, Slot, Text};
    use crate::{Execution, InstructionSet, Program};
    use std::cell::RefCell;

    struct Double;

    const X: Slot<f64> = Slot::new(Array::X);
    const FX: Slot<f64> = Slot::new(Array::Fx);

    // SAFETY: the body names the same slots whenever it is called.
    unsafe impl Text for Double {
        type Lane = f64;
        fn body<M: Machine<Lane = f64>>(&self, m: M) {
            let mut sum = m.load(X);
            for _ in 0..20 {
                sum = sum + m.load(X);
            }
            m.store(FX, sum);
        }
    }

    thread_local! {
        static HEARD: RefCell<Vec<Rest>> = const { RefCell::new(vec![]) };
    }

    fn note(rest: Rest) {
        HEARD.with_borrow_mut(|heard| heard.push(rest));
    }

    #[test]
    fn runs_rest_at_the_same_places_and_do_the_same() {
        let n = 30_011;
        let x: Vec<f64> = (0..n).map(|i| i as f64).collect();
        let program = Program::new(Double);
        let run = |execution| {
            let mut sums = vec![0.0; n];
            let memory = Memory::new().read(X, &x).write(FX, &mut sums);
            let outcome = program.run(&memory, 0..n, execution, InstructionSet::best());
            assert_eq!(outcome, Ok(()));
            sums
        };
        for execution in [Execution::Eager, Execution::Strip(64), Execution::Chained] {
            let alone = run(execution);
            assert!(HEARD.with_borrow(Vec::is_empty));
            let rests = [(); 2].map(|()| {
                assert_eq!(listening(note, || run(execution)), alone);
                HEARD.take().len()
            });
            assert!(rests[0] > 2 && rests[0] == rests[1], "{execution:?}: {rests:?}");
        }
        assert!(!heard());
    }
}
