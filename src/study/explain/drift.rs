//! Deviation of conserved quantities over a whole run, at the steps tried.

use super::recommended::LikelyRange;
use crate::study::rounded;
use serde::{Deserialize, Serialize};

/// Largest deviation of a quantity from its first value, at one step.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct StepDeviation {
    /// The step (time).
    pub step: f64,
    /// Largest deviation over the run (the quantity's unit); infinite where the run fails.
    pub(crate) deviation: LikelyRange,
}

impl StepDeviation {
    /// Upper bound of the deviation.
    pub(crate) fn farthest(&self) -> f64 {
        self.deviation.most
    }
}

/// A run to the end of the scene.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) struct DeviationRun {
    /// Largest deviation over the run (the quantity's unit); infinite where the run fails.
    pub(super) deviation: LikelyRange,
    /// Costs; none where the run fails.
    pub(super) costs: Option<RunCosts>,
    /// Reason why it is no example to follow: its failure, or its warnings; empty where there are none.
    pub(super) faults: String,
}

/// Wall seconds until the first step, of a row, and of a unit of time, in total and in each phase.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(super) struct RunCosts {
    pub(super) start: f64,
    pub(super) row: f64,
    pub(super) unit: f64,
    pub(super) phases: Vec<(String, f64)>,
}

/// Runs of a configuration at several steps.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct StepDeviations {
    /// Runs, the longest step first.
    pub(crate) tried: Vec<StepDeviation>,
}

impl StepDeviations {
    /// Adds a run.
    pub(super) fn add(&mut self, step: f64, deviation: LikelyRange) {
        self.tried.push(StepDeviation { step, deviation });
        self.tried.sort_by(|a, b| b.step.total_cmp(&a.step));
    }

    /// Returns the longest step tried at which the deviation stays within an error at this step and at all shorter ones.
    pub(crate) fn step_for(&self, error: f64) -> Option<StepDeviation> {
        self.tried.iter().rev().take_while(|it| it.farthest() <= error).last().copied()
    }

    /// Deviation at a step that was tried.
    pub(crate) fn at(&self, step: f64) -> Option<f64> {
        self.tried.iter().find(|it| rounded(it.step, 4) == rounded(step, 4)).map(StepDeviation::farthest)
    }

    /// Smallest deviation found (the quantity's unit); infinite where no run finished.
    pub(crate) fn least(&self) -> f64 {
        self.tried.iter().map(|it| it.farthest()).fold(f64::INFINITY, f64::min)
    }

    /// Step at which the deviation is expected to reach an error, extrapolated from the two shortest steps; none where they show no trend.
    pub(super) fn expected_step(&self, error: f64) -> Option<f64> {
        let [.., long, short] = self.tried.as_slice() else { return None };
        let power = libm::log(long.farthest() / short.farthest()) / libm::log(long.step / short.step);
        let power = if power.is_finite() { power.clamp(POWERS[0], POWERS[1]) } else { return None };
        Some(short.step * libm::pow(error / short.farthest(), power.recip()))
    }

    /// Next step to try for an error. Steps are halved until the error is reached, or quartered where half is not expected to be enough.
    /// Then the interval between the longest step that reaches it and the one above is bisected. None where these are
    /// closer than [`CLOSE`], or where halving gains nothing.
    pub(super) fn next_step(&self, error: f64) -> Option<f64> {
        let shortest = self.tried.last()?;
        let Some(found) = self.step_for(error) else {
            // Only rounding is left, or chaos: two halvings in a row gain nothing.
            let gains = |pair: &[StepDeviation]| {
                pair[1].farthest() < 0.5 * pair[0].farthest() || pair[0].farthest().is_infinite()
            };
            let last = self.tried.windows(2).rev().take(2);
            let is_stuck = self.tried.len() > 4 && last.filter(|pair| !gains(pair)).count() == 2;
            let is_far = self.expected_step(error).is_some_and(|step| step < 0.25 * shortest.step);
            let part = if is_far { 0.25 } else { 0.5 };
            return (!is_stuck).then_some(rounded(part * shortest.step, 4));
        };
        let above = self.tried.iter().rev().find(|it| it.step > found.step)?;
        let middle = rounded((above.step * found.step).sqrt(), 4);
        (above.step / found.step > CLOSE).then_some(middle)
    }
}

/// Range of the power of the step that deviations are assumed to follow.
const POWERS: [f64; 2] = [0.5, 9.0];

/// Steps within this factor are not distinguished.
const CLOSE: f64 = 1.3;

#[cfg(test)]
mod tests {
    use super::*;

    fn tried(runs: &[[f64; 2]]) -> StepDeviations {
        let mut drift = StepDeviations::default();
        runs.iter().for_each(|&[step, farthest]| drift.add(step, LikelyRange::exactly(farthest)));
        drift
    }

    /// A step counts only if all shorter ones reach the error too: one long step may reach it by coincidence.
    #[test]
    fn all_shorter_steps_reach_the_error_too() {
        let drift = tried(&[[0.8, 1e-7], [0.4, 1e-5], [0.2, 1e-6], [0.1, 1e-8]]);
        assert_eq!(drift.step_for(2e-6).map(|it| it.step), Some(0.2));
        assert_eq!(drift.step_for(1e-9), None);
        assert_eq!((drift.at(0.2), drift.at(0.3), drift.least()), (Some(1e-6), None, 1e-8));
    }

    /// Half of the step until the error is reached; then 0.2·√2 between 0.2 and 0.4, and between 0.2 and that, until they are closer than 1.3.
    #[test]
    fn steps_are_halved_and_then_bisected() {
        let mut drift = tried(&[[0.8, f64::INFINITY], [0.4, 1e-5]]);
        assert_eq!(drift.next_step(1e-6), Some(0.2));
        drift.add(0.2, LikelyRange::exactly(1e-7));
        assert_eq!(drift.next_step(1e-6), Some(0.2828));
        drift.add(0.2828, LikelyRange::exactly(2e-6));
        assert_eq!(drift.next_step(1e-6), Some(0.2378));
        drift.add(0.2378, LikelyRange::exactly(9e-7));
        assert_eq!((drift.next_step(1e-6), drift.step_for(1e-6).map(|it| it.step)), (None, Some(0.2378)));
    }

    /// By hand: from 16 at 0.4 to 1 at 0.2 it falls with the fourth power, and to 1/81 at a third of the step.
    #[test]
    fn expected_step_is_extrapolated_from_two_steps() {
        let step = tried(&[[0.4, 16.0], [0.2, 1.0]]).expected_step(1.0 / 81.0).unwrap();
        assert!((step - 0.2 / 3.0).abs() < 1e-12, "{step}");
        assert_eq!(tried(&[[0.4, f64::INFINITY], [0.2, 1.0]]).expected_step(0.1), None);
    }

    /// From 16 at 0.4 to 1 at 0.2 it falls with the fourth power: an error of 10⁻² is expected at 0.063, one of 10⁻⁴ at 0.02.
    #[test]
    fn steps_are_quartered_where_an_error_is_far() {
        let drift = tried(&[[0.4, 16.0], [0.2, 1.0]]);
        assert_eq!([1e-2, 1e-4].map(|error| drift.next_step(error)), [Some(0.1), Some(0.05)]);
    }

    #[test]
    fn steps_that_gain_nothing_end_the_search() {
        let stuck = [[1.6, 1.0], [0.8, 1e-6], [0.4, 1e-13], [0.2, 1e-13], [0.1, 2e-13]];
        assert_eq!(tried(&stuck).next_step(1e-16), None);
        assert_eq!(tried(&stuck[..3]).next_step(1e-16), Some(0.2));
    }
}
