//! Section 2, step 3: Index maps the discs' observables to lattice vectors.

use super::index::INDEX;
use crate::isa::{Array, Element, Kernel, Machine, Slot};
use crate::sweep::lattice::LatticeShape;
use std::marker::PhantomData;

/// Gathers x, y, their derivatives, Ω', R and M of every cell: those of the disc that Index numbers, or of particle 0. Vector
/// length: the lattice with its halo.
///
/// Particle 0 is at rest at the origin, with a radius of 0 and a mass of 1.
///
/// # As printed
/// BP93 does not define particle 0. Read literally, all empty cells have one position, and (10) to (12) divide by their distance.
/// Here each empty cell adds a position of its own, far from everything, by (1 − Test)·far, which is exact.
#[derive(Clone, Copy, Debug)]
pub struct PrintedMap<S, P> {
    periodic: [bool; 2],
    precisions: PhantomData<(S, P)>,
}

impl<S: Element, P: Element> PrintedMap<S, P> {
    /// Kernel for a lattice.
    #[inline]
    pub fn new(shape: LatticeShape) -> Self {
        PrintedMap { periodic: shape.periodic(), precisions: PhantomData }
    }
}

// SAFETY: the slots depend on the periodic sides only.
unsafe impl<S: Element, P: Element> Kernel for PrintedMap<S, P> {
    type Lane = P;

    #[inline(always)]
    fn body<M: Machine<Lane = P>>(&self, m: M) {
        m.section("step 3");
        let index = m.load_index(INDEX);
        let places = [
            (Array::X0, Array::X, Array::ImageX, self.periodic[0]),
            (Array::Y0, Array::Y, Array::ImageY, self.periodic[1]),
        ];
        for (from, to, image, is_periodic) in places {
            let mut r = m.gather(Slot::<S>::new(from), index, m.uniform(0.0));
            if to == Array::X {
                let empty = m.uniform(1.0) - m.load(Slot::<P>::new(Array::Test));
                r = r + empty * m.load(Slot::<P>::new(Array::FarX));
            }
            if is_periodic {
                r = r + m.load(Slot::<P>::new(image));
            }
            m.store(Slot::<P>::new(to), r);
        }
        let rates = [(Array::X1, Array::Vx), (Array::Y1, Array::Vy), (Array::Phi1, Array::Omega)];
        for (from, to) in rates {
            m.store(Slot::<P>::new(to), m.gather(Slot::<S>::new(from), index, m.uniform(0.0)));
        }
        for (from, to, of_particle_0) in
            [(Array::DiscRadius, Array::Radius, 0.0), (Array::DiscMass, Array::Mass, 1.0)]
        {
            m.store(Slot::<P>::new(to), m.gather(Slot::<P>::new(from), index, m.uniform(of_particle_0)));
        }
    }
}
