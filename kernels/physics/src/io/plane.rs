//! Planar particles in files with three coordinates.

use crate::particles::Particle;

/// Largest difference of two third coordinates by rounding, relative to them.
const ROUNDING: f64 = 1e-12;

/// Sets the third coordinates to 0 if all are equal, as a plane at any height has them. Returns false if they differ.
pub(super) fn move_into_plane(particles: &mut [Particle]) -> bool {
    let height = particles.first().map_or(0.0, |first| first.position[2]);
    let is_in_plane = |particle: &Particle| (particle.position[2] - height).abs() <= ROUNDING * height.abs();
    let is_plane = particles.iter().all(is_in_plane);
    if is_plane {
        particles.iter_mut().for_each(|particle| particle.position[2] = 0.0);
    }
    is_plane
}
