//! What the levels leave unsaid of a program: how far off they were on drill scenes, by where its arrays lay and how long the
//! vectors were; elsewhere by the scenes around.

use super::Surroundings;
use serde::{Deserialize, Serialize};

/// What of a run tells how far off the levels are.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Place {
    /// Bytes touched between two uses of the farthest of the program's arrays.
    distance: f64,
    /// Elements of a strip; nought of whole vectors and of loops.
    strip: f64,
    /// Elements that the program goes over.
    elements: f64,
}

/// How far off a program was on a drill scene.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(from = "[f64; 4]", into = "[f64; 4]")]
pub struct Residual {
    place: Place,
    /// How many times as long as the levels say it took.
    ratio: f64,
}

impl From<[f64; 4]> for Residual {
    fn from([distance, strip, elements, ratio]: [f64; 4]) -> Residual {
        Residual { place: Place { distance, strip, elements }, ratio }
    }
}

impl From<Residual> for [f64; 4] {
    fn from(Residual { place: Place { distance, strip, elements }, ratio }: Residual) -> [f64; 4] {
        [distance, strip, elements, ratio]
    }
}

/// How far apart, as logarithms, distances, strips and numbers of elements are of which one says something of the other.
const ALIKE: [f64; 3] = [0.4, 0.45, 0.4];
/// That the levels are right counts beforehand as much as so many scenes at the same place.
const BEFOREHAND: f64 = 0.1;

impl Place {
    /// Of a program that finds such things around it, and goes over so many elements, in strips or not.
    pub fn new(around: &Surroundings, strip: Option<usize>, elements: usize) -> Place {
        let strip = strip.map_or(0.0, |strip| strip.min(elements) as f64);
        Place { distance: around.farthest().round(), strip, elements: elements as f64 }
    }

    /// How much what happens here says of another place.
    fn weight(&self, other: &Place) -> f64 {
        if (self.strip == 0.0) != (other.strip == 0.0) {
            return 0.0;
        }
        let [here, there] = [self, other]
            .map(|place| [place.distance, place.strip, place.elements].map(|of| of.max(1.0).ln()));
        let apart = |of: usize| ((here[of] - there[of]) / ALIKE[of]).powi(2);
        (-0.5 * (0..ALIKE.len()).map(apart).sum::<f64>()).exp()
    }
}

impl Residual {
    /// Of a program that took so many times as long.
    pub fn new(place: Place, ratio: f64) -> Residual {
        // To so many digits: more would say nothing.
        Residual { place, ratio: (1e4 * ratio).round() / 1e4 }
    }

    /// How many times as long as the levels say the program took.
    pub fn ratio(&self) -> f64 {
        self.ratio
    }

    /// Whether it says something.
    pub(super) fn is_sound(&self) -> bool {
        <[f64; 4]>::from(*self).iter().all(|number| number.is_finite() && *number >= 0.0) && self.ratio > 0.0
    }
}

/// How many times as long as the levels say a program takes: a mean over all scenes, those nearby counting most; far from all of
/// them once.
pub(super) fn ratio(scenes: &[Residual], place: &Place) -> f64 {
    let (mut sum, mut weights) = (0.0, BEFOREHAND);
    for scene in scenes {
        let weight = scene.place.weight(place);
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
        let scenes =
            [(64.0, 1.2), (1024.0, 0.8)].map(|(strip, ratio)| Residual::from([0.0, strip, 3e3, ratio]));
        let at = |strip, elements| ratio(&scenes, &Place::new(&Surroundings::default(), strip, elements));
        let [short, between, long] = [64, 256, 1024].map(|strip| at(Some(strip), 3000));
        assert!((short - 1.2).abs() < 0.02 && (long - 0.8).abs() < 0.02, "{short} {long}");
        assert!(between < short && between > long);
        // Neither of whole vectors, nor of many more elements, nor where there are no scenes.
        assert_eq!(at(None, 3000), 1.0);
        assert!((at(Some(64), 1_000_000) - 1.0).abs() < 1e-6);
        let place = Place::new(&Surroundings::default(), Some(64), 3000);
        assert_eq!((ratio(&[], &place), ratio(&[Residual::from([1e9, 64.0, 3e3, 5.0])], &place)), (1.0, 1.0));
    }
}
