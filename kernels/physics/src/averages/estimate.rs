//! The mean of a series with its error, or why there is none.

use super::autocorrelation::{corrected, mean};
use super::blocking::blocked_error;
use super::equilibration::equilibrated;
use super::student::student;
use serde::Serialize;

/// Independent samples below which no mean is given: neither the cut nor the error can be relied on. With hardly more of them the bars are a
/// little short: those of 95 % hold the truth in 88 to 94 of 100 series.
pub const FEWEST_SAMPLES: f64 = 10.0;
/// A run that is too short is said to need this many times what it would by its own estimate, which is a rough one.
const MARGIN: f64 = 1.5;
/// Bars hold the truth with this probability.
pub const CONFIDENCE: f64 = 0.95;
/// A series is still changing where its rank correlation with time is above this over √(samples − 1): one stationary series of
/// a thousand is.
const TREND: f64 = 3.3;
/// The same, however few samples there are.
const STRONG: f64 = 0.8;
/// A series that varies by less than this part of its largest value does not vary: it is rounding.
const ROUNDING: f64 = 1e-9;
/// Student's t hardly changes beyond this number of degrees of freedom.
const MANY: f64 = 1000.0;

/// A mean over time with its error.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Estimate {
    /// The mean.
    pub mean: f64,
    /// Half the width of the interval that holds the true mean with a probability of 95 %: Student's t times the larger of both errors.
    pub bar: f64,
    /// Standard error of the mean by its autocorrelation: s √(g/n).
    pub standard_error: f64,
    /// Standard error by blocks; none where the series is too short for it.
    pub standard_error_by_blocks: Option<f64>,
    /// Degrees of freedom of the error.
    pub freedoms: f64,
    /// Statistical inefficiency g, in values of the series.
    pub inefficiency: f64,
    /// Integrated autocorrelation time (g − 1)/2 (time); 0 where values are independent.
    pub correlation_time: f64,
    /// When the transient ends (time): what was before does not count.
    pub equilibrated_at: f64,
    /// Independent samples after that.
    pub independent_samples: f64,
    /// How long a time they span (time).
    pub span: f64,
}

/// What there is to be said of a quantity over a run.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[serde(tag = "says", rename_all = "kebab-case")]
pub enum Outcome {
    /// It has a mean.
    Mean(Estimate),
    /// It does not vary beyond rounding.
    Constant {
        /// Its value.
        mean: f64,
    },
    /// The run is too short for a mean.
    TooShort {
        /// Independent samples that there are.
        independent_samples: f64,
        /// About when there will be enough (time).
        enough_at: f64,
        /// What joins with those of other runs.
        #[serde(skip)]
        estimate: Option<Estimate>,
    },
    /// It is still changing at the end: it has no mean, or has not come to it.
    Changing {
        /// Its first value.
        first: f64,
        /// Its last value.
        last: f64,
    },
    /// It should stay as it is; no mean is asked of it.
    Kept {
        /// Its first value.
        first: f64,
        /// Its last value.
        last: f64,
        /// The largest difference from the first.
        farthest: f64,
    },
}

/// Half the width of the interval of 95 % for a standard error with degrees of freedom.
pub fn bar(error: f64, freedoms: f64) -> f64 {
    student(CONFIDENCE, whole(freedoms)) * error
}

/// The mean of values that are independent, with the half width of its interval of 95 %; none of fewer than two.
pub fn of_independent(values: &[f64]) -> Option<[f64; 2]> {
    if values.len() < 2 {
        return None;
    }
    let (n, mean) = (values.len() as f64, mean(values));
    let squares = values.iter().map(|value| (value - mean).powi(2)).sum::<f64>();
    Some([mean, bar((squares / (n * (n - 1.0))).sqrt(), n - 1.0)])
}

/// The mean of values one after the other in time, with the half width of its interval of 95 %: they may be correlated, and are taken to have
/// left their start behind; none of fewer than two.
pub fn of_correlated(values: &[f64]) -> Option<[f64; 2]> {
    (values.len() > 1).then(|| of_stationary(values, 0.0, 1.0)).map(|found| [found.mean, found.bar])
}

fn whole(freedoms: f64) -> usize {
    freedoms.clamp(1.0, MANY) as usize
}

/// What a series says: of values `spacing` apart, the first at `from` + `spacing` (time).
pub fn estimated(series: &[f64], from: f64, spacing: f64) -> Outcome {
    let largest = series.iter().fold(0.0_f64, |largest, value| largest.max(value.abs()));
    let [low, high] = ends(series);
    let (Some(&first), Some(&last)) = (series.first(), series.last()) else {
        return too_short(series, from, spacing);
    };
    if series.len() > 1 && high - low <= ROUNDING * largest {
        return Outcome::Constant { mean: last };
    }
    if (series.len() as f64) < FEWEST_SAMPLES {
        return too_short(series, from, spacing);
    }
    let Some(start) = equilibrated(series) else { return Outcome::Changing { first, last } };
    let kept = &series[start..];
    let estimate = of_stationary(kept, from + start as f64 * spacing, spacing);
    let limit = (TREND / (estimate.independent_samples - 1.0).max(0.0).sqrt()).min(STRONG);
    if rank_correlation(kept).abs() > limit {
        return Outcome::Changing { first, last };
    }
    if estimate.independent_samples < FEWEST_SAMPLES {
        let Estimate { equilibrated_at, span, independent_samples, .. } = estimate;
        let enough_at = equilibrated_at + MARGIN * span * FEWEST_SAMPLES / independent_samples;
        return Outcome::TooShort { independent_samples, enough_at, estimate: Some(estimate) };
    }
    Outcome::Mean(estimate)
}

/// Too few values to look for a transient.
fn too_short(series: &[f64], from: f64, spacing: f64) -> Outcome {
    let independent_samples = series.len() as f64;
    Outcome::TooShort { independent_samples, enough_at: from + FEWEST_SAMPLES * spacing, estimate: None }
}

/// The smallest and the largest value.
pub(super) fn ends(values: &[f64]) -> [f64; 2] {
    let none = [f64::INFINITY, f64::NEG_INFINITY];
    values.iter().fold(none, |[low, high], &value| [low.min(value), high.max(value)])
}

fn of_stationary(kept: &[f64], equilibrated_at: f64, spacing: f64) -> Estimate {
    let n = kept.len() as f64;
    let mean = mean(kept);
    let squares = kept.iter().map(|value| (value - mean).powi(2)).sum::<f64>() / n;
    let correlation = corrected(kept);
    let independent_samples = n / correlation.inefficiency;
    // Over n/g − 1: the mean of the series takes one independent sample away.
    let standard_error = (squares / (independent_samples - 1.0).max(1.0)).sqrt();
    let standard_error_by_blocks = blocked_error(kept);
    let freedoms = correlation.freedoms(kept.len());
    let larger = standard_error.max(standard_error_by_blocks.unwrap_or(0.0));
    Estimate {
        mean,
        bar: bar(larger, freedoms),
        standard_error,
        standard_error_by_blocks,
        freedoms,
        inefficiency: correlation.inefficiency,
        correlation_time: 0.5 * (correlation.inefficiency - 1.0) * spacing,
        equilibrated_at,
        independent_samples,
        span: n * spacing,
    }
}

/// Spearman's rank correlation with time: 1 or −1 where a series only rises or falls, by whatever law.
fn rank_correlation(series: &[f64]) -> f64 {
    let mut order: Vec<usize> = (0..series.len()).collect();
    order.sort_by(|&a, &b| series[a].total_cmp(&series[b]));
    let mut ranks = vec![0.0; series.len()];
    let mut below = 0;
    // Equal values share the mean of their ranks.
    for equal in order.chunk_by(|&a, &b| series[a] == series[b]) {
        let rank = below as f64 + 0.5 * (equal.len() as f64 - 1.0);
        equal.iter().for_each(|&at| ranks[at] = rank);
        below += equal.len();
    }
    let middle = 0.5 * (series.len() as f64 - 1.0);
    let [mut times, mut both, mut squares] = [0.0; 3];
    for (rank, at) in ranks.iter().zip(0u32..) {
        let (time, rank) = (f64::from(at) - middle, rank - middle);
        times += time * time;
        both += time * rank;
        squares += rank * rank;
    }
    if squares > 0.0 { both / (times * squares).sqrt() } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::averages::noise::Noise;

    /// The bar holds the truth in 92 to 98 of 100 series that begin far off, whatever their correlation.
    #[test]
    fn bars_hold_the_truth_as_often_as_they_say() {
        for (length, memory, height, duration) in [
            (1000, 0.0, 10.0, 100.0),
            (1000, 0.5, 10.0, 100.0),
            (1000, 0.9, 10.0, 30.0),
            (2000, 0.97, 10.0, 35.0),
        ] {
            let found = (0..250).map(|seed| {
                estimated(&Noise::new(seed).relaxing(length, memory, height, duration), 0.0, 1.0)
            });
            let means: Vec<Estimate> = found
                .filter_map(
                    |outcome| if let Outcome::Mean(estimate) = outcome { Some(estimate) } else { None },
                )
                .collect();
            let held = means.iter().filter(|estimate| estimate.mean.abs() <= estimate.bar).count();
            let share = held as f64 / means.len() as f64;
            println!("{memory}: {share:.3} of {}", means.len());
            assert!(
                means.len() > 210 && (0.92..=0.98).contains(&share),
                "{memory}: {share} of {}",
                means.len()
            );
        }
    }

    /// Where there are hardly more than the fewest samples, bars of 95 % hold the truth in 88 to 94 of 100 series: no less.
    #[test]
    fn bars_of_short_series_are_a_little_short() {
        for (memory, least) in [(0.8, 0.925), (0.9, 0.875)] {
            let found = (0..3000).map(|seed| estimated(&Noise::new(seed).series(200, memory), 0.0, 1.0));
            let held = found.filter_map(|outcome| match outcome {
                Outcome::Mean(estimate) => Some(estimate.mean.abs() <= estimate.bar),
                _ => None,
            });
            let held: Vec<bool> = held.collect();
            let share = held.iter().filter(|held| **held).count() as f64 / held.len() as f64;
            assert!(
                held.len() > 1500 && (least..0.98).contains(&share),
                "{memory}: {share} of {}",
                held.len()
            );
        }
    }

    /// By hand: the mean 2, the standard error 1/√3, Student's t of two degrees of freedom.
    #[test]
    fn a_mean_of_independent_values_has_students_bar() {
        let [mean, bar] = of_independent(&[1.0, 2.0, 3.0]).unwrap();
        assert!(mean == 2.0 && (bar - 4.3027 / 3f64.sqrt()).abs() < 1e-4, "{bar}");
        assert_eq!(of_independent(&[1.0]), None);
    }

    /// By hand: ranks 1, 0, 2.5 and 2.5 of the times 0 to 3.
    #[test]
    fn ranks_are_correlated_with_time() {
        assert!((rank_correlation(&[5.0, -1.0, 9.0, 9.0]) - 3.5 / (5.0_f64 * 4.5).sqrt()).abs() < 1e-15);
        let cooling: Vec<f64> = (0..100).map(|at| (1.0 + f64::from(at)).powi(-2)).collect();
        assert!((rank_correlation(&cooling) + 1.0).abs() < 1e-15);
        assert_eq!(rank_correlation(&[2.0; 5]), 0.0);
        assert!(matches!(estimated(&cooling, 0.0, 1.0), Outcome::Changing { .. }));
    }

    #[test]
    fn what_has_no_mean_is_told_apart() {
        let line: Vec<f64> = (0..500).map(f64::from).collect();
        assert_eq!(estimated(&line, 0.0, 1.0), Outcome::Changing { first: 0.0, last: 499.0 });
        assert_eq!(estimated(&[2.5; 40], 0.0, 1.0), Outcome::Constant { mean: 2.5 });
        let rounded: Vec<f64> = (0..40).map(|at| 2.5 + 1e-14 * f64::from(at)).collect();
        assert!(matches!(estimated(&rounded, 0.0, 1.0), Outcome::Constant { .. }));
        let few = Outcome::TooShort { independent_samples: 3.0, enough_at: 7.0, estimate: None };
        assert_eq!(estimated(&[1.0, 2.0, 1.0], 2.0, 0.5), few);
        // Slow beside the run: how much longer it takes is of the order of what it would take.
        let slow = (0..20).map(|seed| estimated(&Noise::new(seed).series(400, 0.97), 0.0, 1.0));
        let short: Vec<f64> = slow
            .filter_map(|outcome| match outcome {
                Outcome::TooShort { independent_samples, enough_at, .. } => {
                    assert!(independent_samples < FEWEST_SAMPLES);
                    Some(enough_at)
                }
                _ => None,
            })
            .collect();
        assert!(short.len() > 5 && short.iter().all(|at| (400.0..4000.0).contains(at)), "{short:?}");
    }
}
