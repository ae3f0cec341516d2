//! End of the initial transient of a series.

use super::waves::{WaveError, mean};

/// Number of batches in the search.
const BATCHES: usize = 64;
/// Largest fraction of the series that may be cut.
const LATEST: f64 = 0.75;
/// Smallest fraction of the batches left by every cut that is tried: the scatter of a few batches may be small accidentally.
const LEAST_LEFT: f64 = 0.375;
/// Factor by which the series is shortened in the search for a shorter transient.
const FINER: usize = 8;
/// Smallest deviation of the beginning from the rest that indicates a transient (standard errors of the difference): of a thousand series without a
/// transient, two are cut.
const DIFFERENT: f64 = 4.0;
/// Deviation within which the rest of a detected transient agrees with the series (standard errors).
const AGREEING: f64 = 2.0;

/// Number of values in the initial transient of a series; none if it lasts almost as long as the series.
///
/// The cut minimises the error that the rest would have as independent batches, s²/m of its m batch means (marginal standard error rule: White,
/// Simulation 69, 323 (1997)). In contrast to the number of independent samples, this rule detects a transient of a single row. A beginning that
/// agrees with the rest is kept. At the cut, the transient has fallen below the noise of a batch, but not below that of the mean: an equal part is
/// cut in addition, which squares the remainder of an exponential.
pub(super) fn transient_length(series: &[f64]) -> Option<usize> {
    let cut = least_error(series);
    // A transient shorter than the cut deviates more in a part of it.
    let mut beginnings = std::iter::successors(Some(cut), |it| Some(it / 2)).take_while(|&it| it > 0);
    if !beginnings.any(|it| has_different_mean(&series[..it], &series[cut..], DIFFERENT)) {
        return Some(0);
    }
    // A transient of a few rows is within one batch; a shorter series has shorter batches.
    let mut start = 2 * cut;
    let mut beginning = series;
    while beginning.len() > BATCHES {
        beginning = &beginning[..beginning.len() / FINER];
        let shorter = 2 * least_error(beginning);
        if shorter == 0
            || shorter >= cut
            || has_different_mean(&series[shorter..cut], &series[cut..], AGREEING)
        {
            break;
        }
        start = shorter;
    }
    (start as f64 <= LATEST * series.len() as f64).then_some(start)
}

/// Number of values before the batches whose mean has the smallest error.
fn least_error(series: &[f64]) -> usize {
    let (length, means) = batches(series);
    let mut best = (f64::INFINITY, 0);
    let mut squares = RunningVariance::default();
    for (at, value) in means.iter().enumerate().rev() {
        squares.add(*value);
        let error = squares.variance() / squares.count;
        // A rest that does not vary has no known error.
        if squares.count >= LEAST_LEFT * means.len() as f64 && error > 0.0 && error <= best.0 {
            best = (error, at);
        }
    }
    best.1 * length
}

/// Sums of squares about the mean, updated for each value (Welford, Technometrics 4, 419 (1962)).
#[derive(Default)]
struct RunningVariance {
    count: f64,
    mean: f64,
    sum: f64,
}

impl RunningVariance {
    fn add(&mut self, value: f64) {
        self.count += 1.0;
        let off = value - self.mean;
        self.mean += off / self.count;
        self.sum += off * (value - self.mean);
    }

    fn variance(&self) -> f64 {
        self.sum / self.count
    }
}

/// Tests if the mean of a first part differs from that of the rest by a number of standard errors. A part shorter than the correlation time varies
/// like a single value. No section of the rest of the same length may have such a mean: rare events are not a transient.
fn has_different_mean(first: &[f64], rest: &[f64], errors: f64) -> bool {
    let WaveError { mean: expected, standard_error, samples, .. } = WaveError::of(rest);
    let square = standard_error * standard_error;
    let of_first = (square * rest.len() as f64 / first.len() as f64).min(square * samples);
    let off = mean(first) - expected;
    let farthest =
        rest.chunks_exact(first.len()).map(|it| (mean(it) - expected) * off.signum()).fold(0.0, f64::max);
    off.abs() > farthest.max(errors * (of_first + square).sqrt())
}

/// Number of values of a batch, and the means of all complete batches.
pub(super) fn batches(series: &[f64]) -> (usize, Vec<f64>) {
    let length = series.len().div_ceil(BATCHES).max(1);
    (length, series.chunks_exact(length).map(mean).collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::averages::noise::Noise;
    use crate::averages::{AverageOutcome, estimate_mean};

    /// A step of ten values, far above noise of known size: ten values are cut, and ten more.
    #[test]
    fn transient_cut_is_twice_the_step() {
        for (height, first) in [(50.0, 10), (-4.0, 10), (5e4, 1)] {
            let mut series = Noise::new(1).series(64, 0.0);
            series[..first].iter_mut().for_each(|value| *value += height);
            assert_eq!(transient_length(&series), Some(2 * first), "{height}");
        }
    }

    #[test]
    fn transients_are_cut_and_stationary_series_kept() {
        let cut = |height| {
            let cuts = (0..100).filter_map(|seed| {
                transient_length(&Noise::new(seed).relaxing(1000, 0.5, height, 20.0)).map(|cut| cut as f64)
            });
            let cuts: Vec<f64> = cuts.collect();
            assert!(cuts.len() > 95, "{height}: {}", cuts.len());
            cuts.iter().sum::<f64>() / cuts.len() as f64
        };
        let (with, without) = (cut(10.0), cut(0.0));
        // The remaining transient is then e⁻³, and at most a quarter is cut.
        assert!((60.0..250.0).contains(&with) && without < 30.0, "{with} {without}");
    }

    /// An outlier in the first of two thousand rows costs a few rows, not a batch of them.
    #[test]
    fn outlier_in_first_row_costs_few_rows() {
        let cut = |seed| transient_length(&Noise::new(seed).relaxing(2000, 0.3, 5e4, 0.2)).unwrap();
        let mut cuts: Vec<usize> = (0..50).map(cut).collect();
        cuts.sort_unstable();
        assert!(cuts[0] >= 4 && cuts[40] <= 64, "{cuts:?}");
    }

    #[test]
    fn long_transients_have_no_mean() {
        for duration in [30.0, 75.0, 150.0] {
            let decay: Vec<f64> = (0..200).map(|at| libm::exp(-f64::from(at) / duration)).collect();
            let outcome = estimate_mean(&decay, 0.0, 1.0);
            assert!(!matches!(outcome, AverageOutcome::Mean(_)), "{duration}: {outcome:?}");
        }
    }
}
