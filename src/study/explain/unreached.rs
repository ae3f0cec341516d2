//! Why an error is not reached, and which is known.

use super::words::seconds;
use std::fmt::{self, Display, Formatter};
use stripmine_physics::number::significant;

/// No plan reaches the error that is asked for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Unreached {
    /// What was asked for (the quantity's unit).
    pub wanted: f64,
    /// The least error that is known to be reached (the quantity's unit); infinite where none is.
    pub least: f64,
    /// Wall seconds of the plan that would reach it if the bias fell with the step as it should, where the trials did not see that.
    pub takes: Option<f64>,
    /// Seconds of trials in which the bias of a step should be seen, where these saw none.
    pub enough: Option<f64>,
}

impl Display for Unreached {
    fn fmt(&self, out: &mut Formatter<'_>) -> fmt::Result {
        if let Some(takes) = self.takes {
            write!(
                out,
                "a run of about {} would, if the bias fell with the step as it should, which the trials did not see; ",
                seconds(takes)
            )?;
        }
        if self.least.is_finite() {
            write!(out, "the best error that is known is {}", significant(self.least, 2))
        } else {
            write!(out, "the trials saw the bias of no step")
        }
    }
}
