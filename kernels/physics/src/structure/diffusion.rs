//! Diffusion constant from two functions of lags, and the test that lags are long enough.
//!
//! Both estimates approach it from below. If velocities decorrelate within a time τ, the slope of the mean square displacement between half a lag t
//! and the lag falls short of 4 D by the fraction 2τ/t (exp(−t/2τ) − exp(−t/τ)), and the integral of the velocity autocorrelation by exp(−t/τ). The
//! change from one octave of lags to the next determines τ. If the change exceeds its error, lags must be so many τ long that the missing part is
//! small; it is added to the error bar.

use super::blocks::MOST as MOST_BLOCKS;
use super::motion::{integral, slope};
use super::{AveragedFunction, FunctionReliability};
use crate::number::significant;

/// Required lags over τ: the missing part is then 0.1 and 0.2 %.
const LONG_ENOUGH: [f64; 2] = [10.0, 6.0];
/// Smallest significant change, in half-widths of its 95 % confidence interval.
const CERTAIN: f64 = 2.0;
/// Safety factor on the recommended length, since τ has an error.
const MARGIN: f64 = 1.25;
/// Smallest autocorrelation at the first lag, relative to lag 0, for its integral to be accurate: the trapezoidal rule then has an error of 1 % for
/// exponential decay.
const RESOLVED: f64 = 0.7;
/// Range of lags over τ in which the ratio of two octaves is searched.
const RATIOS: [f64; 2] = [0.05, 200.0];

/// Estimate of the constant from a function of lags.
struct DiffusionEstimate {
    /// Estimate from an octave of lags: lags, values and the indices of the octave's ends.
    of: fn(&[f64], &[f64], [usize; 2]) -> f64,
    /// Missing fraction at a lag over τ.
    missing: fn(f64) -> f64,
    /// Ratio to the next octave, which ends at a lag over τ.
    ratio: fn(f64) -> f64,
    long_enough: f64,
}

/// Missing fraction of the slope between half a lag and the lag.
fn missing_of_slope(x: f64) -> f64 {
    2.0 / x * (libm::exp(-0.5 * x) - libm::exp(-x))
}

const SLOPE: DiffusionEstimate = DiffusionEstimate {
    of: |lags, values, [from, to]| slope(lags, values, from, to) / 4.0,
    missing: missing_of_slope,
    ratio: |x| (1.0 - missing_of_slope(0.5 * x)) / (1.0 - missing_of_slope(x)),
    long_enough: LONG_ENOUGH[0],
};

const INTEGRAL: DiffusionEstimate = DiffusionEstimate {
    of: |lags, values, [_, to]| 0.5 * integral(lags, values, to),
    missing: |x| libm::exp(-x),
    ratio: |x| 1.0 / (1.0 + libm::exp(-0.5 * x)),
    long_enough: LONG_ENOUGH[1],
};

/// Indices of a quarter and a half of the longest lag and of the lag itself; then those of half of it, down to four rows.
fn octaves(lags: &[f64]) -> Vec<[usize; 3]> {
    let [Some(&first), Some(&last)] = [lags.get(1), lags.last()] else { return vec![] };
    let at = |lag: f64| lags.partition_point(|&it| it < lag * (1.0 - 1e-6));
    let ends = std::iter::successors(Some(last), |lag| Some(0.5 * lag));
    let ends = ends.take_while(|lag| 0.25 * lag > first * (1.0 - 1e-6));
    ends.map(|lag| [at(0.25 * lag), at(0.5 * lag), at(lag)]).collect()
}

impl DiffusionEstimate {
    /// D from the longest octave, of a block or of means.
    fn constant(&self, lags: &[f64], values: &[f64]) -> f64 {
        octaves(lags).first().map_or(f64::NAN, |&[_, half, last]| (self.of)(lags, values, [half, last]))
    }

    /// Correlation time τ from the changes between octaves, the longest one; none if no change is significant.
    fn correlation_time(&self, whole: &AveragedFunction<'_>) -> Option<f64> {
        let of = |&[quarter, half, last]: &[usize; 3]| {
            let later = |block: &[f64]| (self.of)(whole.over, block, [half, last]);
            let change = |block: &[f64]| later(block) - (self.of)(whole.over, block, [quarter, half]);
            let ([change, bar], [value, _]) = ((whole.mean)(&change, last)?, (whole.mean)(&later, last)?);
            let is_change = change.abs() > CERTAIN * bar;
            is_change.then(|| whole.over[last] / self.lags_of((1.0 - change.abs() / value.abs()).max(0.0)))
        };
        octaves(whole.over).iter().filter_map(of).reduce(f64::max)
    }

    /// Lag over τ at which two octaves have a ratio.
    fn lags_of(&self, ratio: f64) -> f64 {
        let [mut low, mut high] = RATIOS;
        while high - low > 1e-6 * high {
            let middle = 0.5 * (low + high);
            if (self.ratio)(middle) < ratio { low = middle } else { high = middle }
        }
        low
    }

    /// Missing part at the longest lag, relative to the estimate.
    fn bias(&self, whole: &AveragedFunction<'_>) -> f64 {
        let (Some(correlation_time), Some(last)) = (self.correlation_time(whole), whole.over.last()) else {
            return 0.0;
        };
        let missing = (self.missing)(last / correlation_time);
        missing / (1.0 - missing)
    }

    /// Reason why there is no constant, with the run that would give one.
    fn judge(&self, whole: &AveragedFunction<'_>) -> FunctionReliability {
        if whole.setting.domain.periodic() != [true; 2] {
            let why =
                "no diffusion constant: closed sides bound the displacements; both sides must be periodic";
            return FunctionReliability::None(why.to_owned());
        }
        let Some(&last) = whole.over.last().filter(|_| !octaves(whole.over).is_empty()) else {
            return FunctionReliability::None(format!(
                "no diffusion constant: the longest lag spans fewer than 4 rows; write at least {} rows",
                4 * MOST_BLOCKS
            ));
        };
        match self.correlation_time(whole) {
            Some(correlation_time) if correlation_time * self.long_enough > last => {
                // The longest lag is at least the length of the run over the number of blocks.
                let enough = (MARGIN * MOST_BLOCKS as f64 * self.long_enough * correlation_time)
                    .max(2.0 * whole.elapsed);
                FunctionReliability::None(format!(
                    "no diffusion constant: motion is not diffusive yet at the longest lag, {}: velocities are correlated for about {}; extend the run \
                     until about time {} to resolve it",
                    significant(last, 2),
                    significant(correlation_time, 2),
                    significant(enough, 2)
                ))
            }
            _ => FunctionReliability::Sound,
        }
    }
}

/// D from the slope of the mean square displacement, between half of the longest lag and the longest lag.
pub(super) fn by_displacements(whole: &AveragedFunction<'_>, block: &[f64]) -> f64 {
    SLOPE.constant(whole.over, &block[..whole.over.len()])
}

/// Relative bias of the slope.
pub(super) fn bias_of_displacements(whole: &AveragedFunction<'_>) -> f64 {
    SLOPE.bias(whole)
}

/// Judgement of the slope.
pub(super) fn judge_displacements(whole: &AveragedFunction<'_>) -> FunctionReliability {
    SLOPE.judge(whole)
}

/// D as half of the integral of ⟨v(0)·v(t)⟩ by the trapezoidal rule.
pub(super) fn by_velocities(whole: &AveragedFunction<'_>, block: &[f64]) -> f64 {
    INTEGRAL.constant(whole.over, &block[..whole.over.len()])
}

/// Relative bias of the integral.
pub(super) fn bias_of_velocities(whole: &AveragedFunction<'_>) -> f64 {
    INTEGRAL.bias(whole)
}

/// Judgement of the integral; it also fails if velocities decorrelate between two rows.
pub(super) fn judge_velocities(whole: &AveragedFunction<'_>) -> FunctionReliability {
    match INTEGRAL.judge(whole) {
        FunctionReliability::Sound if whole.means[1][0] < RESOLVED * whole.means[0][0] => FunctionReliability::None(
            "no diffusion constant: rows too far apart, velocities decorrelate between them; write rows so often that the autocorrelation falls by less \
             than a third"
                .to_owned(),
        ),
        verdict => verdict,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Hand calculation for exponential decorrelation: M = 4 (t − 1 + exp(−t)), C = 2 exp(−t), τ = D = 1.
    #[test]
    fn missing_parts_match_exponential_decay() {
        for last in [1.0_f64, 3.0, 10.0] {
            let lags = [0.0, 0.25 * last, 0.5 * last, last];
            let displacements = lags.map(|t| 4.0 * (t - 1.0 + (-t).exp()));
            let [earlier, later] = [[1, 2], [2, 3]].map(|ends| (SLOPE.of)(&lags, &displacements, ends));
            assert!((later / (1.0 - (SLOPE.missing)(last)) - 1.0).abs() < 1e-12, "{last}");
            assert!((SLOPE.lags_of(earlier / later) / last - 1.0).abs() < 1e-4, "{last}");
            let fine: Vec<f64> = (0..=4000).map(|step| f64::from(step) * last / 4000.0).collect();
            let products: Vec<f64> = fine.iter().map(|t| 2.0 * (-t).exp()).collect();
            let [earlier, later] = [2000, 4000].map(|to| (INTEGRAL.of)(&fine, &products, [0, to]));
            assert!((later - (1.0 - (INTEGRAL.missing)(last))).abs() < 1e-5, "{last}");
            assert!((INTEGRAL.lags_of(earlier / later) / last - 1.0).abs() < 1e-3, "{last}");
        }
        let lags: Vec<f64> = [0, 1, 2, 3, 4, 5, 6, 7, 8, 10, 12, 14, 16].map(f64::from).to_vec();
        assert_eq!(octaves(&lags), [[4, 8, 12], [2, 4, 8], [1, 2, 4]]);
        assert!(octaves(&lags[..4]).is_empty() && octaves(&[]).is_empty());
    }
}
