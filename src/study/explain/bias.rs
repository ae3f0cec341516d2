//! How far a step takes a mean from its limit: what a comparison at a long step shows, carried to shorter ones.

use super::any_number;
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
    #[serde(with = "any_number")]
    pub difference: f64,
    /// Half the width of the interval of 95 % of that.
    #[serde(with = "any_number")]
    pub bar: f64,
    /// The power of the step with which it falls.
    pub power: f64,
}

impl Bias {
    /// What two runs say, one at a long step, the other the reference.
    pub fn of(step: f64, own: &Known, reference: &Known, power: f64) -> Bias {
        Bias { step, difference: own.mean - reference.mean, bar: own.bar.hypot(reference.bar), power }
    }

    /// What was seen at the step that was compared.
    pub fn seen(&self) -> Off {
        self.at(self.step)
    }

    /// Whether it is within its bar, and that is more than an error: it is only thought to fall with the step.
    pub fn is_unseen_for(&self, error: f64) -> bool {
        self.difference.abs() <= self.bar && self.seen().most() > error
    }

    /// What it is taken to be at a step: what was seen, and what the reference has of it itself, the part of it that a shorter step has. Rounding by
    /// fewer digits does not fall with the step, but is far below what can be seen of a mean.
    pub fn at(&self, step: f64) -> Off {
        let part = (step / self.step).min(1.0).powf(self.power) / (1.0 - REFERENCE.powf(self.power));
        Off { shift: part * self.difference.abs(), bar: part * self.bar }
    }
}

/// What a step takes a mean off by.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Off {
    /// How far.
    pub shift: f64,
    /// Half the width of the interval of 95 % of that.
    pub bar: f64,
}

impl Off {
    /// What is off by so much.
    pub fn exactly(shift: f64) -> Off {
        Off { shift, bar: 0.0 }
    }

    /// The most that it is taken to be.
    pub fn most(self) -> f64 {
        self.with(0.0)
    }

    /// The most that a mean is off with a probability of 95 %, where its bar by chance is `chance`: what was seen adds to it, and what is not known
    /// of it scatters as chance does.
    pub fn with(self, chance: f64) -> f64 {
        self.shift + self.bar.hypot(chance)
    }

    /// The bar by chance that is left of an error; none where there is nothing left.
    pub fn leaves(self, error: f64) -> Option<f64> {
        let left = error - self.shift;
        (left > self.bar).then(|| (left * left - self.bar * self.bar).sqrt())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_left_of_an_error_makes_it_whole() {
        let off = Off { shift: 0.2, bar: 0.3 };
        let chance = off.leaves(0.7).unwrap();
        assert!((off.with(chance) - 0.7).abs() < 1e-12 && (chance - 0.4).abs() < 1e-12);
        assert!(off.most() == 0.5 && off.leaves(0.5).is_none() && off.leaves(0.1).is_none());
    }

    /// A difference of 3 at the long step, and the reference at a quarter of it has a sixteenth of the bias.
    #[test]
    fn what_a_step_takes_off_falls_with_its_power() {
        let bias = Bias { step: 0.4, difference: -3.0, bar: 1.5, power: 2.0 };
        let [long, half] = [0.4, 0.2].map(|step| bias.at(step));
        assert!((long.shift - 3.2).abs() < 1e-12 && (long.bar - 1.6).abs() < 1e-12);
        assert!((half.shift - 0.8).abs() < 1e-12 && bias.at(0.8) == long);
    }
}
