//! Discs of a start that overlap by no more than the digits of their positions: their radii are made smaller by as much.

use super::scene::Scene;
use crate::domain::{Domain, Side};
use crate::number::significant;
use crate::particles::Particles;
use crate::scene::{FILE, GENERATE, POSITIONS, Start, Values, Warning};
use crate::start::deepest_overlap;

/// Discs may overlap by this part of the sum of their radii at the start: rounding of double precision.
pub(super) const ROUNDING: f64 = 1e-12;
/// Radii are made smaller by no larger part.
const LARGEST: f64 = 1e-6;

/// How far discs overlap each other, and reach beyond closed sides.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Squeeze {
    /// Pairs and ends of sides of which it is true.
    count: usize,
    /// The deepest of them, as a part of the radii.
    deepest: f64,
}

impl Squeeze {
    /// Of discs in a box.
    pub(super) fn of(domain: &Domain, particles: &Particles) -> Squeeze {
        let (mut count, mut deepest) = deepest_overlap(domain, particles, ROUNDING, LARGEST);
        for disc in particles.all() {
            for axis in 0..2 {
                let Side::Closed(side) = domain.sides[axis] else { continue };
                let along = disc.position[axis] - domain.origin[axis];
                let beyond = 1.0 - along.min(side - along) / disc.radius;
                if beyond > ROUNDING {
                    (count, deepest) = (count + 1, f64::max(deepest, beyond));
                }
            }
        }
        Squeeze { count, deepest }
    }

    /// Whether it is more than digits leave out.
    pub(super) fn is_deep(&self) -> bool {
        self.deepest > LARGEST
    }

    /// Makes radii so much smaller that nothing overlaps, where that is as little as digits leave out; a word of it if it was done.
    pub(super) fn undone(
        &self,
        values: &Values,
        scene: &Scene,
        particles: &mut Particles,
    ) -> Option<Warning> {
        if self.count == 0 || self.is_deep() {
            return None;
        }
        particles.all_mut().iter_mut().for_each(|disc| disc.radius *= 1.0 - self.deepest);
        let key = match scene.start {
            Start::File(_) => &FILE,
            _ if values.gives(&POSITIONS) => &POSITIONS,
            _ => &GENERATE,
        };
        let part = significant(self.deepest, 2);
        Some(Warning {
            check: "overlaps",
            share: f64::INFINITY,
            is_refusal: false,
            key: key.path(),
            message: format!(
                "discs overlap each other or closed sides in {} places, by up to {part} of their radii, as positions of few digits do: all \
                 radii are made smaller by this part",
                self.count
            ),
            suggestion: "write positions with all digits to keep the radii".to_owned(),
        })
    }
}
