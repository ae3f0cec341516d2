//! Lattice vectors: the discs' quantities, cell by cell.

use super::shape::{Coordinates, LatticeShape};
use crate::isa::{Array, Element, Machine, Slot, Text};
use crate::law::Field;
use std::marker::PhantomData;

/// The lattice vector of a quantity.
#[inline]
pub(crate) const fn lattice_vector(field: Field) -> Array {
    match field {
        Field::Velocity(axis) => [Array::Vx, Array::Vy][axis as usize],
        Field::Omega => Array::Omega,
        Field::Radius => Array::Radius,
        Field::InverseMass => Array::InverseMass,
        Field::Mass => Array::Mass,
        Field::Occupied => Array::Test,
    }
}

/// Where a quantity stands disc by disc, and what an empty cell has.
#[inline]
const fn of_discs(field: Field) -> (Array, f64) {
    match field {
        Field::Velocity(axis) => ([Array::DiscVx, Array::DiscVy][axis as usize], 0.0),
        Field::Omega => (Array::DiscOmega, 0.0),
        Field::Radius => (Array::DiscRadius, 0.0),
        // An effective mass of two empty cells must be a number.
        Field::InverseMass => (Array::DiscInverseMass, 1.0),
        Field::Mass => (Array::DiscMass, 1.0),
        #[expect(clippy::panic, reason = "found when the program is built, by whoever writes such a law")]
        Field::Occupied => panic!("an empty cell stands far from everything: no law of ours asks"),
    }
}

/// Maps the discs' quantities to lattice vectors through the Index (BP93 section 2, step 3). Vector length: the padded
/// lattice, so that the halo is filled in the same sweep.
///
/// An empty cell gets a position far from everything, which makes every contact with it impossible, in place of the
/// source's vector Test ([`printed`](crate::printed) has it).
#[derive(Clone, Copy, Debug)]
pub struct Spread<P> {
    fields: &'static [Field],
    image_shifts: [bool; 2],
    precision: PhantomData<P>,
}

impl<P: Element> Spread<P> {
    /// For the quantities a law asks for. Absolute positions are shifted in the halo of periodic sides, which takes
    /// the arrays `image.x`, `image.y`; relative ones are repeated as they are.
    #[inline]
    pub fn new(shape: LatticeShape, coordinates: Coordinates, fields: &'static [Field]) -> Self {
        let shifts = coordinates == Coordinates::Absolute;
        Spread {
            fields,
            image_shifts: shape.periodic().map(|periodic| periodic && shifts),
            precision: PhantomData,
        }
    }
}

// SAFETY: the slots depend on the fields and the periodic sides only.
unsafe impl<P: Element> Text for Spread<P> {
    type Lane = P;

    #[inline(always)]
    fn body<M: Machine<Lane = P>>(&self, m: M) {
        m.section("gather");
        let index = m.load_index(Slot::new(Array::Index));
        for axis in 0..2 {
            let (from, to, image) =
                [(Array::DiscX, Array::X, Array::ImageX), (Array::DiscY, Array::Y, Array::ImageY)][axis];
            let elsewhere = if axis == 0 { m.load(Slot::<P>::new(Array::FarX)) } else { m.uniform(0.0) };
            let mut r = m.gather(Slot::<P>::new(from), index, elsewhere);
            if self.image_shifts[axis] {
                r = r + m.load(Slot::<P>::new(image));
            }
            m.store(Slot::<P>::new(to), r);
        }
        for &field in self.fields {
            let (from, empty) = of_discs(field);
            let to = Slot::<P>::new(lattice_vector(field));
            m.store(to, m.gather(Slot::<P>::new(from), index, m.uniform(empty)));
        }
    }
}
