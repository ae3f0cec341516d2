//! Sample pairs for tests of laws.

use super::{Pair, PairBody};
use crate::noise::Stream;
use rand::RngExt;

impl Pair {
    /// Two equal discs of radius and mass 1 at rest, which touch along x and overlap by 5 %.
    pub fn touching() -> Pair {
        Pair { bodies: [PairBody::at(0.0, 0.0), PairBody::at(1.9, 0.0)] }
    }

    /// Touching discs whose opposite spins roll on each other; the second has the given radius.
    pub fn gears(radius: f64) -> Pair {
        let mut pair = Pair::touching();
        let [first, second] = &mut pair.bodies;
        second.radius = radius;
        second.position[0] += radius - 1.0;
        first.omega = 3.0;
        second.omega = -3.0 / radius;
        pair
    }

    /// Two equal discs about to collide, with total kinetic energy ½. Their lines of flight are `offset` apart; 0 is head-on.
    pub fn colliding(offset: f64) -> Pair {
        let speed = 0.5f64.sqrt();
        let mut bodies = [PairBody::at(-1.1, 0.5 * offset), PairBody::at(1.1, -0.5 * offset)];
        bodies[0].velocity[0] = speed;
        bodies[1].velocity[0] = -speed;
        Pair { bodies }
    }

    /// A pair in contact at a random angle, 0 to 10 % deep, with random velocities, spins, radii and masses.
    pub fn random(random: &mut Stream) -> Pair {
        let mut spread = |width: f64| random.random_range(-0.5 * width..=0.5 * width);
        let radii = [1.0 + spread(0.2), 1.0 + spread(0.2)];
        let distance = (radii[0] + radii[1]) * (0.95 + spread(0.1));
        let angle = spread(std::f64::consts::TAU);
        let first = [spread(4.0), spread(4.0)];
        let second = [first[0] + distance * libm::cos(angle), first[1] + distance * libm::sin(angle)];
        let bodies = [(first, radii[0]), (second, radii[1])].map(|(position, radius)| PairBody {
            position,
            velocity: [spread(2.0), spread(2.0)],
            omega: spread(4.0),
            radius,
            inverse_mass: 1.0 / (1.0 + spread(1.0)),
        });
        Pair { bodies }
    }
}
