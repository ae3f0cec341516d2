//! Timing samples of several pieces of work. Samples are taken in turns over the whole measurement, so that a disturbance affects all equally.
//! Results are medians, which are what a user typically observes.

use crate::statistics::{median, quantile};
use std::time::Instant;

/// Minimum number of samples for a spread.
const QUARTERS: usize = 4;

/// Samples of one piece of work (ns).
#[derive(Clone, Debug, Default)]
pub(super) struct Samples(Vec<f64>);

impl Samples {
    /// Adds a sample.
    pub(super) fn push(&mut self, ns: f64) {
        self.0.push(ns);
    }

    /// Adds one sample per piece of work, averaged over `times` rounds. The pieces run one after the other, like the parts of a step, so each
    /// finds the caches as left by the others. A first untimed round fills the caches.
    ///
    /// # Errors
    /// Error of a piece of work; then no sample is added.
    pub(super) fn take_in_turns<E>(
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

    /// Median; `None` without samples.
    pub(super) fn median(&self) -> Option<f64> {
        (!self.0.is_empty()).then(|| median(self.0.iter().copied()))
    }

    /// Half the interquartile range over the median; `None` with too few samples.
    pub(super) fn spread(&self) -> Option<f64> {
        let mut rising = self.0.clone();
        rising.sort_by(f64::total_cmp);
        let [low, middle, high] = [0.25, 0.5, 0.75].map(|share| quantile(&rising, share));
        (rising.len() >= QUARTERS).then(|| Some(0.5 * (high? - low?) / middle?))?
    }

    /// Relative difference between the medians of the even and the odd samples; `None` with too few samples.
    pub(super) fn disagreement(&self) -> Option<f64> {
        let half = |from: usize| median(self.0.iter().skip(from).step_by(2).copied());
        (self.0.len() >= QUARTERS).then(|| half(0).max(half(1)) / half(0).min(half(1)) - 1.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::convert::Infallible;

    #[test]
    fn median_and_halves_of_samples() {
        let mut samples = Samples::default();
        assert_eq!(samples.median(), None);
        [3.0, 2.0, 4.0, 6.0, 5.0, 3.0, 4.0, 6.0, 9.0].into_iter().for_each(|ns| samples.push(ns));
        assert_eq!((samples.median(), samples.disagreement()), (Some(4.0), Some(0.5)));
        assert!(samples.spread().unwrap() > 0.0);
    }

    /// The spread of few samples is unknown, not 0.
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

    /// Failed work adds no sample.
    #[test]
    fn failed_work_is_not_timed() {
        let mut all = vec![Samples::default(); 2];
        let work = |at: usize| if at == 1 { Err(at) } else { Ok(()) };
        assert_eq!(Samples::take_in_turns(&mut all, 2, work), Err(1));
        assert!(all.iter().all(|samples| samples.median().is_none()));
    }

    #[test]
    fn work_in_turns_is_warmed_up_and_timed() {
        let mut all = vec![Samples::default(); 2];
        let mut order = vec![];
        let work = |at| {
            order.push(at);
            Ok::<_, Infallible>(())
        };
        Samples::take_in_turns(&mut all, 2, work).unwrap();
        assert_eq!(order, [0, 1, 0, 1, 0, 1]);
        assert!(all.iter().all(|samples| samples.median().is_some()));
    }
}
