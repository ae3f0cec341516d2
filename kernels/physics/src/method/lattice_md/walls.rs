//! Prescribed motion of walls.

use super::Model;
use crate::method::pairwise::Prescribed;
use crate::scene::WallMotion;

/// Motion of all wall discs at a time.
pub(super) fn walls_at(motion: WallMotion, time: f64) -> Prescribed {
    match motion {
        WallMotion::Fixed => Prescribed::default(),
        WallMotion::Oscillating { amplitude, frequency } => {
            let rate = std::f64::consts::TAU * frequency;
            // Portable sine and cosine give the same bits on every platform.
            let (sine, cosine) = (libm::sin(rate * time), libm::cos(rate * time));
            Prescribed {
                displacement: amplitude.map(|a| a * sine),
                velocity: amplitude.map(|a| a * rate * cosine),
            }
        }
    }
}

/// Power of moving walls (energy/time), if energy is tracked. All walls have one velocity, and their force on the grains is the sum of the grains'
/// forces, because those between grains cancel. Forces are in the scene's order, grains first.
pub(super) fn wall_power(
    model: &Model,
    motion: WallMotion,
    time: f64,
    grains: usize,
    forces: impl FnOnce() -> Vec<[f64; 3]>,
) -> f64 {
    if motion == WallMotion::Fixed || !model.follows_energy() {
        return 0.0;
    }
    let Prescribed { velocity, .. } = walls_at(motion, time);
    let forces = forces();
    let along = |axis: usize| velocity[axis] * forces[..grains].iter().map(|force| force[axis]).sum::<f64>();
    along(0) + along(1)
}
