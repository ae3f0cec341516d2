//! What the print has no equation for, run beside its programs: positions brought back into a periodic box, discs outside
//! found, images in the halo. That no disc was lost is found by the [`Check`](crate::sweep::lattice::cells::Check) of every lattice.

use super::index::INDEX;
use crate::isa::{Array, Element, Machine, Predicate, Slot, Text, Vector};
use crate::sweep::lattice::cells::{STRAYS, wrapped};
use crate::sweep::lattice::{Frame, LatticeShape};
use std::marker::PhantomData;

/// Brings positions back into the periodic box and counts discs outside the lattice in [`STRAYS`]: the programs behind it are
/// for positions that have a cell. Vector length: the discs.
#[derive(Clone, Copy, Debug)]
pub struct IntoBox<S> {
    periodic: [bool; 2],
    low: [f64; 2],
    /// Everything below has a cell of the lattice.
    high: [f64; 2],
    period: [f64; 2],
    precision: PhantomData<S>,
}

impl<S: Element> IntoBox<S> {
    /// For a lattice at `frame`.
    #[inline]
    pub fn new(shape: LatticeShape, frame: Frame) -> Self {
        let cells = [shape.columns(), shape.rows()];
        let period = [0, 1].map(|axis| cells[axis] as f64 * frame.edge[axis]);
        let high = [0, 1].map(|axis| {
            let mut high = frame.origin[axis] + period[axis];
            // The position below may be rounded up into a cell that is not there.
            let column = |r: f64| ((r - frame.origin[axis]) / frame.edge[axis]) as usize;
            while column(high.next_down()) >= cells[axis] {
                high = high.next_down();
            }
            high
        });
        IntoBox { periodic: shape.periodic(), low: frame.origin, high, period, precision: PhantomData }
    }
}

// SAFETY: the slots depend on which sides are periodic only.
unsafe impl<S: Element> Text for IntoBox<S> {
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

/// Repeats Index and Test in the halo of periodic sides. Vector length: the halo cells.
#[derive(Clone, Copy, Debug)]
pub struct Images<P>(PhantomData<P>);

impl<P> Default for Images<P> {
    #[inline]
    fn default() -> Self {
        Images(PhantomData)
    }
}

// SAFETY: the body names its slots unconditionally.
unsafe impl<P: Element> Text for Images<P> {
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
