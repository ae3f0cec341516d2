//! Candidates: pairs of cells packed into one word each, and their decoding.

use super::occupancy::Occupancy;
use crate::GROUP;
use crate::backend::Precision;
use crate::sweep::fast::pairs::{CellOffset, cell_offset};
use crate::sweep::lattice::LatticeFrame;

/// A pair of cells whose discs may touch: the first cell of the group in the high bits, offset and lane in the low ones.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct PackedCandidate(pub(super) u64);

impl PackedCandidate {
    /// Bits of a code.
    pub(super) const CODE: u32 = 9;

    /// Position of the group's first cell.
    #[inline(always)]
    pub(super) fn base(self) -> usize {
        (self.0 >> Self::CODE) as usize
    }

    /// Offset and lane: an index into [`codes`].
    #[inline(always)]
    pub(super) fn code(self) -> usize {
        (self.0 & ((1 << Self::CODE) - 1)) as usize
    }
}

/// Number of offsets of a half mask.
#[inline]
pub(super) const fn offset_count(half_width: usize) -> usize {
    half_width + half_width * (2 * half_width + 1)
}

/// An offset of a half mask in the order of the sweep: column and row. Numbers beyond the last are no offsets.
#[inline]
pub(super) const fn half_mask_offset(half_width: usize, number: usize) -> [isize; 2] {
    if number < half_width {
        return [number as isize + 1, 0];
    }
    let (width, behind) = (2 * half_width + 1, number - half_width);
    [(behind % width) as isize - half_width as isize, (behind / width) as isize + 1]
}

/// Offsets of a half mask in their order.
#[inline]
fn half_mask_offsets(half_width: usize) -> impl Iterator<Item = [isize; 2]> {
    (0..offset_count(half_width)).map(move |number| half_mask_offset(half_width, number))
}

/// Lane and offset of every code, in order.
#[inline]
pub(super) fn codes(half_width: usize) -> impl Iterator<Item = (usize, [isize; 2])> {
    half_mask_offsets(half_width).flat_map(|offset| (0..GROUP).map(move |lane| (lane, offset)))
}

/// Tables that decode candidates.
#[derive(Clone, Debug)]
pub struct Codes<P> {
    stride: usize,
    /// Distances from the group's first cell to the own cell and to the partner's.
    cells: Vec<[i32; 2]>,
    /// Vectors from the centre of the own cell to that of the partner's (length), by offset.
    cell_offsets: Vec<CellOffset<P>>,
}

impl<P: Precision> Codes<P> {
    /// Tables for the lattice of an occupancy.
    #[inline]
    pub fn new(occupancy: &Occupancy, frame: LatticeFrame) -> Self {
        let stride = occupancy.shape().stride() as isize;
        let all = || codes(occupancy.half_width());
        Codes {
            stride: occupancy.shape().stride(),
            cells: all()
                .map(|(lane, [column, row])| [lane as i32, (lane as isize + row * stride + column) as i32])
                .collect(),
            cell_offsets: half_mask_offsets(occupancy.half_width())
                .map(|offset| cell_offset([0, 1].map(|axis| offset[axis] as f64 * frame.edge[axis])))
                .collect(),
        }
    }

    /// True if the tables fit this lattice: equal row length and mask width.
    #[inline]
    pub(super) fn is_for(&self, occupancy: &Occupancy) -> bool {
        let codes = offset_count(occupancy.half_width()) * GROUP;
        self.stride == occupancy.shape().stride() && self.cells.len() == codes
    }

    /// Vectors between cells, by the number of the offset.
    #[inline(always)]
    pub(super) fn cell_offsets(&self) -> &[CellOffset<P>] {
        &self.cell_offsets
    }

    /// The two discs of a candidate, and the number of the offset.
    #[inline(always)]
    pub(super) fn pair(&self, candidate: PackedCandidate, index: &[u32]) -> ([u32; 2], u32) {
        let (base, code) = (candidate.base(), candidate.code());
        // SAFETY: a code is offset·GROUP + lane, and the table has an entry for each. The group and the cells at its offsets are in
        // the padded lattice or in the register of padding behind it, which the Index has too.
        let discs = unsafe {
            let cells = *self.cells.get_unchecked(code);
            cells.map(|cell| *index.get_unchecked(base.wrapping_add_signed(cell as isize)))
        };
        (discs, (code / GROUP) as u32)
    }
}
