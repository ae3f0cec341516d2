//! Interface between a sweep and the search that finds its pairs.

use super::pairs::{PairBuffer, PairSequence};
use super::records::StateRecords;
use crate::InstructionSet;
use crate::backend::Precision;
use crate::isa::ProgramError;
use std::ops::Range;

/// Division of rows into bands that threads may sweep concurrently. It affects the order of summation, so it depends on the scene
/// alone.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct RowLayout {
    /// Number of rows.
    pub count: usize,
    /// Largest distance in rows from a disc to a partner ahead.
    pub ahead: usize,
    /// Least number of rows in a band.
    pub band: usize,
}

impl RowLayout {
    /// The rows of each band.
    #[inline]
    pub fn bands(&self) -> impl ExactSizeIterator<Item = Range<usize>> + use<> {
        let rows = self.count;
        let count = (rows / self.band.max(2 * self.ahead)).max(1);
        (0..count).map(move |band| band * rows / count..(band + 1) * rows / count)
    }
}

/// Share of one of several ranks: whole bands, whose sums and notes it owns. Its discs may also be in rows beside them.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct RankShare {
    /// The rows of its bands.
    pub rows: Range<usize>,
    /// Number of rows beyond these in which its discs may be.
    pub margin: usize,
}

impl RankShare {
    /// The part of `rows` at most `below` rows before the share's rows or `above` rows behind them. Rows are periodic with
    /// `count`.
    #[inline]
    pub fn rows_near(
        &self,
        rows: &Range<usize>,
        [below, above]: [usize; 2],
        count: usize,
    ) -> Vec<Range<usize>> {
        let near = (self.rows.start + count).saturating_sub(below)..self.rows.end + count + above;
        let mut found: Vec<Range<usize>> = vec![];
        for around in 0..3 {
            let [start, end] = [rows.start, rows.end].map(|row| row + around * count);
            let (start, end) = (start.max(near.start), end.min(near.end));
            if start < end {
                found.push(start - around * count..end - around * count);
            }
        }
        found.sort_by_key(|rows| rows.start);
        // If a rank is near itself around the box, rows come twice.
        found.dedup_by(|next, last| {
            let joins = next.start <= last.end;
            if joins {
                last.end = last.end.max(next.end);
            }
            joins
        });
        found
    }
}

/// Finds pairs of discs that may touch: every touching pair once, and any number of others.
///
/// # Safety
/// Pairs are of discs below [`discs`](Self::discs), in the rows documented, with numbers of cell offsets that exist: sweeps read
/// and add unchecked.
pub unsafe trait Finder<S, P: Precision>: Sync {
    /// Buffer for the pairs found.
    type Found: Clone + std::fmt::Debug + Default + Send;

    /// Number of discs.
    fn discs(&self) -> usize;

    /// Rows of the discs.
    fn rows(&self) -> RowLayout;

    /// Replaces the contents of `found` by the pairs from `cursor` on in `rows`: some hundred, or all that remain. Advances the
    /// cursor, to the end of the rows when no pair is left. Partners are in these rows and those [`ahead`](RowLayout::ahead) of them.
    ///
    /// # Errors
    /// [`ProgramError::NoSuchInstructionSet`].
    fn find(
        &self,
        discs: &StateRecords<S>,
        rows: Range<usize>,
        cursor: &mut SearchCursor,
        found: &mut Self::Found,
        set: InstructionSet,
    ) -> Result<(), ProgramError>;

    /// Average number of pairs tried per disc if the search of a row can be cut into [parts](Self::find_part), else 0.
    #[inline]
    fn pairs_tried(&self) -> f64 {
        0.0
    }

    /// Numbers, in search order, of the items searched in some rows; any cut of this range is a valid division into parts.
    #[inline]
    fn search_items(&self, _rows: Range<usize>) -> Range<usize> {
        0..0
    }

    /// Replaces the contents of `found` by all pairs of a part. The parts of some rows, one after the other, give the pairs of
    /// [`find`](Self::find) in the same order.
    #[inline]
    fn find_part(&self, _discs: &StateRecords<S>, _part: Range<usize>, _found: &mut Self::Found) {}

    /// Appends pairs of some rows that the regular search does not find.
    #[inline]
    fn find_extra_pairs(&self, _rows: Range<usize>, _: &mut PairBuffer<P>) {}

    /// The pairs found.
    fn pairs<'a>(&'a self, found: &'a Self::Found) -> impl PairSequence<P> + 'a;
}

/// Pairs that are found before the law is evaluated for them: they and their discs stay in the nearest cache.
pub(super) const AT_ONCE: usize = 512;

/// Tolerance of squared distances in single precision; pairs slightly beyond contact do no harm.
pub(super) const MARGIN: f64 = 1.0 + 2e-5;

/// Position at which a search resumes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SearchCursor {
    pub(super) row: usize,
    /// Position in the row, in the finder's own unit.
    pub(super) along: usize,
}

impl SearchCursor {
    /// At the beginning of a row.
    #[inline]
    pub fn at(row: usize) -> Self {
        SearchCursor { row, along: 0 }
    }

    /// The row to search next.
    #[inline]
    pub fn row(&self) -> usize {
        self.row
    }
}
