//! Why an error is not reached, and the error that is.

use super::words::seconds;
use std::fmt::{self, Display, Formatter};
use stripmine_physics::number::significant;

/// No plan reaches the error that is asked for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Unreached {
    /// The error that was asked for (the quantity's unit).
    pub wanted: f64,
    /// The error to which the trials know the mean (the quantity's unit); not a number where it should keep its value.
    pub known: f64,
    /// The least error that is known to be reached (the quantity's unit); infinite where none is.
    pub least: f64,
    /// Wall seconds of a run that is expected to reach it, by the trend of the steps that were tried.
    pub expected: Option<f64>,
    /// Wall seconds of the plan that would reach it, and the most that a plan may take.
    pub takes: Option<[f64; 2]>,
}

impl Unreached {
    /// Of an error that was asked for, and the least that is known.
    pub(super) fn of(wanted: f64, least: f64) -> Unreached {
        Unreached { wanted, known: f64::NAN, least, expected: None, takes: None }
    }

    /// Advice: trials that are long enough for the run that is expected to reach it, or any that are longer.
    pub(super) fn advice(&self) -> String {
        match (self.takes, self.expected) {
            (Some(_), _) => "raise --limit".to_owned(),
            (None, Some(run)) => {
                format!("look longer by --seconds {}", significant((TIMES_RUN * run).ceil(), 2))
            }
            (None, None) => "look longer by --patient".to_owned(),
        }
    }
}

/// Trials that take so many times as long as a run come to it, by way of runs with longer steps.
const TIMES_RUN: f64 = 4.0;

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
