//! Comparison of the runs of a plan with the target error, and the cause of each miss.

use crate::statistics::{MeanWithBar, RunSpread};

/// Largest error bar of a reference, in parts of the target error, that allows a decision.
const DECIDES: f64 = 1.0 / 3.0;
/// Mean error of all runs, in parts of the target error, above which misses are due to bias; otherwise they are due to statistics.
const BIASED: f64 = 0.5;

/// Cause of the misses of a plan.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum MissCause {
    /// The mean of all runs is biased.
    Bias,
    Statistics,
}

impl MissCause {
    pub(super) fn word(self) -> &'static str {
        match self {
            MissCause::Bias => "bias",
            MissCause::Statistics => "statistics",
        }
    }
}

/// Judged runs of a plan.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct PlanVerdict {
    /// False where the reference is not known well enough.
    pub(crate) is_decided: bool,
    pub runs: usize,
    /// Errors of the runs that have a mean, in parts of the target error.
    pub(crate) errors: Vec<f64>,
    /// Number of runs within the error.
    pub within: usize,
    /// Number of runs that failed or have no mean; they are misses.
    pub(crate) broken: usize,
    /// Cause of the other misses.
    pub(crate) cause: MissCause,
    /// Mean of the runs less the reference, with the combined error bar, in parts of the target error.
    pub(crate) bias: MeanWithBar,
    /// Standard deviation of the runs in parts of the target error; none for fewer than two.
    pub(crate) scatter: Option<f64>,
}

impl PlanVerdict {
    /// Judges runs by a reference and its error bar, and a target error, all in one unit.
    pub(super) fn of(runs: &[Result<f64, String>], [reference, bar]: [f64; 2], error: f64) -> PlanVerdict {
        let off: Vec<f64> = runs.iter().flatten().map(|value| (value - reference) / error).collect();
        let mean = MeanWithBar::of(&off);
        let count = off.len() as f64;
        PlanVerdict {
            is_decided: bar <= DECIDES * error,
            runs: runs.len(),
            errors: off.iter().map(|off| off.abs()).collect(),
            within: off.iter().filter(|off| off.abs() <= 1.0).count(),
            broken: runs.len() - off.len(),
            cause: if mean.value.abs() > BIASED { MissCause::Bias } else { MissCause::Statistics },
            bias: MeanWithBar { value: mean.value, bar: mean.bar.hypot(bar / error) },
            scatter: RunSpread::of(&off).error.map(|error| error * count.sqrt()),
        }
    }

    /// Number of runs outside the error, for a cause.
    pub(crate) fn missed_by(&self, cause: MissCause) -> usize {
        if cause == self.cause { self.runs - self.broken - self.within } else { 0 }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// By hand, for a reference of 10 and an error of 2: runs, error bar of the reference, and the number within, missed by bias, missed by
    /// statistics, failed; none where nothing is decided.
    type VerdictCase = (&'static [f64], usize, f64, Option<[usize; 4]>);

    #[test]
    fn misses_have_a_cause() {
        let cases: [VerdictCase; 7] = [
            (&[10.0, 11.9, 8.1, 12.0], 0, 0.5, Some([4, 0, 0, 0])),
            // The bias is 1.25, more than half of the error.
            (&[12.5, 11.0, 10.5, 11.0], 0, 0.5, Some([3, 1, 0, 0])),
            (&[12.5, 7.5, 10.0, 10.0], 0, 0.5, Some([2, 0, 2, 0])),
            (&[7.0, 7.0, 7.0], 0, 0.0, Some([0, 3, 0, 0])),
            (&[10.0, 12.5], 2, 0.5, Some([1, 1, 0, 2])),
            // Error bars of a third of the error, and above.
            (&[10.0, 10.0], 0, 2.0 / 3.0, Some([2, 0, 0, 0])),
            (&[10.0, 10.0], 0, 0.7, None),
        ];
        for (values, broken, bar, expected) in cases {
            let broken = (0..broken).map(|_| Err("broke".to_owned()));
            let runs: Vec<Result<f64, String>> = values.iter().copied().map(Ok).chain(broken).collect();
            let verdict = PlanVerdict::of(&runs, [10.0, bar], 2.0);
            let [bias, statistics] =
                [MissCause::Bias, MissCause::Statistics].map(|cause| verdict.missed_by(cause));
            let counts = [verdict.within, bias, statistics, verdict.broken];
            assert_eq!(verdict.is_decided.then_some(counts), expected, "{values:?}, {bar}");
            assert_eq!(verdict.runs, runs.len());
        }
    }

    /// By hand: 12 and 14 have errors of 1 and 2 targets; their standard deviation is 1/√2 of a target, the error bar of their mean t(1) = 12.706
    /// halves of one.
    #[test]
    fn bias_and_scatter_are_parts_of_the_error() {
        let verdict = PlanVerdict::of(&[Ok(12.0), Ok(14.0)], [10.0, 0.4], 2.0);
        assert_eq!(verdict.bias.value, 1.5);
        assert!((verdict.bias.bar - f64::hypot(0.5 * 12.706_204_7, 0.2)).abs() < 1e-6, "{:?}", verdict.bias);
        assert!((verdict.scatter.unwrap() - 0.5f64.sqrt()).abs() < 1e-12);
        assert_eq!(PlanVerdict::of(&[Ok(12.0)], [10.0, 0.4], 2.0).scatter, None);
    }
}
