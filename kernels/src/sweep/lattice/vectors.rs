//! Lattice vectors: quantities of the discs, cell by cell.

use super::shape::{Coordinates, LatticeShape};
use crate::isa::{Array, Element, Kernel, Machine, Slot};
use crate::law::ParticleField;
use std::marker::PhantomData;

/// Lattice vector of a quantity.
#[inline]
pub(crate) const fn lattice_vector(field: ParticleField) -> Array {
    match field {
        ParticleField::Velocity(axis) => [Array::Vx, Array::Vy][axis as usize],
        ParticleField::Omega => Array::Omega,
        ParticleField::Radius => Array::Radius,
        ParticleField::InverseMass => Array::InverseMass,
        ParticleField::Mass => Array::Mass,
        ParticleField::Occupied => Array::Test,
    }
}

/// Array of a quantity disc by disc, and its value in an empty cell.
#[inline]
const fn disc_array(field: ParticleField) -> (Array, f64) {
    match field {
        ParticleField::Velocity(axis) => ([Array::DiscVx, Array::DiscVy][axis as usize], 0.0),
        ParticleField::Omega => (Array::DiscOmega, 0.0),
        ParticleField::Radius => (Array::DiscRadius, 0.0),
        // The effective mass of two empty cells must be a number.
        ParticleField::InverseMass => (Array::DiscInverseMass, 1.0),
        ParticleField::Mass => (Array::DiscMass, 1.0),
        #[expect(clippy::panic, reason = "found by the author of such a law, when the kernel is built")]
        ParticleField::Occupied => {
            panic!("no array of occupied cells: an empty cell has a position far from all discs")
        }
    }
}

/// Gathers the discs' quantities into lattice vectors through the Index (BP93 section 2, step 3). Vector length: the padded
/// lattice, so that the halo is filled in the same sweep.
///
/// An empty cell gets a position far from everything, which excludes every contact with it. It replaces the vector Test of BP93,
/// which [`printed`](crate::printed) uses.
#[derive(Clone, Copy, Debug)]
pub struct SpreadToLattice<P> {
    fields: &'static [ParticleField],
    image_shifts: [bool; 2],
    precision: PhantomData<P>,
}

impl<P: Element> SpreadToLattice<P> {
    /// Kernel for the quantities that a law reads. Absolute positions are shifted in the halo of periodic sides, by the arrays
    /// `image.x` and `image.y`; relative ones are copied.
    #[inline]
    pub fn new(shape: LatticeShape, coordinates: Coordinates, fields: &'static [ParticleField]) -> Self {
        let shifts = coordinates == Coordinates::Absolute;
        SpreadToLattice {
            fields,
            image_shifts: shape.periodic().map(|periodic| periodic && shifts),
            precision: PhantomData,
        }
    }
}

// SAFETY: the slots depend on the fields and the periodic sides only.
unsafe impl<P: Element> Kernel for SpreadToLattice<P> {
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
            let (from, empty) = disc_array(field);
            let to = Slot::<P>::new(lattice_vector(field));
            m.store(to, m.gather(Slot::<P>::new(from), index, m.uniform(empty)));
        }
    }
}
