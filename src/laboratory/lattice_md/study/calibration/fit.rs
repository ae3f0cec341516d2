//! Fits: a line with confidence intervals.

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

/// Half the 95 % interval of a number by how its estimates from parts of the samples differ.
pub(super) fn half_interval<const N: usize>(parts: [f64; N]) -> f64 {
    let n = N as f64;
    let mean = parts.iter().sum::<f64>() / n;
    let variance = parts.iter().map(|part| (part - mean).powi(2)).sum::<f64>() / (n - 1.0);
    student(N - 1) * (variance / n).sqrt()
}

/// Student's factor of a two-sided 95 % interval.
fn student(freedom: usize) -> f64 {
    const TABLE: [f64; 10] = [12.71, 4.30, 3.18, 2.78, 2.57, 2.45, 2.36, 2.31, 2.26, 2.23];
    TABLE.get(freedom - 1).copied().unwrap_or(2.0)
}

/// The middle one.
pub(super) fn median(values: impl Iterator<Item = f64>) -> f64 {
    let mut values: Vec<f64> = values.filter(|value| value.is_finite()).collect();
    values.sort_by(f64::total_cmp);
    values.get(values.len() / 2).copied().unwrap_or(0.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_is_found_and_its_interval_grows_with_the_noise() {
        let points = |noise: f64| -> Vec<(f64, f64)> {
            let ns = [8.0, 16.0, 64.0, 128.0, 256.0];
            let signs = [1.0, -1.0, 1.0, -1.0, 1.0];
            ns.iter().zip(signs).map(|(&n, sign)| (n, (5.0 + 0.25 * n) * (1.0 + noise * sign))).collect()
        };
        let exact = line(&points(0.0));
        assert!((exact.element.value - 0.25).abs() < 1e-9 && (exact.start.value - 5.0).abs() < 1e-9);
        let [low, high] = [0.01, 0.05].map(|noise| line(&points(noise)).element.interval);
        assert!(high > 3.0 * low && low > exact.element.interval);
    }

    #[test]
    fn an_interval_is_students() {
        // s = 2, n = 4: 3.18 · 2 / √4.
        let parts = [8.0, 8.0, 12.0, 12.0].map(|part: f64| 10.0 + (part - 10.0) * 0.75_f64.sqrt());
        assert!((half_interval(parts) - 3.18).abs() < 1e-9, "{}", half_interval(parts));
    }
}
