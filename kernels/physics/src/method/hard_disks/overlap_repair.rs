//! Repair of starts with rounding overlaps: if discs overlap only by the precision of their positions, all radii shrink accordingly.

use super::scene::HardDiskScene;
use crate::domain::{BoxSide, Domain};
use crate::number::significant;
use crate::particles::Particles;
use crate::scene::{DiscStart, FILE, GENERATE, POSITIONS, SceneValues, Warning};
use crate::start::deepest_overlap;

/// Tolerated overlap at the start as a fraction of the sum of the radii: rounding of double precision.
pub(super) const ROUNDING: f64 = 1e-12;
/// Largest relative reduction of the radii.
const LARGEST: f64 = 1e-6;

/// Overlaps of discs with each other and with closed sides.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct StartOverlaps {
    /// Number of overlapping pairs and of discs beyond a closed side.
    count: usize,
    /// Deepest overlap as a fraction of the radii.
    deepest: f64,
}

impl StartOverlaps {
    /// Measures the overlaps of discs in a box.
    pub(super) fn of(domain: &Domain, particles: &Particles) -> StartOverlaps {
        let (mut count, mut deepest) = deepest_overlap(domain, particles, ROUNDING, LARGEST);
        for disc in particles.all() {
            for axis in 0..2 {
                let BoxSide::Closed(side) = domain.sides[axis] else { continue };
                let along = disc.position[axis] - domain.origin[axis];
                let beyond = 1.0 - along.min(side - along) / disc.radius;
                if beyond > ROUNDING {
                    (count, deepest) = (count + 1, f64::max(deepest, beyond));
                }
            }
        }
        StartOverlaps { count, deepest }
    }

    /// True if the overlap exceeds the precision of written positions.
    pub(super) fn is_deep(&self) -> bool {
        self.deepest > LARGEST
    }

    /// Shrinks all radii until nothing overlaps, if the overlaps are within the precision of positions. Returns a warning if it did.
    pub(super) fn shrink_radii(
        &self,
        values: &SceneValues,
        scene: &HardDiskScene,
        particles: &mut Particles,
    ) -> Option<Warning> {
        if self.count == 0 || self.is_deep() {
            return None;
        }
        particles.all_mut().iter_mut().for_each(|disc| disc.radius *= 1.0 - self.deepest);
        let key = match scene.start {
            DiscStart::File(_) => &FILE,
            _ if values.is_given(&POSITIONS) => &POSITIONS,
            _ => &GENERATE,
        };
        let part = significant(self.deepest, 2);
        Some(Warning {
            check: "overlaps",
            share: f64::INFINITY,
            is_refusal: false,
            key: key.path(),
            message: format!(
                "discs overlap each other or closed sides in {} places, by up to {part} of their radii, as positions of low precision do: \
                 all radii are made smaller by this part",
                self.count
            ),
            suggestion: "write positions in full precision to keep the radii".to_owned(),
        })
    }
}
