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
    /// Wall seconds of the plan that would reach it, and the most that a plan may take.
    pub takes: Option<[f64; 2]>,
}

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
                write!(out, "the least error that is known is {}", significant(self.least, 2))
            }
            None => write!(out, "the bias of no step is known"),
        }
    }
}
