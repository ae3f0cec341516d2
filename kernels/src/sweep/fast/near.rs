//! Distance filter of the searches: lists pairs that are near.

use super::finder::{AT_ONCE, MARGIN, SearchCursor};
use super::grid::CellGrid;
use super::pairs::{CandidatePair, DiscPair, PairBuffer, cell_offset};
use super::records::{RecordEntry, RecordPositions, StateRecords};
use crate::backend::Precision;
use crate::isa::Element;
use std::ops::Range;

/// Lists those of the given pairs that are nearer than a limit.
pub(super) struct DistanceFilter<'a, S> {
    positions: RecordPositions<'a, S>,
    cell_offsets: [[f64; 2]; 5],
    limit: f64,
    /// Records with the radii, if pairs are near at the sum of their own.
    radii: Option<&'a StateRecords<S>>,
    touches: &'a mut Vec<CandidatePair>,
}

impl<'a, S: Element> DistanceFilter<'a, S> {
    /// Filter for `count` discs that touch at most at a distance `reach` (length), or at the sum of their radii if that is asked.
    ///
    /// # Panics
    /// If there is another number of records.
    #[inline]
    pub(super) fn new<P: Precision>(
        discs: &'a StateRecords<S>,
        count: usize,
        grid: &CellGrid,
        (reach, by_radii): (f64, bool),
        touches: &'a mut PairBuffer<P>,
    ) -> Self {
        assert_eq!(discs.discs(), count, "the search and the records must have the same discs");
        let (limit, cell_offsets) = (reach * reach * MARGIN, grid.cell_offsets());
        touches.pairs.clear();
        touches.cell_offsets.clear();
        touches.cell_offsets.extend(cell_offsets.map(cell_offset));
        let radii = by_radii.then_some(discs);
        DistanceFilter {
            positions: discs.positions(),
            cell_offsets,
            limit,
            radii,
            touches: &mut touches.pairs,
        }
    }

    /// Searches rows piece by piece (`pieces` of a row) until enough pairs are listed.
    #[inline(always)]
    pub(super) fn search(
        &mut self,
        rows: Range<usize>,
        cursor: &mut SearchCursor,
        pieces: impl Fn(usize) -> usize,
        piece: impl Fn(&mut Self, usize, usize),
    ) {
        while cursor.row < rows.end {
            let there = pieces(cursor.row);
            while cursor.along < there {
                if self.touches.len() >= AT_ONCE {
                    return;
                }
                piece(self, cursor.row, cursor.along);
                cursor.along += 1;
            }
            *cursor = SearchCursor::at(cursor.row + 1);
        }
    }

    /// Position of a disc.
    ///
    /// # Safety
    /// `disc` is one of the discs.
    #[inline(always)]
    pub(super) unsafe fn disc_position(&self, disc: u32) -> [f64; 2] {
        // SAFETY: the caller promises a disc, and every disc has a record, as `new` has checked.
        unsafe { self.positions.of(disc) }
    }

    /// True if two discs at positions with a cell offset are near enough.
    ///
    /// # Safety
    /// `cell_offset` is below 5.
    #[inline(always)]
    unsafe fn is_near(&self, discs: DiscPair, [here, there]: [[f64; 2]; 2], cell_offset: usize) -> bool {
        // SAFETY: the caller promises a cell offset below 5, the length of `cell_offsets`.
        let along = unsafe { *self.cell_offsets.get_unchecked(cell_offset) };
        let (dx, dy) = ((here[0] - there[0]) - along[0], (here[1] - there[1]) - along[1]);
        let limit = match self.radii {
            Some(records) => {
                let [a, b] = discs.map(|disc| records.get(RecordEntry::Radius, disc as usize).to_f64());
                (a + b) * (a + b) * MARGIN
            }
            None => self.limit,
        };
        dx * dx + dy * dy < limit
    }

    /// Lists those of some pairs, given with the numbers of their cell offsets, that are near enough. The number of listed pairs stays in a register,
    /// while [`list_if_near`](Self::list_if_near) stores it for every pair.
    ///
    /// # Safety
    /// The pairs are of discs, and every cell offset is below 5.
    #[inline(always)]
    pub(super) unsafe fn list_those_near(&mut self, pairs: impl ExactSizeIterator<Item = (DiscPair, usize)>) {
        self.touches.reserve(pairs.len());
        let (to, mut length) = (self.touches.as_mut_ptr(), self.touches.len());
        for (discs, cell_offset) in pairs {
            // SAFETY: the caller promises discs, and a cell offset below 5.
            let is_near =
                unsafe { self.is_near(discs, discs.map(|disc| self.disc_position(disc)), cell_offset) };
            // SAFETY: `reserve` has left capacity for all pairs.
            unsafe { to.add(length).write(CandidatePair { discs, cell_offset: cell_offset as u32 }) };
            length += usize::from(is_near);
        }
        // SAFETY: everything below `length` has been written.
        unsafe { self.touches.set_len(length) };
    }

    /// Lists a pair if it is near enough.
    ///
    /// # Safety
    /// `second` is one of the discs, and `cell_offset` below 5.
    #[inline(always)]
    pub(super) unsafe fn list_if_near(&mut self, first: u32, at: [f64; 2], second: u32, cell_offset: usize) {
        // SAFETY: the caller promises that `second` is a disc, and a cell offset below 5.
        let is_near = unsafe { self.is_near([first, second], [at, self.disc_position(second)], cell_offset) };
        let length = self.touches.len();
        if length == self.touches.capacity() {
            self.touches.reserve(AT_ONCE);
        }
        // Written in either case, which avoids an unpredictable branch.
        let touch = CandidatePair { discs: [first, second], cell_offset: cell_offset as u32 };
        // SAFETY: `reserve` above has left capacity for one more, and it is written before the length covers it.
        unsafe {
            self.touches.as_mut_ptr().add(length).write(touch);
            self.touches.set_len(length + usize::from(is_near));
        }
    }
}
