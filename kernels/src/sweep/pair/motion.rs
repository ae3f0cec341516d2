//! Motion of a pair under a law: kinetic energy and trajectory.

use super::{Pair, PairBody, dot};
use crate::law::Law;

/// Rates of change of a body's position, velocity and angular velocity.
type BodyRates = [f64; 5];

impl PairBody {
    /// Kinetic energy of motion and spin; 0 for a fixed disc.
    #[inline]
    fn kinetic_energy(&self) -> f64 {
        if self.inverse_mass == 0.0 {
            return 0.0;
        }
        let rim = self.radius * self.omega;
        0.5 / self.inverse_mass * (dot(self.velocity, self.velocity) + 0.5 * (rim * rim))
    }

    /// The disc after `dt` at constant rates.
    #[inline]
    fn moved(self, &[vx, vy, ax, ay, angular_acceleration]: &BodyRates, dt: f64) -> PairBody {
        PairBody {
            position: [self.position[0] + dt * vx, self.position[1] + dt * vy],
            velocity: [self.velocity[0] + dt * ax, self.velocity[1] + dt * ay],
            omega: self.omega + dt * angular_acceleration,
            ..self
        }
    }
}

impl Pair {
    /// Kinetic energy of motion and spin, with a disc's inertia ½ M R². Fixed discs count 0.
    #[inline]
    pub fn kinetic_energy(&self) -> f64 {
        self.bodies.iter().map(PairBody::kinetic_energy).sum()
    }

    /// Endless iterator over the pair's states, from the present one in steps of `dt`. Uses the classical fourth-order
    /// Runge–Kutta method and a disc's inertia ½ M R².
    #[inline]
    pub fn trajectory<L: Law<2>>(self, law: &L, dt: f64) -> impl Iterator<Item = Pair> {
        std::iter::successors(Some(self), move |pair| Some(pair.runge_kutta_step(law, dt)))
    }

    #[inline]
    fn runge_kutta_step<L: Law<2>>(self, law: &L, dt: f64) -> Pair {
        let first = self.rates(law);
        let second = self.moved(&first, 0.5 * dt).rates(law);
        let third = self.moved(&second, 0.5 * dt).rates(law);
        let fourth = self.moved(&third, dt).rates(law);
        let mean = std::array::from_fn(|i| {
            std::array::from_fn(|k| {
                (first[i][k] + 2.0 * second[i][k] + 2.0 * third[i][k] + fourth[i][k]) / 6.0
            })
        });
        self.moved(&mean, dt)
    }

    #[inline]
    fn rates<L: Law<2>>(&self, law: &L) -> [BodyRates; 2] {
        let sums = self.sums(law);
        std::array::from_fn(|i| {
            let PairBody { velocity: [vx, vy], inverse_mass, radius, .. } = self.bodies[i];
            let [fx, fy, torque] = sums[i];
            let inverse_inertia = 2.0 * inverse_mass / (radius * radius);
            [vx, vy, fx * inverse_mass, fy * inverse_mass, torque * inverse_inertia]
        })
    }

    #[inline]
    fn moved(self, rates: &[BodyRates; 2], dt: f64) -> Pair {
        Pair { bodies: std::array::from_fn(|i| self.bodies[i].moved(&rates[i], dt)) }
    }
}
