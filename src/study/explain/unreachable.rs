//! Reasons why an error is not reached, and the smallest error found.

use super::words::seconds;
use std::fmt::{self, Display, Formatter};
use stripmine_physics::number::significant;

/// No plan reaches the target error.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Unreached {
    /// Requested error (the quantity's unit).
    pub(crate) wanted: f64,
    /// Error bar of the mean in the trials (the quantity's unit); NaN for a conserved quantity.
    pub known: f64,
    /// Smallest error known to be reached (the quantity's unit); infinite where none is.
    pub least: f64,
    /// Wall seconds of a run expected to reach the error, extrapolated from the steps tried.
    pub expected: Option<f64>,
    /// Wall seconds of the plan that would reach the error, and the limit of a plan.
    pub(crate) takes: Option<[f64; 2]>,
    /// Wall seconds of the trials; 0 where unknown.
    pub trials: f64,
}

impl Unreached {
    /// Result for a requested error and the smallest error known.
    pub(super) fn of(wanted: f64, least: f64) -> Unreached {
        Unreached { wanted, known: f64::NAN, least, expected: None, takes: None, trials: 0.0 }
    }

    /// Returns the advice: trials long enough for the run expected to reach the error, or longer ones.
    pub(super) fn advice(&self) -> String {
        match (self.takes, self.expected) {
            (Some(_), _) => "raise --limit".to_owned(),
            (None, Some(run)) => {
                let enough = f64::max(TIMES_RUN * run, LONGER * self.trials);
                format!("use longer trials: --seconds {}", significant(enough.ceil(), 2))
            }
            (None, None) => "use longer trials: --patient".to_owned(),
        }
    }
}

/// Recommended trial time, in expected runs: longer steps and several starts come before the run that reaches the error.
const TIMES_RUN: f64 = 8.0;
/// Smallest factor by which recommended trials are longer than those made.
const LONGER: f64 = 2.0;

impl Display for Unreached {
    fn fmt(&self, out: &mut Formatter<'_>) -> fmt::Result {
        if self.known.is_finite() {
            write!(out, "the trials give the mean to \u{b1} {}; ", significant(self.known, 2))?;
        }
        match self.takes {
            Some([takes, limit]) => write!(
                out,
                "reaching it takes about {}, above the limit of {}, which gives an error of {}",
                seconds(takes),
                seconds(limit),
                significant(self.least, 2)
            ),
            None if self.least.is_finite() => {
                write!(out, "the smallest error found is {}", significant(self.least, 2))?;
                self.expected.map_or(Ok(()), |run| {
                    write!(out, ", and a run of about {} should reach it", seconds(run))
                })
            }
            None => write!(out, "no step has a known bias"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// By hand: eight runs of 2.3 s take 18.4 s, more than twice the 5 s that were too short, and less than twice 10 s.
    #[test]
    fn advised_trials_are_longer_than_past_ones() {
        let advice = |trials| Unreached { expected: Some(2.3), trials, ..Unreached::of(1e-3, 4e-3) }.advice();
        assert_eq!(
            [5.0, 10.0].map(advice),
            ["use longer trials: --seconds 19", "use longer trials: --seconds 20"]
        );
        assert_eq!(Unreached::of(1e-3, 4e-3).advice(), "use longer trials: --patient");
    }
}
