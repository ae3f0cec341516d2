//! How far a step takes a mean off, by paired runs at a step and at half of it, and at other steps by the known order of the scheme.

use crate::study::trial::any_number;
use serde::{Deserialize, Serialize};
use stripmine_physics::number::significant;

/// Part of the correction of a short window that is taken for its own uncertainty: the memory of a quantity is rarely a single exponential.
const OF_CORRECTION: f64 = 0.5;

/// Windows that show as much of a bias show all of it.
const FULL: f64 = 0.95;

/// The bias of a configuration.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Bias {
    /// The longest step that was compared (time).
    pub step: f64,
    /// The mean at that step less that of the limit of short steps (the quantity's unit).
    #[serde(with = "any_number")]
    pub shift: f64,
    /// Half the width of the interval of 95 % of that.
    #[serde(with = "any_number")]
    pub bar: f64,
    /// The power of the step with which it falls.
    pub power: f64,
    /// The window over which runs were compared (time).
    #[serde(with = "any_number")]
    pub window: f64,
    /// The part of the bias that such a window shows.
    #[serde(with = "any_number")]
    pub part: f64,
    /// States from which runs were compared.
    pub starts: usize,
    /// Bias that the error of single contacts lets expect (the quantity's unit); none where particles have no contacts.
    #[serde(with = "any_number")]
    pub by_contacts: Option<f64>,
}

/// A difference at a step.
#[derive(Clone, Copy, Debug)]
pub(super) struct Seen {
    /// The step (time).
    pub(super) step: f64,
    /// The step of the reference, where it is of the same integrator (time); 0 where it is of a better one.
    pub(super) reference: f64,
    /// The difference of the means, and half the width of its interval of 95 %.
    pub(super) difference: [f64; 2],
}

/// The bias at the first step by one fit of β (h^p − h_r^p) through all differences, each with the weight of its bar.
///
/// Differences share the reference, so that their errors are not independent: the bar is that of the best one, no less.
pub(super) fn fitted(seen: &[Seen], power: f64) -> [f64; 2] {
    let terms = seen.iter().map(|it| {
        let law = it.step.powf(power) - it.reference.powf(power);
        (law, it.difference[0], it.difference[1].max(f64::MIN_POSITIVE))
    });
    let (mut upper, mut lower, mut best) = (0.0, 0.0, f64::INFINITY);
    for (law, value, bar) in terms {
        // A common factor of the weights cancels; squares of small bars would not.
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
    /// By the differences over a window (time) that shows a part of the bias.
    pub(super) fn of(seen: &[Seen], power: f64, window: f64, part: f64, starts: usize) -> Bias {
        let [drift, bar] = fitted(seen, power);
        let shift = drift / part;
        Bias {
            step: seen.first().map_or(0.0, |it| it.step),
            shift,
            bar: (bar / part).hypot(OF_CORRECTION * (shift - drift)),
            power,
            window,
            part,
            starts,
            by_contacts: None,
        }
    }

    /// The measurement, for a reader.
    pub(super) fn in_words(&self) -> String {
        format!(
            "at {} it is {} ± {}, by {} pairs of runs over {}{}",
            significant(self.step, 3),
            significant(self.shift, 2),
            significant(self.bar, 2),
            self.starts,
            significant(self.window, 2),
            match self.part < FULL {
                true => format!(", which show {} % of it", significant(100.0 * self.part, 2)),
                false => String::new(),
            }
        )
    }

    /// Whether it is beyond its bar.
    pub fn is_significant(&self) -> bool {
        self.shift.abs() > self.bar
    }

    /// The most that it is at the step that was compared, with a probability of 95 % (the quantity's unit).
    pub fn below(&self) -> f64 {
        self.shift.abs() + self.bar
    }

    /// The bias that is expected at the step that was compared (the quantity's unit).
    ///
    /// A significant one as it was seen. Of one that is not, what was seen less what its error makes of it, or what single contacts let expect,
    /// whichever is more, and never more than it is known to be below.
    pub fn expected(&self) -> f64 {
        if self.is_significant() {
            return self.shift.abs();
        }
        // The standard error is about half of the bar.
        let left = (self.shift.powi(2) - 0.25 * self.bar.powi(2)).max(0.0).sqrt();
        left.max(self.by_contacts.unwrap_or(0.0)).min(self.below())
    }

    /// The bias that is expected at a step (the quantity's unit), and the most that it is.
    pub fn at(&self, step: f64) -> Off {
        let part = (step / self.step).min(1.0).powf(self.power);
        Off { shift: part * self.expected(), below: part * self.below() }
    }
}

/// Distance of a mean from the limit of short steps.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Off {
    /// Expected distance.
    pub shift: f64,
    /// The most that it is, with a probability of 95 %.
    pub below: f64,
}

impl Off {
    /// A distance that is known.
    pub fn exactly(shift: f64) -> Off {
        Off { shift, below: shift }
    }

    /// The most that a mean is off where chance takes it off by `chance` with a probability of 95 %.
    pub fn with(self, chance: f64) -> f64 {
        self.shift + chance
    }

    /// The part of an error that is left to chance; none where there is nothing left.
    pub fn leaves(self, error: f64) -> Option<f64> {
        Some(error - self.shift).filter(|left| *left > 0.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// By hand: β = 2 at the power 2 with steps 0.2 and 0.1 and a reference at 0.05: differences 2 (0.04 − 0.0025) = 0.075 and 2 (0.01 − 0.0025) = 0.015;
    /// the bias at 0.2 is 0.08.
    #[test]
    fn one_fit_goes_through_all_differences() {
        let seen = [(0.2, 0.075, 0.001), (0.1, 0.015, 0.0005)].map(|(step, difference, bar)| Seen {
            step,
            reference: 0.05,
            difference: [difference, bar],
        });
        let [shift, bar] = fitted(&seen, 2.0);
        assert!((shift - 0.08).abs() < 1e-12, "{shift}");
        // The better of 0.001/0.0375 and 0.0005/0.0075 times 0.04.
        assert!((bar - 0.04 * 0.001 / 0.0375).abs() < 1e-12, "{bar}");
    }

    #[test]
    fn a_short_window_shows_a_part() {
        let seen = [Seen { step: 0.2, reference: 0.0, difference: [0.01, 0.002] }];
        let part = 0.567_667_641_6;
        let bias = Bias::of(&seen, 1.0, 2.0, part, 16);
        assert!((bias.shift - 0.01 / part).abs() < 1e-9 && bias.is_significant());
        let correction = 0.5 * (0.01 / part - 0.01);
        assert!((bias.bar - f64::hypot(0.002 / part, correction)).abs() < 1e-9);
        let half = bias.at(0.1);
        assert!(
            (half.shift - 0.5 * bias.shift).abs() < 1e-12 && (half.below - 0.5 * bias.below()).abs() < 1e-12
        );
        assert_eq!(bias.at(0.4), bias.at(0.2));
    }

    /// A bias that is not significant is not bought off: 0.1 ± 0.4 leaves an error of 0.3 whole.
    #[test]
    fn noise_is_no_bias() {
        let seen = [Seen { step: 0.2, reference: 0.0, difference: [0.1, 0.4] }];
        let bias = Bias::of(&seen, 1.0, 2.0, 1.0, 16);
        assert!(!bias.is_significant() && (bias.below() - 0.5).abs() < 1e-6);
        assert_eq!((bias.expected(), bias.at(0.2).leaves(0.3)), (0.0, Some(0.3)));
        // Contacts let expect more, but no more than it is known to be below.
        let of_contacts = |by_contacts| Bias { by_contacts: Some(by_contacts), ..bias }.expected();
        assert_eq!(of_contacts(0.2), 0.2);
        assert!((of_contacts(0.9) - 0.5).abs() < 1e-6);
    }
}
