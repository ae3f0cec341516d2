//! Timing: the best of several repeats, each long enough for the timer.

use std::time::Instant;

/// The smallest step of the clock that was seen (ns).
pub(super) fn timer_resolution() -> f64 {
    let step = |_| {
        let start = Instant::now();
        loop {
            let passed = start.elapsed().as_nanos();
            if passed > 0 {
                return passed as f64;
            }
        }
    };
    (0..200).map(step).fold(f64::INFINITY, f64::min)
}

/// How long something takes.
#[derive(Clone, Copy, Debug)]
pub(super) struct Sample {
    /// The best repeat (ns).
    pub(super) best: f64,
    /// The median repeat (ns).
    pub(super) median: f64,
}

impl Sample {
    /// Of two series of the same.
    pub(super) fn better(self, other: Sample) -> Sample {
        Sample { best: self.best.min(other.best), median: self.median.min(other.median) }
    }
}

/// Times `work` in `repeats` repeats of at least `shortest` nanoseconds each.
pub(super) fn time(repeats: usize, shortest: f64, mut work: impl FnMut()) -> Sample {
    let mut once = |times: usize| {
        let start = Instant::now();
        (0..times).for_each(|_| work());
        start.elapsed().as_nanos() as f64
    };
    let mut times = 1;
    // The first run warms the caches and the allocator.
    once(1);
    while once(times) < shortest && times < 1 << 20 {
        times *= 2;
    }
    let mut samples: Vec<f64> = (0..repeats).map(|_| once(times) / times as f64).collect();
    samples.sort_by(f64::total_cmp);
    Sample { best: samples[0], median: samples[samples.len() / 2] }
}
