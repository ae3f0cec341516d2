//! What the levels leave unsaid of a program: how far off they were on drill scenes, by where its arrays lay and how long the
//! vectors were; elsewhere by the scenes around.

use super::Surroundings;
use serde::{Deserialize, Serialize};

/// How far off a program was on a drill scene.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(from = "[f64; 3]", into = "[f64; 3]")]
pub struct Residual {
    /// Bytes touched between two uses of the farthest of its arrays.
    distance: f64,
    /// Elements of a vector: of all, or of a strip.
    length: f64,
    /// How many times as long as the levels say it took.
    ratio: f64,
}

impl From<[f64; 3]> for Residual {
    fn from([distance, length, ratio]: [f64; 3]) -> Residual {
        Residual { distance, length, ratio }
    }
}

impl From<Residual> for [f64; 3] {
    fn from(Residual { distance, length, ratio }: Residual) -> [f64; 3] {
        [distance, length, ratio]
    }
}

/// How far apart, as logarithms, distances and lengths are of which one says something of the other.
const ALIKE: [f64; 2] = [0.5, 0.45];
/// That the levels are right counts beforehand as much as so many scenes at the same place.
const BEFOREHAND: f64 = 0.1;

impl Residual {
    /// Of a program that found such things around it and took so many times as long, over vectors or strips of some elements.
    pub fn new(around: &Surroundings, length: usize, ratio: f64) -> Residual {
        // To so many digits: more would say nothing.
        Residual {
            distance: around.farthest().round(),
            length: length as f64,
            ratio: (1e4 * ratio).round() / 1e4,
        }
    }

    /// How many times as long as the levels say the program took.
    pub fn ratio(&self) -> f64 {
        self.ratio
    }

    /// Whether it says something.
    pub(super) fn is_sound(&self) -> bool {
        [self.distance, self.length, self.ratio].iter().all(|number| number.is_finite() && *number >= 0.0)
            && self.ratio > 0.0
    }

    /// How much it says of another place.
    fn weight(&self, around: &Surroundings, length: usize) -> f64 {
        let apart =
            |here: f64, there: f64, alike: f64| ((here.max(1.0) / there.max(1.0)).ln() / alike).powi(2);
        let [distances, lengths] = ALIKE;
        let far =
            apart(self.distance, around.farthest(), distances) + apart(self.length, length as f64, lengths);
        (-0.5 * far).exp()
    }
}

/// How many times as long as the levels say a program takes that finds such things around it, over vectors or strips of some
/// elements: a mean over all scenes, those nearby counting most; far from all of them once.
pub(super) fn ratio(scenes: &[Residual], around: &Surroundings, length: usize) -> f64 {
    let (mut sum, mut weights) = (0.0, BEFOREHAND);
    for scene in scenes {
        let weight = scene.weight(around, length);
        sum += weight * scene.ratio.ln();
        weights += weight;
    }
    (sum / weights).exp()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn scenes_nearby_say_how_far_off_the_levels_are_and_those_far_away_nothing() {
        let nowhere = Surroundings::default();
        let scenes = [(64.0, 1.2), (1024.0, 0.8)].map(|(length, ratio)| Residual::from([0.0, length, ratio]));
        let at = |length| ratio(&scenes, &nowhere, length);
        assert!((at(64) - 1.2).abs() < 0.02 && (at(1024) - 0.8).abs() < 0.02, "{} {}", at(64), at(1024));
        assert!(at(256) < at(64) && at(256) > at(1024));
        assert!((at(1_000_000) - 1.0).abs() < 1e-6 && ratio(&[], &nowhere, 64) == 1.0);
        let beside = Residual::from([1e9, 64.0, 5.0]);
        assert_eq!(ratio(&[beside], &nowhere, 64), 1.0);
    }
}
