//! What a sweep asks of whatever finds its pairs.

use super::pairs::{Pairs, Touches};
use crate::InstructionSet;
use crate::backend::Precision;
use crate::isa::ProgramError;
use std::ops::Range;

/// How rows are cut into bands that threads may sweep beside each other. A function of nothing but the scene: it comes
/// into the order of summation.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Rows {
    /// How many there are.
    pub count: usize,
    /// How many rows ahead the partners of a row may be.
    pub ahead: usize,
    /// Fewest rows of a band.
    pub band: usize,
}

impl Rows {
    /// The rows of each band.
    #[inline]
    pub fn bands(&self) -> impl ExactSizeIterator<Item = Range<usize>> + use<> {
        let rows = self.count;
        let count = (rows / self.band.max(2 * self.ahead)).max(1);
        (0..count).map(move |band| band * rows / count..(band + 1) * rows / count)
    }
}

/// What one of several ranks sees to: whole bands, whose sums and notes are its own. Its discs may be in rows beside them.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Share {
    /// The rows of its bands.
    pub rows: Range<usize>,
    /// How many rows beyond these its discs may be.
    pub margin: usize,
}

impl Share {
    /// Those of some rows that lie at most `below` rows before the own ones or `above` behind them, all rows being `count`: the first follow on the
    /// last.
    #[inline]
    pub fn near(&self, rows: &Range<usize>, [below, above]: [usize; 2], count: usize) -> Vec<Range<usize>> {
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
        // Where a rank is near itself around the box, rows come twice.
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

/// Finds pairs of discs that may touch: every pair that does, once, and others as few as it likes.
///
/// # Safety
/// Pairs are of discs below [`discs`](Self::discs), in the rows said: sweeps read and add unchecked.
pub unsafe trait Finder<S, P: Precision>: Sync {
    /// The pairs found, and room for finding them.
    type Found: Clone + std::fmt::Debug + Default + Send;

    /// How many discs there are; pairs are of these.
    fn discs(&self) -> usize;

    /// The rows that discs are in.
    fn rows(&self) -> Rows;

    /// Replaces what was found by what is found from `cursor` on in `rows`: some hundred pairs, or all that are left.
    /// The cursor moves on, to the end of the rows when nothing is left. Partners are in the rows and those
    /// [`ahead`](Rows::ahead) of them.
    ///
    /// # Errors
    /// [`ProgramError::NoSuchInstructionSet`].
    fn find(
        &self,
        places: [&[S]; 2],
        rows: Range<usize>,
        cursor: &mut Cursor,
        found: &mut Self::Found,
        set: InstructionSet,
    ) -> Result<(), ProgramError>;

    /// Pairs tried for each disc, on the average, where the search of a row may be cut into [parts](Self::find_part); 0 where it
    /// may not.
    #[inline]
    fn tried(&self) -> f64 {
        0.0
    }

    /// Numbers, in the order of the search, of what is searched in some rows: any cut of them is one into parts.
    #[inline]
    fn searched(&self, _rows: Range<usize>) -> Range<usize> {
        0..0
    }

    /// Replaces what was found by all pairs of a part. Those of all parts of some rows, one part after the other, are those of
    /// [`find`](Self::find) in the same order.
    #[inline]
    fn find_part(&self, _places: [&[S]; 2], _part: Range<usize>, _found: &mut Self::Found) {}

    /// Appends the pairs that are found beside the search of some rows.
    #[inline]
    fn find_beside(&self, _rows: Range<usize>, _: &mut Touches<P>) {}

    /// What was found.
    fn pairs<'a>(&'a self, found: &'a Self::Found) -> impl Pairs<P> + 'a;
}

/// Pairs that are found before the law is asked about them: they and their discs stay in the nearest cache.
pub(super) const AT_ONCE: usize = 512;

/// Squares of distances may be off by so much in single precision, and pairs beyond contact do no harm.
pub(super) const MARGIN: f64 = 1.0 + 2e-5;

/// Where a search goes on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Cursor {
    pub(super) row: usize,
    /// How far in the row: in units of the finder's own.
    pub(super) along: usize,
}

impl Cursor {
    /// At the beginning of a row.
    #[inline]
    pub fn at(row: usize) -> Self {
        Cursor { row, along: 0 }
    }

    /// The row that is searched.
    #[inline]
    pub fn row(&self) -> usize {
        self.row
    }
}
