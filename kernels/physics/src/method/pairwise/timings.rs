//! Wall time of the phases of a step.

use serde::Serialize;

macro_rules! define_phases {
    ($(($variant:ident, $name:literal, $doc:literal)),* $(,)?) => {
        /// Phase of a step, as `bench` reports it.
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        pub enum Phase {
            $(#[doc = $doc] $variant,)*
        }

        impl Phase {
            /// All phases, in the order of the step.
            pub const ALL: &'static [Phase] = &[$(Phase::$variant),*];

            /// Name in reports.
            pub const fn name(self) -> &'static str {
                match self { $(Phase::$variant => $name),* }
            }
        }
    };
}

define_phases! {
    (Predict, "predict", "prediction of the state"),
    (CorrectPredict, "correct_predict", "correction of one step and prediction of the next in one pass"),
    (Halo, "halo", "exchange of discs near those of other ranks"),
    (Index, "index", "cells, Index, lattice vectors, or the update of the lists"),
    (Forces, "forces", "the law over all pairs"),
    (Correct, "correct", "correction of the state"),
}

/// Seconds of wall time spent in each phase, and the traffic to other ranks.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Timings {
    seconds: [f64; Phase::ALL.len()],
    halo: HaloTraffic,
}

/// Traffic that a rank sends about discs near other ranks.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct HaloTraffic {
    /// Number of messages.
    pub messages: u64,
    /// Total size in bytes.
    pub bytes: u64,
}

impl Timings {
    /// Runs `work` and adds its duration.
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

    /// Traffic to other ranks.
    pub fn halo(&self) -> HaloTraffic {
        self.halo
    }

    /// Counts a message of some bytes to another rank.
    pub(crate) fn sent(&mut self, bytes: u64) {
        self.halo.messages += 1;
        self.halo.bytes += bytes;
    }

    /// Seconds spent in a phase.
    pub fn seconds(&self, phase: Phase) -> f64 {
        self.seconds[phase as usize]
    }

    /// Seconds of the phases that occurred, by name.
    pub fn named(&self) -> std::collections::BTreeMap<&'static str, f64> {
        let there = Phase::ALL.iter().filter(|&&phase| self.seconds(phase) > 0.0);
        there.map(|&phase| (phase.name(), self.seconds(phase))).collect()
    }
}
