//! Bias of a mean by the time step, from paired runs at a step and at half of it; other steps follow from the order of the scheme.

use crate::study::trial::{Window, any_number, shown_part, steady_bias};
use serde::{Deserialize, Serialize};
use stripmine_physics::averages::mean_of_independent;
use stripmine_physics::number::significant;

/// Part of the correction for a short window that counts as its uncertainty: the memory of a quantity is rarely a single exponential.
const OF_CORRECTION: f64 = 0.5;

/// Two measurements disagree if they differ by this many error bars: about three standard errors.
const SURE: f64 = 1.5;

/// A significant bias disagrees with the estimate from single collisions if it is this many times larger: collisions alone do not say how a quantity
/// responds to them.
const DISAGREES: f64 = 4.0;

/// A window that shows this part of a bias counts as showing all of it.
const FULL: f64 = 0.95;

/// Bias of a configuration by its time step.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Bias {
    /// Longest step compared (time).
    pub step: f64,
    /// Mean at that step less the mean in the limit of short steps (the quantity's unit).
    #[serde(with = "any_number")]
    pub shift: f64,
    /// Half the width of its 95 % confidence interval.
    #[serde(with = "any_number")]
    pub bar: f64,
    /// Power of the step that the bias is proportional to.
    pub(crate) power: f64,
    /// Window over which runs were compared (time).
    #[serde(with = "any_number")]
    pub window: f64,
    /// Part of the bias that such a window shows.
    #[serde(with = "any_number")]
    pub part: f64,
    /// Number of states that the paired runs started from.
    pub starts: usize,
    /// Bias from paired runs and its error bar; none where no pair finished.
    pub pairs: Option<[f64; 2]>,
    /// Bias from the shadow energy and its error bar; none where there is no such energy.
    pub shadow: Option<[f64; 2]>,
    /// Magnitude of the bias from single collisions; none where particles do not touch.
    pub collisions: Option<f64>,
    /// Growth of the bias by energy drift, where that accumulates along a run (per unit of time).
    #[serde(with = "any_number")]
    pub(crate) creep: f64,
}

/// Difference of means at a step, for a window.
#[derive(Clone, Copy, Debug)]
pub(super) struct StepDifference {
    /// The step (time).
    pub(super) step: f64,
    /// Step of the reference, where it uses the same integrator (time); 0 where it uses a better one.
    pub(super) reference: f64,
    /// Difference over the window.
    pub(super) shown: f64,
    /// Estimated difference of the steady state, or of a whole run, and half the width of its 95 % interval.
    pub(super) difference: [f64; 2],
}

impl StepDifference {
    /// Estimates the difference of case `case` from a window and the one before, for a quantity with a memory (time) and for the mean over a run
    /// that shows part `of_run` of the steady-state bias.
    pub(super) fn of(
        [before, window]: [&Window; 2],
        case: usize,
        (memory, of_run): (f64, f64),
        (step, reference): (f64, f64),
    ) -> StepDifference {
        let parts = [window, before].map(|it| shown_part(it.time, memory));
        let pairs = window.differences[case].iter().zip(&before.differences[case]);
        let told: Vec<f64> = pairs
            .map(|(now, before)| {
                let [bias, at_once] = steady_bias([*now, *before], parts);
                of_run * bias + (1.0 - of_run) * at_once
            })
            .collect();
        let shown = &window.differences[case];
        StepDifference {
            step,
            reference,
            shown: shown.iter().sum::<f64>() / shown.len() as f64,
            difference: mean_of_independent(&told).map_or([f64::NAN, f64::INFINITY], Into::into),
        }
    }
}

/// Returns the bias at the first step and its error bar, by a single weighted fit of β (h^p − h_r^p) to all differences.
///
/// The differences share the reference, so their errors are correlated: the error bar is that of the best difference, no smaller.
pub(super) fn fitted(seen: &[StepDifference], power: f64) -> [f64; 2] {
    let terms = seen.iter().map(|it| {
        let law = it.step.powf(power) - it.reference.powf(power);
        (law, it.difference[0], it.difference[1].max(f64::MIN_POSITIVE))
    });
    let (mut upper, mut lower, mut best) = (0.0, 0.0, f64::INFINITY);
    for (law, value, bar) in terms {
        // A common factor of the weights cancels; squares of small error bars would not.
        let weight = (law / bar).powi(2);
        upper += weight * value / law;
        lower += weight;
        best = f64::min(best, bar / law.abs());
    }
    let Some(first) = seen.first().filter(|_| lower > 0.0 && lower.is_finite()) else {
        let exact = seen.first().map_or(0.0, |it| it.difference[0]);
        return [exact, 0.0];
    };
    [upper / lower, best].map(|value| value * first.step.powf(power))
}

impl Bias {
    /// Estimates the bias from the differences at some steps over a window (time) that shows `part` of it.
    pub(super) fn of(seen: &[StepDifference], power: f64, window: f64, part: f64, starts: usize) -> Bias {
        let [shift, bar] = fitted(seen, power);
        let shown = seen.first().map_or(0.0, |it| it.shown);
        Bias {
            step: seen.first().map_or(0.0, |it| it.step),
            shift,
            bar: bar.hypot(OF_CORRECTION * (shift - shown)),
            power,
            window,
            part,
            starts,
            pairs: None,
            shadow: None,
            collisions: None,
            creep: 0.0,
        }
        .with_pairs()
    }

    fn with_pairs(self) -> Bias {
        Bias { pairs: Some([self.shift, self.bar]), ..self }
    }

    /// Combines the bias with the one from the shadow energy at a step (time), each weighted by its error bar. If they disagree, paired runs
    /// are used and the difference is added to their error bar.
    #[must_use]
    pub(super) fn with_shadow(self, step: f64, [shift, bar]: [f64; 2]) -> Bias {
        let scale = (self.step / step).powf(self.power);
        let shadow = [scale * shift, scale * bar];
        let known = Bias { shadow: Some(shadow), ..self };
        let Some([of_pairs, pairs_bar]) = self.pairs else {
            return Bias { shift: shadow[0], bar: shadow[1], ..known };
        };
        if !known.agrees() {
            return Bias { bar: pairs_bar.hypot(shadow[0] - of_pairs), ..known };
        }
        let weights = [pairs_bar, shadow[1]].map(|bar| bar.max(f64::MIN_POSITIVE).powi(-2));
        let both = weights[0] + weights[1];
        if !both.is_finite() {
            return known;
        }
        Bias {
            shift: (weights[0] * of_pairs + weights[1] * shadow[0]) / both,
            bar: both.sqrt().recip(),
            ..known
        }
    }

    /// Adds the magnitude of the bias from single collisions (the quantity's unit).
    #[must_use]
    pub(super) fn with_collisions(self, collisions: Option<f64>) -> Bias {
        Bias { collisions, ..self }
    }

    /// Adds the growth of the bias by energy drift at a step (per unit of time).
    #[must_use]
    pub(super) fn with_creep(self, step: f64, creep: f64) -> Bias {
        Bias { creep: (self.step / step).powf(self.power) * creep, ..self }
    }

    /// True unless paired runs and the shadow energy differ by more than their error bars.
    fn agrees(&self) -> bool {
        self.pairs
            .zip(self.shadow)
            .is_none_or(|(pairs, shadow)| (pairs[0] - shadow[0]).abs() <= SURE * pairs[1].hypot(shadow[1]))
    }

    /// Unknown bias of a step (time) for which no paired runs exist.
    pub(super) fn unknown(step: f64, power: f64) -> Bias {
        Bias {
            step,
            shift: 0.0,
            bar: f64::INFINITY,
            power,
            window: 0.0,
            part: 0.0,
            starts: 0,
            pairs: None,
            shadow: None,
            collisions: None,
            creep: 0.0,
        }
    }

    /// Describes the measurement in words.
    pub(super) fn in_words(&self) -> String {
        let both = |[shift, bar]: [f64; 2]| format!("{} ± {}", significant(shift, 2), significant(bar, 2));
        let mut words = match self.pairs {
            None => "no paired runs finished within the trial time (use --patient for more)".to_owned(),
            Some(pairs) => format!(
                "at a step of {} it is {}, from {} paired runs over a time of {}{}",
                significant(self.step, 3),
                both(pairs),
                self.starts,
                significant(self.window, 2),
                match self.part < FULL {
                    true => format!(", which show {} % of it", significant(100.0 * self.part, 2)),
                    false => String::new(),
                }
            ),
        };
        if let Some(shadow) = self.shadow {
            let but = if self.agrees() { "" } else { ", which disagrees" };
            words.push_str(&format!("; {} from the shadow energy{but}", both(shadow)));
        }
        if let Some(collisions) = self.collisions {
            let but = match self.shift.abs() - self.bar > DISAGREES * collisions {
                true => ", too small to explain it",
                false if self.below() < collisions => ", larger than measured",
                false => "",
            };
            words.push_str(&format!("; about {} from single collisions{but}", significant(collisions, 2)));
        }
        if self.creep > 0.0 {
            words.push_str(&format!("; energy drift adds {} per unit of time", significant(self.creep, 2)));
        }
        words
    }

    /// True if the bias exceeds its error bar.
    pub(crate) fn is_significant(&self) -> bool {
        self.shift.abs() > self.bar
    }

    /// Upper bound of the bias at the compared step, with 95 % confidence (the quantity's unit).
    pub(crate) fn below(&self) -> f64 {
        self.shift.abs() + self.bar
    }

    /// Expected bias at the compared step (the quantity's unit).
    ///
    /// A significant bias counts as measured; from any other the contribution of its statistical error is subtracted.
    pub(crate) fn expected(&self) -> f64 {
        if self.is_significant() {
            return self.shift.abs();
        }
        // The standard error is about half of the error bar. Of an unknown bias only the estimate from collisions is left, limited by the measured
        // bound.
        let measured = (self.shift.powi(2) - 0.25 * self.bar.powi(2)).max(0.0).sqrt();
        measured.max(self.collisions.unwrap_or(0.0).min(self.below()))
    }

    /// Ratio of the bias at a step (time) to that at the compared step.
    fn part_at(&self, step: f64) -> f64 {
        (step / self.step).powf(self.power)
    }

    /// Measured bias at a step (the quantity's unit), and half the width of its 95 % interval.
    pub(super) fn measured_at(&self, step: f64) -> [f64; 2] {
        [self.shift, self.bar].map(|value| self.part_at(step) * value)
    }

    /// Bias at a step from paired runs (the quantity's unit), and its error bar.
    pub(super) fn pairs_at(&self, step: f64) -> Option<[f64; 2]> {
        self.pairs.map(|both| both.map(|value| self.part_at(step) * value))
    }

    /// Bias at a step from the shadow energy (the quantity's unit), and its error bar.
    pub(super) fn shadow_at(&self, step: f64) -> Option<[f64; 2]> {
        self.shadow.map(|both| both.map(|value| self.part_at(step) * value))
    }

    /// Magnitude of the bias at a step from single collisions (the quantity's unit).
    pub(super) fn collisions_at(&self, step: f64) -> Option<f64> {
        self.collisions.map(|size| self.part_at(step) * size)
    }

    /// Expected bias at a step (the quantity's unit), and its upper bound.
    pub(crate) fn at(&self, step: f64) -> BiasEstimate {
        self.over(step, 0.0)
    }

    /// Returns the expected bias of a run of a given length (time) at a step, and its upper bound. Both grow with the length where energy drifts.
    pub(crate) fn over(&self, step: f64, time: f64) -> BiasEstimate {
        let [part, creep] = [1.0, self.creep * time].map(|it| self.part_at(step) * it);
        BiasEstimate { shift: part * self.expected() + creep, below: part * self.below() + creep }
    }
}

/// Distance of a mean from its limit at short steps.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub(crate) struct BiasEstimate {
    /// Expected distance.
    pub shift: f64,
    /// Upper bound, with 95 % confidence.
    pub below: f64,
}

impl BiasEstimate {
    /// A distance known exactly.
    pub(crate) fn exactly(shift: f64) -> BiasEstimate {
        BiasEstimate { shift, below: shift }
    }

    /// Total error of the mean, with a statistical error of `chance` at 95 % confidence.
    pub(crate) fn with_statistical_error(self, chance: f64) -> f64 {
        self.shift + chance
    }

    /// Part of an error left to statistics; none where the bias uses it up.
    pub(crate) fn error_left_to_statistics(self, error: f64) -> Option<f64> {
        Some(error - self.shift).filter(|left| *left > 0.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn seen(step: f64, reference: f64, difference: [f64; 2]) -> StepDifference {
        StepDifference { step, reference, shown: difference[0], difference }
    }

    /// By hand: β = 2 at the power 2 with steps 0.2 and 0.1 and a reference at 0.05: differences 2 (0.04 − 0.0025) = 0.075 and 2 (0.01 − 0.0025) = 0.015;
    /// the bias at 0.2 is 0.08.
    #[test]
    fn bias_is_fitted_to_all_differences() {
        let [shift, bar] = fitted(&[seen(0.2, 0.05, [0.075, 0.001]), seen(0.1, 0.05, [0.015, 0.0005])], 2.0);
        assert!((shift - 0.08).abs() < 1e-12, "{shift}");
        // The better of 0.001/0.0375 and 0.0005/0.0075 times 0.04.
        assert!((bar - 0.04 * 0.001 / 0.0375).abs() < 1e-12, "{bar}");
    }

    /// Half of the correction for a short window is added to the error bar: here 0.5 (0.02 − 0.01).
    #[test]
    fn a_bias_falls_with_the_step() {
        let bias =
            Bias::of(&[StepDifference { shown: 0.01, ..seen(0.2, 0.0, [0.02, 0.002]) }], 1.0, 2.0, 0.5, 16);
        assert!((bias.shift - 0.02).abs() < 1e-12 && bias.is_significant());
        assert!((bias.bar - f64::hypot(0.002, 0.005)).abs() < 1e-12);
        let half = bias.at(0.1);
        assert!((half.shift - 0.01).abs() < 1e-12 && (half.below - 0.5 * bias.below()).abs() < 1e-12);
        assert!((bias.at(0.4).shift - 0.04).abs() < 1e-12);
    }

    /// An unknown bias neither shortens the step nor counts as small.
    #[test]
    fn an_unknown_bias_has_no_bound() {
        let bias = Bias::unknown(0.2, 1.0);
        assert!(!bias.is_significant() && bias.expected() == 0.0 && bias.at(0.1).below.is_infinite());
    }

    /// A bias within its error bar does not shorten the step: 0.1 ± 0.4 leaves an error of 0.3 whole.
    #[test]
    fn insignificant_bias_counts_as_noise() {
        let bias = Bias::of(&[seen(0.2, 0.0, [0.1, 0.4])], 1.0, 2.0, 1.0, 16);
        assert!(!bias.is_significant() && (bias.below() - 0.5).abs() < 1e-6);
        assert_eq!((bias.expected(), bias.at(0.2).error_left_to_statistics(0.3)), (0.0, Some(0.3)));
    }

    /// By hand: error bars of 0.3 and 0.1 have the weights 1 and 9; at twice the step, with power 2, the shadow energy predicts four times as much.
    #[test]
    fn pairs_and_the_shadow_energy_are_weighed() {
        let pairs = Bias::of(&[seen(0.2, 0.0, [1.0, 0.3])], 2.0, 1.0, 1.0, 16);
        let both = pairs.with_shadow(0.1, [0.3, 0.025]);
        assert!((both.shift - (1.0 + 9.0 * 1.2) / 10.0).abs() < 1e-12, "{both:?}");
        assert!((both.bar - (1.0 / (1.0 / 0.09 + 100.0_f64)).sqrt()).abs() < 1e-12, "{both:?}");
        let apart = pairs.with_shadow(0.2, [2.0, 0.1]);
        assert!(apart.shift == 1.0 && (apart.bar - 0.3_f64.hypot(1.0)).abs() < 1e-12, "{apart:?}");
        assert!(apart.in_words().contains("which disagrees"), "{}", apart.in_words());
        let alone = Bias::unknown(0.2, 2.0).with_shadow(0.2, [0.5, 0.1]);
        assert_eq!([alone.shift, alone.bar], [0.5, 0.1]);
    }

    /// By hand: 10⁻³ per unit of time at the step 0.1 is 4·10⁻³ at 0.2 with the power 2, and adds 0.04 in a time of 10.
    #[test]
    fn energy_drift_accumulates_along_a_run() {
        let bias = Bias::of(&[seen(0.2, 0.0, [1.0, 0.1])], 2.0, 1.0, 1.0, 16).with_creep(0.1, 1e-3);
        assert!((bias.over(0.2, 10.0).shift - 1.04).abs() < 1e-12 && bias.at(0.2).shift == 1.0);
        assert!((bias.over(0.1, 10.0).shift - 0.26).abs() < 1e-12);
        assert!(bias.in_words().contains("energy drift adds 0.004 "), "{}", bias.in_words());
    }

    /// A bias within its error bar is taken from single collisions, and is no more than the measured bound.
    #[test]
    fn collisions_estimate_an_insignificant_bias() {
        let of = |collisions: f64| {
            Bias::of(&[seen(0.2, 0.0, [0.1, 0.4])], 1.0, 2.0, 1.0, 16)
                .with_collisions(Some(collisions))
                .expected()
        };
        assert_eq!([of(0.3), of(2.0)], [0.3, 0.5]);
        let significant = Bias::of(&[seen(0.2, 0.0, [0.8, 0.1])], 1.0, 2.0, 1.0, 16);
        assert_eq!(significant.with_collisions(Some(3.0)).expected(), 0.8);
        assert_eq!(Bias::unknown(0.2, 1.0).with_collisions(Some(0.25)).expected(), 0.25);
    }
}
