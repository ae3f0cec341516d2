//! Kernels that BP93 has no equation for: wrapping of positions in a periodic box, discs outside, images in the halo. The
//! [`CheckIndex`](crate::sweep::lattice::cells::CheckIndex) of every lattice finds lost discs.

use super::index::INDEX;
use crate::isa::{Array, Element, Kernel, Machine, Predicate, Slot, Vector};
use crate::sweep::lattice::cells::{STRAYS, wrapped};
use crate::sweep::lattice::{LatticeFrame, LatticeShape};
use std::marker::PhantomData;

/// Wraps positions into the periodic box and counts discs outside the lattice in [`STRAYS`]: the kernels that follow need
/// positions that have a cell. Vector length: the discs.
#[derive(Clone, Copy, Debug)]
pub struct IntoBox<S> {
    periodic: [bool; 2],
    low: [f64; 2],
    /// Positions below have a cell of the lattice.
    high: [f64; 2],
    period: [f64; 2],
    precision: PhantomData<S>,
}

impl<S: Element> IntoBox<S> {
    /// Kernel for a lattice at `frame`.
    #[inline]
    pub fn new(shape: LatticeShape, frame: LatticeFrame) -> Self {
        let cells = [shape.columns(), shape.rows()];
        let period = [0, 1].map(|axis| cells[axis] as f64 * frame.edge[axis]);
        let high = [0, 1].map(|axis| {
            let mut high = frame.origin[axis] + period[axis];
            // The position just below may be rounded up into a cell that does not exist.
            let column = |r: f64| ((r - frame.origin[axis]) / frame.edge[axis]) as usize;
            while column(high.next_down()) >= cells[axis] {
                high = high.next_down();
            }
            high
        });
        IntoBox { periodic: shape.periodic(), low: frame.origin, high, period, precision: PhantomData }
    }
}

// SAFETY: the slots depend on the periodic sides only.
unsafe impl<S: Element> Kernel for IntoBox<S> {
    type Lane = f64;

    #[inline(always)]
    fn body<M: Machine<Lane = f64>>(&self, m: M) {
        let mut inside: Option<M::P> = None;
        for (axis, array) in [Array::X0, Array::Y0].into_iter().enumerate() {
            let r = Slot::<S>::new(array);
            let [low, high] = [self.low[axis], self.high[axis]].map(|side| m.uniform(side));
            m.section("box");
            let mut position = m.load(r);
            if self.periodic[axis] {
                m.section("wrap");
                position = wrapped(position, [low, high], m.uniform(self.period[axis]));
                m.store(r, position);
            }
            m.section("box");
            let here = low.less_equal(position).and(position.less_than(high));
            inside = Some(inside.map_or(here, |other| other.and(here)));
        }
        if let Some(inside) = inside {
            m.count(STRAYS, inside.not());
        }
    }
}

/// Copies Index and Test to the halo of periodic sides. Vector length: the halo cells.
#[derive(Clone, Copy, Debug)]
pub struct PrintedImages<P>(PhantomData<P>);

impl<P> Default for PrintedImages<P> {
    #[inline]
    fn default() -> Self {
        PrintedImages(PhantomData)
    }
}

// SAFETY: the body names its slots unconditionally.
unsafe impl<P: Element> Kernel for PrintedImages<P> {
    type Lane = f64;

    #[inline(always)]
    fn body<M: Machine<Lane = f64>>(&self, m: M) {
        m.section("images");
        let test = Slot::<P>::new(Array::Test);
        let source = m.load_index(Slot::new(Array::HaloSource));
        let cell = m.load_index(Slot::new(Array::HaloCell));
        let (disc, is_there) = (m.gather_index(INDEX, source), m.gather(test, source, m.uniform(0.0)));
        m.scatter_index(INDEX, cell, disc);
        m.scatter(test, cell, is_there);
    }
}
