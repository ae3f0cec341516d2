//! The Index: which disc stands in which cell. BP93 (2), (3).

use super::shape::{Coordinates, Frame, LatticeShape};
use crate::isa::{Array, Counter, Element, Machine, Predicate, Slot, Text, Vector};
use std::marker::PhantomData;

const DISC_CELL: Slot<u32> = Slot::new(Array::DiscCell);
const INDEX: Slot<u32> = Slot::new(Array::Index);
const HALO_CELL: Slot<u32> = Slot::new(Array::HaloCell);
const HALO_SOURCE: Slot<u32> = Slot::new(Array::HaloSource);

/// Counts discs outside the lattice, or with positions that are no numbers. Written by [`Enter`].
pub const STRAYS: Counter = Counter(0);
/// Counts discs whose cell another disc took, and strays once more. Written by [`Check`].
pub const CONFLICTS: Counter = Counter(1);

/// Empties the Index. Vector length: the padded lattice.
#[derive(Clone, Copy, Debug, Default)]
pub struct Clear;

// SAFETY: the body names its slots unconditionally.
unsafe impl Text for Clear {
    type Lane = f64;

    #[inline(always)]
    fn body<M: Machine<Lane = f64>>(&self, m: M) {
        m.section("clear");
        m.store_index(INDEX, m.to_index(m.uniform(0.0)));
    }
}

/// Finds the cell of every disc and enters the disc there. Vector length: the discs.
///
/// Positions (state precision `S`) wrap around periodic sides; the lattice's copy of them (force precision `P`) is
/// written absolute or relative to the cell. A disc outside a closed side, more than a period outside a periodic one,
/// or with a position that is no number, belongs to no cell and is counted as a stray. Arithmetic is in double
/// precision whatever `S` and `P`: single precision counts cells exactly only to 2²⁴.
#[derive(Clone, Copy, Debug)]
pub struct Enter<S, P> {
    shape: LatticeShape,
    frame: Frame,
    coordinates: Coordinates,
    precisions: PhantomData<(S, P)>,
}

impl<S: Element, P: Element> Enter<S, P> {
    /// For a lattice at `frame`.
    pub fn new(shape: LatticeShape, frame: Frame, coordinates: Coordinates) -> Self {
        Enter { shape, frame, coordinates, precisions: PhantomData }
    }

    /// Column or row of a position, whether it is one of the lattice, and the position as the lattice wants it.
    #[inline(always)]
    fn along<M: Machine<Lane = f64>>(&self, m: M, axis: usize) -> (M::V, M::P) {
        let position = Slot::<S>::new([Array::X0, Array::Y0][axis]);
        let on_lattice = Slot::<P>::new([Array::DiscX, Array::DiscY][axis]);
        let cells = [self.shape.columns(), self.shape.rows()][axis] as f64;
        let (origin, edge) = (self.frame.origin[axis], self.frame.edge[axis]);
        let low = m.uniform(origin);
        let high = m.uniform(origin + cells * edge);

        let mut r = m.load(position);
        if self.shape.periodic()[axis] {
            m.section("wrap");
            let period = m.uniform(cells * edge);
            r = M::V::select(r.less_than(low), r + period, r);
            // Rounded, a period below the far side may lie below the near one.
            r = M::V::select(high.less_equal(r), (r - period).max(low), r);
            m.store(position, r);
        }

        m.section("cell");
        let inside = low.less_equal(r).and(r.less_equal(high));
        let from_low = r - low;
        // A position on the far side, or a rounding error below it, belongs to the last cell.
        let cell = (from_low * m.uniform(1.0 / edge)).truncate().min(m.uniform(cells - 1.0));

        if self.coordinates == Coordinates::CellRelative {
            m.section("coordinates");
            r = from_low - (cell + m.uniform(0.5)) * m.uniform(edge);
        }
        m.store(on_lattice, r);
        (cell, inside)
    }
}

// SAFETY: the slots depend on the shape and the coordinates only.
unsafe impl<S: Element, P: Element> Text for Enter<S, P> {
    type Lane = f64;

    #[inline(always)]
    fn body<M: Machine<Lane = f64>>(&self, m: M) {
        let (column, inside_columns) = self.along(m, 0);
        let (row, inside_rows) = self.along(m, 1);

        m.section("cell");
        let first = m.uniform((self.shape.position(0, 0) + 1) as f64);
        let number = row * m.uniform(self.shape.stride() as f64) + (column + first);
        let inside = inside_columns.and(inside_rows);
        let cell = m.to_index(M::V::select(inside, number, m.uniform(0.0)));
        m.store_index(DISC_CELL, cell);
        m.count(STRAYS, inside.not());

        m.section("scatter");
        m.scatter_index(INDEX, cell, m.to_index(m.numbers()));
    }
}

/// Gathers the Index back and compares: a scatter silently loses a disc when two share a cell. Vector length: discs.
#[derive(Clone, Copy, Debug, Default)]
pub struct Check;

// SAFETY: the body names its slots unconditionally.
unsafe impl Text for Check {
    type Lane = f64;

    #[inline(always)]
    fn body<M: Machine<Lane = f64>>(&self, m: M) {
        m.section("check");
        let there = m.index_numbers(m.gather_index(INDEX, m.load_index(DISC_CELL)));
        m.count(CONFLICTS, there.equal(m.numbers()).not());
    }
}

/// Repeats the Index in the halo of periodic sides. Vector length: the halo cells.
#[derive(Clone, Copy, Debug, Default)]
pub struct Images;

// SAFETY: the body names its slots unconditionally.
unsafe impl Text for Images {
    type Lane = f64;

    #[inline(always)]
    fn body<M: Machine<Lane = f64>>(&self, m: M) {
        m.section("images");
        let disc = m.gather_index(INDEX, m.load_index(HALO_SOURCE));
        m.scatter_index(INDEX, m.load_index(HALO_CELL), disc);
    }
}
