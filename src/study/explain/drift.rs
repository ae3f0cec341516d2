//! What should keep its value and does not quite: by how much at two steps, and from that at others.

use crate::study::trial::any_number;
use serde::{Deserialize, Serialize};

/// The power of the step is taken to be no lower: noise in two values says nothing beyond.
const LEAST_POWER: f64 = 0.5;
/// A step is shortened so much that the error is this many times smaller than is asked for: two values tell its law roughly.
const MARGIN: f64 = 2.0;
/// Shorter steps than this part of the longest were not seen, and are not vouched for.
const SHORTEST: f64 = 1.0 / 1024.0;

/// How far a quantity goes from its first value in a run, at two steps.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Drift {
    /// The longer step; the other is half of it (time).
    pub step: f64,
    /// The farthest at both (the quantity's unit).
    #[serde(with = "any_number")]
    pub farthest: [f64; 2],
    /// The time that was seen (time).
    pub time: f64,
    /// The power that theory gives for positions, which is no lower: two long steps may show a steeper fall, that ends.
    pub most_power: f64,
    /// Whether it has all digits: with fewer, rounding ends the law at some step, and none below the shorter is vouched for.
    pub is_full: bool,
}

impl Drift {
    /// The same over a longer time: it goes no farther than in proportion.
    #[must_use]
    pub fn over(self, time: f64) -> Drift {
        let longer = (time / self.time).max(1.0);
        Drift { farthest: self.farthest.map(|far| longer * far), ..self }
    }

    /// The power of the step with which it falls.
    pub fn power(&self) -> f64 {
        let [long, short] = self.farthest;
        let seen = if short > 0.0 { (long / short).log2() } else { f64::INFINITY };
        seen.min(self.most_power).max(LEAST_POWER)
    }

    /// How far it goes at a step that is no longer than the first.
    pub fn at(&self, step: f64) -> f64 {
        let [long, short] = self.farthest;
        let half = 0.5 * self.step;
        if step >= self.step {
            return long;
        }
        // From the shorter one on by the law, between both whichever is larger.
        let by_law = short * (step / half).powf(self.power());
        if step > half { by_law.max(short).min(long.max(short)) } else { by_law }
    }

    /// The longest step at which it goes no farther than an error; none where that was not seen.
    pub fn step_for(&self, error: f64) -> Option<f64> {
        let shortest = if self.is_full { SHORTEST } else { 0.5 };
        let parts = (0..).map(|at| 2f64.powf(-0.25 * f64::from(at))).take_while(|part| *part >= shortest);
        parts.map(|part| part * self.step).find(|&step| MARGIN * self.at(step) <= error)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// An error of fourth order: a sixteenth at half the step.
    #[test]
    fn the_step_follows_from_the_law_of_two_errors() {
        let drift = Drift { step: 0.4, farthest: [16e-4, 1e-4], time: 10.0, most_power: 8.0, is_full: true };
        assert_eq!((drift.power(), drift.at(0.4), drift.at(0.2)), (4.0, 16e-4, 1e-4));
        assert!((drift.at(0.1) - 1e-4 / 16.0).abs() < 1e-18);
        let step = drift.step_for(2e-5).unwrap();
        assert!(2.0 * drift.at(step) <= 2e-5 && 2.0 * drift.at(1.2 * step) > 2e-5, "{step}");
        assert_eq!(drift.step_for(1.0), Some(0.4));
        assert_eq!(drift.over(20.0).at(0.2), 2e-4);
        assert_eq!(Drift { is_full: false, ..drift }.step_for(2e-5), None);
        let kinks = Drift { most_power: 2.5, ..drift };
        assert!(kinks.power() == 2.5 && kinks.at(0.1) > 2.0 * drift.at(0.1));
        // Rounding alone, which no step lowers.
        let rounding =
            Drift { step: 0.4, farthest: [1e-13, 1e-13], time: 10.0, most_power: 8.0, is_full: true };
        assert_eq!((rounding.power(), rounding.step_for(1e-20)), (0.5, None));
    }
}
