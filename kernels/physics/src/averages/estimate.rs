//! Estimate of the mean of a series with its error, or the reason why there is none.

use super::equilibration::{batches, transient_length};
use super::student::student;
use super::waves::{WaveError, is_smooth_drift, mean};
use crate::number::with_error_bar;
use serde::Serialize;
use std::fmt;

/// Smallest number of independent samples for a mean: with fewer, neither the cut nor the error is reliable.
pub(crate) const FEWEST_SAMPLES: f64 = 20.0;
/// Estimated number of independent samples with which a run is likely to have enough: the estimate itself is rough.
pub const LIKELY_ENOUGH: f64 = 40.0;
/// Probability that a confidence interval contains the true value.
pub(crate) const CONFIDENCE: f64 = 0.95;
/// Level at which a series counts as drifting: one of a thousand stationary ones has such a drift.
const DRIFT: f64 = 0.999;
/// Level after a transient has been cut, since a part of it may remain.
const DRIFT_AFTER_TRANSIENT: f64 = 0.99;
/// Independent samples of a series for each batch that carries its variance: in a Gaussian series these are a third of all batches. The series has
/// fewer samples than [`FEWEST_SAMPLES`] if five batches carry all of it, as with rare events.
const PER_CARRIER: f64 = 4.0;
/// Relative variation below which a series counts as constant: it is rounding error.
const ROUNDING: f64 = 1e-9;
/// Fewest values of a series at rest.
const LEAST_AT_REST: usize = 100;
/// Number of degrees of freedom beyond which Student's t hardly changes.
const MANY: f64 = 1000.0;

/// A mean with the half-width of its 95 % confidence interval.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct MeanWithBar {
    /// The mean.
    #[serde(rename = "mean")]
    pub value: f64,
    /// Half-width of the interval (the error bar).
    pub bar: f64,
}

impl fmt::Display for MeanWithBar {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&with_error_bar(self.value, self.bar))
    }
}

impl MeanWithBar {
    /// Mean of at least one independent value; the error bar of a single one is infinite.
    pub fn of(values: &[f64]) -> MeanWithBar {
        let n = values.len() as f64;
        let value = values.iter().sum::<f64>() / n;
        let squares = values.iter().map(|it| (it - value).powi(2)).sum::<f64>();
        let error = || (squares / (n - 1.0) / n).sqrt();
        let bar =
            if values.len() > 1 { student(CONFIDENCE, values.len() - 1) * error() } else { f64::INFINITY };
        MeanWithBar { value, bar }
    }

    /// Mean of a time series of at least one value, which may be correlated.
    pub fn of_time_series(values: &[f64]) -> MeanWithBar {
        mean_of_correlated(values).unwrap_or_else(|| MeanWithBar::of(values))
    }

    /// Relative deviation from a known value.
    #[must_use]
    pub fn relative_to(self, known: f64) -> MeanWithBar {
        MeanWithBar { value: self.value / known - 1.0, bar: (self.bar / known).abs() }
    }

    /// Converts to percent.
    #[must_use]
    pub fn percent(self) -> MeanWithBar {
        MeanWithBar { value: 100.0 * self.value, bar: 100.0 * self.bar }
    }
}

impl From<MeanWithBar> for [f64; 2] {
    fn from(MeanWithBar { value, bar }: MeanWithBar) -> Self {
        [value, bar]
    }
}

/// Mean over time with its error and the numbers that it follows from.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Estimate {
    /// Value of the mean.
    pub mean: f64,
    /// Half-width of the 95 % confidence interval of the mean: Student's t times the standard error.
    pub bar: f64,
    /// Standard error of the mean of the correlated values.
    pub standard_error: f64,
    /// Degrees of freedom of the error.
    pub freedoms: f64,
    /// Statistical inefficiency g, in values of the series; below 1 if successive values compensate each other.
    pub(crate) inefficiency: f64,
    /// Integrated autocorrelation time (g − 1)/2 (time); 0 if values are independent or compensate each other.
    pub correlation_time: f64,
    /// End of the transient (time); earlier values are not used.
    pub equilibrated_at: f64,
    /// Number of independent samples after the transient.
    pub independent_samples: f64,
    /// Time that the samples span (time).
    pub span: f64,
}

/// Result of averaging a quantity over a run.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[serde(tag = "says", rename_all = "kebab-case")]
pub enum AverageOutcome {
    /// The quantity has a mean.
    Mean(Estimate),
    /// The quantity is NaN in some rows.
    Undefined,
    /// The quantity does not vary beyond rounding.
    Constant {
        /// Constant value.
        mean: f64,
    },
    /// The run is too short for a mean.
    TooShort {
        /// Number of independent samples found.
        independent_samples: f64,
        /// Estimated time at which there will be enough (time).
        enough_at: f64,
        /// Preliminary estimate, to be joined with those of other runs.
        #[serde(skip)]
        estimate: Option<Estimate>,
    },
    /// The quantity is still changing at the end: it has no mean, or is not yet stationary.
    Changing {
        /// First value.
        first: f64,
        /// Last value.
        last: f64,
    },
    /// The quantity should be conserved; no mean is computed.
    Kept {
        /// First value.
        first: f64,
        /// Last value.
        last: f64,
        /// Largest difference from the first value.
        farthest: f64,
    },
}

/// Half-width of the 95 % confidence interval for a standard error with degrees of freedom.
pub(super) fn bar(error: f64, freedoms: f64) -> f64 {
    student(CONFIDENCE, freedoms.clamp(1.0, MANY) as usize) * error
}

/// Mean of independent values; none for fewer than two.
pub fn mean_of_independent(values: &[f64]) -> Option<MeanWithBar> {
    if values.len() < 2 {
        return None;
    }
    let (n, mean) = (values.len() as f64, mean(values));
    let squares = values.iter().map(|value| (value - mean).powi(2)).sum::<f64>();
    Some(MeanWithBar { value: mean, bar: bar((squares / (n * (n - 1.0))).sqrt(), n - 1.0) })
}

/// Mean of a time series; none for fewer than two values. The values may be correlated, and must be stationary.
pub fn mean_of_correlated(values: &[f64]) -> Option<MeanWithBar> {
    let error = (values.len() > 1).then(|| WaveError::of_any(values))?;
    Some(MeanWithBar { value: error.mean, bar: bar(error.standard_error, error.waves as f64) })
}

/// Half-width of the 95 % confidence interval for the mean of a stationary series, and its degrees of freedom; none for fewer than two values.
/// There are more degrees of freedom than in an [`Estimate`], so that errors of other runs can be predicted.
pub fn predictive_half_width(values: &[f64]) -> Option<[f64; 2]> {
    let error = (values.len() > 1).then(|| WaveError::of_more(values))?;
    let freedoms = error.waves as f64;
    Some([bar(error.standard_error, freedoms), freedoms])
}

/// Estimates the mean of a series of values `spacing` apart, the first at `from` + `spacing` (time).
pub fn estimate_mean(series: &[f64], from: f64, spacing: f64) -> AverageOutcome {
    let few = |independent_samples: f64, enough_at: f64, estimate: Option<Estimate>| {
        AverageOutcome::TooShort { independent_samples, enough_at, estimate }
    };
    let (Some(&first), Some(&last)) = (series.first(), series.last()) else {
        return few(0.0, from + FEWEST_SAMPLES * spacing, None);
    };
    if !series.iter().all(|value| value.is_finite()) {
        return AverageOutcome::Undefined;
    }
    let largest = series.iter().fold(0.0_f64, |largest, value| largest.max(value.abs()));
    let [low, high] = ends(series);
    if series.len() > 1 && high - low <= ROUNDING * largest {
        return AverageOutcome::Constant { mean: last };
    }
    let n = series.len() as f64;
    if n < FEWEST_SAMPLES {
        return few(n, from + FEWEST_SAMPLES * spacing, None);
    }
    if let Some(settled) = settled(series, from, spacing) {
        return AverageOutcome::Mean(settled);
    }
    let cut = transient_length(series);
    let start = cut.unwrap_or(0);
    let kept = &series[start..];
    let error = WaveError::of(kept);
    let estimate = Estimate::of(&error, kept, from + start as f64 * spacing, spacing);
    if cut.is_none() || estimate.independent_samples < FEWEST_SAMPLES {
        if is_smooth_drift(&series[series.len() / 2..], DRIFT) {
            return AverageOutcome::Changing { first, last };
        }
        let samples = estimate.independent_samples.min(FEWEST_SAMPLES - 1.0);
        let seeming = error.seeming.min(PER_CARRIER * variance_carriers(kept)).max(1.0);
        let longer = (LIKELY_ENOUGH / seeming).max(if cut.is_none() { 2.0 } else { 1.0 });
        let enough_at = estimate.equilibrated_at + longer * estimate.span;
        return few(samples, enough_at, cut.map(|_| estimate));
    }
    if error.is_drifting(if start > 0 { DRIFT_AFTER_TRANSIENT } else { DRIFT }) {
        return AverageOutcome::Changing { first, last };
    }
    AverageOutcome::Mean(estimate)
}

/// Estimate of a series that came to rest: its last half, of at least [`LEAST_AT_REST`] values, varies by rounding only. The error is that
/// variation. Zeros and whole numbers are no sign of rest: counts may change again.
fn settled(series: &[f64], from: f64, spacing: f64) -> Option<Estimate> {
    let half = &series[series.len() / 2..];
    let ([low, high], last) = (ends(half), *half.last()?);
    let variation = ROUNDING * last.abs();
    let is_count = half.iter().all(|value| value.fract() == 0.0);
    if half.len() < LEAST_AT_REST || is_count || high - low > variation {
        return None;
    }
    let moving = series.iter().rposition(|value| (value - last).abs() > variation).map_or(0, |at| at + 1);
    let kept = &series[moving..];
    let ([low, high], n) = (ends(kept), kept.len() as f64);
    let bar = (high - low).max(f64::EPSILON * last.abs());
    Some(Estimate {
        mean: mean(kept),
        bar,
        standard_error: 0.5 * bar,
        freedoms: n - 1.0,
        inefficiency: 1.0,
        correlation_time: 0.0,
        equilibrated_at: from + moving as f64 * spacing,
        independent_samples: n,
        span: n * spacing,
    })
}

impl Estimate {
    fn of(error: &WaveError, kept: &[f64], equilibrated_at: f64, spacing: f64) -> Estimate {
        let n = kept.len() as f64;
        let fewest = error.resolved.min(PER_CARRIER * variance_carriers(kept));
        let independent_samples =
            if fewest < FEWEST_SAMPLES { error.samples.min(fewest) } else { error.samples };
        let inefficiency = n / error.samples;
        Estimate {
            mean: error.mean,
            bar: bar(error.standard_error, error.waves as f64),
            standard_error: error.standard_error,
            freedoms: error.waves as f64,
            inefficiency,
            correlation_time: 0.5 * (inefficiency - 1.0).max(0.0) * spacing,
            equilibrated_at,
            independent_samples,
            span: n * spacing,
        }
    }
}

/// Number of batches that carry the variance of a series, (Σx²)²/Σx⁴ about the mean: small if the series varies by rare events only.
fn variance_carriers(series: &[f64]) -> f64 {
    let (_, means) = batches(series);
    let middle = mean(&means);
    let squares = means.iter().map(|value| (value - middle).powi(2));
    let [sum, fourths] = squares.fold([0.0; 2], |[sum, fourths], it| [sum + it, fourths + it * it]);
    if fourths > 0.0 { sum * sum / fourths } else { 0.0 }
}

/// Smallest and largest value.
fn ends(values: &[f64]) -> [f64; 2] {
    let none = [f64::INFINITY, f64::NEG_INFINITY];
    values.iter().fold(none, |[low, high], &value| [low.min(value), high.max(value)])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::averages::noise::Noise;

    /// Series for a seed.
    type Series = fn(u64) -> Vec<f64>;

    /// Name, series, true mean, and the smallest fraction of them with a mean.
    const SERIES: [(&str, Series, f64, f64); 11] = [
        ("independent", |seed| Noise::new(seed).series(300, 0.0), 0.0, 0.97),
        ("100 samples", |seed| Noise::new(seed).series(1900, 0.9), 0.0, 0.95),
        ("40 samples", |seed| Noise::new(seed).series(760, 0.9), 0.0, 0.6),
        ("alternating", |seed| difference(&Noise::new(seed).series(401, 0.0), 0.5), 0.0, 0.97),
        ("noise on a slow part", |seed| sum(seed, 2000, 0.3), 0.0, 0.7),
        ("slow transient", |seed| Noise::new(seed).relaxing(1000, 0.5, 10.0, 60.0), 0.0, 0.9),
        ("transient", |seed| Noise::new(seed).relaxing(1000, 0.9, 10.0, 30.0), 0.0, 0.6),
        ("small transient", |seed| Noise::new(seed).relaxing(1000, 0.5, 1.0, 50.0), 0.0, 0.85),
        ("transient of a row", |seed| Noise::new(seed).relaxing(2000, 0.3, 5e4, 0.2), 0.0, 0.95),
        ("rise of two rows", |seed| Noise::new(seed).relaxing(300, 0.3, -4.0, 2.0), 0.0, 0.9),
        ("skewed", |seed| energies(seed, 1000), 0.5, 0.85),
    ];

    fn difference(series: &[f64], part: f64) -> Vec<f64> {
        series.windows(2).map(|pair| pair[1] - part * pair[0]).collect()
    }

    /// Independent values plus a component with a correlation time of 25 of them.
    fn sum(seed: u64, length: usize, slow: f64) -> Vec<f64> {
        let slowly = Noise::new(seed + 1_000_000).series(length, 0.96);
        let fast = Noise::new(seed).series(length, 0.0);
        slowly.iter().zip(fast).map(|(a, b)| slow.sqrt() * a + (1.0 - slow).sqrt() * b).collect()
    }

    /// Squares of correlated values: energies of one degree of freedom.
    fn energies(seed: u64, length: usize) -> Vec<f64> {
        Noise::new(seed).series(length, 0.6).iter().map(|x| 0.5 * x * x).collect()
    }

    fn share(count: usize, of: usize) -> f64 {
        count as f64 / of as f64
    }

    /// Error bars contain the true value in 92 to 98 of 100 series, for any correlation and any beginning.
    #[test]
    fn confidence_intervals_have_their_coverage() {
        const SEEDS: u64 = 400;
        for (name, series, truth, least) in SERIES {
            let means: Vec<bool> = (0..SEEDS)
                .filter_map(|seed| match estimate_mean(&series(seed), 0.0, 1.0) {
                    AverageOutcome::Mean(estimate) => Some((estimate.mean - truth).abs() <= estimate.bar),
                    _ => None,
                })
                .collect();
            let held = share(means.iter().filter(|held| **held).count(), means.len());
            println!("{name}: {held:.3} of {}", means.len());
            assert!((0.92..=0.98).contains(&held), "{name}: {held}");
            assert!(share(means.len(), SEEDS as usize) >= least, "{name}: {} have a mean", means.len());
        }
    }

    /// Series of 1 to 10 independent samples rarely have a mean, and rarely count as changing.
    #[test]
    fn short_series_have_no_mean() {
        for (samples, most) in [(1.0, 0.002), (2.5, 0.002), (5.0, 0.005), (10.0, 0.05)] {
            let (length, memory) = (400, (400.0 / samples - 1.0) / (400.0 / samples + 1.0));
            let outcomes =
                (0..1000).map(|seed| estimate_mean(&Noise::new(seed).series(length, memory), 0.0, 1.0));
            let [mut means, mut changing] = [0; 2];
            for outcome in outcomes {
                match outcome {
                    AverageOutcome::Mean(_) => means += 1,
                    AverageOutcome::Changing { .. } => changing += 1,
                    _ => {}
                }
            }
            println!("{samples}: {means} means, {changing} changing of 1000");
            assert!(share(means, 1000) <= most && changing <= 8, "{samples}: {means}, {changing}");
        }
    }

    /// A few events in 400 values, with Poisson statistics: no mean is based on fewer than five.
    #[test]
    fn rare_events_have_no_mean() {
        let series = |count: u64| -> Vec<f64> {
            (0..400_u64).map(|at| f64::from(u8::from(at % (400 / count) == 57 % (400 / count)))).collect()
        };
        for count in [1, 2, 4] {
            let AverageOutcome::TooShort { independent_samples, enough_at, .. } =
                estimate_mean(&series(count), 0.0, 1.0)
            else {
                panic!("{count} events have a mean");
            };
            assert!(
                independent_samples < FEWEST_SAMPLES && enough_at > 500.0,
                "{independent_samples} {enough_at}"
            );
        }
    }

    /// Error bars of stationary values contain the true value at the stated rate, down to a few independent samples; those of a few values do so
    /// more often.
    #[test]
    fn stationary_intervals_have_their_coverage() {
        for (length, memory, most) in [
            (10, 0.0, 1.0),
            (20, 0.0, 0.99),
            (20, 0.5, 0.98),
            (20, 0.8, 0.98),
            (40, 0.9, 0.98),
            (100, 0.0, 0.98),
            (100, 0.95, 0.98),
            (400, 0.9, 0.98),
        ] {
            let found =
                (0..1000).map(|seed| mean_of_correlated(&Noise::new(seed).series(length, memory)).unwrap());
            let held = share(found.filter(|it| it.value.abs() <= it.bar).count(), 1000);
            println!("{length} values, {memory}: {held}");
            assert!((0.92..=most).contains(&held), "{length} values, {memory}: {held}");
        }
    }

    /// A slow component beneath fast noise: a run of five of its samples rarely has a mean, for any number of samples of the noise.
    #[test]
    fn noise_does_not_hide_slow_changes() {
        for (slow_samples, most) in [(1.0, 0.1), (5.0, 0.06), (10.0, 0.12)] {
            let memory = (1000.0 / slow_samples - 1.0) / (1000.0 / slow_samples + 1.0);
            let series = |seed| {
                let slow = Noise::new(seed + 1_000_000).series(1000, memory).into_iter();
                slow.zip(Noise::new(seed).series(1000, 0.0))
                    .map(|(a, b)| 0.3_f64.sqrt() * a + 0.7_f64.sqrt() * b)
            };
            let outcomes = (0..400).map(|seed| estimate_mean(&series(seed).collect::<Vec<_>>(), 0.0, 1.0));
            let means = outcomes.filter(|outcome| matches!(outcome, AverageOutcome::Mean(_))).count();
            println!("{slow_samples} slow samples: {means} of 400 have a mean");
            assert!(share(means, 400) <= most, "{slow_samples}: {means}");
        }
    }

    /// At most one in two hundred stationary series has a transient cut.
    #[test]
    fn stationary_series_are_rarely_cut() {
        for memory in [0.0, 0.5, 0.9] {
            let cuts = (0..1000).filter(|&seed| {
                matches!(estimate_mean(&Noise::new(seed).series(1000, memory), 0.0, 1.0),
                    AverageOutcome::Mean(estimate) if estimate.equilibrated_at > 0.0)
            });
            let cuts = cuts.count();
            println!("memory {memory}: {cuts} of 1000 are cut");
            assert!(cuts <= 5, "{memory}: {cuts}");
        }
    }

    /// Hand calculation: the mean 2, the standard error 1/√3, Student's t with two degrees of freedom.
    #[test]
    fn independent_values_have_students_half_width() {
        let MeanWithBar { value: mean, bar } = mean_of_independent(&[1.0, 2.0, 3.0]).unwrap();
        assert!(mean == 2.0 && (bar - 4.3027 / 3f64.sqrt()).abs() < 1e-4, "{bar}");
        assert_eq!(mean_of_independent(&[1.0]), None);
    }

    #[test]
    fn outcomes_without_mean_are_distinguished() {
        let line: Vec<f64> = (0..500).map(f64::from).collect();
        assert_eq!(estimate_mean(&line, 0.0, 1.0), AverageOutcome::Changing { first: 0.0, last: 499.0 });
        let cooling: Vec<f64> = (0..100).map(|at| (1.0 + f64::from(at)).powi(-2)).collect();
        assert!(matches!(estimate_mean(&cooling, 0.0, 1.0), AverageOutcome::Changing { .. }));
        assert_eq!(estimate_mean(&[2.5; 40], 0.0, 1.0), AverageOutcome::Constant { mean: 2.5 });
        let rounded: Vec<f64> = (0..40).map(|at| 2.5 + 1e-14 * f64::from(at)).collect();
        assert!(matches!(estimate_mean(&rounded, 0.0, 1.0), AverageOutcome::Constant { .. }));
        // A pack that settles: at rest from row 208 on, as exp(-0.1 t) < 10⁻⁹.
        let settling: Vec<f64> = (0..1000).map(|at| 5.2 * (1.0 + (-0.1 * f64::from(at)).exp())).collect();
        let AverageOutcome::Mean(rest) = estimate_mean(&settling, 0.0, 1.0) else { panic!() };
        assert!((rest.mean - 5.2).abs() < rest.bar && rest.bar < 5.3e-9, "{rest:?}");
        assert!((rest.equilibrated_at - 208.0).abs() < 2.0, "{rest:?}");
        // A slow drift of a large number is no rest.
        let drifting: Vec<f64> = (0..1000).map(|at| 1e6 + 0.001 * f64::from(at) + 0.5).collect();
        assert!(matches!(estimate_mean(&drifting, 0.0, 1.0), AverageOutcome::Changing { .. }));
        // Counts that happen to stay are not at rest.
        let counts: Vec<f64> = (0..1000).map(|at| f64::from(i32::from(at > 300))).collect();
        assert!(!matches!(estimate_mean(&counts, 0.0, 1.0), AverageOutcome::Mean(it) if it.bar < 1e-3));
        let mut undefined = vec![2.5; 40];
        undefined[7] = f64::NAN;
        assert_eq!(estimate_mean(&undefined, 0.0, 1.0), AverageOutcome::Undefined);
        let few = AverageOutcome::TooShort { independent_samples: 3.0, enough_at: 12.0, estimate: None };
        assert_eq!(estimate_mean(&[1.0, 2.0, 1.0], 2.0, 0.5), few);
        // For a correlation time comparable to the run, the predicted length has the right order of magnitude.
        let slow = (0..20).map(|seed| estimate_mean(&Noise::new(seed).series(400, 0.97), 0.0, 1.0));
        let short: Vec<f64> = slow
            .filter_map(|outcome| match outcome {
                AverageOutcome::TooShort { enough_at, .. } => Some(enough_at),
                _ => None,
            })
            .collect();
        assert!(short.len() > 15 && short.iter().all(|at| (600.0..4000.0).contains(at)), "{short:?}");
    }
}
