//! The prescribed motion of walls.

use crate::scene::WallMotion;

/// Displacement (length) and velocity (length/time) of all wall discs at a time.
pub(super) fn walls_at(motion: WallMotion, time: f64) -> ([f64; 2], [f64; 2]) {
    match motion {
        WallMotion::Fixed => ([0.0; 2], [0.0; 2]),
        WallMotion::Oscillating { amplitude, frequency } => {
            let rate = std::f64::consts::TAU * frequency;
            // The portable sine and cosine: the same bits on every platform.
            let (sine, cosine) = (libm::sin(rate * time), libm::cos(rate * time));
            (amplitude.map(|a| a * sine), amplitude.map(|a| a * rate * cosine))
        }
    }
}
