//! Statistics over several runs.

use serde::Serialize;
pub use stripmine_physics::averages::MeanWithBar;
pub(crate) use stripmine_physics::averages::student;

/// Mean and range of a quantity over independent runs.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct RunSpread {
    /// Mean.
    pub mean: f64,
    /// Standard error of the mean; none for a single run.
    pub error: Option<f64>,
    /// Smallest value.
    pub lowest: f64,
    /// Largest value.
    pub highest: f64,
    /// Number of runs.
    pub runs: usize,
}

impl RunSpread {
    /// Computes the spread of at least one value.
    pub fn of(values: &[f64]) -> RunSpread {
        let n = values.len() as f64;
        let mean = values.iter().sum::<f64>() / n;
        let squares = values.iter().map(|value| (value - mean).powi(2)).sum::<f64>();
        RunSpread {
            mean,
            error: (values.len() > 1).then(|| (squares / (n - 1.0) / n).sqrt()),
            lowest: values.iter().copied().fold(f64::INFINITY, f64::min),
            highest: values.iter().copied().fold(f64::NEG_INFINITY, f64::max),
            runs: values.len(),
        }
    }
}

/// Median, the upper of two middle values; NaN of an empty sequence.
pub(crate) fn median(values: impl Iterator<Item = f64>) -> f64 {
    let mut values: Vec<f64> = values.collect();
    values.sort_by(f64::total_cmp);
    values.get(values.len() / 2).copied().unwrap_or(f64::NAN)
}

/// Probability that independent values of a distribution deviate from it at least as far as these, by the largest
/// difference of the distribution functions (Kolmogorov and Smirnov, with Stephens' correction for few values).
pub(crate) fn kolmogorov_smirnov(mut values: Vec<f64>, distribution: impl Fn(f64) -> f64) -> f64 {
    values.sort_by(f64::total_cmp);
    let count = values.len() as f64;
    let distance = values.iter().zip(0..).map(|(&value, before)| {
        let expected = distribution(value);
        (expected - f64::from(before) / count).max(f64::from(before + 1) / count - expected)
    });
    let distance = distance.fold(0.0, f64::max);
    let scaled = (count.sqrt() + 0.12 + 0.11 / count.sqrt()) * distance;
    if scaled < 0.2 {
        return 1.0;
    }
    let term = |k: i32| 2.0 * (-1f64).powi(k - 1) * (-2.0 * f64::from(k * k) * scaled * scaled).exp();
    (1..=100).map(term).sum::<f64>().clamp(0.0, 1.0)
}

/// Returns the 95 % interval of a probability by Wilson's score, from the successes among independent trials (at least one).
pub(crate) fn wilson(came_true: usize, trials: usize) -> [f64; 2] {
    // Quantile of the normal distribution.
    const Z: f64 = 1.959_963_984_540_054;
    let (count, share) = (trials as f64, came_true as f64 / trials as f64);
    let middle = share + Z * Z / (2.0 * count);
    let half = Z * (share * (1.0 - share) / count + (Z / (2.0 * count)).powi(2)).sqrt();
    [-1.0, 1.0].map(|sign| ((middle + sign * half) / (1.0 + Z * Z / count)).clamp(0.0, 1.0))
}

/// Value below which a given share of sorted values lies; none for an empty slice.
pub(crate) fn quantile(rising: &[f64], share: f64) -> Option<f64> {
    let last = rising.len().checked_sub(1)?;
    Some(rising[(share * last as f64).round() as usize])
}

/// Slope of the least-squares line through points; 0 for fewer than two.
pub(crate) fn slope(x: &[f64], y: &[f64]) -> f64 {
    let mean = |values: &[f64]| values.iter().sum::<f64>() / values.len() as f64;
    let (middle, height) = (mean(x), mean(y));
    let spread = x.iter().map(|x| (x - middle) * (x - middle)).sum::<f64>();
    let rise = x.iter().zip(y).map(|(x, y)| (x - middle) * (y - height)).sum::<f64>();
    if spread > 0.0 { rise / spread } else { 0.0 }
}

/// Half-width of the 95 % interval of the [`slope`] of at least three points, from their scatter about the line; 0 for fewer.
pub(crate) fn slope_error(x: &[f64], y: &[f64]) -> f64 {
    let mean = |values: &[f64]| values.iter().sum::<f64>() / values.len() as f64;
    let (middle, height, slope) = (mean(x), mean(y), slope(x, y));
    let rest = x.iter().zip(y).map(|(x, y)| (y - height - slope * (x - middle)).powi(2)).sum::<f64>();
    let spread = x.iter().map(|x| (x - middle) * (x - middle)).sum::<f64>();
    match x.len() {
        0..3 => 0.0,
        count => student(0.95, count - 2) * (rest / (count - 2) as f64 / spread).sqrt(),
    }
}

/// Non-negative `x` that minimises `|A x - b|`, by coordinate descent on the normal equations; rows are (features, value).
pub(crate) fn non_negative<const N: usize>(rows: &[([f64; N], f64)]) -> [f64; N] {
    let mut square = [[0.0; N]; N];
    let mut right = [0.0; N];
    for (features, value) in rows {
        for i in 0..N {
            right[i] += features[i] * value;
            for j in 0..N {
                square[i][j] += features[i] * features[j];
            }
        }
    }
    let mut x = [0.0; N];
    for _ in 0..5000 {
        let mut moved = 0.0_f64;
        for k in 0..N {
            if square[k][k] <= 0.0 {
                continue;
            }
            let others: f64 = (0..N).filter(|&j| j != k).map(|j| square[k][j] * x[j]).sum();
            let next = ((right[k] - others) / square[k][k]).max(0.0);
            moved = moved.max((next - x[k]).abs() * square[k][k].sqrt());
            x[k] = next;
        }
        if moved < 1e-12 {
            break;
        }
    }
    x
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn deviation_is_relative_to_the_known_value() {
        assert_eq!(MeanWithBar { value: 4.2, bar: 0.4 }.relative_to(4.0).to_string(), "0.05 ± 0.10");
    }

    #[test]
    fn a_line_has_its_slope() {
        let x = [1.0, 2.0, 4.0, 8.0];
        assert!((slope(&x, &x.map(|x| 3.0 - 0.5 * x)) + 0.5).abs() < 1e-15);
        // By hand: two points off a flat line by the same amount, at the ends, tilt it.
        assert!((slope(&[0.0, 1.0, 2.0], &[0.0, 0.0, 1.0]) - 0.5).abs() < 1e-15);
        assert_eq!((slope(&[], &[]), slope(&[1.0], &[2.0])), (0.0, 0.0));
    }

    #[test]
    fn the_error_of_the_mean_needs_two_runs() {
        assert_eq!(RunSpread::of(&[3.0]).error, None);
        let spread = RunSpread::of(&[1.0, 3.0]);
        assert_eq!((spread.mean, spread.error, spread.lowest, spread.highest), (2.0, Some(1.0), 1.0, 3.0));
    }

    /// By hand: 1 and 3 have the mean 2 and the standard error 1, of one degree of freedom.
    #[test]
    fn the_bar_of_a_mean_is_students() {
        let MeanWithBar { value, bar } = MeanWithBar::of(&[1.0, 3.0]);
        assert!(value == 2.0 && bar == student(0.95, 1));
        assert_eq!(MeanWithBar::of(&[1.0]).bar, f64::INFINITY);
    }

    /// Critical distances of the tables (Stephens 1974): 1.358 and 1.628 for 5 and 1 of 100; and evenly spaced values.
    #[test]
    fn kolmogorov_probabilities_match_published_tables() {
        for (scaled, p) in [(1.358, 0.05), (1.628, 0.01)] {
            let count = 10_000;
            let shift = scaled / (100.0 + 0.12 + 0.0011);
            let values = (0..count).map(|at| (f64::from(at) + 0.5) / f64::from(count)).collect();
            let found = kolmogorov_smirnov(values, |x: f64| (x + shift - 0.5 / f64::from(count)).min(1.0));
            assert!((found / p - 1.0).abs() < 0.02, "{found} {p}");
        }
        // Critical distance for ten values: 0.4092 for 5 of 100. The distribution is above or below them.
        for above in [true, false] {
            let values: Vec<f64> =
                (0..10).map(|at| f64::from(at) / 10.0 + if above { 0.1 } else { 0.0 }).collect();
            let shift = if above { 0.4092 - 0.1 } else { -(0.4092 - 0.1) };
            let found = kolmogorov_smirnov(values, |x| x + shift);
            assert!((found / 0.05 - 1.0).abs() < 0.03, "{above}: {found}");
        }
        assert_eq!(
            kolmogorov_smirnov((0..100).map(|at| (f64::from(at) + 0.5) / 100.0).collect(), |x| x),
            1.0
        );
    }

    /// Newcombe, Statistics in Medicine 17 (1998) 857, table I, method 3.
    #[test]
    fn wilson_intervals_are_the_published_ones() {
        for (came_true, trials, published) in [
            (81, 263, [0.2553, 0.3662]),
            (15, 148, [0.0624, 0.1605]),
            (0, 20, [0.0, 0.1611]),
            (1, 29, [0.0061, 0.1718]),
            (29, 29, [0.8830, 1.0]),
        ] {
            for (end, published) in wilson(came_true, trials).into_iter().zip(published) {
                assert!((end - published).abs() < 5.1e-5, "{came_true} of {trials}: {end}");
            }
        }
    }

    /// By hand: (0, 0), (1, 2), (2, 1) has a slope of ½, residuals of −½, 1 and −½, and so an error of √(3/2 / 2).
    #[test]
    fn slopes_have_the_error_of_their_residuals() {
        let (x, y) = ([0.0, 1.0, 2.0], [0.0, 2.0, 1.0]);
        assert_eq!(slope(&x, &y), 0.5);
        assert!((slope_error(&x, &y) / student(0.95, 1) - 0.75_f64.sqrt()).abs() < 1e-12);
        assert_eq!(slope_error(&x[..2], &y[..2]), 0.0);
    }

    #[test]
    fn quantiles_are_elements_of_the_data() {
        assert_eq!(
            [0.0, 0.25, 1.0].map(|share| quantile(&[1.0, 2.0, 3.0, 4.0, 5.0], share)),
            [1.0, 2.0, 5.0].map(Some)
        );
        assert_eq!(quantile(&[], 0.5), None);
    }

    #[test]
    fn least_squares_solution_is_non_negative() {
        let rows: Vec<([f64; 2], f64)> =
            [[1.0, 2.0], [2.0, 1.0], [3.0, 5.0]].map(|row| (row, 2.0 * row[0] + 0.5 * row[1])).to_vec();
        let [a, b] = non_negative(&rows);
        assert!((a - 2.0).abs() < 1e-6 && (b - 0.5).abs() < 1e-6, "{a} {b}");
        let against: Vec<([f64; 2], f64)> = rows.iter().map(|&(row, _)| (row, row[0] - row[1])).collect();
        assert!(non_negative(&against).iter().all(|&x| x >= 0.0));
    }
}
