//! The error of a mean by blocks: the check beside autocorrelation.

use super::autocorrelation::mean;

/// Blocks below which the spread of their means says nothing.
const FEWEST: usize = 4;

/// Standard error of the mean of a correlated series by the means of blocks (Flyvbjerg and Petersen, J. Chem. Phys. 91, 461
/// (1989)): values are averaged in pairs, again and again, up to the first block length B with B³ > 2 n (s_B/s_1)⁴, where
/// s are the standard errors of the two lengths and the bias of the error is as large as its noise (Lee et al., Phys. Rev. E
/// 83, 066706 (2011)). None where that takes fewer than four blocks.
pub fn blocked_error(series: &[f64]) -> Option<f64> {
    let n = series.len() as f64;
    let mut means = series.to_vec();
    let mut length = 1.0_f64;
    let single = independent_error(&means)?;
    while means.len() >= FEWEST {
        let error = independent_error(&means)?;
        if single == 0.0 || length.powi(3) > 2.0 * n * (error / single).powi(4) {
            return Some(error);
        }
        means = means.chunks_exact(2).map(|pair| 0.5 * (pair[0] + pair[1])).collect();
        length *= 2.0;
    }
    None
}

/// Standard error of the mean of independent values; none of fewer than two.
fn independent_error(values: &[f64]) -> Option<f64> {
    let n = values.len() as f64;
    let mean = mean(values);
    let squares: f64 = values.iter().map(|value| (value - mean).powi(2)).sum();
    (values.len() > 1).then(|| (squares / (n - 1.0) / n).sqrt())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::averages::noise::Noise;

    /// Against the spread of the means of 400 series.
    #[test]
    fn the_error_is_the_spread_of_means_over_many_series() {
        for (memory, within) in [(0.0, 0.06), (0.5, 0.1), (0.9, 0.15)] {
            let series = || (0..400).map(|seed| Noise::new(seed).series(2000, memory));
            let spread = (series().map(|it| mean(&it).powi(2)).sum::<f64>() / 400.0).sqrt();
            let found = series().filter_map(|it| blocked_error(&it)).sum::<f64>() / 400.0;
            assert!((found / spread - 1.0).abs() < within, "{memory}: {found} {spread}");
        }
    }

    #[test]
    fn a_series_that_is_one_long_correlation_has_no_error_by_blocks() {
        let line: Vec<f64> = (0..64).map(f64::from).collect();
        assert_eq!(blocked_error(&line), None);
        assert_eq!((blocked_error(&[1.0]), blocked_error(&[3.0; 8])), (None, Some(0.0)));
    }
}
