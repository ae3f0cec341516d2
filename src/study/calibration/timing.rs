//! Timing: many short samples of every point, taken in turns over the whole measurement, so that a busy moment of the
//! machine meets each of them alike and none of them always; a reading of the yardstick between any two of them.

use crate::study::pace::{COUNTS, Timed, at_pace, quantile, reading};
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

/// A clock that reads the yardstick between samples.
pub(super) struct PacedClock {
    readings: Vec<f64>,
}

impl PacedClock {
    /// With one reading.
    pub(super) fn new() -> PacedClock {
        PacedClock { readings: vec![reading()] }
    }

    /// The readings before and after some work, and what it says.
    fn around<T>(&mut self, work: impl FnOnce() -> T) -> (T, [f64; 2]) {
        let before = self.readings.last().copied().unwrap_or_default();
        let said = work();
        self.look();
        (said, [before, self.readings.last().copied().unwrap_or_default()])
    }

    /// A reading of its own: something else was done since the last sample.
    pub(super) fn look(&mut self) {
        self.readings.push(reading());
    }

    /// What the yardstick took in the middle (ns): how times follow the pace is known best where there are samples on both
    /// sides.
    pub(super) fn reference(&self) -> f64 {
        quantile(&self.rising(), 0.5).unwrap_or(f64::NAN)
    }

    /// How many times as long that is as in a good moment: nine of ten readings are slower.
    pub(super) fn pace(&self) -> f64 {
        self.reference() / quantile(&self.rising(), 0.1).unwrap_or(f64::NAN)
    }

    fn rising(&self) -> Vec<f64> {
        let mut rising = self.readings.clone();
        rising.sort_by(f64::total_cmp);
        rising
    }
}

/// The samples of one point.
#[derive(Clone, Debug, Default)]
pub(super) struct Samples {
    /// Runs of a sample: as many as the timer needs. Known after the first.
    runs: usize,
    /// Nanoseconds of a run, sample by sample.
    each: Vec<Timed>,
    /// The same at one pace, rising, once it is known: all, those of even and those of odd number.
    paced: [Vec<f64>; 3],
}

impl Samples {
    /// Takes one more sample, at least `shortest` nanoseconds long.
    pub(super) fn take(&mut self, clock: &mut PacedClock, shortest: f64, mut work: impl FnMut()) {
        let mut time = |times: usize| {
            let start = Instant::now();
            (0..times).for_each(|_| work());
            start.elapsed().as_nanos() as f64
        };
        let runs = &mut self.runs;
        let (ns, around) = clock.around(|| {
            // Something else was in the caches before.
            let warm = time(1);
            if *runs == 0 {
                let once = time(1).min(warm).max(1.0);
                *runs = ((shortest / once).ceil() as usize).clamp(1, 1 << 20);
            }
            time(*runs) / *runs as f64
        });
        self.each.push(Timed { ns, around });
    }

    /// Takes one more sample of each of some works that are done one after the other, so many times in a row, as the parts
    /// of a step are: each finds what the others have left. Done once before, for something else was in the caches.
    pub(super) fn take_in_turns(
        all: &mut [Samples],
        clock: &mut PacedClock,
        times: usize,
        mut work: impl FnMut(usize),
    ) {
        (0..all.len()).for_each(&mut work);
        let mut ns = vec![0.0; all.len()];
        let ((), around) = clock.around(|| {
            for _ in 0..times {
                for (at, ns) in ns.iter_mut().enumerate() {
                    let start = Instant::now();
                    work(at);
                    *ns += start.elapsed().as_nanos() as f64;
                }
            }
        });
        for (samples, ns) in all.iter_mut().zip(ns) {
            samples.each.push(Timed { ns: ns / times as f64, around });
        }
    }

    /// Tells the samples at the pace of a reference.
    pub(super) fn settle(&mut self, reference: f64) {
        let half = |half: usize| -> Vec<Timed> { self.each.iter().skip(half).step_by(2).copied().collect() };
        self.paced = [self.each.clone(), half(0), half(1)].map(|samples| at_pace(&samples, reference));
    }

    /// The sample that counts, at one pace; infinite before there is one.
    pub(super) fn typical(&self) -> f64 {
        quantile(&self.paced[0], COUNTS).unwrap_or(f64::INFINITY)
    }

    /// The same of every second sample, from the first or from the second on.
    pub(super) fn of_half(&self, half: usize) -> f64 {
        quantile(&self.paced[1 + half], COUNTS).unwrap_or_else(|| self.typical())
    }

    /// Half the range between the quartiles, as a share of the sample that counts.
    pub(super) fn spread(&self) -> f64 {
        let quarter = |share: f64| quantile(&self.paced[0], share).unwrap_or(f64::NAN);
        0.5 * (quarter(0.75) - quarter(0.25)) / self.typical()
    }

    /// How far the two halves differ, as a share.
    pub(super) fn disagreement(&self) -> f64 {
        let [a, b] = [self.of_half(0), self.of_half(1)];
        (a - b).abs() / a.min(b)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_low_sample_counts_and_halves_are_told_apart() {
        let timed = |ns| Timed { ns, around: [1.0; 2] };
        let each = [3.0, 2.0, 4.0, 6.0, 5.0].map(timed).to_vec();
        let mut samples = Samples { each, ..Samples::default() };
        assert!(samples.typical().is_infinite());
        samples.settle(1.0);
        assert_eq!((samples.typical(), samples.of_half(0), samples.of_half(1)), (3.0, 4.0, 2.0));
        assert_eq!((samples.spread(), samples.disagreement()), (1.0 / 3.0, 1.0));
    }

    #[test]
    fn the_middle_reading_is_the_reference() {
        let readings = |slow: usize| {
            let slow = (0..slow).map(|i| 150.0 + i as f64 / 10.0);
            (0..40).map(|i| 100.0 + f64::from(i) / 10.0).chain(slow).collect()
        };
        let [few, many] = [10, 200].map(|slow| PacedClock { readings: readings(slow) });
        assert!((100.0..104.0).contains(&few.reference()), "{}", few.reference());
        assert!((150.0..170.0).contains(&many.reference()), "{}", many.reference());
        assert!(few.pace() < 1.1 && many.pace() > 1.4);
    }

    #[test]
    fn a_sample_is_as_long_as_the_timer_needs() {
        let (mut samples, mut clock) = (Samples::default(), PacedClock::new());
        samples.take(&mut clock, 20_000.0, || drop(std::hint::black_box(vec![0_u8; 64])));
        samples.settle(clock.reference());
        assert!(samples.runs > 10 && samples.typical() > 0.0);
        assert!(clock.pace() > 0.0);
    }

    #[test]
    fn works_in_turns_are_done_once_before_and_timed_each_by_itself() {
        let (mut all, mut clock) = (vec![Samples::default(); 2], PacedClock::new());
        let mut order = vec![];
        Samples::take_in_turns(&mut all, &mut clock, 2, |at| order.push(at));
        assert_eq!(order, [0, 1, 0, 1, 0, 1]);
        assert!(all.iter().all(|samples| samples.each.len() == 1));
    }
}
