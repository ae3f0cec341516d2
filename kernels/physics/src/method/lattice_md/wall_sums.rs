//! Impulses on plane walls since the start, and forces and torques now.

use super::model::GranularModel;
use crate::method::pairwise::{PlaneWalls, PrescribedMotion, WallTouch};

/// Impulses of the grains on each wall since the start, and the forces of the last step.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct WallSums {
    /// Impulse on each wall along x and y (mass · length/time).
    pub(super) impulses: Vec<[f64; 2]>,
    /// Force on each wall along x and y.
    pub(super) forces: Vec<[f64; 2]>,
}

/// Names of the sums of a wall in checkpoints.
const SAVED: [&str; 4] = ["impulse_x", "impulse_y", "force_x", "force_y"];

impl WallSums {
    /// Sums at the start, with its forces.
    pub(super) fn starting_with(walls: &PlaneWalls, touches: &[WallTouch]) -> WallSums {
        let count = walls.all().len();
        WallSums { impulses: vec![[0.0; 2]; count], forces: forces(count, touches) }
    }

    /// Replaces the forces of the last step, before a step that does not continue it.
    pub(super) fn restart(&mut self, touches: &[WallTouch]) {
        self.forces = forces(self.forces.len(), touches);
    }

    /// Adds the impulses of a step of `dt` (time) by the trapezoidal rule, as the integrators do.
    pub(super) fn add(&mut self, dt: f64, touches: &[WallTouch]) {
        if self.impulses.is_empty() {
            return;
        }
        let now = forces(self.forces.len(), touches);
        for ((impulse, before), now) in self.impulses.iter_mut().zip(&self.forces).zip(&now) {
            (0..2).for_each(|axis| impulse[axis] += 0.5 * dt * (before[axis] + now[axis]));
        }
        self.forces = now;
    }

    /// All sums by name, for a checkpoint.
    pub(super) fn entries(&self, walls: &PlaneWalls) -> Vec<(String, f64)> {
        let each = walls.all().iter().zip(self.impulses.iter().zip(&self.forces));
        let each = each.flat_map(|(wall, (impulse, force))| {
            let values = [impulse[0], impulse[1], force[0], force[1]];
            SAVED.into_iter().zip(values).map(|(name, value)| (format!("wall.{}.{name}", wall.label), value))
        });
        each.collect()
    }

    /// Restores sums from what [`entries`](Self::entries) returned.
    ///
    /// # Errors
    /// As `find`, which returns a sum by its name.
    pub(super) fn from_entries(
        walls: &PlaneWalls,
        find: impl Fn(&str) -> Result<f64, String>,
    ) -> Result<WallSums, String> {
        let mut sums = WallSums::default();
        for wall in walls.all() {
            let value = |name: &str| find(&format!("wall.{}.{name}", wall.label));
            sums.impulses.push([value(SAVED[0])?, value(SAVED[1])?]);
            sums.forces.push([value(SAVED[2])?, value(SAVED[3])?]);
        }
        Ok(sums)
    }
}

/// Forces of the grains on each wall.
fn forces(count: usize, touches: &[WallTouch]) -> Vec<[f64; 2]> {
    let mut forces = vec![[0.0; 2]; count];
    for touch in touches {
        let force = &mut forces[touch.wall as usize];
        (0..2).for_each(|axis| force[axis] -= touch.sums[axis]);
    }
    forces
}

/// Force along x and y on each wall, and torque about its middle.
pub(super) fn forces_and_torques(
    model: &GranularModel,
    touches: &[(WallTouch, [f64; 2])],
    motions: &[PrescribedMotion],
) -> Vec<[f64; 3]> {
    let (walls, domain) = (&model.walls, model.domain());
    let mut all = vec![[0.0; 3]; walls.all().len()];
    for (touch, at) in touches {
        let number = touch.wall as usize;
        let [x, y] = domain.displacement(walls.middle_at(number, motions), *at);
        let [fx, fy] = [-touch.sums[0], -touch.sums[1]];
        let sums = &mut all[number];
        (sums[0], sums[1], sums[2]) = (sums[0] + fx, sums[1] + fy, sums[2] + x * fy - y * fx);
    }
    all
}
