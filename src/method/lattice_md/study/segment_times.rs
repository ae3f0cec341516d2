//! Times of work on an undisturbed core: from the samples that were undisturbed, or from how the others depend on the
//! slowdown. Work that takes longer than the core stays undisturbed is timed segment by segment.

use super::noise_monitor::Timed;
use crate::statistics::quantile;

/// This many undisturbed samples are enough.
const FEW: usize = 2;
/// Two samples are compared only if their slowdowns differ by at least this much (logarithm).
const APART: f64 = 0.1;
/// A sample is compared with this many after it.
const COMPARED: usize = 8;
/// Prior weight, in pairs of samples, of a time in proportion to the slowdown: few samples determine little.
const PRIOR: usize = 50;
/// The highest power of the slowdown that is accepted: what another program slows down most grows with its square.
const HIGHEST: f64 = 2.5;

/// The times of some work, run by run, each segment by segment.
#[derive(Clone, Debug, Default)]
pub struct SegmentTimes {
    /// By the number of segments of a run: for each segment, its times in all such runs.
    of: Vec<Vec<Vec<Timed>>>,
}

impl SegmentTimes {
    /// One more run.
    pub fn push(&mut self, run: &[Timed]) {
        if self.of.len() <= run.len() {
            self.of.resize(run.len() + 1, vec![]);
        }
        let segments = &mut self.of[run.len()];
        segments.resize(run.len(), vec![]);
        segments.iter_mut().zip(run).for_each(|(segment, timed)| segment.push(*timed));
    }

    /// Adds the runs of another measurement.
    pub fn join(&mut self, more: &SegmentTimes) {
        for segments in &more.of {
            for run in 0..segments.first().map_or(0, Vec::len) {
                self.push(&segments.iter().map(|segment| segment[run]).collect::<Vec<_>>());
            }
        }
    }

    /// The runs by segment: of the number of segments that most runs had.
    fn segments(&self) -> &[Vec<Timed>] {
        let runs = |segments: &&Vec<Vec<Timed>>| segments.first().map_or(0, Vec::len);
        self.of.iter().max_by_key(runs).map_or(&[], Vec::as_slice)
    }

    fn run(&self, run: usize) -> Vec<Timed> {
        self.segments().iter().map(|segment| segment[run]).collect()
    }

    /// Runs.
    pub fn runs(&self) -> usize {
        self.segments().first().map_or(0, Vec::len)
    }

    /// Every `step`th run, beginning with `from`.
    #[must_use]
    pub fn every(&self, step: usize, from: usize) -> SegmentTimes {
        let mut part = SegmentTimes::default();
        (from..self.runs()).step_by(step).for_each(|run| part.push(&self.run(run)));
        part
    }

    /// Nanoseconds of a run on an undisturbed core: for each share, the sum over the segments of that quantile of the
    /// samples. None without runs.
    pub fn quantiles<const N: usize>(&self, reference: f64, shares: [f64; N]) -> Option<[f64; N]> {
        let segments = self.segments();
        if self.runs() == 0 {
            return None;
        }
        let mut known = None;
        let mut sums = [0.0; N];
        for segment in segments {
            let mut times: Vec<f64> =
                segment.iter().filter(|timed| timed.was_quiet(reference)).map(|timed| timed.ns).collect();
            let of_quiet = times.len() >= FEW;
            if !of_quiet {
                let power = *known.get_or_insert_with(|| power(segments));
                times =
                    segment.iter().map(|timed| timed.ns / timed.slowdown(reference).powf(power)).collect();
            }
            times.sort_by(f64::total_cmp);
            // A corrected time is sometimes too short.
            let least = if of_quiet { 0.0 } else { CORRECTED };
            for (sum, share) in sums.iter_mut().zip(shares) {
                *sum += quantile(&times, share.max(least)).unwrap_or(0.0);
            }
        }
        Some(sums)
    }

    /// The same at the quantile that represents the samples.
    pub fn typical(&self, reference: f64) -> Option<f64> {
        self.quantiles(reference, [COUNTS]).map(|[typical]| typical)
    }

    /// The share of the time that was measured on an undisturbed core, and not corrected for a slowdown.
    pub fn quiet(&self, reference: f64) -> f64 {
        let [mut quiet, mut all] = [0.0; 2];
        for segment in self.segments() {
            let ns: f64 = segment.iter().map(|timed| timed.ns).sum();
            all += ns;
            if segment.iter().filter(|timed| timed.was_quiet(reference)).count() >= FEW {
                quiet += ns;
            }
        }
        if all > 0.0 { quiet / all } else { 0.0 }
    }
}

/// The power of the slowdown that the times of some work grow with: the median over pairs of samples of a segment (Theil and
/// Sen). Another program on the core slows down what keeps the core busy by more than the reference loop, and what waits for
/// memory by less. What takes longer than a slowdown lasts depends on the two readings hardly at all.
fn power(segments: &[Vec<Timed>]) -> f64 {
    let mut slopes = vec![1.0; PRIOR];
    for segment in segments {
        let points: Vec<[f64; 2]> = segment
            .iter()
            .filter(|timed| timed.ns > 0.0)
            .map(|timed| [timed.slowdown(1.0).ln(), timed.ns.ln()])
            .collect();
        let pairs = points
            .iter()
            .enumerate()
            .flat_map(|(at, a)| points[at + 1..].iter().take(COMPARED).map(move |b| (a, b)));
        let apart = pairs.filter(|(a, b)| (a[0] - b[0]).abs() > APART);
        slopes.extend(apart.map(|(a, b)| (a[1] - b[1]) / (a[0] - b[0])));
    }
    let middle = slopes.len() / 2;
    slopes.select_nth_unstable_by(middle, f64::total_cmp).1.clamp(0.0, HIGHEST)
}

/// The quantile that represents the samples. A disturbance makes a sample longer, and so does what other programs left in the
/// larger caches, even on an undisturbed core; but the shortest of all may be too short by the resolution of the clock.
pub const COUNTS: f64 = 0.1;
/// The lowest quantile that is used of corrected samples.
const CORRECTED: f64 = 0.25;

#[cfg(test)]
mod tests {
    use super::*;

    fn timed(ns: f64, before: f64, after: f64) -> Timed {
        Timed { ns, around: [before, after] }
    }

    fn segments(runs: &[Timed]) -> SegmentTimes {
        let mut segments = SegmentTimes::default();
        runs.iter().for_each(|run| segments.push(&[*run]));
        segments
    }

    #[test]
    fn undisturbed_samples_count_alone_where_there_are_enough() {
        let noisy = [timed(300.0, 20.0, 20.0), timed(90.0, 10.0, 20.0), timed(95.0, 20.0, 10.0)];
        let quiet = [
            timed(101.0, 10.0, 10.2),
            timed(102.0, 10.1, 10.0),
            timed(103.0, 10.0, 10.0),
            timed(103.0, 10.0, 10.0),
        ];
        let both = segments(&[noisy.as_slice(), &quiet].concat());
        assert_eq!(both.quantiles(10.0, [0.0, 1.0]), Some([101.0, 103.0]));
        assert_eq!((both.quiet(10.0), segments(&noisy).quiet(10.0)), (1.0, 0.0));
        assert_eq!(SegmentTimes::default().typical(10.0), None);
    }

    #[test]
    fn each_work_has_its_own_power_of_the_slowdown() {
        for power in [0.3, 1.8] {
            let each = |i: i32| {
                let slowdown = 1.1 + 0.05 * f64::from(i % 10);
                timed(100.0 * slowdown.powf(power), 10.0 * slowdown, 10.0 * slowdown)
            };
            let mut samples: Vec<Timed> = (0..40).map(each).collect();
            // One interrupted sample does not change the result.
            samples.push(timed(9000.0, 15.0, 15.0));
            let [low, high] = segments(&samples).quantiles(10.0, [0.0, 0.95]).unwrap();
            assert!(
                (low / 100.0 - 1.0).abs() < 0.03 && (high / 100.0 - 1.0).abs() < 0.03,
                "{power}: {low} {high}"
            );
        }
        // Few samples count less than the prior, and powers out of range are not accepted.
        let few = [timed(100.0, 20.0, 20.0), timed(100.0, 40.0, 40.0)];
        assert_eq!(segments(&few).quantiles(10.0, [0.0, 1.0]), Some([25.0, 50.0]));
        let wild: Vec<Timed> =
            (0..40).map(|at| timed(f64::from(1 << (at % 10)), 10.0 + f64::from(at % 10), 10.0)).collect();
        assert_eq!(power(&[wild]), HIGHEST);
    }

    #[test]
    fn a_long_run_is_the_sum_of_its_segments() {
        // Never undisturbed from end to end, but each segment in some runs.
        let mut all = SegmentTimes::default();
        for run in 0..16 {
            let segment = |at: usize| {
                let [before, after] = [at, at + 1].map(|rest| if (run + rest) % 4 < 2 { 10.0 } else { 17.0 });
                let slow = if before + after > 20.0 { 1.5 } else { 1.0 };
                timed(slow * (at + 1) as f64, before, after)
            };
            all.push(&(0..9).map(segment).collect::<Vec<_>>());
        }
        // A run with another number of segments is not compared with these.
        all.push(&[timed(1.0, 10.0, 10.0)]);
        assert_eq!((all.typical(10.0), all.runs(), all.quiet(10.0)), (Some(45.0), 16, 1.0));
        let mut joined = all.every(2, 0);
        joined.join(&all.every(2, 1));
        assert_eq!((joined.typical(10.0), joined.runs()), (Some(45.0), 16));
    }
}
