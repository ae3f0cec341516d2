//! Prescribed motion of walls.

use super::GranularModel;
use crate::method::pairwise::{PrescribedMotion, WallTouch};
use crate::scene::WallMotion;

/// Motion of all wall discs at a time.
pub(super) fn walls_at(motion: WallMotion, time: f64) -> PrescribedMotion {
    match motion {
        WallMotion::Fixed => PrescribedMotion::default(),
        WallMotion::Oscillating { amplitude, frequency } => {
            let rate = std::f64::consts::TAU * frequency;
            // Portable sine and cosine give the same bits on every platform.
            let (sine, cosine) = (libm::sin(rate * time), libm::cos(rate * time));
            PrescribedMotion {
                displacement: amplitude.map(|a| a * sine),
                velocity: amplitude.map(|a| a * rate * cosine),
            }
        }
    }
}

/// Power of moving wall discs (energy/time), if energy is tracked. All have one velocity, and their force on the grains is the sum of the grains'
/// forces without those of plane walls, because forces between grains cancel. Forces are those of the grains, in the scene's order.
pub(super) fn wall_power(
    model: &GranularModel,
    motion: WallMotion,
    time: f64,
    touches: &[WallTouch],
    forces: impl FnOnce() -> Vec<[f64; 3]>,
) -> f64 {
    if motion == WallMotion::Fixed || !model.follows_energy() {
        return 0.0;
    }
    let PrescribedMotion { velocity, .. } = walls_at(motion, time);
    let forces = forces();
    let along = |axis: usize| {
        let of_planes = touches.iter().map(|touch| touch.sums[axis]).sum::<f64>();
        velocity[axis] * (forces.iter().map(|force| force[axis]).sum::<f64>() - of_planes)
    };
    along(0) + along(1)
}

/// Power of moving plane walls (energy/time), if energy is tracked.
pub(super) fn plane_wall_power(
    model: &GranularModel,
    motions: &[PrescribedMotion],
    touches: &[WallTouch],
) -> f64 {
    if !model.follows_energy() {
        return 0.0;
    }
    let power = |touch: &WallTouch| {
        let [vx, vy] = motions[touch.wall as usize].velocity;
        vx * touch.sums[0] + vy * touch.sums[1]
    };
    touches.iter().map(power).sum()
}

#[cfg(test)]
mod tests;
