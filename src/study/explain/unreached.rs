//! Why an error is not reached, and the error that is.

use super::words::seconds;
use std::fmt::{self, Display, Formatter};
use stripmine_physics::number::significant;

/// No plan reaches the error that is asked for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Unreached {
    /// The error that was asked for (the quantity's unit).
    pub(crate) wanted: f64,
    /// The error to which the trials know the mean (the quantity's unit); not a number where it should keep its value.
    pub known: f64,
    /// The least error that is known to be reached (the quantity's unit); infinite where none is.
    pub least: f64,
    /// Wall seconds of a run that is expected to reach it, by the trend of the steps that were tried.
    pub expected: Option<f64>,
    /// Wall seconds of the plan that would reach it, and the most that a plan may take.
    pub(crate) takes: Option<[f64; 2]>,
    /// Wall seconds of the trials; 0 where nobody said.
    pub trials: f64,
}

impl Unreached {
    /// Of an error that was asked for, and the least that is known.
    pub(super) fn of(wanted: f64, least: f64) -> Unreached {
        Unreached { wanted, known: f64::NAN, least, expected: None, takes: None, trials: 0.0 }
    }

    /// Advice: trials that are long enough for the run that is expected to reach it, or any that are longer.
    pub(super) fn advice(&self) -> String {
        match (self.takes, self.expected) {
            (Some(_), _) => "raise --limit".to_owned(),
            (None, Some(run)) => {
                let enough = f64::max(TIMES_RUN * run, LONGER * self.trials);
                format!("look longer by --seconds {}", significant(enough.ceil(), 2))
            }
            (None, None) => "look longer by --patient".to_owned(),
        }
    }
}

/// Length of the trials that are advised, in runs: longer steps and several starts come before the run that is expected.
const TIMES_RUN: f64 = 8.0;
/// Trials that were not enough are made again for this many times as long, at least.
const LONGER: f64 = 2.0;

impl Display for Unreached {
    fn fmt(&self, out: &mut Formatter<'_>) -> fmt::Result {
        if self.known.is_finite() {
            write!(out, "the trials know it to \u{b1} {}; ", significant(self.known, 2))?;
        }
        match self.takes {
            Some([takes, limit]) => write!(
                out,
                "a run of about {} would reach it, more than the limit of {}, in which the error is {}",
                seconds(takes),
                seconds(limit),
                significant(self.least, 2)
            ),
            None if self.least.is_finite() => {
                write!(out, "the least error that is known is {}", significant(self.least, 2))?;
                self.expected.map_or(Ok(()), |run| {
                    write!(out, ", and a run of about {} is expected to reach it", seconds(run))
                })
            }
            None => write!(out, "the bias of no step is known"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// By hand: eight runs of 2.3 s are 18.4 s, more than twice the 5 s that were not enough, and less than twice 10 s.
    #[test]
    fn longer_trials_are_longer_than_those_that_were_made() {
        let advice = |trials| Unreached { expected: Some(2.3), trials, ..Unreached::of(1e-3, 4e-3) }.advice();
        assert_eq!([5.0, 10.0].map(advice), ["look longer by --seconds 19", "look longer by --seconds 20"]);
        assert_eq!(Unreached::of(1e-3, 4e-3).advice(), "look longer by --patient");
    }
}
