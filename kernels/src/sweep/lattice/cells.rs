//! The Index, which stores the disc of each cell. BP93 (2), (3).

use super::shape::{Coordinates, LatticeFrame, LatticeShape};
use crate::isa::{Array, Element, Kernel, LaneCounter, Machine, Predicate, Slot, Vector};
use std::marker::PhantomData;

const DISC_CELL: Slot<u32> = Slot::new(Array::DiscCell);
const INDEX: Slot<u32> = Slot::new(Array::Index);
const HALO_CELL: Slot<u32> = Slot::new(Array::HaloCell);
const HALO_SOURCE: Slot<u32> = Slot::new(Array::HaloSource);

/// Counts discs outside the lattice or with a position that is not a number. Written by [`EnterDiscs`].
pub const STRAYS: LaneCounter = LaneCounter(0);
/// Counts discs whose cell another disc took, and strays again. Written by [`CheckIndex`].
pub const CONFLICTS: LaneCounter = LaneCounter(1);

/// Empties the Index. Vector length: the padded lattice.
#[derive(Clone, Copy, Debug, Default)]
pub struct ClearIndex;

// SAFETY: the body names its slots unconditionally.
unsafe impl Kernel for ClearIndex {
    type Lane = f64;

    #[inline(always)]
    fn body<M: Machine<Lane = f64>>(&self, m: M) {
        m.section("clear");
        m.store_index(INDEX, m.to_index(m.uniform(0.0)));
    }
}

/// Wraps a position at most a period (length) outside a periodic side into the range from `low` to `high`.
#[inline(always)]
pub(crate) fn wrapped<V: Vector>(r: V, [low, high]: [V; 2], period: V) -> V {
    let r = V::select(r.less_than(low), r + period, r);
    // Because of rounding, a period below the far side may be below the near one.
    V::select(high.less_equal(r), (r - period).max(low), r)
}

/// Finds the cell of every disc and enters the disc in the Index. Vector length: the discs.
///
/// Positions (state precision `S`) wrap around periodic sides. The lattice's copy (force precision `P`) is absolute or relative
/// to the cell. A disc is in no cell and counts as a stray if it is outside a closed side, more than a period outside a periodic
/// one, or at a position that is not a number. Arithmetic is in double precision for every `S` and `P`: single precision counts
/// cells exactly only to 2²⁴.
#[derive(Clone, Copy, Debug)]
pub struct EnterDiscs<S, P> {
    shape: LatticeShape,
    frame: LatticeFrame,
    coordinates: Coordinates,
    anchored: bool,
    precisions: PhantomData<(S, P)>,
}

impl<S: Element, P: Element> EnterDiscs<S, P> {
    /// Kernel for a lattice at `frame`, with state positions from the origin.
    #[inline]
    pub fn new(shape: LatticeShape, frame: LatticeFrame, coordinates: Coordinates) -> Self {
        EnterDiscs { shape, frame, coordinates, anchored: false, precisions: PhantomData }
    }

    /// Kernel for a lattice at `frame`, with state positions from the centre of the cell in which the disc was last entered. In
    /// single precision these are as precise as the cell is small, anywhere in the box.
    #[inline]
    pub fn anchored(shape: LatticeShape, frame: LatticeFrame) -> Self {
        let coordinates = Coordinates::CellRelative;
        EnterDiscs { shape, frame, coordinates, anchored: true, precisions: PhantomData }
    }

    /// Column or row of a position relative to the centre of the cell `from`, as [`along`](Self::along) returns it for absolute
    /// ones. Also returns the unchanged position and the position relative to the new cell.
    #[inline(always)]
    fn along_from<M: Machine<Lane = f64>>(&self, m: M, axis: usize, from: M::V) -> (M::V, M::P, [M::V; 2]) {
        let cells = [self.shape.columns(), self.shape.rows()][axis] as f64;
        let edge = self.frame.edge[axis];
        let (zero, count) = (m.uniform(0.0), m.uniform(cells));

        m.section("cell");
        let r = m.load(Slot::<S>::new([Array::X0, Array::Y0][axis]));
        let mut from = from;
        // Position in cells from the low side.
        let mut along = (from + m.uniform(0.5)) + r * m.uniform(1.0 / edge);
        if self.shape.periodic()[axis] {
            m.section("wrap");
            let beyond = M::V::select(count.less_equal(along), zero - count, zero);
            let periods = M::V::select(along.less_than(zero), count, beyond);
            along = along + periods;
            from = from + periods;
        }
        m.section("cell");
        let inside = zero.less_equal(along).and(along.less_equal(count));
        let cell = along.truncate().min(m.uniform(cells - 1.0));
        m.section("coordinates");
        // Unchanged to the bit if the disc has stayed in its cell.
        let moved = r + (from - cell) * m.uniform(edge);
        (cell, inside, [r, moved])
    }

    /// Column and row in which a disc was last entered.
    #[inline(always)]
    fn anchor<M: Machine<Lane = f64>>(&self, m: M) -> [M::V; 2] {
        m.section("anchor");
        let first = m.uniform((self.shape.position(0, 0) + 1) as f64);
        let stride = self.shape.stride() as f64;
        let from_first = m.index_numbers(m.load_index(DISC_CELL)) - first;
        // Adds half a cell, so that rounding does not give the row before.
        let row = ((from_first + m.uniform(0.5)) * m.uniform(1.0 / stride)).truncate();
        [from_first - row * m.uniform(stride), row]
    }

    /// Writes positions relative to the new cells. A stray keeps its reference cell, so that it can be reported.
    #[inline(always)]
    fn store_anchored<M: Machine<Lane = f64>>(&self, m: M, inside: M::P, positions: [[M::V; 2]; 2]) {
        m.section("coordinates");
        for (axis, [r, moved]) in positions.into_iter().enumerate() {
            let r = M::V::select(inside, moved, r);
            m.store(Slot::<S>::new([Array::X0, Array::Y0][axis]), r);
            m.store(Slot::<P>::new([Array::DiscX, Array::DiscY][axis]), r);
        }
    }

    /// Column or row of a position, and a predicate that is true inside the lattice; stores the position in the lattice's
    /// coordinates.
    #[inline(always)]
    fn along<M: Machine<Lane = f64>>(&self, m: M, axis: usize) -> (M::V, M::P) {
        let position = Slot::<S>::new([Array::X0, Array::Y0][axis]);
        let on_lattice = Slot::<P>::new([Array::DiscX, Array::DiscY][axis]);
        let cells = [self.shape.columns(), self.shape.rows()][axis] as f64;
        let (origin, edge) = (self.frame.origin[axis], self.frame.edge[axis]);
        let low = m.uniform(origin);
        let high = m.uniform(origin + cells * edge);

        m.section("position");
        let mut r = m.load(position);
        if self.shape.periodic()[axis] {
            m.section("wrap");
            r = wrapped(r, [low, high], m.uniform(cells * edge));
            m.store(position, r);
        }

        m.section("bounds");
        let inside = low.less_equal(r).and(r.less_equal(high));
        m.section("cell");
        let from_low = r - low;
        let cell = (from_low * m.uniform(1.0 / edge)).truncate();
        m.section("bounds");
        // A position on the far side, or a rounding error below it, belongs to the last cell.
        let cell = cell.min(m.uniform(cells - 1.0));

        m.section("copy");
        if self.coordinates == Coordinates::CellRelative {
            m.section("coordinates");
            r = from_low - (cell + m.uniform(0.5)) * m.uniform(edge);
        }
        m.store(on_lattice, r);
        (cell, inside)
    }
}

// SAFETY: the slots depend on the shape, the coordinates and the anchoring only.
unsafe impl<S: Element, P: Element> Kernel for EnterDiscs<S, P> {
    type Lane = f64;

    #[inline(always)]
    fn body<M: Machine<Lane = f64>>(&self, m: M) {
        let mut seen = None;
        let (column, inside_columns, row, inside_rows) = if self.anchored {
            let [column, row] = self.anchor(m);
            let (column, inside_columns, x) = self.along_from(m, 0, column);
            let (row, inside_rows, y) = self.along_from(m, 1, row);
            seen = Some([x, y]);
            (column, inside_columns, row, inside_rows)
        } else {
            let (column, inside_columns) = self.along(m, 0);
            let (row, inside_rows) = self.along(m, 1);
            (column, inside_columns, row, inside_rows)
        };

        m.section("cell");
        let first = m.uniform((self.shape.position(0, 0) + 1) as f64);
        let number = row * m.uniform(self.shape.stride() as f64) + (column + first);
        m.section("bounds");
        let inside = inside_columns.and(inside_rows);
        if let Some(positions) = seen {
            self.store_anchored(m, inside, positions);
        }
        let number = M::V::select(inside, number, m.uniform(0.0));
        m.count(STRAYS, inside.not());
        m.section("cell");
        let cell = m.to_index(number);
        m.store_index(DISC_CELL, cell);

        m.section("scatter");
        m.scatter_index(INDEX, cell, m.to_index(m.numbers()));
    }
}

/// Gathers the Index and compares: a scatter silently loses a disc when two share a cell. Vector length: the discs.
#[derive(Clone, Copy, Debug, Default)]
pub struct CheckIndex;

// SAFETY: the body names its slots unconditionally.
unsafe impl Kernel for CheckIndex {
    type Lane = f64;

    #[inline(always)]
    fn body<M: Machine<Lane = f64>>(&self, m: M) {
        m.section("check");
        let there = m.index_numbers(m.gather_index(INDEX, m.load_index(DISC_CELL)));
        m.count(CONFLICTS, there.equal(m.numbers()).not());
    }
}

/// Copies the Index to the halo of periodic sides. Vector length: the halo cells.
#[derive(Clone, Copy, Debug, Default)]
pub struct IndexImages;

// SAFETY: the body names its slots unconditionally.
unsafe impl Kernel for IndexImages {
    type Lane = f64;

    #[inline(always)]
    fn body<M: Machine<Lane = f64>>(&self, m: M) {
        m.section("images");
        let disc = m.gather_index(INDEX, m.load_index(HALO_SOURCE));
        m.scatter_index(INDEX, m.load_index(HALO_CELL), disc);
    }
}
