//! How far a step takes a mean from its limit: what a comparison at a long step shows, carried to shorter ones.

use super::sample::Known;
use serde::{Deserialize, Serialize};

/// The step of the reference in parts of the one that is held against it.
pub const REFERENCE: f64 = 0.25;

/// What a way to run a scene takes a mean off by.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Bias {
    /// The step that was compared (time).
    pub step: f64,
    /// The mean there less that of the reference (the quantity's unit).
    pub difference: f64,
    /// Half the width of the interval of 95 % of that.
    pub bar: f64,
    /// The power of the step with which it falls.
    pub power: f64,
}

impl Bias {
    /// What two runs say, one at a long step, the other the reference.
    pub fn of(step: f64, own: &Known, reference: &Known, power: f64) -> Bias {
        Bias { step, difference: own.mean - reference.mean, bar: own.bar.hypot(reference.bar), power }
    }

    /// The most that it is taken to be at a step: what was seen with its bar, and with what the reference has of it itself, the part of it that a
    /// shorter step has. Rounding by fewer digits does not fall with the step, but is far below what can be seen of a mean.
    pub fn at_most(&self, step: f64) -> f64 {
        let whole = (self.difference.abs() + self.bar) / (1.0 - REFERENCE.powf(self.power));
        whole * (step / self.step).min(1.0).powf(self.power)
    }
}
