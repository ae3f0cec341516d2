//! Robust least-squares fits of relative errors: points far from the fit were disturbed and have less weight.

use crate::statistics::non_negative;

/// Measured time, and the amounts of work that it consists of.
pub(super) struct FitRow<const N: usize> {
    /// Amount of work for each unknown cost.
    pub(super) features: [f64; N],
    /// Measured nanoseconds.
    pub(super) ns: f64,
}

impl<const N: usize> FitRow<N> {
    /// Predicted nanoseconds.
    pub(super) fn predicted_time(&self, unknowns: &[f64; N]) -> f64 {
        self.features.iter().zip(unknowns).map(|(feature, cost)| feature * cost).sum::<f64>()
    }

    /// Error of the prediction, as the magnitude of the logarithm of the ratio.
    pub(super) fn deviation(&self, unknowns: &[f64; N]) -> f64 {
        (self.predicted_time(unknowns) / self.ns).ln().abs()
    }
}

/// Number of rounds that reweight the points.
const ROUNDS: usize = 6;

/// Fits non-negative unknowns to all rows, weighted by relative errors.
pub(super) fn fit_robustly<const N: usize>(rows: &[FitRow<N>]) -> [f64; N] {
    let mut unknowns: Option<[f64; N]> = None;
    for _ in 0..ROUNDS {
        let weighted = rows.iter().map(|row| {
            let far = unknowns.map_or(0.0, |unknowns| row.deviation(&unknowns));
            let scale = (0.05 / (0.05 + far)).sqrt() / row.ns;
            (row.features.map(|feature| feature * scale), row.ns * scale)
        });
        unknowns = Some(non_negative(&weighted.collect::<Vec<_>>()));
    }
    unknowns.unwrap_or([0.0; N])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_fit_ignores_a_disturbed_point() {
        let line = |disturbed: f64| {
            let ns = |n: f64| (5.0 + 0.25 * n) * if n == 64.0 { disturbed } else { 1.0 };
            fit_robustly(
                &[8.0, 16.0, 64.0, 128.0, 256.0, 512.0].map(|n| FitRow { features: [n, 1.0], ns: ns(n) }),
            )
        };
        let [element, start] = line(1.0);
        assert!((element - 0.25).abs() < 1e-6 && (start - 5.0).abs() < 1e-5, "{element} {start}");
        let [element, start] = line(3.0);
        assert!((element - 0.25).abs() < 0.02 && (start - 5.0).abs() < 0.5, "{element} {start}");
    }
}
