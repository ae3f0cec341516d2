//! The law between a disc and an element of a wall.

use super::elements::ELEMENT_NUMBERS;
use crate::isa::{Element, Predicate, Vector};
use crate::law::{
    Env, Law, LawTable, ObservationRequest, ParticleField, ParticleSum, StatedEnv, WallCoefficient,
};
use std::cell::Cell;

/// Displacement of an element that does not count (length): no disc is as large, and its square is finite in single precision.
const NOWHERE: f64 = 1e18;

/// Environment of a law that evaluates discs and elements of walls, one of each a lane.
pub(super) struct WallEnv<V, U, N> {
    pub(super) uniform: U,
    pub(super) section: N,
    pub(super) position: [V; 2],
    pub(super) velocity: [V; 2],
    pub(super) omega: V,
    pub(super) radius: V,
    pub(super) inverse_mass: V,
    pub(super) element: [V; ELEMENT_NUMBERS],
    pub(super) asked: ObservationRequest,
    pub(super) sums: [Cell<V>; ParticleSum::PLANAR.len()],
    pub(super) penetration: Cell<V>,
    pub(super) power: Cell<V>,
    pub(super) energy: Cell<V>,
}

impl<V: Vector, U: Fn(f64) -> V + Copy, N: Fn(&'static str) + Copy> WallEnv<V, U, N> {
    /// Evaluates the law.
    #[inline(always)]
    pub(super) fn evaluate<L: Law<2>>(&self, law: &L) {
        let env = StatedEnv::new(self, law);
        let own = law.own(env);
        law.pair(env, (), &own);
    }
}

impl<V: Vector, U: Fn(f64) -> V + Copy, N: Fn(&'static str) + Copy> Env<2> for &WallEnv<V, U, N> {
    type V = V;
    type Partner = ();
    const BOTH_PARTNERS: bool = false;

    #[inline(always)]
    fn own_position(self) -> [V; 2] {
        self.position
    }
    #[inline(always)]
    fn own(self, field: ParticleField) -> V {
        match field {
            ParticleField::Velocity(axis) => self.velocity[axis as usize % 2],
            ParticleField::Omega => self.omega,
            ParticleField::Radius => self.radius,
            ParticleField::InverseMass => self.inverse_mass,
            ParticleField::Mass => self.uniform(1.0) / self.inverse_mass,
            ParticleField::Occupied => self.uniform(1.0),
        }
    }
    #[inline(always)]
    fn displacement(self, own: [V; 2], (): ()) -> [V; 2] {
        let [x, y, along_x, along_y, gate_x, gate_y, other_x, other_y, limit, other_limit, ..] = self.element;
        let [u, v] = [own[0] - x, own[1] - y];
        let along = u * along_x + v * along_y;
        let counts = (u * gate_x + v * gate_y)
            .less_than(limit)
            .and((u * other_x + v * other_y).less_than(other_limit));
        let nowhere = self.uniform(NOWHERE);
        [V::select(counts, u - along * along_x, nowhere), v - along * along_y]
    }
    #[inline(always)]
    fn partner(self, field: ParticleField, (): ()) -> V {
        match field {
            ParticleField::Velocity(axis) => self.element[10 + axis as usize % 2],
            _ => self.uniform(0.0),
        }
    }
    #[inline(always)]
    fn coefficient(self, which: WallCoefficient, _: f64) -> V {
        self.element[12 + which as usize]
    }
    #[inline(always)]
    fn uniform(self, value: f64) -> V {
        (self.uniform)(value)
    }
    #[expect(clippy::unreachable, reason = "the contact law has no table")]
    #[inline]
    fn lookup<const COLUMNS: usize>(self, _: &LawTable, _: [usize; COLUMNS], _: V) -> [V; COLUMNS] {
        unreachable!("a law of contacts has no table")
    }
    #[inline(always)]
    fn none(self, _: V::Predicate) -> bool {
        false
    }
    #[inline(always)]
    fn own_add(self, sum: ParticleSum, value: V) {
        let cell = &self.sums[sum.column::<2>()];
        cell.set(cell.get() + value);
    }
    #[expect(clippy::unreachable, reason = "called only if `Env::BOTH_PARTNERS`")]
    #[inline]
    fn partner_sub(self, _: ParticleSum, (): (), _: V) {
        unreachable!("a wall has no sums of its own")
    }
    #[inline(always)]
    fn watches(self) -> bool {
        self.asked.watched.is_some()
    }
    #[inline(always)]
    fn watch(self, penetration: V) {
        self.penetration.set(penetration);
    }
    #[inline(always)]
    fn counts_dissipation(self) -> bool {
        self.asked.dissipation
    }
    #[inline(always)]
    fn dissipate(self, power: V) {
        self.power.set(power);
    }
    #[inline(always)]
    fn observes_energy(self) -> bool {
        self.asked.energy
    }
    #[inline(always)]
    fn energy(self, energy: V) {
        self.energy.set(energy);
    }
    #[inline(always)]
    fn virial(self, _: V) {}
    #[inline(always)]
    fn section(self, name: &'static str) {
        (self.section)(name);
    }
}

/// Disc that may touch an element, its position from where that of the element is measured.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TouchingDisc<P> {
    /// Position (length).
    pub position: [P; 2],
    /// Velocity (length/time).
    pub velocity: [P; 2],
    /// Angular velocity (1/time).
    pub omega: P,
    /// Radius (length).
    pub radius: P,
    /// Inverse mass.
    pub inverse_mass: P,
}

/// Contact of a disc with an element.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WallContact<P> {
    /// Force on the disc along x and y, and torque.
    pub sums: [P; 3],
    /// Penetration (length).
    pub penetration: P,
    /// Power that it dissipates (energy/time).
    pub power: P,
    /// Energy that it stores.
    pub energy: P,
}

/// Evaluates a law for one disc and one element; none if they do not touch. The sums have the bits of [`WallForces`](super::WallForces).
#[inline]
pub fn touch<P: Element, L: Law<2>>(
    law: &L,
    disc: &TouchingDisc<P>,
    element: &[P; ELEMENT_NUMBERS],
) -> Option<WallContact<P>> {
    let zero = P::from_f64(0.0);
    let TouchingDisc { position, velocity, omega, radius, inverse_mass } = *disc;
    let env = WallEnv {
        uniform: P::from_f64,
        section: |_: &'static str| {},
        position,
        velocity,
        omega,
        radius,
        inverse_mass,
        element: *element,
        asked: ObservationRequest { watched: Some(0.0), dissipation: true, energy: true },
        sums: [Cell::new(zero), Cell::new(zero), Cell::new(zero)],
        penetration: Cell::new(zero),
        power: Cell::new(zero),
        energy: Cell::new(zero),
    };
    env.evaluate(law);
    let penetration = env.penetration.get();
    zero.less_than(penetration).then(|| WallContact {
        sums: env.sums.each_ref().map(Cell::get),
        penetration,
        power: env.power.get(),
        energy: env.energy.get(),
    })
}
