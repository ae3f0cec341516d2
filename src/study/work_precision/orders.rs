//! Orders of convergence from errors over steps.

use crate::statistics::slope;

/// Relative errors below this may be accumulated rounding of double precision.
const ROUNDING: f64 = 1e-11;
/// Most points of a fit, the smallest steps first.
const MOST: usize = 5;
/// Fewest points of a fit.
const LEAST: usize = 3;

/// Fitted order of convergence.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct FittedOrder {
    pub order: f64,
    /// Smallest and largest step of the fit (time).
    pub range: [f64; 2],
    /// Number of points.
    pub(crate) points: usize,
}

/// Fits a power law to errors over steps, by rising step. Errors below `floor` belong to the reference, and errors above `ceiling` are outside the
/// range of convergence; both are ignored. None for fewer than three points.
pub(crate) fn fit(errors: &[(f64, f64)], floor: f64, ceiling: f64) -> Option<FittedOrder> {
    let in_range = errors.iter().filter(|(_, error)| *error > floor.max(ROUNDING) && *error < ceiling);
    let used: Vec<(f64, f64)> = in_range.copied().take(MOST).collect();
    if used.len() < LEAST {
        return None;
    }
    let (steps, logarithms): (Vec<f64>, Vec<f64>) =
        used.iter().map(|(step, error)| (libm::log(*step), libm::log(*error))).unzip();
    Some(FittedOrder {
        order: slope(&steps, &logarithms),
        range: [used[0].0, used[used.len() - 1].0],
        points: used.len(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn power_law_order_is_fitted_within_range() {
        let steps = (0..9).map(|k| 0.001 * f64::from(1 << k));
        let errors: Vec<(f64, f64)> = steps.map(|h| (h, (h.powi(3) + 1e-8).min(1e-3))).collect();
        let fitted = fit(&errors, 3e-7, 0.9e-3).unwrap();
        assert!((fitted.order - 3.0).abs() < 0.05, "{fitted:?}");
        assert_eq!((fitted.range, fitted.points), ([0.008, 0.064], 4));
        // Including points below the floor would give a wrong order.
        assert!(fit(&errors, 0.0, 1.0).unwrap().order < 2.5);
        assert_eq!(fit(&errors[..2], 0.0, 1.0), None);
    }

    /// Large steps are outside the range of convergence: only the smallest are used.
    #[test]
    fn fit_uses_the_smallest_steps() {
        let steps = (0..9).map(|k| f64::from(1 << k));
        let errors: Vec<(f64, f64)> =
            steps.map(|h| (h, if h > 16.0 { 1e-3 * h } else { 1e-6 * h * h })).collect();
        let fitted = fit(&errors, 0.0, f64::INFINITY).unwrap();
        assert!((fitted.order - 2.0).abs() < 1e-12 && fitted.points == 5, "{fitted:?}");
    }
}
