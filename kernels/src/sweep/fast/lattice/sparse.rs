//! Contact search where few cells are occupied: disc by disc, with one bit per cell.
//!
//! ```text
//! for every row:
//!     list the occupied cells                           64 bits at a time
//!     for every one of them:
//!         the bits at the offsets of the half mask      a word for each row of the mask, shifted together
//!         append a candidate for every bit
//!         keep those within the contact distance plus a margin
//! ```
//!
//! Comparing registers of cells would be wasted on mostly empty cells. The distance of every candidate is checked at once,
//! because at this density most neighbours are not in contact. A candidate is written before its check, which avoids an
//! unpredictable branch.

use super::codes::{Codes, PackedCandidate};
use super::detection::append_bits;
use super::occupancy::Occupancy;
use crate::GROUP;
use crate::backend::RegisterTask;
use crate::backend::{Precision, Registers};
use crate::isa::Element;
use crate::sweep::fast::finder::{MARGIN, SearchCursor};
use crate::sweep::fast::records::StateRecords;
use std::ops::Range;

/// Searches whole rows from `cursor` on, until `full` candidates are found.
pub(super) struct SparseSearch<'a, S, P> {
    pub(super) occupancy: &'a Occupancy,
    pub(super) codes: &'a Codes<P>,
    pub(super) discs: &'a StateRecords<S>,
    pub(super) reach: f64,
    pub(super) rows: Range<usize>,
    pub(super) cursor: &'a mut SearchCursor,
    pub(super) full: usize,
    pub(super) found: &'a mut Vec<PackedCandidate>,
    /// Scratch: occupied cells of a row.
    pub(super) cells: &'a mut Vec<u64>,
}

/// Uses no vectors, but the processor's bit instructions.
impl<S: Element, P: Precision> RegisterTask<f32> for SparseSearch<'_, S, P> {
    #[inline(always)]
    fn on<R: Registers<Lane = f32>>(self, _: R) {
        let SparseSearch { occupancy, codes, discs, reach, rows, cursor, full, found, cells } = self;
        let (shape, occupied, index) = (occupancy.shape(), occupancy.occupied(), occupancy.index());
        let h = occupancy.half_width();
        let (ahead, around) = ((1 << h) - 1, (1 << (2 * h + 1)) - 1);
        let (limit, positions) = (reach * reach * MARGIN, discs.positions());
        let end = (rows.end + h) * shape.stride() + shape.position(0, 0);
        assert!(
            rows.end <= shape.rows() && end < occupied.positions() && end <= index.len() + h * shape.stride()
        );
        while cursor.row < rows.end && found.len() < full {
            let first = shape.position(0, cursor.row as isize);
            cells.clear();
            for column in (0..shape.columns()).step_by(64) {
                let inside = u64::MAX >> (64 - (shape.columns() - column).min(64));
                // SAFETY: the row ends before `end`, for which there are bits (asserted above).
                let own = unsafe { occupied.bits_from(first + column) } & inside;
                if own != 0 {
                    append_bits(cells, own, |bit| (first + column) as u64 + bit);
                }
            }
            for &cell in cells.iter() {
                let position = cell as usize;
                // SAFETY: the cell is in one of the rows, so its offsets are before `end`.
                let mut near = unsafe { occupied.bits_from(position + 1) } & ahead;
                for row in 1..=h {
                    // SAFETY: the row is at most `h` ahead, so the position is before `end` too.
                    let there = unsafe { occupied.bits_from(position + row * shape.stride() - h) } & around;
                    near |= there << (h + (row - 1) * (2 * h + 1));
                }
                let before = found.len();
                append_bits(found, near, |bit| {
                    PackedCandidate((cell << PackedCandidate::CODE) | (bit * GROUP as u64))
                });
                let mut kept = before;
                for listed in before..found.len() {
                    let candidate = found[listed];
                    let ([own, partner], cell_offset) = codes.pair(candidate, index);
                    let [x, y, ..] = codes.cell_offsets()[cell_offset as usize];
                    // SAFETY: the Index numbers discs and sentinels, which have records.
                    let (own, partner) = unsafe { (positions.of(own), positions.of(partner)) };
                    let dx = (own[0] - partner[0]) - x.to_f64();
                    let dy = (own[1] - partner[1]) - y.to_f64();
                    found[kept] = candidate;
                    kept += usize::from(dx * dx + dy * dy < limit);
                }
                found.truncate(kept);
            }
            *cursor = SearchCursor::at(cursor.row + 1);
        }
    }
}
