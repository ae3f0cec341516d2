//! The pair potential of Lennard-Jones, cut off and shifted, LAN17.

use super::{Axis::X, Axis::Y, Env, Field, Law, Sum};
use crate::isa::Vector;

/// Particles that repel each other as r⁻¹² and, up to the cut-off, attract as r⁻⁶: U = 4 ε ((σ/r)¹² − (σ/r)⁶) less its value at the
/// cut-off, and nothing beyond. With the cut-off at 2^(1/6) σ they only repel (WCA).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LennardJones {
    /// ε (energy).
    strength: f64,
    /// σ² (length²).
    square: f64,
    /// The square of the cut-off (length²).
    reach: f64,
    /// The potential at the cut-off (energy).
    shift: f64,
}

impl LennardJones {
    /// With ε (energy), σ and the cut-off (length).
    #[inline]
    pub fn new(strength: f64, diameter: f64, cutoff: f64) -> Self {
        let sixth = (diameter / cutoff).powi(6);
        LennardJones {
            strength,
            square: diameter * diameter,
            reach: cutoff * cutoff,
            shift: 4.0 * strength * sixth * (sixth - 1.0),
        }
    }
}

impl Law<2> for LennardJones {
    type Own<V: Copy> = [V; 2];

    const FIELDS: &'static [Field] = &[];
    const SUMS: &'static [Sum] = &[Sum::Force(X), Sum::Force(Y)];

    #[inline(always)]
    fn own<E: Env<2>>(&self, env: E) -> [E::V; 2] {
        env.own_position()
    }

    /// F = 24 ε (2 (σ/r)¹² − (σ/r)⁶)/r², times the vector between the particles.
    ///
    /// # As printed
    /// The sum multiplies the acceleration by F/m; forces are added here. A particle does not meet itself.
    #[inline(always)]
    fn pair<E: Env<2>>(&self, env: E, place: E::Place, own: &[E::V; 2]) {
        let uniform = |value: f64| env.uniform(value);
        env.section("distance");
        let [dx, dy] = env.displacement(*own, place);
        let square = dx * dx + dy * dy;
        let within = square.less_than(uniform(self.reach));
        // A program of the lattice meets each particle's own place and empty ones, all at infinity.
        if env.none(within) {
            return;
        }
        env.section("force");
        let zero = uniform(0.0);
        let inverse = uniform(1.0) / square;
        let ratio = uniform(self.square) * inverse;
        let sixth = ratio * ratio * ratio;
        let repulsion = sixth * (sixth + sixth - uniform(1.0));
        let strength = E::V::select(within, uniform(24.0 * self.strength) * repulsion * inverse, zero);
        env.section("sums");
        for (sum, along) in [(Sum::Force(X), dx), (Sum::Force(Y), dy)] {
            env.add_product(sum, place, strength, along);
        }
        if env.observes_energy() {
            env.section("energy");
            let share = if E::BOTH_PARTNERS { 1.0 } else { 0.5 };
            let potential =
                uniform(4.0 * self.strength) * (sixth * (sixth - uniform(1.0))) - uniform(self.shift);
            env.energy(E::V::select(within, potential * uniform(share), zero));
            env.virial(E::V::select(within, strength * square * uniform(share), zero));
        }
    }
}
