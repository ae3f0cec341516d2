//! Probes: places within a run at which a timer may read the clock. They lie at the same places whenever a program runs over
//! as many elements, so that what lies between two of them can be compared with itself, run by run.

use std::cell::Cell;

thread_local! {
    static LISTENER: Cell<Option<fn(Probe)>> = const { Cell::new(None) };
}

/// A place in a run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Probe {
    /// Before work that has a number.
    Begins(usize),
    /// Within a program.
    Within,
    /// After work that has a number.
    Ends(usize),
}

/// Does some work; `listener` hears of every probe that this thread comes to meanwhile.
#[inline]
pub fn probed<T>(listener: fn(Probe), work: impl FnOnce() -> T) -> T {
    /// The listener before, which listens on even where the work breaks off.
    struct Before(Option<fn(Probe)>);
    impl Drop for Before {
        #[inline]
        fn drop(&mut self) {
            LISTENER.set(self.0);
        }
    }
    let _before = Before(LISTENER.replace(Some(listener)));
    work()
}

/// SinceProbe, if anybody listens.
#[inline]
pub fn probe(at: Probe) {
    if let Some(listener) = LISTENER.get() {
        listener(at);
    }
}

/// Whether this thread has a listener.
#[inline]
pub(crate) fn is_probed() -> bool {
    LISTENER.get().is_some()
}

/// Elements times operations between two probes: some dozens of microseconds.
pub(crate) const SPAN: usize = 1 << 17;
/// A pass over at least this many elements may end in a probe; passes over fewer are too short.
const LONG: usize = 4096;

/// What an interpreted run has done since its last probe.
#[derive(Debug)]
pub(crate) struct SinceProbe {
    probed: bool,
    /// Elements times passes.
    done: usize,
}

impl SinceProbe {
    /// Of a run that begins.
    #[inline]
    pub(crate) fn new() -> SinceProbe {
        SinceProbe { probed: is_probed(), done: 0 }
    }

    /// Whether to ask after every pass over this many elements, and not only after all of a strip.
    #[inline(always)]
    pub(crate) fn after_passes(&self, elements: usize) -> bool {
        self.probed && elements >= LONG
    }

    /// Something was done; a probe where it was enough.
    #[inline(never)]
    pub(crate) fn after(&mut self, done: usize) {
        self.done += done;
        if self.probed && self.done >= SPAN {
            self.done = 0;
            probe(Probe::Within);
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
        static HEARD: RefCell<Vec<Probe>> = const { RefCell::new(vec![]) };
    }

    fn note(at: Probe) {
        HEARD.with_borrow_mut(|heard| heard.push(at));
    }

    #[test]
    fn runs_are_probed_at_the_same_places_and_do_the_same() {
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
            let probes = [(); 2].map(|()| {
                assert_eq!(probed(note, || run(execution)), alone);
                HEARD.take().len()
            });
            assert!(probes[0] > 2 && probes[0] == probes[1], "{execution:?}: {probes:?}");
        }
        assert!(!is_probed());
    }
}
