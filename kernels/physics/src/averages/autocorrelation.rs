//! How many values in a row say as much as one independent value.

/// Lanes of a sum of products: a constant, so that the order of summation is the same on every host.
const LANES: usize = 8;
/// Correlations over at most this number of values are summed whatever their sign: noise may take the first ones below zero.
const FIRST: usize = 3;

/// What the autocorrelation of a series sums up to.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Correlation {
    /// Statistical inefficiency g: the number of values that say as much as one independent value; at least 1.
    pub inefficiency: f64,
    /// The number of lags that the autocorrelation is summed over.
    pub window: usize,
}

impl Correlation {
    /// Degrees of freedom of the error of the mean of `n` values: the variance of g is 2 (2 W + 1)/n of its square, with W the window
    /// (Wolff, Comput. Phys. Commun. 156, 143 (2004), equation 42), and that of a variance by ν degrees of freedom 2/ν.
    pub fn freedoms(self, n: usize) -> f64 {
        let independent = n as f64 / self.inefficiency - 1.0;
        (n as f64 / (2 * self.window + 1) as f64).min(independent)
    }
}

/// Statistical inefficiency g = 1 + 2 Σ (1 − t/n) C(t), with C the normalised autocorrelation over t values.
///
/// The sum ends at the first C(t) that is not positive (t > 3): what follows is noise (Chodera et al., J. Chem. Theory
/// Comput. 3, 26 (2007), equations 14 to 16). It also ends, with a value above `most`, once that is passed. A series that
/// does not vary has 1.
pub fn inefficiency(series: &[f64], most: f64) -> Correlation {
    summed(series, 0.0, most)
}

/// As [`inefficiency`], with C corrected for the mean being that of the series itself: this lowers every C(t) by g/n of what
/// is left to 1 (Wolff 2004, equation 49).
pub fn corrected(series: &[f64]) -> Correlation {
    let first = inefficiency(series, f64::INFINITY);
    summed(series, (first.inefficiency / series.len() as f64).min(0.5), f64::INFINITY)
}

fn summed(series: &[f64], raised: f64, most: f64) -> Correlation {
    let n = series.len();
    let mean = mean(series);
    let about: Vec<f64> = series.iter().map(|value| value - mean).collect();
    let variance = product(&about, &about) / n as f64;
    let mut found = Correlation { inefficiency: 1.0, window: 0 };
    // Not a number where the series is empty.
    if variance.is_nan() || variance <= 0.0 {
        return found;
    }
    for lag in 1..n {
        let correlation = product(&about[..n - lag], &about[lag..]) / ((n - lag) as f64 * variance);
        let correlation = correlation + raised * (1.0 - correlation);
        if lag > FIRST && (correlation <= 0.0 || found.inefficiency > most) {
            break;
        }
        found.inefficiency += 2.0 * correlation * (1.0 - lag as f64 / n as f64);
        found.window = lag;
    }
    found.inefficiency = found.inefficiency.max(1.0);
    found
}

/// Mean of some values; not a number of none.
pub(super) fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len() as f64
}

/// Sum of the products of two columns of one length, in an order that depends on the length only.
fn product(a: &[f64], b: &[f64]) -> f64 {
    let mut sums = [0.0; LANES];
    let (a, b) = (a.chunks_exact(LANES), b.chunks_exact(LANES));
    let rest: f64 = a.remainder().iter().zip(b.remainder()).map(|(a, b)| a * b).sum();
    for (a, b) in a.zip(b) {
        for lane in 0..LANES {
            sums[lane] += a[lane] * b[lane];
        }
    }
    sums.iter().sum::<f64>() + rest
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::averages::noise::Noise;

    /// The definition, sum by sum.
    fn by_definition(series: &[f64]) -> f64 {
        let n = series.len();
        let mean = series.iter().sum::<f64>() / n as f64;
        let covariance = |lag: usize| {
            let pairs = (0..n - lag).map(|at| (series[at] - mean) * (series[at + lag] - mean));
            pairs.sum::<f64>() / (n - lag) as f64
        };
        let mut g = 1.0;
        for lag in 1..n {
            let correlation = covariance(lag) / covariance(0);
            if correlation <= 0.0 && lag > 3 {
                break;
            }
            g += 2.0 * correlation * (1.0 - lag as f64 / n as f64);
        }
        g.max(1.0)
    }

    #[test]
    fn the_inefficiency_is_that_of_the_definition() {
        for (seed, length, memory) in [(1, 50, 0.0), (2, 333, 0.7), (3, 1001, 0.95), (4, 3, 0.5)] {
            let series = Noise::new(seed).series(length, memory);
            let found = inefficiency(&series, f64::INFINITY).inefficiency;
            let expected = by_definition(&series);
            assert!((found / expected - 1.0).abs() < 1e-12, "{seed}: {found} {expected}");
            let stopped = inefficiency(&series, 0.5 * expected).inefficiency;
            assert!(
                stopped <= found && stopped > 0.5 * expected || found < 2.0,
                "{seed}: {stopped} of {found}"
            );
        }
        assert_eq!(inefficiency(&[2.0; 9], f64::INFINITY).inefficiency, 1.0);
    }

    /// x' = φ x + noise has g = (1 + φ)/(1 − φ).
    #[test]
    fn the_inefficiency_of_known_series_is_found() {
        for memory in [0.0, 0.5, 0.8, 0.95] {
            let found = (0..40).map(|seed| {
                let series = Noise::new(seed).series(2000, memory);
                corrected(&series).inefficiency
            });
            let found = found.sum::<f64>() / 40.0;
            let expected = (1.0 + memory) / (1.0 - memory);
            assert!((found / expected - 1.0).abs() < 0.08, "{memory}: {found} {expected}");
        }
    }
}
