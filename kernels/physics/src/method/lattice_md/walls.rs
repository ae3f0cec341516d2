//! Prescribed motion of walls.

use super::GranularModel;
use crate::method::pairwise::PrescribedMotion;
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

/// Power of moving walls (energy/time), if energy is tracked. All walls have one velocity, and their force on the grains is the sum of the grains'
/// forces, because those between grains cancel. Forces are in the scene's order, grains first.
pub(super) fn wall_power(
    model: &GranularModel,
    motion: WallMotion,
    time: f64,
    grains: usize,
    forces: impl FnOnce() -> Vec<[f64; 3]>,
) -> f64 {
    if motion == WallMotion::Fixed || !model.follows_energy() {
        return 0.0;
    }
    let PrescribedMotion { velocity, .. } = walls_at(motion, time);
    let forces = forces();
    let along = |axis: usize| velocity[axis] * forces[..grains].iter().map(|force| force[axis]).sum::<f64>();
    along(0) + along(1)
}
