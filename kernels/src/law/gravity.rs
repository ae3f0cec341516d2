//! Softened gravity between bodies, PWP.

use super::{Axis, Env, Law, ParticleField, ParticleSum};
use crate::isa::Vector;

/// Attraction of two masses, `F = −m_i m_j d/(|d|² + ε²)^{3/2}` with d from the partner to the own body; the constant of gravity
/// is 1. With `RATE` also dF/dt, for Hermite's scheme.
///
/// # As printed
/// The printed force lacks the vector and the power of the softened distance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gravity<const RATE: bool = false> {
    /// Softening length ε (length); 0 for points.
    pub softening: f64,
}

/// Quantities of the own body.
#[derive(Clone, Copy, Debug)]
pub struct OwnBody<V> {
    position: [V; 3],
    velocity: Option<[V; 3]>,
    /// −m.
    minus_mass: V,
}

const VELOCITY: [ParticleField; 3] =
    [ParticleField::Velocity(Axis::X), ParticleField::Velocity(Axis::Y), ParticleField::Velocity(Axis::Z)];
const FORCE: [ParticleSum; 3] =
    [ParticleSum::Force(Axis::X), ParticleSum::Force(Axis::Y), ParticleSum::Force(Axis::Z)];
const FORCE_RATE: [ParticleSum; 3] =
    [ParticleSum::ForceRate(Axis::X), ParticleSum::ForceRate(Axis::Y), ParticleSum::ForceRate(Axis::Z)];

impl<const RATE: bool> Law<3> for Gravity<RATE> {
    type Own<V: Copy> = OwnBody<V>;
    const FIELDS: &'static [ParticleField] = if RATE {
        &[ParticleField::Mass, VELOCITY[0], VELOCITY[1], VELOCITY[2]]
    } else {
        &[ParticleField::Mass]
    };
    const SUMS: &'static [ParticleSum] = if RATE {
        &[FORCE[0], FORCE[1], FORCE[2], FORCE_RATE[0], FORCE_RATE[1], FORCE_RATE[2]]
    } else {
        &FORCE
    };

    #[inline(always)]
    fn own<E: Env<3>>(&self, env: E) -> OwnBody<E::V> {
        OwnBody {
            position: env.own_position(),
            velocity: if RATE { Some(VELOCITY.map(|velocity| env.own(velocity))) } else { None },
            minus_mass: env.uniform(0.0) - env.own(ParticleField::Mass),
        }
    }

    #[inline(always)]
    fn pair<E: Env<3>>(&self, env: E, partner: E::Partner, own: &OwnBody<E::V>) {
        env.section("distance");
        let displacement = env.displacement(own.position, partner);
        let softened = env.uniform(self.softening * self.softening);
        let [dx, dy, dz] = displacement;
        let square = dx.times_plus(dx, dy.times_plus(dy, dz.times_plus(dz, softened)));
        env.section("attraction");
        let inverse_cube = square.inverse_three_halves(env.uniform(1.0));
        let attraction = own.minus_mass * env.partner(ParticleField::Mass, partner) * inverse_cube;
        for axis in 0..3 {
            env.add_product(FORCE[axis], partner, displacement[axis], attraction);
        }
        if let Some([u, v, w]) = own.velocity {
            env.section("rate");
            let [u_there, v_there, w_there] = VELOCITY.map(|velocity| env.partner(velocity, partner));
            let change = [u - u_there, v - v_there, w - w_there];
            // With s = |d|² + ε²: d/dt (d s^(−3/2)) = (d' − 3 (d·d')/s d) s^(−3/2), and 1/s = (s s^(−3/2))².
            let along = dx.times_plus(change[0], dy.times_plus(change[1], dz * change[2]));
            let inverse_root = square * inverse_cube;
            let shrinking = env.uniform(-3.0) * along * inverse_root * inverse_root;
            for axis in 0..3 {
                let rate = displacement[axis].times_plus(shrinking, change[axis]);
                env.add_product(FORCE_RATE[axis], partner, rate, attraction);
            }
        }
        if env.observes_energy() {
            env.section("energy");
            let share = if E::BOTH_PARTNERS { attraction } else { attraction * env.uniform(0.5) };
            // −m_i m_j/√s, and d · F.
            env.energy(share * square);
            env.virial(share * (square - softened));
        }
    }
}
