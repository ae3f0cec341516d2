//! Times of pieces of work: many short samples of each, taken in turns over the whole measurement, so that a disturbance affects all
//! alike. What counts is the middle of the samples, which is what a user meets; the lowest tenth stands beside it.

use crate::statistics::quantile;
use std::time::Instant;

/// Parts of the samples, each spread over the whole measurement: how far they differ is the uncertainty of a number.
pub const PARTS: usize = 4;

/// Samples from which on it is known how far they lie apart.
const QUARTERS: usize = 4;

/// Runs of a sample at most.
const MOST: usize = 1 << 20;

/// The samples of one piece of work (ns).
#[derive(Clone, Debug, Default)]
pub struct Samples {
    /// Runs of a sample: as many as the clock needs. Known after the first.
    runs: usize,
    each: Vec<f64>,
}

impl Samples {
    /// Adds one.
    pub fn push(&mut self, ns: f64) {
        self.each.push(ns);
    }

    /// How many there are.
    pub fn count(&self) -> usize {
        self.each.len()
    }

    /// Adds those of another time.
    pub fn join(&mut self, more: &Samples) {
        self.each.extend_from_slice(&more.each);
    }

    /// Takes one more, at least `shortest` nanoseconds long.
    ///
    /// # Errors
    /// That of the work, which is then no sample.
    pub fn take<E>(&mut self, shortest: f64, mut work: impl FnMut() -> Result<(), E>) -> Result<(), E> {
        let mut time = |times: usize| {
            let start = Instant::now();
            (0..times).try_for_each(|_| work())?;
            Ok(start.elapsed().as_nanos() as f64)
        };
        // The first run fills the caches.
        let once = time(1)?;
        if self.runs == 0 {
            let once = once.min(time(1)?).max(1.0);
            self.runs = ((shortest / once).ceil() as usize).clamp(1, MOST);
        }
        self.each.push(time(self.runs)? / self.runs as f64);
        Ok(())
    }

    /// Takes one more of each of some works that are done one after the other, `times` times in a row, as the parts of a step are: each
    /// finds the caches as the others leave them. A first round fills the caches.
    ///
    /// # Errors
    /// That of a work; then none has a sample more.
    pub fn take_in_turns<E>(
        all: &mut [Samples],
        times: usize,
        mut work: impl FnMut(usize) -> Result<(), E>,
    ) -> Result<(), E> {
        (0..all.len()).try_for_each(&mut work)?;
        let mut ns = vec![0.0; all.len()];
        for _ in 0..times {
            for (at, ns) in ns.iter_mut().enumerate() {
                let start = Instant::now();
                work(at)?;
                *ns += start.elapsed().as_nanos() as f64 / times as f64;
            }
        }
        all.iter_mut().zip(ns).for_each(|(samples, ns)| samples.push(ns));
        Ok(())
    }

    fn at(&self, share: f64) -> Option<f64> {
        quantile(&rising(&self.each), share)
    }

    /// The middle one; without end if there is none.
    pub fn middle(&self) -> f64 {
        self.at(0.5).unwrap_or(f64::INFINITY)
    }

    /// The lowest tenth ends here.
    pub fn low(&self) -> f64 {
        self.at(0.1).unwrap_or(f64::INFINITY)
    }

    /// The quartiles; not a number where there are no samples.
    pub fn quartiles(&self) -> [f64; 2] {
        [0.25, 0.75].map(|share| self.at(share).unwrap_or(f64::NAN))
    }

    /// The middle one of a part.
    pub fn of_part(&self, part: usize) -> f64 {
        let every: Vec<f64> = self.each.iter().skip(part).step_by(PARTS).copied().collect();
        quantile(&rising(&every), 0.5).unwrap_or_else(|| self.middle())
    }

    /// Half the range of the middle half, as a share of the middle; none of fewer than a sample for each quarter.
    pub fn spread(&self) -> Option<f64> {
        let [low, high] = self.quartiles();
        (self.count() >= QUARTERS).then(|| 0.5 * (high - low) / self.middle())
    }

    /// The middles of the samples of even and of odd number; none of fewer than two.
    pub fn halves(&self) -> Option<[f64; 2]> {
        let half = |from: usize| {
            let every: Vec<f64> = self.each.iter().skip(from).step_by(2).copied().collect();
            quantile(&rising(&every), 0.5)
        };
        Some([half(0)?, half(1)?])
    }

    /// How far these lie apart, as a share; none where the halves are single samples.
    pub fn disagreement(&self) -> Option<f64> {
        let [even, odd] = self.halves().filter(|_| self.count() >= QUARTERS)?;
        Some(even.max(odd) / even.min(odd) - 1.0)
    }
}

fn rising(values: &[f64]) -> Vec<f64> {
    let mut values = values.to_vec();
    values.sort_by(f64::total_cmp);
    values
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::convert::Infallible;

    #[test]
    fn the_middle_counts_and_parts_are_evaluated_apart() {
        let mut samples = Samples::default();
        assert!(samples.middle().is_infinite() && samples.halves().is_none());
        [3.0, 2.0, 4.0, 6.0, 5.0, 3.0, 4.0, 6.0, 9.0].into_iter().for_each(|ns| samples.push(ns));
        assert_eq!((samples.middle(), samples.of_part(1), samples.count()), (4.0, 3.0, 9));
        assert_eq!((samples.halves(), samples.disagreement()), (Some([4.0, 6.0]), Some(0.5)));
        assert!(samples.low() <= 3.0 && samples.spread().unwrap() > 0.0);
    }

    /// The spread of one sample is not 0, but unknown.
    #[test]
    fn few_samples_have_no_spread() {
        let mut samples = Samples::default();
        for ns in [3.0, 3.0, 3.0] {
            samples.push(ns);
            assert_eq!((samples.spread(), samples.disagreement()), (None, None));
        }
        samples.push(3.0);
        assert_eq!((samples.spread(), samples.disagreement()), (Some(0.0), Some(0.0)));
    }

    /// A work that fails is no sample.
    #[test]
    fn works_that_fail_are_not_timed() {
        let mut samples = Samples::default();
        assert_eq!(samples.take(1.0, || Err("broken")), Err("broken"));
        let mut all = vec![Samples::default(); 2];
        let work = |at: usize| if at == 1 { Err(at) } else { Ok(()) };
        assert_eq!(Samples::take_in_turns(&mut all, 2, work), Err(1));
        assert!(all.iter().chain([&samples]).all(|samples| samples.count() == 0));
    }

    #[test]
    fn a_sample_is_as_long_as_the_clock_needs() {
        let mut samples = Samples::default();
        let work = || {
            drop(std::hint::black_box(vec![0_u8; 64]));
            Ok::<_, Infallible>(())
        };
        samples.take(20_000.0, work).unwrap();
        assert!(samples.runs > 10 && samples.middle() > 0.0);
    }

    #[test]
    fn works_in_turns_are_done_once_before_and_timed_each_by_itself() {
        let mut all = vec![Samples::default(); 2];
        let mut order = vec![];
        let work = |at| {
            order.push(at);
            Ok::<_, Infallible>(())
        };
        Samples::take_in_turns(&mut all, 2, work).unwrap();
        assert_eq!(order, [0, 1, 0, 1, 0, 1]);
        assert!(all.iter().all(|samples| samples.count() == 1));
    }
}
