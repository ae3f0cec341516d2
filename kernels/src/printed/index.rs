//! Section 2, step 3: the lattice vectors Index and Test.

use crate::isa::{Array, Element, Kernel, Machine, Slot, Vector};
use crate::sweep::lattice::{LatticeFrame, LatticeShape};
use std::marker::PhantomData;

pub(super) const INDEX: Slot<u32> = Slot::new(Array::Index);
pub(super) const CELL: Slot<u32> = Slot::new(Array::DiscCell);

/// Zeros of (2) and (3), their "0 otherwise". Vector length: the lattice with its halo.
#[derive(Clone, Copy, Debug)]
pub struct PrintedClear<P>(PhantomData<P>);

impl<P> Default for PrintedClear<P> {
    #[inline]
    fn default() -> Self {
        PrintedClear(PhantomData)
    }
}

// SAFETY: the body names its slots unconditionally.
unsafe impl<P: Element> Kernel for PrintedClear<P> {
    type Lane = f64;

    #[inline(always)]
    fn body<M: Machine<Lane = f64>>(&self, m: M) {
        m.section("(2)");
        m.store_index(INDEX, m.to_index(m.uniform(0.0)));
        m.section("(3)");
        m.store(Slot::<P>::new(Array::Test), m.uniform(0.0));
    }
}

/// Sets (2) and (3) where there is a particle. Vector length: the discs.
///
/// The cell of each disc is stored: step 5 needs it to return from the lattice to the discs. Positions must be in the box
/// ([`IntoBox`](super::additions::IntoBox)), otherwise the cell would be beyond the lattice.
#[derive(Clone, Copy, Debug)]
pub struct PrintedEnter<S, P> {
    shape: LatticeShape,
    frame: LatticeFrame,
    precisions: PhantomData<(S, P)>,
}

impl<S: Element, P: Element> PrintedEnter<S, P> {
    /// Kernel for a lattice at `frame`.
    #[inline]
    pub fn new(shape: LatticeShape, frame: LatticeFrame) -> Self {
        PrintedEnter { shape, frame, precisions: PhantomData }
    }
}

// SAFETY: the body names its slots unconditionally.
unsafe impl<S: Element, P: Element> Kernel for PrintedEnter<S, P> {
    type Lane = f64;

    #[inline(always)]
    fn body<M: Machine<Lane = f64>>(&self, m: M) {
        let LatticeFrame { origin, edge } = self.frame;
        m.section("(2)");
        let [x, y] = [Array::X0, Array::Y0].map(|axis| m.load(Slot::<S>::new(axis)));
        let column = ((x - m.uniform(origin[0])) / m.uniform(edge[0])).truncate();
        let row = ((y - m.uniform(origin[1])) / m.uniform(edge[1])).truncate();
        let row = row * m.uniform(self.shape.stride() as f64);
        m.section("i of (2)");
        let column = column + m.uniform((self.shape.position(0, 0) + 1) as f64);
        m.section("(2)");
        let cell = m.to_index(row + column);
        m.section("way back");
        m.store_index(CELL, cell);
        m.section("(2)");
        m.scatter_index(INDEX, cell, m.to_index(m.numbers()));
        m.section("(3)");
        m.scatter(Slot::<P>::new(Array::Test), cell, m.uniform(1.0));
    }
}
