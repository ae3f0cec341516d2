//! Runs of a plan held against the error that was asked for, and the cause of each miss.

use crate::statistics::{Mean, Spread};

/// A reference whose bar is more than this part of the error decides nothing.
const DECIDES: f64 = 1.0 / 3.0;
/// Misses are due to bias where the mean of all runs is off by more than this part of the error, else to statistics.
const BIASED: f64 = 0.5;

/// The cause of the misses of a plan.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Cause {
    /// The mean of all runs is off.
    Bias,
    /// Runs scatter.
    Statistics,
}

impl Cause {
    /// The cause in a word.
    pub(super) fn word(self) -> &'static str {
        match self {
            Cause::Bias => "bias",
            Cause::Statistics => "statistics",
        }
    }
}

/// Runs of a plan, judged.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Verdict {
    /// False where the reference is not known well enough.
    pub(crate) is_decided: bool,
    pub runs: usize,
    /// Errors of those that have a mean, over the error asked for.
    pub(crate) errors: Vec<f64>,
    /// Runs within the error.
    pub within: usize,
    /// Those that broke or have no mean; they are misses.
    pub(crate) broken: usize,
    /// The cause of the other misses.
    pub(crate) cause: Cause,
    /// The mean of the runs less the reference, with the bar of both, over the error.
    pub(crate) bias: Mean,
    /// Standard deviation of the runs over the error; none of fewer than two.
    pub(crate) scatter: Option<f64>,
}

impl Verdict {
    /// Judges runs by a reference and its bar, and an error, all in one unit.
    pub(super) fn of(runs: &[Result<f64, String>], [reference, bar]: [f64; 2], error: f64) -> Verdict {
        let off: Vec<f64> = runs.iter().flatten().map(|value| (value - reference) / error).collect();
        let mean = Mean::of(&off);
        let count = off.len() as f64;
        Verdict {
            is_decided: bar <= DECIDES * error,
            runs: runs.len(),
            errors: off.iter().map(|off| off.abs()).collect(),
            within: off.iter().filter(|off| off.abs() <= 1.0).count(),
            broken: runs.len() - off.len(),
            cause: if mean.value.abs() > BIASED { Cause::Bias } else { Cause::Statistics },
            bias: Mean { value: mean.value, bar: mean.bar.hypot(bar / error) },
            scatter: Spread::of(&off).error.map(|error| error * count.sqrt()),
        }
    }

    /// Runs that are off by more than the error, for a cause.
    pub(crate) fn missed_by(&self, cause: Cause) -> usize {
        if cause == self.cause { self.runs - self.broken - self.within } else { 0 }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// By hand, for a reference of 10 and an error of 2: runs, bar of the reference, and the number within, missed by bias, missed by statistics, broken;
    /// none where nothing is decided.
    type Case = (&'static [f64], usize, f64, Option<[usize; 4]>);

    #[test]
    fn misses_have_a_cause() {
        let cases: [Case; 7] = [
            (&[10.0, 11.9, 8.1, 12.0], 0, 0.5, Some([4, 0, 0, 0])),
            // The mean is off by 1.25, more than half of the error.
            (&[12.5, 11.0, 10.5, 11.0], 0, 0.5, Some([3, 1, 0, 0])),
            (&[12.5, 7.5, 10.0, 10.0], 0, 0.5, Some([2, 0, 2, 0])),
            (&[7.0, 7.0, 7.0], 0, 0.0, Some([0, 3, 0, 0])),
            (&[10.0, 12.5], 2, 0.5, Some([1, 1, 0, 2])),
            // Bars of a third of the error, and beyond.
            (&[10.0, 10.0], 0, 2.0 / 3.0, Some([2, 0, 0, 0])),
            (&[10.0, 10.0], 0, 0.7, None),
        ];
        for (values, broken, bar, expected) in cases {
            let broken = (0..broken).map(|_| Err("broke".to_owned()));
            let runs: Vec<Result<f64, String>> = values.iter().copied().map(Ok).chain(broken).collect();
            let verdict = Verdict::of(&runs, [10.0, bar], 2.0);
            let [bias, statistics] = [Cause::Bias, Cause::Statistics].map(|cause| verdict.missed_by(cause));
            let counts = [verdict.within, bias, statistics, verdict.broken];
            assert_eq!(verdict.is_decided.then_some(counts), expected, "{values:?}, {bar}");
            assert_eq!(verdict.runs, runs.len());
        }
    }

    /// By hand: 12 and 14 are 1 and 2 errors off; their standard deviation is 1/√2 of an error, the bar of their mean t(1) = 12.706 halves of one.
    #[test]
    fn bias_and_scatter_are_parts_of_the_error() {
        let verdict = Verdict::of(&[Ok(12.0), Ok(14.0)], [10.0, 0.4], 2.0);
        assert_eq!(verdict.bias.value, 1.5);
        assert!((verdict.bias.bar - f64::hypot(0.5 * 12.706_204_7, 0.2)).abs() < 1e-6, "{:?}", verdict.bias);
        assert!((verdict.scatter.unwrap() - 0.5f64.sqrt()).abs() < 1e-12);
        assert_eq!(Verdict::of(&[Ok(12.0)], [10.0, 0.4], 2.0).scatter, None);
    }
}
