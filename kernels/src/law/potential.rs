//! Pair potentials. Each states its formulas once; cutting off, shifting and sweeping are shared by all.

use super::{Axis::X, Axis::Y, Env, Law, LawTable, ParticleField, ParticleSum};
use crate::isa::Vector;

/// A potential U(r) of two particles: it vanishes at large distance, and grows without bound and ever more steeply at small
/// distance. One that does not states its own [`closest`](Self::closest) and [`stiffness`](Self::stiffness).
///
/// [`energy`](Self::energy), [`force`](Self::force) and [`curvature`](Self::curvature) are the textbook formulas, for theory,
/// checks and tests. [`swept_force`](Self::swept_force) and [`swept_energy`](Self::swept_energy) give the same with the
/// operations of vectors. [`CutOff`] makes a [`Law`] of both.
pub trait PairPotential: Send + Sync + 'static {
    /// U (energy) at a distance (length).
    fn energy(&self, distance: f64) -> f64;
    /// F = −dU/dr (energy/length) at a distance (length); positive for repulsion.
    fn force(&self, distance: f64) -> f64;
    /// U″ (energy/length²) at a distance (length).
    fn curvature(&self, distance: f64) -> f64;

    /// Vectors of a sweep that force and energy share.
    type Shared<V: Vector>: Copy
    where
        Self: Sized;
    /// F/r (energy/length²) from the square of the distance (length²), and vectors for [`swept_energy`](Self::swept_energy).
    fn swept_force<E: Env<2>>(&self, env: E, square: E::V) -> (E::V, Self::Shared<E::V>)
    where
        Self: Sized;
    /// U (energy) from these vectors.
    fn swept_energy<E: Env<2>>(&self, env: E, shared: Self::Shared<E::V>) -> E::V
    where
        Self: Sized;

    /// Table that sweeps read.
    fn table(&self) -> Option<&LawTable> {
        None
    }

    /// Largest stiffness |U″| (energy/length²) of a pair at a distance (length) and beyond.
    fn stiffness(&self, nearest: f64) -> f64 {
        self.curvature(nearest)
    }

    /// Closest distance (length) in a head-on collision of positive energy; 0 if the potential never reaches that energy.
    fn closest(&self, energy: f64) -> f64 {
        let (mut near, mut far): (f64, f64) = (1.0, 1.0);
        while self.energy(far) > energy {
            far *= 2.0;
        }
        while near > 0.0 && self.energy(near) < energy {
            near *= 0.5;
        }
        loop {
            let middle = 0.5 * (near + far);
            if middle <= near || middle >= far {
                return middle;
            }
            if self.energy(middle) < energy { far = middle } else { near = middle }
        }
    }
}

/// Law of a potential that is cut off and shifted: U(r) − U(r_c) up to the cut-off r_c, and 0 beyond.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CutOff<P> {
    potential: P,
    /// r_c (length).
    cutoff: f64,
    /// r_c² (length²).
    square: f64,
    /// U(r_c) (energy).
    shift: f64,
}

impl<P: PairPotential> CutOff<P> {
    /// Cuts off a potential at a distance (length).
    #[inline]
    pub fn new(potential: P, cutoff: f64) -> Self {
        CutOff { square: cutoff * cutoff, shift: potential.energy(cutoff), potential, cutoff }
    }

    /// The original potential.
    pub fn potential(&self) -> &P {
        &self.potential
    }

    /// r_c (length).
    pub fn cutoff(&self) -> f64 {
        self.cutoff
    }

    /// U(r) − U(r_c) (energy) at a distance (length); 0 beyond the cut-off.
    pub fn energy(&self, distance: f64) -> f64 {
        if distance < self.cutoff { self.potential.energy(distance) - self.shift } else { 0.0 }
    }

    /// F (energy/length) at a distance (length); 0 beyond the cut-off.
    pub fn force(&self, distance: f64) -> f64 {
        if distance < self.cutoff { self.potential.force(distance) } else { 0.0 }
    }
}

impl<P: PairPotential + Clone> Law<2> for CutOff<P> {
    type Own<V: Copy> = [V; 2];

    const FIELDS: &'static [ParticleField] = &[];
    const SUMS: &'static [ParticleSum] = &[ParticleSum::Force(X), ParticleSum::Force(Y)];

    #[inline(always)]
    fn own<E: Env<2>>(&self, env: E) -> [E::V; 2] {
        env.own_position()
    }

    /// Evaluates F/r times the vector between the particles.
    #[inline(always)]
    fn pair<E: Env<2>>(&self, env: E, partner: E::Partner, own: &[E::V; 2]) {
        let uniform = |value: f64| env.uniform(value);
        env.section("distance");
        let [dx, dy] = env.displacement(*own, partner);
        let square = dx * dx + dy * dy;
        let within = square.less_than(uniform(self.square));
        // A kernel on the lattice also visits each particle itself and empty cells, all at infinity.
        if env.none(within) {
            return;
        }
        env.section("force");
        let zero = uniform(0.0);
        let (force, shared) = self.potential.swept_force(env, square);
        let strength = E::V::select(within, force, zero);
        env.section("sums");
        for (sum, along) in [(ParticleSum::Force(X), dx), (ParticleSum::Force(Y), dy)] {
            env.add_product(sum, partner, strength, along);
        }
        if env.observes_energy() {
            env.section("energy");
            let share = if E::BOTH_PARTNERS { 1.0 } else { 0.5 };
            let potential = self.potential.swept_energy(env, shared) - uniform(self.shift);
            env.energy(E::V::select(within, potential * uniform(share), zero));
            env.virial(E::V::select(within, strength * square * uniform(share), zero));
        }
    }
}
