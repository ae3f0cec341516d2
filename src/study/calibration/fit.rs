//! Fits: a line with confidence intervals, and non-negative least squares.

use crate::model::host::{Estimate, PassCost};

/// `t = start + n element` through points (n, t), each weighted by its time, with 95 % intervals from the residuals.
pub(super) fn line(points: &[(f64, f64)]) -> PassCost {
    let weight = |t: f64| 1.0 / (t * t);
    let sum = |f: &dyn Fn(f64, f64) -> f64| points.iter().map(|&(n, t)| weight(t) * f(n, t)).sum::<f64>();
    let [w, wn, wnn, wt, wnt] =
        [sum(&|_, _| 1.0), sum(&|n, _| n), sum(&|n, _| n * n), sum(&|_, t| t), sum(&|n, t| n * t)];
    let determinant = w * wnn - wn * wn;
    let slope = (w * wnt - wn * wt) / determinant;
    let start = (wnn * wt - wn * wnt) / determinant;
    let residual = sum(&|n, t| (t - start - slope * n).powi(2));
    let freedom = points.len().saturating_sub(2).max(1);
    let variance = residual / freedom as f64;
    let half = |of: f64| student(freedom) * (variance * of / determinant).max(0.0).sqrt();
    PassCost {
        element: Estimate { value: slope.max(0.0), interval: half(w) },
        start: Estimate { value: start.max(0.0), interval: half(wnn) },
    }
}

/// Student's factor of a two-sided 95 % interval.
fn student(freedom: usize) -> f64 {
    const TABLE: [f64; 10] = [12.71, 4.30, 3.18, 2.78, 2.57, 2.45, 2.36, 2.31, 2.26, 2.23];
    TABLE.get(freedom - 1).copied().unwrap_or(2.0)
}

/// The non-negative `x` of least `|A x - b|`, by coordinate descent; rows are (features, value).
pub(super) fn non_negative<const N: usize>(rows: &[([f64; N], f64)]) -> [f64; N] {
    let mut x = [0.0; N];
    for _ in 0..2000 {
        for k in 0..N {
            let mut numerator = 0.0;
            let mut denominator = 0.0;
            for (features, value) in rows {
                let others: f64 = (0..N).filter(|&j| j != k).map(|j| features[j] * x[j]).sum();
                numerator += features[k] * (value - others);
                denominator += features[k] * features[k];
            }
            x[k] = if denominator > 0.0 { (numerator / denominator).max(0.0) } else { 0.0 };
        }
    }
    x
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_is_found_and_its_interval_grows_with_the_noise() {
        let points = |noise: f64| -> Vec<(f64, f64)> {
            [8.0, 16.0, 64.0, 128.0, 256.0]
                .iter()
                .enumerate()
                .map(|(i, &n)| (n, (20.0 + 0.5 * n) * (1.0 + noise * if i % 2 == 0 { 1.0 } else { -1.0 })))
                .collect()
        };
        let exact = line(&points(0.0));
        assert!((exact.element.value - 0.5).abs() < 1e-12 && (exact.start.value - 20.0).abs() < 1e-9);
        let noisy = line(&points(0.05));
        assert!(noisy.element.interval > 1e3 * exact.element.interval.max(1e-15));
        assert!((noisy.element.value - 0.5).abs() <= noisy.element.interval);
    }

    #[test]
    fn what_would_be_negative_is_nothing() {
        let rows = [([1.0, 0.0], 2.0), ([0.0, 1.0], -3.0), ([1.0, 1.0], 2.0)];
        let [a, b] = non_negative(&rows);
        assert!((a - 2.0).abs() < 1e-9 && b == 0.0);
    }
}
