//! Pairs on a lattice with at most one disc a cell: at the places of half the mask.
//!
//! A disc's partners lie at fixed shifts from its cell. Of every two opposite places one is looked at: those to the right in
//! the own row and all of the rows above, numbered so (5×5 cells: 12 places):
//!
//! ```text
//! row + 2     7  8  9 10 11
//! row + 1     2  3  4  5  6
//! own row           ·  0  1
//! ```
//!
//! Two searches find the same pairs. Where many cells are occupied, registers of neighbouring cells are compared with the same
//! cells at a shift, empty or not (`detection.rs`). Where few are ([`SPARSE`]), a bit for every cell tells which, and each disc
//! asks for the bits around it (`sparse.rs`). Either gives candidates, a word each: the first cell of a group of 16, the place
//! and the lane (`codes.rs`). From that two loads from tables give the two cells, and two from the Index the discs.

mod bits;
mod codes;
mod detection;
mod occupancy;
mod sparse;

pub use codes::Codes;
pub use occupancy::{Occupancy, SPARSE, Taken};

use super::finder::{AT_ONCE, Cursor, Finder, Rows};
use super::grid::Grid;
use super::pairs::{Pairs, SENTINELS, Touches};
use crate::InstructionSet;
use crate::backend::Precision;
use crate::backend::dispatch_native;
use crate::isa::{Element, ProgramError};
use crate::sweep::lattice::LatticeShape;
use codes::Candidate;
use detection::Search;
use sparse::SparseSearch;
use std::ops::Range;

/// Rows of a band, at least.
const BAND: usize = 16;

/// An occupied lattice, searched cell by cell, or, if it is sparse, disc by disc.
#[derive(Clone, Copy, Debug)]
pub struct Lattice<'a, P> {
    /// Who is where.
    pub occupancy: &'a Occupancy,
    /// What pairs of cells are packed into.
    pub codes: &'a Codes<P>,
    /// By how much more than its contact distance a pair may be apart and is still found, as a fraction of that: 0 but where
    /// places are others than those that the occupancy was last given.
    pub slack: f64,
}

/// The pairs found on a lattice.
#[derive(Clone, Debug, Default)]
pub struct Candidates {
    candidates: Vec<Candidate>,
    cells: Vec<u64>,
    /// The lattice that they were found on.
    shape: Option<LatticeShape>,
}

// SAFETY: the Index numbers discs where the bit of a cell is set, and candidates are pairs of such cells: the own one in the rows
// searched, the partner's at most as many rows ahead as the mask is wide to one side.
unsafe impl<S: Element, P: Precision> Finder<S, P> for Lattice<'_, P> {
    type Found = Candidates;

    #[inline]
    fn discs(&self) -> usize {
        self.occupancy.discs()
    }

    #[inline]
    fn rows(&self) -> Rows {
        Rows { count: self.occupancy.shape().rows(), ahead: self.occupancy.half_width(), band: BAND }
    }

    fn find(
        &self,
        places: [&[S]; 2],
        rows: Range<usize>,
        cursor: &mut Cursor,
        found: &mut Candidates,
        set: InstructionSet,
    ) -> Result<(), ProgramError> {
        let Lattice { occupancy, codes, slack } = *self;
        let Candidates { candidates: found, cells, shape } = found;
        assert!(codes.are_of(occupancy), "codes of this lattice");
        let entries = occupancy.discs() + SENTINELS;
        assert!(places.iter().all(|place| place.len() == entries), "a place for every disc");
        *shape = Some(*occupancy.shape());
        found.clear();
        if occupancy.is_sparse() {
            let reach = occupancy.reach();
            dispatch_native(
                set,
                SparseSearch { occupancy, codes, places, reach, rows, cursor, full: AT_ONCE, found, cells },
            )
        } else {
            let beyond = (1.0 + slack) * (1.0 + slack);
            dispatch_native(set, Search { occupancy, beyond, rows, cursor, full: AT_ONCE, found })
        }
    }

    /// Discs in shared cells with all discs around them, and with each other.
    fn find_beside(&self, rows: Range<usize>, found: &mut Touches<P>) {
        let occupancy = self.occupancy;
        let (shared, shape) = (occupancy.shared_cells(), occupancy.shape());
        let Grid { frame, counts, periodic } = occupancy.grid();
        let half = occupancy.half_width() as isize;
        let cell_offset = |offset: [isize; 2]| [0, 1].map(|axis| offset[axis] as f64 * frame.edge[axis]);
        let those = shared.iter().enumerate().filter(|(_, (_, [_, row]))| rows.contains(row));
        for (at, &(disc, [column, row])) in those {
            for offset in (-half..=half).flat_map(|rows| (-half..=half).map(move |columns| [columns, rows])) {
                let position = shape.position(column as isize + offset[0], row as isize + offset[1]);
                let there = occupancy.index()[position];
                if (there as usize) < occupancy.discs() {
                    found.push([disc, there], cell_offset(offset));
                }
            }
            for &(other, cell) in &shared[at + 1..] {
                let offset = [0, 1].map(|axis| {
                    let (count, cell_offset) =
                        (counts[axis] as isize, cell[axis] as isize - [column, row][axis] as isize);
                    if periodic[axis] && cell_offset.abs() > half {
                        cell_offset - cell_offset.signum() * count
                    } else {
                        cell_offset
                    }
                });
                if offset.iter().all(|cell_offset| cell_offset.abs() <= half) {
                    found.push([disc, other], cell_offset(offset));
                }
            }
        }
    }

    #[inline]
    fn pairs<'a>(&'a self, found: &'a Candidates) -> impl Pairs<P> + 'a {
        assert!(self.codes.are_of(self.occupancy), "codes of this lattice");
        assert!(found.candidates.is_empty() || found.shape.as_ref() == Some(self.occupancy.shape()));
        Packed { codes: self.codes, index: self.occupancy.index(), candidates: &found.candidates }
    }
}

/// Candidates and what unpacks them.
struct Packed<'a, P> {
    codes: &'a Codes<P>,
    index: &'a [u32],
    candidates: &'a [Candidate],
}

impl<P: Precision> Pairs<P> for Packed<'_, P> {
    #[inline(always)]
    fn count(&self) -> usize {
        self.candidates.len()
    }
    #[inline(always)]
    fn pair(&self, number: usize) -> ([u32; 2], [P; 2]) {
        self.codes.pair(self.candidates[number], self.index)
    }
}
