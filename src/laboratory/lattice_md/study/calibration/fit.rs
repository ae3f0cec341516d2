//! Fits in relative errors: what is far from the fit was disturbed, and weighs less.

use crate::statistics::non_negative;

/// A time, and what it is charged for.
pub(super) struct Row<const N: usize> {
    /// How much of each unknown.
    pub(super) features: [f64; N],
    /// Nanoseconds that are known already.
    pub(super) known: f64,
    /// Nanoseconds measured.
    pub(super) ns: f64,
}

impl<const N: usize> Row<N> {
    /// Nanoseconds by these unknowns.
    pub(super) fn said(&self, unknowns: &[f64; N]) -> f64 {
        self.known + self.features.iter().zip(unknowns).map(|(feature, cost)| feature * cost).sum::<f64>()
    }

    /// How far off these are, as the logarithm of a ratio.
    pub(super) fn deviation(&self, unknowns: &[f64; N]) -> f64 {
        (self.said(unknowns) / self.ns).ln().abs()
    }
}

/// Rounds in which what is far from the fit weighs less and less.
const ROUNDS: usize = 6;

/// The unknowns, none below zero, that suit all rows best, each in its relative error.
pub(super) fn suited<const N: usize>(rows: &[Row<N>]) -> [f64; N] {
    let mut unknowns: Option<[f64; N]> = None;
    for _ in 0..ROUNDS {
        let weighted = rows.iter().map(|row| {
            let far = unknowns.map_or(0.0, |unknowns| row.deviation(&unknowns));
            let scale = (0.05 / (0.05 + far)).sqrt() / row.ns;
            (row.features.map(|feature| feature * scale), (row.ns - row.known).max(0.0) * scale)
        });
        unknowns = Some(non_negative(&weighted.collect::<Vec<_>>()));
    }
    unknowns.unwrap_or([0.0; N])
}

/// The element and the start of `t = start + n element` through points (n, t).
pub(super) fn line(points: impl Iterator<Item = (f64, f64)>) -> [f64; 2] {
    suited(&points.map(|(n, ns)| Row { features: [n, 1.0], known: 0.0, ns }).collect::<Vec<_>>())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_is_found_though_one_point_was_disturbed() {
        let points = [8.0, 16.0, 64.0, 128.0, 256.0, 512.0].map(|n| (n, 5.0 + 0.25 * n));
        let [element, start] = line(points.into_iter());
        assert!((element - 0.25).abs() < 1e-6 && (start - 5.0).abs() < 1e-5, "{element} {start}");
        let disturbed = points.map(|(n, t)| (n, if n == 64.0 { 3.0 * t } else { t }));
        let [element, start] = line(disturbed.into_iter());
        assert!((element - 0.25).abs() < 0.02 && (start - 5.0).abs() < 0.5, "{element} {start}");
    }
}
