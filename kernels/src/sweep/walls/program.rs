//! Forces of walls as a vector program on the lattice.

use super::contact::WallEnv;
use super::elements::ELEMENT_NUMBERS;
use crate::isa::{Array, Element, Kernel, Machine, Slot};
use crate::law::granular::EqualDiscs;
use crate::law::{Axis, Law, ObservationRequest, ParticleField};
use crate::sweep::lattice::forces::sum_array;
use crate::sweep::lattice::vectors::lattice_vector;
use std::cell::Cell;
use std::marker::PhantomData;

/// Arrays of the numbers of elements, in order.
pub const WALL_ARRAYS: [Array; ELEMENT_NUMBERS] = [
    Array::WallX,
    Array::WallY,
    Array::WallAlongX,
    Array::WallAlongY,
    Array::WallGateX,
    Array::WallGateY,
    Array::WallOtherGateX,
    Array::WallOtherGateY,
    Array::WallLimit,
    Array::WallOtherLimit,
    Array::WallVx,
    Array::WallVy,
    Array::WallNormalDamping,
    Array::WallShearDamping,
    Array::WallFriction,
];

/// Adds the forces of walls to the lattice vectors of the forces. Vector length: elements of walls in different cells.
///
/// A cell that several elements can touch is in several ranges of elements, one after the other: within a range the scatter writes each
/// cell once.
#[derive(Clone, Debug)]
pub struct WallForces<P, L> {
    law: L,
    equal: Option<EqualDiscs>,
    precision: PhantomData<P>,
}

impl<P: Element, L: Law<2>> WallForces<P, L> {
    /// Kernel for a law that reads radius and inverse mass of each disc; `equal` has those of equal discs.
    #[inline]
    pub fn new(law: L, equal: Option<EqualDiscs>) -> Self {
        WallForces { law, equal, precision: PhantomData }
    }
}

// SAFETY: the slots depend on the law and on whether discs are equal only.
unsafe impl<P: Element, L: Law<2>> Kernel for WallForces<P, L> {
    type Lane = P;

    #[inline(always)]
    fn body<M: Machine<Lane = P>>(&self, m: M) {
        m.section("disc");
        let cell = m.load_index(Slot::new(Array::WallCell));
        let zero = m.uniform(0.0);
        let gather = |array: Array| m.gather(Slot::<P>::new(array), cell, zero);
        let field = |field: ParticleField| {
            if L::FIELDS.contains(&field) { gather(lattice_vector(field)) } else { zero }
        };
        let position = [gather(Array::X), gather(Array::Y)];
        let velocity = [Axis::X, Axis::Y].map(|axis| field(ParticleField::Velocity(axis)));
        let omega = field(ParticleField::Omega);
        let [radius, inverse_mass] = match self.equal {
            Some(EqualDiscs { radius, inverse_mass }) => [m.uniform(radius), m.uniform(inverse_mass)],
            None => [field(ParticleField::Radius), field(ParticleField::InverseMass)],
        };
        m.section("element");
        let element = WALL_ARRAYS.map(|array| m.load(Slot::<P>::new(array)));
        let env = WallEnv {
            uniform: |value| m.uniform(value),
            section: |name| m.section(name),
            position,
            velocity,
            omega,
            radius,
            inverse_mass,
            element,
            asked: ObservationRequest::default(),
            sums: [Cell::new(zero), Cell::new(zero), Cell::new(zero)],
            penetration: Cell::new(zero),
            power: Cell::new(zero),
            energy: Cell::new(zero),
        };
        env.evaluate(&self.law);
        m.section("sums");
        for &sum in L::SUMS {
            let to = Slot::<P>::new(sum_array(sum));
            let before = m.gather(to, cell, zero);
            m.scatter(to, cell, before + env.sums[sum.column::<2>()].get());
        }
    }
}
