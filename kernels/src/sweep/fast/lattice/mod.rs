//! Pair search on a lattice with at most one disc per cell, at the offsets of half the mask.
//!
//! The partners of a disc are at fixed shifts from its cell. Of every two opposite offsets one is searched: those to the right in
//! the own row and all in the rows above, numbered as follows (5×5 cells: 12 offsets):
//!
//! ```text
//! row + 2     7  8  9 10 11
//! row + 1     2  3  4  5  6
//! own row           ·  0  1
//! ```
//!
//! Two searches find the same pairs. Where many cells are occupied, registers of neighbouring cells are compared with the same
//! cells at a shift, empty or not (`detection.rs`). Where few are ([`SPARSE`]), one bit per cell marks occupied cells, and each
//! disc reads the bits around it (`sparse.rs`). Both give candidates of one word each: the first cell of a group of 16, the
//! offset and the lane (`codes.rs`). A table load turns it into the two cells, and two loads from the Index into the discs.

mod bits;
mod codes;
mod detection;
mod occupancy;
mod sparse;

pub use codes::Codes;
pub use occupancy::{CellTaken, Occupancy, SPARSE};

use super::finder::{AT_ONCE, Finder, RowLayout, SearchCursor};
use super::grid::CellGrid;
use super::pairs::{CellOffset, PairBuffer, PairSequence};
use super::records::StateRecords;
use crate::InstructionSet;
use crate::backend::Precision;
use crate::backend::dispatch_native;
use crate::isa::{Element, ProgramError};
use crate::sweep::lattice::LatticeShape;
use codes::PackedCandidate;
use detection::DenseSearch;
use sparse::SparseSearch;
use std::ops::Range;

/// Least number of rows in a band.
const BAND: usize = 16;

/// An occupied lattice, searched cell by cell or, if it is sparse, disc by disc.
#[derive(Clone, Copy, Debug)]
pub struct Lattice<'a, P> {
    /// Assignment of discs to cells.
    pub occupancy: &'a Occupancy,
    /// Tables that decode candidates.
    pub codes: &'a Codes<P>,
    /// Fraction of the contact distance by which a pair may be farther apart and is still found. It is 0 unless the positions
    /// differ from those last stored in the occupancy.
    pub slack: f64,
}

/// Pairs found on a lattice.
#[derive(Clone, Debug, Default)]
pub struct Candidates {
    candidates: Vec<PackedCandidate>,
    cells: Vec<u64>,
    /// The lattice on which they were found.
    shape: Option<LatticeShape>,
}

// SAFETY: the Index numbers discs where the bit of a cell is set, and candidates are pairs of such cells: the own one in the rows
// searched, the partner's at most a half-width of the mask ahead.
unsafe impl<S: Element, P: Precision> Finder<S, P> for Lattice<'_, P> {
    type Found = Candidates;

    #[inline]
    fn discs(&self) -> usize {
        self.occupancy.discs()
    }

    #[inline]
    fn rows(&self) -> RowLayout {
        RowLayout { count: self.occupancy.shape().rows(), ahead: self.occupancy.half_width(), band: BAND }
    }

    fn find(
        &self,
        discs: &StateRecords<S>,
        rows: Range<usize>,
        cursor: &mut SearchCursor,
        found: &mut Candidates,
        set: InstructionSet,
    ) -> Result<(), ProgramError> {
        let Lattice { occupancy, codes, slack } = *self;
        let Candidates { candidates: found, cells, shape } = found;
        assert!(codes.is_for(occupancy), "the codes are those of another lattice");
        assert_eq!(discs.discs(), occupancy.discs(), "the lattice and the records must have the same discs");
        *shape = Some(*occupancy.shape());
        found.clear();
        if occupancy.is_sparse() {
            let reach = occupancy.reach();
            dispatch_native(
                set,
                SparseSearch { occupancy, codes, discs, reach, rows, cursor, full: AT_ONCE, found, cells },
            )
        } else {
            dispatch_native(set, DenseSearch { occupancy, slack, rows, cursor, full: AT_ONCE, found })
        }
    }

    /// Pairs each disc in a shared cell with all discs around it, and with the others in shared cells.
    fn find_extra_pairs(&self, rows: Range<usize>, found: &mut PairBuffer<P>) {
        let occupancy = self.occupancy;
        let (shared, shape) = (occupancy.shared_cells(), occupancy.shape());
        let CellGrid { frame, counts, periodic } = occupancy.grid();
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
                    let (count, cells) =
                        (counts[axis] as isize, cell[axis] as isize - [column, row][axis] as isize);
                    if periodic[axis] && cells.abs() > half { cells - cells.signum() * count } else { cells }
                });
                if offset.iter().all(|cells| cells.abs() <= half) {
                    found.push([disc, other], cell_offset(offset));
                }
            }
        }
    }

    #[inline]
    fn pairs<'a>(&'a self, found: &'a Candidates) -> impl PairSequence<P> + 'a {
        assert!(self.codes.is_for(self.occupancy), "the codes are those of another lattice");
        assert!(found.candidates.is_empty() || found.shape.as_ref() == Some(self.occupancy.shape()));
        PackedPairs { codes: self.codes, index: self.occupancy.index(), candidates: &found.candidates }
    }
}

/// Candidates with the tables that decode them.
struct PackedPairs<'a, P> {
    codes: &'a Codes<P>,
    index: &'a [u32],
    candidates: &'a [PackedCandidate],
}

impl<P: Precision> PairSequence<P> for PackedPairs<'_, P> {
    #[inline(always)]
    fn count(&self) -> usize {
        self.candidates.len()
    }
    #[inline(always)]
    fn pair(&self, number: usize) -> ([u32; 2], u32) {
        self.codes.pair(self.candidates[number], self.index)
    }
    #[inline(always)]
    fn cell_offsets(&self) -> &[CellOffset<P>] {
        self.codes.cell_offsets()
    }
}
