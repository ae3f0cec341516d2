//! Where the time of a step goes.

use serde::Serialize;

macro_rules! define_phases {
    ($(($variant:ident, $name:literal, $doc:literal)),* $(,)?) => {
        /// A phase of a step, as `bench` reports it.
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        pub enum Phase {
            $(#[doc = $doc] $variant,)*
        }

        impl Phase {
            /// Every phase, in the order of the step.
            pub const ALL: &'static [Phase] = &[$(Phase::$variant),*];

            /// The name in reports.
            pub const fn name(self) -> &'static str {
                match self { $(Phase::$variant => $name),* }
            }
        }
    };
}

define_phases! {
    (Predict, "predict", "prediction of the state"),
    (CorrectPredict, "correct_predict", "correction of one step and prediction of the next in one pass"),
    (Halo, "halo", "discs near those of other ranks: told and heard of"),
    (Index, "index", "cells, Index, lattice vectors, or the upkeep of the lists"),
    (Forces, "forces", "the law over all pairs"),
    (Correct, "correct", "correction of the state"),
}

/// Seconds of wall time spent in each phase.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Timings {
    seconds: [f64; Phase::ALL.len()],
}

impl Timings {
    /// Runs `work` and adds what it took.
    pub fn time<R>(&mut self, phase: Phase, work: impl FnOnce() -> R) -> R {
        let start = std::time::Instant::now();
        let result = work();
        self.seconds[phase as usize] += start.elapsed().as_secs_f64();
        result
    }

    /// Seconds spent in a phase.
    pub fn seconds(&self, phase: Phase) -> f64 {
        self.seconds[phase as usize]
    }

    /// The phases there were, by name.
    pub fn named(&self) -> std::collections::BTreeMap<&'static str, f64> {
        let there = Phase::ALL.iter().filter(|&&phase| self.seconds(phase) > 0.0);
        there.map(|&phase| (phase.name(), self.seconds(phase))).collect()
    }
}
