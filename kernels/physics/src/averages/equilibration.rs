//! Where the transient at the beginning of a series ends.

use super::autocorrelation::inefficiency;

/// Each start that is tried lies so much further than the one before.
const RATIO: f64 = 1.15;
/// Part of the series up to which starts are tried, and that may be cut off.
const LATEST: f64 = 0.75;

/// How many values at the beginning of a series do not count; none where the transient lasts almost as long as the series.
///
/// The start that leaves the most independent samples is sought: an earlier one keeps the transient, which looks like a long
/// correlation, a later one loses values (Chodera, J. Chem. Theory Comput. 12, 1799 (2016)). Starts lie on a geometric
/// ladder, 15 % apart. There the transient has sunk below the noise of a value, but not below that of the mean: as much
/// again is cut off, which squares what is left of an exponential. Where that is more than three quarters, nothing is left that could
/// be called stationary.
pub fn equilibrated(series: &[f64]) -> Option<usize> {
    let n = series.len();
    let latest = (LATEST * n as f64) as usize;
    let (mut best, mut most_samples) = (0, 0.0);
    let mut start = 0;
    while start <= latest && start < n {
        let left = (n - start) as f64;
        // A larger one leaves fewer samples than the best start.
        let most = if most_samples > 0.0 { left / most_samples } else { f64::INFINITY };
        let samples = left / inefficiency(&series[start..], most).inefficiency;
        if samples > most_samples {
            (best, most_samples) = (start, samples);
        }
        start = (start + 1).max((start as f64 * RATIO) as usize);
    }
    (2 * best <= latest).then_some(2 * best)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::averages::noise::Noise;

    /// Every start on the ladder, each by its whole sum.
    #[test]
    fn the_start_is_that_of_the_most_samples() {
        for seed in 0..20 {
            let series = Noise::new(seed).relaxing(300, 0.6, 8.0, 12.0);
            let mut starts = vec![0_usize];
            while let Some(&last) = starts.last().filter(|&&last| last <= 225) {
                starts.push((last + 1).max((last as f64 * RATIO) as usize));
            }
            starts.pop();
            let samples = |&start: &usize| {
                (300 - start) as f64 / inefficiency(&series[start..], f64::INFINITY).inefficiency
            };
            let best = starts.iter().max_by(|a, b| samples(a).total_cmp(&samples(b))).unwrap();
            assert_eq!(equilibrated(&series), (*best <= 112).then_some(2 * best), "{seed}");
        }
    }

    #[test]
    fn a_transient_is_cut_off_and_a_stationary_series_is_kept() {
        let cut = |height| {
            let cuts = (0..50).filter_map(|seed| {
                equilibrated(&Noise::new(seed).relaxing(1000, 0.5, height, 20.0)).map(|cut| cut as f64)
            });
            let cuts: Vec<f64> = cuts.collect();
            assert!(cuts.len() > 45, "{height}: {}", cuts.len());
            cuts.iter().sum::<f64>() / cuts.len() as f64
        };
        let (with, without) = (cut(10.0), cut(0.0));
        // By then e⁻³ of the transient is left, and no more than a quarter is lost.
        assert!((60.0..250.0).contains(&with) && without < 80.0, "{with} {without}");
    }
}
