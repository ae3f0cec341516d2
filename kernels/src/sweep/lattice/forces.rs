//! A law at every place of the mask: the force computation of BP93, section 2, step 4.

use super::shape::{Coordinates, Frame, LatticeShape};
use super::vectors::arrays;
use crate::GROUP;
use crate::isa::{Array, Counter, Element, Machine, Slot, Text, Vector};
use crate::law::{Env, Field, Law, Sum};
use crate::mask::Mask;
use std::cell::Cell;
use std::marker::PhantomData;

/// A place of the mask.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Neighbour {
    /// Elements from the own cell.
    shift: isize,
    /// From the own cell's centre to this one's (length); 0 for absolute positions.
    way: [f64; 2],
}

/// Runs `law` over the places of a mask for every cell of the lattice. Vector length: [`LatticeShape::swept`].
///
/// With a full mask every pair is met from both sides and each adds to its own sums, place by place in the mask's
/// order, whatever the vector length. With a half mask (`HALF`) each pair is met once: the partner's share goes into
/// arrays of its own, whose order of summation is that of groups of [`GROUP`] cells, so that only executions in such
/// groups exist; [`Join`] finishes the sums.
#[derive(Clone, Debug)]
pub struct Forces<P, L, const HALF: bool> {
    law: L,
    places: Vec<Neighbour>,
    relative: bool,
    watched: Option<f64>,
    dissipation: bool,
    precision: PhantomData<P>,
}

/// Counts cells with a contact deeper than watched. Written by [`Forces`] that [`watch`](Forces::watching).
pub const DEEP: Counter = Counter(2);

impl<P: Element, L: Law<2>, const HALF: bool> Forces<P, L, HALF> {
    /// The program for a law, a mask and a lattice.
    ///
    /// # Panics
    /// If the mask is not of the kind (full or half) that `HALF` says.
    pub fn new(law: L, mask: &Mask, shape: LatticeShape, frame: Frame, coordinates: Coordinates) -> Self {
        assert_eq!(
            mask.covers_both_ways(),
            !HALF,
            "a half mask for a half sweep, a full one for a full sweep"
        );
        let relative = coordinates == Coordinates::CellRelative;
        let places = mask.offsets().iter().map(|&offset| Neighbour {
            shift: shape.shift(offset),
            way: [f64::from(offset.columns) * frame.edge[0], f64::from(offset.rows) * frame.edge[1]],
        });
        Forces {
            law,
            places: places.collect(),
            relative,
            watched: None,
            dissipation: false,
            precision: PhantomData,
        }
    }

    /// The same program, which also writes the penetration of each cell's deepest contact to the array `deepest` and counts
    /// the cells with one deeper than `depth` (length) in [`DEEP`].
    #[must_use]
    pub fn watching(self, depth: f64) -> Self {
        Forces { watched: Some(depth), ..self }
    }

    /// The same program, which also writes what each disc's contacts dissipate (energy/time) to the array `power`, half of it
    /// where both discs may move and have one mass.
    #[must_use]
    pub fn counting_dissipation(self) -> Self {
        Forces { dissipation: true, ..self }
    }
}

/// Where sums go: of the own disc, and of the partner.
const fn sum_arrays(sum: Sum) -> (Array, Array) {
    match sum {
        Sum::Fx => (Array::Fx, Array::PartnerFx),
        Sum::Fy => (Array::Fy, Array::PartnerFy),
        Sum::Torque => (Array::Torque, Array::PartnerTorque),
    }
}

/// What the law sees: one strip of cells and the vectors around it.
struct Around<M: Machine, const HALF: bool> {
    machine: M,
    relative: bool,
    watches: bool,
    deepest: Cell<M::V>,
    dissipation: bool,
    power: Cell<M::V>,
    sums: [Cell<M::V>; Sum::ALL.len()],
}

impl<M: Machine, const HALF: bool> Env<2> for &Around<M, HALF> {
    type V = M::V;
    type Place = Neighbour;
    const BOTH_PARTNERS: bool = HALF;

    #[inline(always)]
    fn own_position(self) -> [M::V; 2] {
        let m = self.machine;
        let mut x = m.load(Slot::<M::Lane>::new(Array::X));
        if HALF {
            // A halo cell repeats a disc that is the own one elsewhere: as the own cell it must meet nobody.
            let interior = m.load(Slot::<M::Lane>::new(Array::Interior));
            let far = m.uniform(0.0) - m.load(Slot::<M::Lane>::new(Array::FarX));
            x = M::V::select(m.uniform(0.0).less_than(interior), x, far);
        }
        [x, m.load(Slot::<M::Lane>::new(Array::Y))]
    }

    #[inline(always)]
    fn own(self, field: Field) -> M::V {
        self.machine.load(Slot::<M::Lane>::new(arrays(field).1))
    }

    #[inline(always)]
    fn displacement(self, own: [M::V; 2], place: Neighbour) -> [M::V; 2] {
        let m = self.machine;
        let mut x = own[0] - m.load_shifted(Slot::<M::Lane>::new(Array::X), place.shift);
        let mut y = own[1] - m.load_shifted(Slot::<M::Lane>::new(Array::Y), place.shift);
        if self.relative {
            x = x - m.uniform(place.way[0]);
            y = y - m.uniform(place.way[1]);
        }
        [x, y]
    }

    #[inline(always)]
    fn partner(self, field: Field, place: Neighbour) -> M::V {
        self.machine.load_shifted(Slot::<M::Lane>::new(arrays(field).1), place.shift)
    }

    #[inline(always)]
    fn uniform(self, value: f64) -> M::V {
        self.machine.uniform(value)
    }

    #[inline(always)]
    fn none(self, predicate: M::P) -> bool {
        // The faithful sweep is branch-free; meeting each pair once, an empty group is left early.
        HALF && self.machine.none(predicate)
    }

    #[inline(always)]
    fn own_add(self, sum: Sum, value: M::V) {
        let cell = &self.sums[sum as usize];
        cell.set(cell.get() + value);
    }

    #[inline(always)]
    fn partner_sub(self, sum: Sum, place: Neighbour, value: M::V) {
        let slot = Slot::<M::Lane>::new(sum_arrays(sum).1);
        let m = self.machine;
        m.store_shifted(slot, place.shift, m.load_shifted(slot, place.shift) - value);
    }

    #[inline(always)]
    fn watches(self) -> bool {
        self.watches
    }

    #[inline(always)]
    fn watch(self, penetration: M::V) {
        self.deepest.set(self.deepest.get().max(penetration));
    }

    #[inline(always)]
    fn counts_dissipation(self) -> bool {
        self.dissipation
    }

    #[inline(always)]
    fn dissipate(self, power: M::V) {
        self.power.set(self.power.get() + power);
    }

    #[inline(always)]
    fn section(self, name: &'static str) {
        self.machine.section(name);
    }
}

// SAFETY: slots and shifts depend on the law, the places and the coordinates only; where `none` lets the law leave, it
// names fewer.
unsafe impl<P: Element, L: Law<2>, const HALF: bool> Text for Forces<P, L, HALF> {
    type Lane = P;
    const GROUP: Option<usize> = if HALF { Some(GROUP) } else { None };
    const IN_BLOCKS: bool = true;

    #[inline(always)]
    fn body<M: Machine<Lane = P>>(&self, m: M) {
        m.section("own disc");
        let zero = m.uniform(0.0);
        let around = Around::<M, HALF> {
            machine: m,
            relative: self.relative,
            watches: self.watched.is_some(),
            deepest: Cell::new(zero),
            dissipation: self.dissipation,
            power: Cell::new(zero),
            sums: [Cell::new(zero), Cell::new(zero), Cell::new(zero)],
        };
        let own = self.law.own(&around);
        for &place in &self.places {
            self.law.pair(&around, place, &own);
        }
        m.section("sums");
        for &sum in self.law.sums() {
            m.store(Slot::<P>::new(sum_arrays(sum).0), around.sums[sum as usize].get());
        }
        if self.dissipation {
            m.store(Slot::<P>::new(Array::Power), around.power.get());
        }
        if let Some(depth) = self.watched {
            m.section("watch");
            // A halo cell has false neighbours across the ends of the rows.
            let interior = zero.less_than(m.load(Slot::<P>::new(Array::Interior)));
            let deepest = M::V::select(interior, around.deepest.get(), zero);
            m.store(Slot::<P>::new(Array::Deepest), deepest);
            m.count(DEEP, m.uniform(depth).less_than(deepest));
        }
    }
}

/// Adds what partners in the halo received to the cells they are images of, and joins the own and the partners' sums.
///
/// The halo is folded image by image in the order of [`LatticeShape::images`], which no execution changes.
#[derive(Clone, Copy, Debug)]
pub struct Join<P> {
    sums: &'static [Sum],
    precision: PhantomData<P>,
}

impl<P: Element> Join<P> {
    /// For the sums of a law.
    pub fn new(sums: &'static [Sum]) -> Self {
        Join { sums, precision: PhantomData }
    }

    /// Folds one padded array of partners' sums: the halo cells' shares go home.
    ///
    /// # Panics
    /// If `partners` is shorter than the padded lattice.
    pub fn fold(shape: &LatticeShape, partners: &mut [P]) {
        assert!(partners.len() >= shape.padded(), "{} of {} elements", partners.len(), shape.padded());
        for image in shape.images() {
            partners[image.source] = partners[image.source] + partners[image.cell];
        }
    }
}

// SAFETY: the slots depend on the sums only.
unsafe impl<P: Element> Text for Join<P> {
    type Lane = P;

    #[inline(always)]
    fn body<M: Machine<Lane = P>>(&self, m: M) {
        m.section("join");
        for &sum in self.sums {
            let (own, partner) = sum_arrays(sum);
            let (own, partner) = (Slot::<P>::new(own), Slot::<P>::new(partner));
            m.store(own, m.load(own) + m.load(partner));
        }
    }
}
