//! Timing: many short samples of every point, taken in turns over the whole measurement, so that a busy moment of the
//! machine meets each of them alike and none of them always.

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

/// The samples of one point.
#[derive(Clone, Debug, Default)]
pub(super) struct Samples {
    /// Runs of a sample: as many as the timer needs. Known after the first.
    runs: usize,
    /// Nanoseconds of a run, sample by sample.
    each: Vec<f64>,
}

impl Samples {
    /// Takes one more sample, at least `shortest` nanoseconds long.
    pub(super) fn take(&mut self, shortest: f64, mut work: impl FnMut()) {
        let mut clock = |times: usize| {
            let start = Instant::now();
            (0..times).for_each(|_| work());
            start.elapsed().as_nanos() as f64
        };
        // Something else was in the caches before.
        let warm = clock(1);
        if self.runs == 0 {
            let once = clock(1).min(warm).max(1.0);
            self.runs = ((shortest / once).ceil() as usize).clamp(1, 1 << 20);
        }
        self.each.push(clock(self.runs) / self.runs as f64);
    }

    /// Times one run as it comes, with whatever the caches hold.
    pub(super) fn take_once(&mut self, work: impl FnOnce()) {
        let start = Instant::now();
        work();
        self.each.push(start.elapsed().as_nanos() as f64);
    }

    /// The best sample; infinite before there is one.
    pub(super) fn best(&self) -> f64 {
        self.each.iter().copied().fold(f64::INFINITY, f64::min)
    }

    /// The best sample of every second one, from the first or from the second on.
    pub(super) fn best_of_half(&self, half: usize) -> f64 {
        let best = self.each.iter().skip(half).step_by(2).copied().fold(f64::INFINITY, f64::min);
        if best.is_finite() { best } else { self.best() }
    }

    /// How much slower than the best the median one was, as a share.
    pub(super) fn spread(&self) -> f64 {
        let mut sorted = self.each.clone();
        sorted.sort_by(f64::total_cmp);
        sorted.get(sorted.len() / 2).map_or(0.0, |median| median / self.best() - 1.0)
    }

    /// How far the best samples of the two halves differ, as a share.
    pub(super) fn disagreement(&self) -> f64 {
        let [a, b] = [self.best_of_half(0), self.best_of_half(1)];
        (a - b).abs() / a.min(b)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_best_sample_counts_and_halves_are_told_apart() {
        let samples = Samples { runs: 1, each: vec![3.0, 2.0, 4.0, 2.5, 3.0] };
        assert_eq!((samples.best(), samples.best_of_half(0), samples.best_of_half(1)), (2.0, 3.0, 2.0));
        assert_eq!((samples.spread(), samples.disagreement()), (0.5, 0.5));
        assert!(Samples::default().best().is_infinite());
    }

    #[test]
    fn a_sample_is_as_long_as_the_timer_needs() {
        let mut samples = Samples::default();
        samples.take(20_000.0, || drop(std::hint::black_box(vec![0_u8; 64])));
        assert!(samples.runs > 10 && samples.best() > 0.0);
    }
}
