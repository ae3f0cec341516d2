//! State of a run as studies compare it: particles by id, and differences between two states of one scene.

use serde::{Deserialize, Serialize};
use stripmine_physics::domain::Domain;
use stripmine_physics::method::Prepared;
use stripmine_physics::particles::{Particle, ParticleKind, Particles, in_space};

/// A moving particle.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
struct MovingParticle {
    position: [f64; 2],
    velocity: [f64; 2],
    omega: f64,
    radius: f64,
    mass: f64,
}

/// The moving particles, by id.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct ParticleState(Vec<MovingParticle>);

impl ParticleState {
    /// Extracts the state from particles of a simulation.
    pub(super) fn of(particles: &Particles) -> ParticleState {
        let mut grains: Vec<&Particle> = particles.grains().iter().collect();
        grains.sort_by_key(|grain| grain.id);
        let body = |grain: &&Particle| {
            let Particle { omega, radius, mass, .. } = **grain;
            MovingParticle {
                position: grain.planar_position(),
                velocity: grain.planar_velocity(),
                omega,
                radius,
                mass,
            }
        };
        ParticleState(grains.iter().map(body).collect())
    }

    pub(super) fn len(&self) -> usize {
        self.0.len()
    }

    /// The centres (length).
    pub(super) fn positions(&self) -> impl Iterator<Item = [f64; 2]> {
        self.0.iter().map(|body| body.position)
    }

    /// Root mean square distance between the particles of two states, and the largest (length).
    pub(super) fn distance(&self, other: &ParticleState, domain: &Domain) -> [f64; 2] {
        let squares = self.0.iter().zip(&other.0).map(|(a, b)| {
            let displacement = domain.displacement(a.position, b.position);
            displacement.iter().map(|part| part * part).sum::<f64>()
        });
        let (sum, largest) = squares.fold((0.0, 0.0), |(sum, largest): (f64, f64), square| {
            // NaN counts as the largest distance.
            (sum + square, if square <= largest || largest.is_nan() { largest } else { square })
        });
        [(sum / self.0.len().max(1) as f64).sqrt(), largest.sqrt()]
    }

    /// Root mean square speed (length/time).
    pub(super) fn speed(&self) -> f64 {
        let squares: f64 =
            self.0.iter().map(|body| body.velocity.iter().map(|part| part * part).sum::<f64>()).sum();
        (squares / self.0.len().max(1) as f64).sqrt()
    }

    /// Momentum, and the sum of its magnitudes (mass · length/time).
    pub(crate) fn momentum(&self) -> ([f64; 2], f64) {
        let sum = |axis: usize| self.0.iter().map(|body| body.mass * body.velocity[axis]).sum();
        let scale = self.0.iter().map(|body| body.mass * body.velocity[0].hypot(body.velocity[1])).sum();
        ([sum(0), sum(1)], scale)
    }

    /// Angular momentum about the corner of the box, and the sum of the magnitudes of its parts (mass · length²/time); none in a
    /// box with periodic sides, where it is undefined.
    pub(crate) fn angular_momentum(&self, domain: &Domain, inertia: Option<f64>) -> Option<(f64, f64)> {
        if domain.periodic().contains(&true) {
            return None;
        }
        let parts = self.0.iter().flat_map(|body| {
            let [x, y] = [0, 1].map(|axis| body.position[axis] - domain.origin[axis]);
            let [u, v] = body.velocity;
            let spin = inertia.map_or(0.0, |factor| factor * body.mass * body.radius.powi(2) * body.omega);
            [body.mass * x * v, -body.mass * y * u, spin]
        });
        Some(parts.fold((0.0, 0.0), |(sum, scale), part| (sum + part, scale + part.abs())))
    }

    /// Relative velocity of two particles (length/time) and the distance of their surfaces (length); none unless there are
    /// exactly two.
    pub(super) fn pair(&self, domain: &Domain) -> Option<([f64; 2], f64)> {
        let [a, b] = self.0.as_slice() else { return None };
        let displacement = domain.displacement(a.position, b.position);
        let relative = [0, 1].map(|axis| b.velocity[axis] - a.velocity[axis]);
        Some((relative, displacement[0].hypot(displacement[1]) - a.radius - b.radius))
    }
}

/// Displaces each moving particle along x and y by `by` (length), a function of its index.
pub(crate) fn displaced(
    particles: &Particles,
    domain: &Domain,
    by: impl Fn(usize, &Particle) -> [f64; 2],
) -> Particles {
    let mut moved = particles.clone();
    for (i, grain) in
        moved.all_mut().iter_mut().enumerate().filter(|(_, grain)| grain.kind == ParticleKind::Grain)
    {
        let displacement = by(i, grain);
        let position = [0, 1].map(|axis| grain.position[axis] + displacement[axis]);
        grain.position = in_space(domain.wrapped(position));
    }
    moved
}

/// Delays a scene: its particles first fly freely for a time.
pub(crate) fn delayed_scene(scene: &Prepared, late: f64) -> Prepared {
    let begin = displaced(scene.particles(), &scene.domain, |_, disc| {
        disc.planar_velocity().map(|part| -late * part)
    });
    scene.model.started_from(begin)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn particles(positions: [[f64; 2]; 2]) -> Particles {
        let disc = |(id, position)| Particle {
            id,
            kind: ParticleKind::Grain,
            species: 0,
            position: in_space(position),
            velocity: [f64::from(id), 0.0, 0.0],
            angle: 0.0,
            omega: 2.0,
            radius: 0.5,
            mass: 2.0,
        };
        Particles::new([2, 1].into_iter().zip(positions).map(disc).collect())
    }

    /// By hand.
    #[test]
    fn states_are_compared_by_id_across_periodic_sides() {
        let mut domain = Domain::planar([0.0; 2], [10.0; 2], [true, false]);
        let [a, b] =
            [[[9.5, 1.0], [4.0, 4.0]], [[0.5, 1.0], [4.0, 4.0]]].map(|at| ParticleState::of(&particles(at)));
        assert_eq!(a.distance(&b, &domain), [0.5f64.sqrt(), 1.0]);
        // A particle at NaN has an undefined distance.
        let lost = ParticleState::of(&particles([[9.5, 1.0], [f64::NAN, 4.0]]));
        assert!(a.distance(&lost, &domain).iter().all(|distance| distance.is_nan()));
        assert_eq!((a.momentum(), a.angular_momentum(&domain, None)), (([6.0, 0.0], 6.0), None));
        domain = Domain::planar([0.0; 2], [10.0; 2], [false; 2]);
        // −m y u: 2·1·2 and 2·4·1; spin: ½·2·¼·2 each.
        assert_eq!(a.angular_momentum(&domain, Some(0.5)), Some((-12.0 + 1.0, 13.0)));
        let (relative, gap) = b.pair(&domain).unwrap();
        assert_eq!((relative, gap), ([1.0, 0.0], (3.5f64 * 3.5 + 9.0).sqrt() - 1.0));
    }
}
