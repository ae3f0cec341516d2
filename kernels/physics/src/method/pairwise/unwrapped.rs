//! Conversion of a state's discs to particles of the scene.

use crate::domain::Domain;
use crate::particles::{Particles, in_space};
use stripmine_kernels::in_pieces;

/// Returns the particles of `start` in a given state: each disc has its number in the scene and, for each degree of freedom (x, y, angle), its value
/// and rate. Discs that no force moves get the velocity `walls` (length/time).
///
/// Positions are those of the state: the last correction may have moved one beyond a periodic side without a counted crossing.
pub(crate) fn unwrapped(
    start: &Particles,
    walls: [f64; 2],
    discs: impl Iterator<Item = (usize, [[f64; 2]; 3])>,
) -> Particles {
    let mut particles = start.clone();
    let grains = start.grain_count();
    for (number, [x, y, angle]) in discs {
        let particle = &mut particles.all_mut()[number];
        particle.position = in_space([x[0], y[0]]);
        if number < grains {
            particle.velocity = in_space([x[1], y[1]]);
            particle.angle = angle[0];
            particle.omega = angle[1];
        } else {
            particle.velocity = in_space(walls);
        }
    }
    particles
}

/// Wraps the positions of particles into the box.
pub(crate) fn wrapped(mut particles: Particles, domain: &Domain) -> Particles {
    in_pieces(particles.all_mut(), |_, piece| {
        piece.iter_mut().for_each(|particle| particle.position = domain.wrapped(particle.position));
    });
    particles
}
