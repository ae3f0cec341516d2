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

/// Seconds of wall time spent in each phase, and what was told to other ranks meanwhile.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Timings {
    seconds: [f64; Phase::ALL.len()],
    halo: Halo,
}

/// What a rank tells of the discs near others.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct Halo {
    /// Messages.
    pub messages: u64,
    /// Bytes of all of them.
    pub bytes: u64,
}

impl Timings {
    /// Runs `work` and adds what it took.
    pub fn time<R>(&mut self, phase: Phase, work: impl FnOnce() -> R) -> R {
        let start = std::time::Instant::now();
        let result = work();
        self.add(phase, start.elapsed().as_secs_f64());
        result
    }

    /// Adds seconds that a phase took.
    pub fn add(&mut self, phase: Phase, seconds: f64) {
        self.seconds[phase as usize] += seconds;
    }

    /// What was told to other ranks.
    pub fn halo(&self) -> Halo {
        self.halo
    }

    /// A message was sent to another rank, of some bytes.
    pub(crate) fn sent(&mut self, bytes: u64) {
        self.halo.messages += 1;
        self.halo.bytes += bytes;
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
