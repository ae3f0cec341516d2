//! Evaluation of a law at every offset of the mask: the force computation of BP93, section 2, step 4.

use super::shape::{Coordinates, LatticeFrame, LatticeShape};
use super::vectors::lattice_vector;
use crate::isa::{Array, Element, Kernel, LaneCounter, Machine, Slot, Vector};
use crate::law::{Env, Law, LawTable, ObservationRequest, ParticleField, ParticleSum, StatedEnv};
use crate::mask::Mask;
use crate::sweep::lookup::rows_in_program;
use std::cell::Cell;
use std::marker::PhantomData;

/// An offset of the mask.
#[derive(Clone, Copy, Debug, PartialEq)]
struct MaskNeighbour {
    /// Distance in elements from the own cell.
    shift: isize,
    /// Vector from the own cell's centre to this one's (length); used only if positions are relative to cells.
    displacement: [f64; 2],
}

/// Evaluates `law` at the offsets of a mask for every cell of the lattice. Vector length: [`LatticeShape::swept`].
///
/// Every pair is visited from both sides, and each side adds to its own sums, offset by offset in the mask's order, for any
/// vector length.
#[derive(Clone, Debug)]
pub struct Forces<P, L> {
    law: L,
    neighbours: Vec<MaskNeighbour>,
    relative: bool,
    asked: ObservationRequest,
    precision: PhantomData<P>,
}

/// Counts cells with a contact deeper than the watched depth. Written by [`Forces`] that are [asked](Forces::asked) for it.
pub const DEEP: LaneCounter = LaneCounter(2);

impl<P: Element, L: Law<2>> Forces<P, L> {
    /// Kernel for a law, a mask and a lattice.
    ///
    /// Recording it panics if the law reads a quantity that it does not state.
    pub fn new(
        law: L,
        mask: &Mask,
        shape: LatticeShape,
        frame: LatticeFrame,
        coordinates: Coordinates,
    ) -> Self {
        let relative = coordinates == Coordinates::CellRelative;
        let neighbours = mask.offsets().iter().map(|&offset| MaskNeighbour {
            shift: shape.shift(offset),
            displacement: [f64::from(offset.columns) * frame.edge[0], f64::from(offset.rows) * frame.edge[1]],
        });
        Forces {
            law,
            neighbours: neighbours.collect(),
            relative,
            asked: ObservationRequest::default(),
            precision: PhantomData,
        }
    }

    /// Makes the kernel also write the requested observations:
    ///
    /// - watched penetrations: the deepest penetration of each cell to the array `deepest`; cells deeper than the watched depth
    ///   are counted in [`DEEP`];
    /// - dissipation: the power that each disc's contacts dissipate (energy/time) to the array `power`;
    /// - energy: stored energy and virial (energy) to the arrays `energy` and `virial`.
    ///
    /// Each disc has the share of a pair that the law defines: the sums over all mobile discs are those of the pairs.
    #[must_use]
    #[inline]
    pub fn asked(self, asked: ObservationRequest) -> Self {
        Forces { asked, ..self }
    }
}

/// Destination array of a sum.
#[inline]
pub(crate) const fn sum_array(sum: ParticleSum) -> Array {
    match sum {
        ParticleSum::Force(axis) => [Array::Fx, Array::Fy][axis as usize],
        ParticleSum::Torque => Array::Torque,
        #[expect(clippy::panic, reason = "found by the author of such a law, when the kernel is built")]
        ParticleSum::ForceRate(_) => panic!("a law of the plane states no rates of forces"),
    }
}

/// Environment of a law that evaluates one strip of cells and the vectors around it.
struct LatticeEnv<M: Machine> {
    machine: M,
    relative: bool,
    asked: ObservationRequest,
    deepest: Cell<M::V>,
    power: Cell<M::V>,
    energy: Cell<M::V>,
    virial: Cell<M::V>,
    sums: [Cell<M::V>; ParticleSum::PLANAR.len()],
}

impl<M: Machine> Env<2> for &LatticeEnv<M> {
    type V = M::V;
    type Partner = MaskNeighbour;
    const BOTH_PARTNERS: bool = false;

    #[inline(always)]
    fn own_position(self) -> [M::V; 2] {
        let m = self.machine;
        [Array::X, Array::Y].map(|axis| m.load(Slot::<M::Lane>::new(axis)))
    }

    #[inline(always)]
    fn own(self, field: ParticleField) -> M::V {
        self.machine.load(Slot::<M::Lane>::new(lattice_vector(field)))
    }

    #[inline(always)]
    fn displacement(self, own: [M::V; 2], neighbour: MaskNeighbour) -> [M::V; 2] {
        let m = self.machine;
        let mut x = own[0] - m.load_shifted(Slot::<M::Lane>::new(Array::X), neighbour.shift);
        let mut y = own[1] - m.load_shifted(Slot::<M::Lane>::new(Array::Y), neighbour.shift);
        if self.relative {
            x = x - m.uniform(neighbour.displacement[0]);
            y = y - m.uniform(neighbour.displacement[1]);
        }
        [x, y]
    }

    #[inline(always)]
    fn partner(self, field: ParticleField, neighbour: MaskNeighbour) -> M::V {
        self.machine.load_shifted(Slot::<M::Lane>::new(lattice_vector(field)), neighbour.shift)
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
        false // As in BP93, the sweep has no branches.
    }

    #[inline(always)]
    fn own_add(self, sum: ParticleSum, value: M::V) {
        let cell = &self.sums[sum.column::<2>()];
        cell.set(cell.get() + value);
    }

    #[expect(clippy::unreachable, reason = "called only if `Env::BOTH_PARTNERS`")]
    #[inline]
    fn partner_sub(self, _: ParticleSum, _: MaskNeighbour, _: M::V) {
        unreachable!("every pair is visited from both sides")
    }

    #[inline(always)]
    fn watches(self) -> bool {
        self.asked.watched.is_some()
    }

    #[inline(always)]
    fn watch(self, penetration: M::V) {
        self.deepest.set(self.deepest.get().max(penetration));
    }

    #[inline(always)]
    fn counts_dissipation(self) -> bool {
        self.asked.dissipation
    }

    #[inline(always)]
    fn dissipate(self, power: M::V) {
        self.power.set(self.power.get() + power);
    }

    #[inline(always)]
    fn observes_energy(self) -> bool {
        self.asked.energy
    }

    #[inline(always)]
    fn energy(self, energy: M::V) {
        self.energy.set(self.energy.get() + energy);
    }

    #[inline(always)]
    fn virial(self, virial: M::V) {
        self.virial.set(self.virial.get() + virial);
    }

    #[inline(always)]
    fn section(self, name: &'static str) {
        self.machine.section(name);
    }
}

// SAFETY: slots and shifts depend on the law, the offsets, the coordinates and the requested observations only.
unsafe impl<P: Element, L: Law<2>> Kernel for Forces<P, L> {
    type Lane = P;

    #[inline(always)]
    fn body<M: Machine<Lane = P>>(&self, m: M) {
        m.section("own disc");
        let zero = m.uniform(0.0);
        let around = LatticeEnv::<M> {
            machine: m,
            relative: self.relative,
            asked: self.asked,
            deepest: Cell::new(zero),
            power: Cell::new(zero),
            energy: Cell::new(zero),
            virial: Cell::new(zero),
            sums: [Cell::new(zero), Cell::new(zero), Cell::new(zero)],
        };
        let env = StatedEnv::new(&around, &self.law);
        let own = self.law.own(env);
        for &neighbour in &self.neighbours {
            self.law.pair(env, neighbour, &own);
        }
        m.section("sums");
        for &sum in L::SUMS {
            m.store(Slot::<P>::new(sum_array(sum)), around.sums[sum.column::<2>()].get());
        }
        if self.asked.dissipation {
            m.store(Slot::<P>::new(Array::Power), around.power.get());
        }
        if self.asked.energy {
            m.store(Slot::<P>::new(Array::Energy), around.energy.get());
            m.store(Slot::<P>::new(Array::Virial), around.virial.get());
        }
        if let Some(depth) = self.asked.watched {
            m.section("watch");
            // A halo cell has false neighbours across the ends of the rows.
            let interior = zero.less_than(m.load(Slot::<P>::new(Array::Interior)));
            let deepest = M::V::select(interior, around.deepest.get(), zero);
            m.store(Slot::<P>::new(Array::Deepest), deepest);
            m.count(DEEP, m.uniform(depth).less_than(deepest));
        }
    }
}
