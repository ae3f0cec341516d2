//! Grid of sectors, and the sectors ahead of each.

use super::finder::RowLayout;
use crate::sweep::lattice::LatticeFrame;

/// Least number of rows in a band.
const BAND: usize = 16;

/// Sectors ahead of a sector in the order of a sweep, itself first: columns and rows.
pub(super) const AHEAD: [[isize; 2]; 5] = [[0, 0], [1, 0], [-1, 1], [0, 1], [1, 1]];

/// Mean number of discs per sector: fewer make many empty sectors, more make many pairs to try.
const OCCUPANTS: f64 = 0.7;

/// Reasons why a box cannot be divided into sectors.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum GridError {
    /// A periodic side has no room for three sectors; a pair would be visited twice.
    #[error(
        "the periodic side along {}, {side} long, has no room for three sectors of at least {reach}: a pair would be \
         visited twice",
        ["x", "y"][*axis]
    )]
    PeriodicTooShort {
        /// The axis.
        axis: usize,
        /// Its length (length).
        side: f64,
        /// Least width of a sector (length).
        reach: f64,
    },
    /// More sectors than can be numbered.
    #[error("{columns}×{rows} sectors are more than the 2^32 − 2 that can be numbered")]
    TooMany {
        /// Along x.
        columns: f64,
        /// Along y.
        rows: f64,
    },
}

/// Grid of sectors.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CellGrid {
    /// Origin and sector size.
    pub frame: LatticeFrame,
    /// Columns and rows.
    pub counts: [usize; 2],
    /// True for a periodic side.
    pub periodic: [bool; 2],
}

impl CellGrid {
    /// Divides a box of given sides (length) into sectors for `discs` discs, at least `reach` wide (length) and not much wider
    /// than `widest`.
    ///
    /// # Errors
    /// [`GridError`] if a periodic side has no room for three sectors, or there are too many to number.
    pub fn new(
        origin: [f64; 2],
        sides: [f64; 2],
        periodic: [bool; 2],
        reach: f64,
        widest: f64,
        discs: usize,
    ) -> Result<CellGrid, GridError> {
        let room = OCCUPANTS * sides[0] * sides[1] / discs.max(1) as f64;
        let wide = reach.max(room.sqrt().min(widest));
        let mut counts = [1.0, 1.0];
        for axis in 0..2 {
            let side = sides[axis];
            let least = if periodic[axis] { 3.0 } else { 1.0 };
            if periodic[axis] && (side / reach).floor() < least {
                return Err(GridError::PeriodicTooShort { axis, side, reach });
            }
            counts[axis] = (side / wide).floor().max(least);
        }
        let [columns, rows] = counts;
        if columns * rows >= f64::from(u32::MAX) || (columns * rows).is_nan() {
            return Err(GridError::TooMany { columns, rows });
        }
        let edge = [sides[0] / columns, sides[1] / rows];
        Ok(CellGrid {
            frame: LatticeFrame { origin, edge },
            counts: counts.map(|count| count as usize),
            periodic,
        })
    }

    /// The sector at an offset of at most one column and one row.
    #[inline(always)]
    pub(super) fn adjacent_cell(
        &self,
        [column, row]: [usize; 2],
        [columns, rows]: [isize; 2],
    ) -> Option<[usize; 2]> {
        let along = |axis: usize, from: usize, by: isize| {
            let (count, there) = (self.counts[axis] as isize, from as isize + by);
            // Division would cost more than the work on the sector.
            let inside = if there < 0 {
                there + count
            } else if there >= count {
                there - count
            } else {
                return Some(there as usize);
            };
            self.periodic[axis].then_some(inside as usize)
        };
        Some([along(0, column, columns)?, along(1, row, rows)?])
    }

    /// Vector from the centre of a sector to the one `ahead` columns and rows from it (length).
    #[inline]
    fn cell_offset(&self, ahead: [isize; 2]) -> [f64; 2] {
        [0, 1].map(|axis| ahead[axis] as f64 * self.frame.edge[axis])
    }

    /// Offsets to the sectors ahead, in their order.
    #[inline]
    pub(super) fn cell_offsets(&self) -> [[f64; 2]; 5] {
        AHEAD.map(|ahead| self.cell_offset(ahead))
    }

    #[inline]
    pub(super) fn rows(&self) -> RowLayout {
        RowLayout { count: self.counts[1], ahead: 1, band: BAND }
    }
}
