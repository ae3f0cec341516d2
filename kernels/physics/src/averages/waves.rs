//! Standard error of the mean of a correlated series, from its slowest waves.

use super::student::student;
use std::f64::consts::PI;

/// Number of waves for the shortest series that has a mean.
const FEWEST: usize = 6;
/// Number of waves if every series must have a mean: more would miss the correlations of a few samples.
const FEWEST_OF_ANY: usize = 2;
/// Number of waves for a long series. More would make error bars 5 % shorter and miss correlations over a hundredth of the series.
pub const MOST: usize = 16;
/// Factor on the number of waves for an error that predicts others.
const MORE: usize = 4;
/// Number of slowest waves in which independent samples are counted: faster noise does not hide a slow change.
const BAND: usize = 64;
/// Waves for each independent sample in the band: all of them are then slower than the correlation time, also beneath faster noise.
const PER_SAMPLE: f64 = 0.25;
/// Factor on the number of waves for a lower limit on the error, which is less noisy and rarely too small.
const WIDER: usize = 2;
/// Number of independent samples in the band at which the squared error is doubled, since a small number of samples is often overestimated. With
/// it, 1 % of series with ten samples appear to have twenty.
const DOUBTFUL: f64 = 20.0;

/// Mean of a stationary series and its error.
///
/// The series is projected on cosines with 1/2, 2/2, 3/2, … periods in its length. If all of them are slower than the series' correlations, their
/// squares are independent samples of n times the variance of the mean, so that Student's t has as many degrees of freedom as there are waves
/// (Müller, J. Econometrics 141, 1331 (2007); Lazarus, Lewis, Stock and Watson, J. Bus. Econ. Stat. 36, 541 (2018)). Waves also account for
/// anticorrelation: the mean of alternating values is better than that of independent ones.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct WaveError {
    pub(super) mean: f64,
    /// Standard error of the mean.
    pub(super) standard_error: f64,
    /// Number of waves: degrees of freedom of the error.
    pub(super) waves: usize,
    /// Number of independent values with the same variance whose mean has the same error.
    pub(super) samples: f64,
    /// Number of independent values from the slowest waves alone: small if a slow change is hidden beneath fast noise.
    pub(super) resolved: f64,
    /// Number of independent values from the slowest waves, without the allowance for a small number.
    pub(super) seeming: f64,
    /// Square of the slowest wave over the mean square of the others.
    slowest: f64,
}

impl WaveError {
    /// Estimates the error of at least two values.
    pub(super) fn of(series: &[f64]) -> WaveError {
        WaveError::by(FEWEST, MOST, series)
    }

    /// Estimates the error from up to four times as many waves. It scatters less and misses long correlations sooner. Needs at least two values.
    pub(super) fn of_more(series: &[f64]) -> WaveError {
        WaveError::by(FEWEST, MORE * MOST, series)
    }

    /// Estimates the error of at least two values with any number of samples, without the allowance for a small number.
    pub(super) fn of_any(series: &[f64]) -> WaveError {
        let error = WaveError::by(FEWEST_OF_ANY, MOST, series);
        WaveError { standard_error: error.standard_error * (error.resolved / error.seeming).sqrt(), ..error }
    }

    fn by(fewest: usize, most: usize, series: &[f64]) -> WaveError {
        let n = series.len() as f64;
        let mean = mean(series);
        let variance = series.iter().map(|value| (value - mean).powi(2)).sum::<f64>();
        let band = squares(series, (BAND * most / MOST).min(series.len() - 1));
        let squares = &band[..(WIDER * most).min(band.len())];
        let over = |waves: usize| {
            let waves = &squares[..waves.min(squares.len())];
            waves.iter().sum::<f64>() / waves.len() as f64
        };
        let in_band = band.iter().sum::<f64>();
        let resolved = |square: f64| if square > 0.0 { in_band / square } else { n };
        let mut waves = fewest.min(squares.len());
        while waves < most.min(squares.len()) && (waves + 1) as f64 <= PER_SAMPLE * resolved(over(waves + 1))
        {
            waves += 1;
        }
        let square = over(waves).max(over(WIDER * waves));
        let seeming = resolved(square);
        let square = square * (1.0 + (DOUBTFUL / seeming).powi(4));
        let others = (waves as f64 * over(waves) - squares[0]) / (waves as f64 - 1.0);
        WaveError {
            mean,
            standard_error: (square / n).sqrt(),
            waves,
            samples: if square > 0.0 { variance / square } else { n },
            resolved: resolved(square),
            seeming,
            slowest: squares[0] / others,
        }
    }

    /// Tests for drift: the slowest wave is larger than the others beyond statistical error, at a given probability.
    pub(super) fn is_drifting(&self, probability: f64) -> bool {
        self.waves > 1 && self.slowest > student(probability, self.waves - 1).powi(2)
    }
}

/// Number of waves in the test for a smooth drift.
const SMOOTH: usize = 24;

/// Tests if a series drifts more smoothly than a random process, for any correlation time. The slowest wave is compared with those of a random
/// walk, whose squares fall as 1/j². No stationary random series falls off more steeply.
pub(super) fn is_smooth_drift(series: &[f64], probability: f64) -> bool {
    if series.len() < 4 {
        return false;
    }
    let squares = squares(series, SMOOTH.min(series.len() - 1));
    let others = squares.iter().zip(1_u32..).skip(1).map(|(square, j)| square * f64::from(j * j));
    let freedoms = squares.len() - 1;
    let others = others.sum::<f64>() / freedoms as f64;
    squares[0] > student(probability, freedoms).powi(2) * others
}

/// Squares of the projections on cosines of 1/2, 2/2, 3/2, … periods, each with the expectation of n times the variance of the mean.
fn squares(series: &[f64], count: usize) -> Vec<f64> {
    let (n, mean) = (series.len() as f64, mean(series));
    let mut sums = vec![0.0; count];
    for (value, at) in series.iter().zip(0_u32..) {
        let first = libm::cos(PI * (f64::from(at) + 0.5) / n);
        let (mut before, mut cosine) = (1.0, first);
        for sum in &mut sums {
            *sum += (value - mean) * cosine;
            (before, cosine) = (cosine, 2.0 * first * cosine - before);
        }
    }
    sums.into_iter().map(|sum| 2.0 / n * sum * sum).collect()
}

/// Mean of some values; NaN for an empty slice.
pub(super) fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len() as f64
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::averages::noise::Noise;

    /// Hand calculation: projections of 1, 2, 4 on cos 30°, 90°, 150° and cos 60°, 180°, 300°.
    #[test]
    fn waves_are_projections_on_cosines() {
        let root = 3f64.sqrt() / 2.0;
        let expected = [2.0 / 3.0 * (root - 4.0 * root).powi(2), 2.0 / 3.0 * (0.5 - 2.0 + 2.0_f64).powi(2)];
        for (found, expected) in squares(&[1.0, 2.0, 4.0], 2).iter().zip(expected) {
            assert!((found - expected).abs() < 1e-12, "{found} {expected}");
        }
        // All waves together contain the whole variance.
        let series = Noise::new(5).series(40, 0.7);
        let middle = mean(&series);
        let variance: f64 = series.iter().map(|value| (value - middle).powi(2)).sum();
        assert!((squares(&series, 39).iter().sum::<f64>() - variance).abs() < 1e-9);
    }

    /// The series x' = φ x + noise has (1 − φ)/(1 + φ) independent samples for each value; x − 0.5 x₋₁ of noise x has 1.25/0.5² of them. The
    /// estimated error is slightly larger on average, and the number of samples smaller.
    #[test]
    fn samples_of_known_series_are_found() {
        type Series = fn(u64) -> Vec<f64>;
        let alternating = |seed| -> Vec<f64> {
            Noise::new(seed).series(2001, 0.0).windows(2).map(|pair| pair[1] - 0.5 * pair[0]).collect()
        };
        let known: [(Series, f64); 5] = [
            (|seed| Noise::new(seed).series(2000, 0.0), 1.0),
            (|seed| Noise::new(seed).series(2000, 0.5), 3.0),
            (|seed| Noise::new(seed).series(2000, 0.8), 9.0),
            (|seed| Noise::new(seed).series(2000, 0.9), 19.0),
            (alternating, 0.2),
        ];
        for (series, expected) in known {
            let found =
                (0..200).map(|seed| 2000.0 / WaveError::of(&series(seed)).samples).sum::<f64>() / 200.0;
            assert!((1.0..1.25).contains(&(found / expected)), "{found} {expected}");
        }
    }

    /// One of a thousand stationary series counts as drifting; a line does, and so does a decay that exceeds the noise.
    #[test]
    fn drift_is_distinguished_from_noise() {
        let stationary = (0..2000).map(|seed| Noise::new(seed).series(400, 0.8));
        let called = stationary.filter(|series| WaveError::of(series).is_drifting(0.999)).count();
        assert!(called <= 8, "{called} of 2000");
        let walks = (0..2000).map(|seed| Noise::new(seed).series(400, 0.9999));
        let called = walks.filter(|series| is_smooth_drift(series, 0.999)).count();
        assert!(called <= 8, "{called} of 2000 random walks");
        let line: Vec<f64> = (0..100).map(f64::from).collect();
        assert!(WaveError::of(&line).is_drifting(0.999) && is_smooth_drift(&line, 0.999));
        let decay = |seed| {
            let noise = Noise::new(seed).series(400, 0.0).into_iter().zip(0_u32..);
            noise.map(|(x, at)| 0.01 * x + libm::exp(-f64::from(at) / 200.0)).collect::<Vec<f64>>()
        };
        assert!((0..100).all(|seed| is_smooth_drift(&decay(seed), 0.999)));
    }
}
