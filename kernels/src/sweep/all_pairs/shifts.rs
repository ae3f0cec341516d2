//! All pairs as whole-array operations: for every shift, each body is paired with the one that many positions behind it. PWP.

use super::is_split;
use crate::isa::{Array, Element, Kernel, Machine, Slot};
use crate::law::{Env, Law, LawTable, ParticleField, ParticleSum, StatedEnv};
use crate::sweep::lookup::rows_in_program;
use std::cell::Cell;
use std::marker::PhantomData;
use std::ops::Range;

/// Evaluates `law` between every body and those `shifts` positions behind it, cyclically. Vector length: the bodies. Arrays that
/// are read at a shift store every body twice, so that no shift wraps around.
///
/// The shifts 1 … N − 1 are all pairs, each visited from both sides; forces are added to the sums present.
#[derive(Clone, Debug)]
pub struct Shifts<P, L> {
    law: L,
    shifts: Range<usize>,
    precision: PhantomData<P>,
}

impl<P: Element, L: Law<3>> Shifts<P, L> {
    /// Kernel for a law and some shifts.
    ///
    /// Recording it panics if the law reads a quantity that bodies do not have.
    pub fn new(law: L, shifts: Range<usize>) -> Self {
        Shifts { law, shifts, precision: PhantomData }
    }
}

/// Array of a quantity of the bodies.
///
/// # Panics
/// If bodies have no such quantity.
#[inline]
pub const fn body_array(field: ParticleField) -> Array {
    match field {
        ParticleField::Mass => Array::BodyMass,
        ParticleField::Velocity(axis) => [Array::BodyVx, Array::BodyVy, Array::BodyVz][axis as usize],
        #[expect(clippy::panic, reason = "found by the author of such a law, when the kernel is built")]
        ParticleField::Omega
        | ParticleField::Radius
        | ParticleField::InverseMass
        | ParticleField::Occupied => {
            panic!("bodies have no such quantity")
        }
    }
}

/// Array of a sum of the bodies.
///
/// # Panics
/// If bodies have no such sum.
#[inline]
pub const fn body_sum_array(sum: ParticleSum) -> Array {
    match sum {
        ParticleSum::Force(axis) => [Array::BodyFx, Array::BodyFy, Array::BodyFz][axis as usize],
        ParticleSum::ForceRate(axis) => [Array::BodyRateX, Array::BodyRateY, Array::BodyRateZ][axis as usize],
        #[expect(clippy::panic, reason = "found by the author of such a law, when the kernel is built")]
        ParticleSum::Torque => panic!("bodies have no torque"),
    }
}

/// Arrays of the positions.
pub const BODY_POSITION: [Array; 3] = [Array::BodyX, Array::BodyY, Array::BodyZ];

/// Arrays of the rounding residues of the positions; read in single precision only.
pub const BODY_REST: [Array; 3] = [Array::BodyRestX, Array::BodyRestY, Array::BodyRestZ];

/// Environment of a law that evaluates one strip of bodies.
struct ShiftEnv<M: Machine> {
    machine: M,
    /// Rounding residue of the own positions; zero in double precision.
    own_rest: [M::V; 3],
    sums: [Cell<M::V>; 6],
}

impl<M: Machine> Env<3> for &ShiftEnv<M> {
    type V = M::V;
    type Partner = isize;
    const BOTH_PARTNERS: bool = false;

    #[inline(always)]
    fn own_position(self) -> [M::V; 3] {
        BODY_POSITION.map(|axis| self.machine.load(Slot::<M::Lane>::new(axis)))
    }

    #[inline(always)]
    fn own(self, field: ParticleField) -> M::V {
        self.machine.load(Slot::<M::Lane>::new(body_array(field)))
    }

    #[inline(always)]
    fn displacement(self, own: [M::V; 3], shift: isize) -> [M::V; 3] {
        let there = |axis| self.machine.load_shifted(Slot::<M::Lane>::new(axis), shift);
        std::array::from_fn(|axis| {
            let far = own[axis] - there(BODY_POSITION[axis]);
            if !const { is_split::<M::Lane>() } {
                return far;
            }
            far + (self.own_rest[axis] - there(BODY_REST[axis]))
        })
    }

    #[inline(always)]
    fn partner(self, field: ParticleField, shift: isize) -> M::V {
        self.machine.load_shifted(Slot::<M::Lane>::new(body_array(field)), shift)
    }

    #[inline(always)]
    fn uniform(self, value: f64) -> M::V {
        self.machine.uniform(value)
    }

    #[inline(always)]
    fn lookup<const N: usize>(self, _: &LawTable, columns: [usize; N], number: M::V) -> [M::V; N] {
        rows_in_program(self.machine, columns, number)
    }

    #[inline(always)]
    fn none(self, _: M::P) -> bool {
        false
    }

    #[inline(always)]
    fn own_add(self, sum: ParticleSum, value: M::V) {
        let cell = &self.sums[sum.column::<3>()];
        cell.set(cell.get() + value);
    }

    #[expect(clippy::unreachable, reason = "called only if `Env::BOTH_PARTNERS`")]
    #[inline]
    fn partner_sub(self, _: ParticleSum, _: isize, _: M::V) {
        unreachable!("every pair is visited from both sides")
    }

    #[inline(always)]
    fn watches(self) -> bool {
        false
    }

    #[inline(always)]
    fn watch(self, _: M::V) {}

    #[inline(always)]
    fn counts_dissipation(self) -> bool {
        false
    }

    #[inline(always)]
    fn dissipate(self, _: M::V) {}

    #[inline(always)]
    fn observes_energy(self) -> bool {
        false
    }

    #[inline(always)]
    fn energy(self, _: M::V) {}

    #[inline(always)]
    fn virial(self, _: M::V) {}

    #[inline(always)]
    fn section(self, name: &'static str) {
        self.machine.section(name);
    }
}

// SAFETY: slots and shifts depend on the law and the shifts only.
unsafe impl<P: Element, L: Law<3>> Kernel for Shifts<P, L> {
    type Lane = P;

    #[inline(always)]
    fn body<M: Machine<Lane = P>>(&self, m: M) {
        m.section("own body");
        let zero = m.uniform(0.0);
        let own_rest = match const { is_split::<P>() } {
            true => BODY_REST.map(|axis| m.load(Slot::<P>::new(axis))),
            false => [zero; 3],
        };
        let behind = ShiftEnv::<M> { machine: m, own_rest, sums: std::array::from_fn(|_| Cell::new(zero)) };
        let env = StatedEnv::new(&behind, &self.law);
        let own = self.law.own(env);
        for shift in self.shifts.clone() {
            self.law.pair(env, shift as isize, &own);
        }
        m.section("sums");
        for &sum in L::SUMS {
            // The sums of these shifts are added up separately, which loses fewer digits.
            let slot = Slot::<P>::new(body_sum_array(sum));
            m.store(slot, m.load(slot) + behind.sums[sum.column::<3>()].get());
        }
    }
}
