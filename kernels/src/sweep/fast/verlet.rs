//! Pairs from Verlet lists: the pairs that were near when the lists were built.
//!
//! Lists hold every pair nearer than contact distance plus skin. Until a disc has moved by half the skin, no other pair can
//! touch. They are built from [`Sectors`] and stored one behind the other:
//!
//! ```text
//! rows      0              3           4           index in `pairs` of the first pair of each row of sectors, and the end
//! pairs     4-9 4-2 4-7    9-2         2-7         the second disc with the number of the cell offset in its upper three bits
//! ```
//!
//! They are pairs, not a list for each disc: in a thin gas most such lists would be empty or short, and no processor predicts
//! their lengths.
//!
//! A pair is listed once, with the disc that comes first in the order of the sectors. The *cell offset* is one of the five from a
//! sector to those ahead of it (itself first). It gives the vector between the reference points of the two positions. So a pair
//! across a periodic side costs no more than any other, and no position is ever wrapped.

use super::finder::{Finder, RowLayout, SearchCursor};
use super::grid::CellGrid;
use super::near::DistanceFilter;
use super::pairs::{DiscPair, PairBuffer, PairSequence};
use super::records::{RecordEntry, StateRecords};
use super::sectors::Sectors;
use crate::InstructionSet;
use crate::backend::Precision;
use crate::isa::{Element, ProgramError};
use crate::threads::{on_threads, pieces};
use std::ops::Range;

/// Bits of a partner that number the disc; the bits above number the cell offset.
const DISC: u32 = 29;

/// Pairs compared between two checks whether enough are found.
const SOME: usize = 16;

/// Ratio of the smallest radius to the largest one below which pairs are listed by their own radii.
const WIDE: f64 = 0.7;

/// Rows of sectors whose lists one thread builds in one piece.
const ROWS: usize = 8;

/// Every pair nearer than contact distance plus skin, once, with the disc that comes first in the order of the sectors. Contact is at
/// the largest diameter, or at the sum of the own radii if these differ widely.
///
/// Positions stay relative to the sectors in which the discs were when the lists were built.
#[derive(Clone, Debug, PartialEq)]
pub struct VerletList {
    grid: CellGrid,
    reach: f64,
    /// True if radii differ so much that each pair is listed, and taken for near, by the sum of its own.
    by_radii: bool,
    discs: usize,
    /// Index in `pairs` of the first pair of each row of sectors, and the end.
    rows: Vec<u32>,
    pairs: Vec<DiscPair>,
}

/// Lists of some rows.
#[derive(Default)]
struct RowLists {
    rows: Vec<u32>,
    pairs: Vec<DiscPair>,
}

impl VerletList {
    /// Lists the pairs of the discs in sectors that are at most `skin` (length) from contact.
    ///
    /// # Panics
    /// If the sectors are too narrow for that, or a disc has no record.
    pub fn new<S: Element>(sectors: &Sectors, discs: &StateRecords<S>, skin: f64) -> Self {
        let (grid, reach) = (*sectors.grid(), sectors.reach());
        let limit = (reach + skin) * (reach + skin);
        assert!(
            // A single sector along an open side has nothing beyond it.
            (0..2).all(|axis| {
                let alone = grid.counts[axis] == 1 && !grid.periodic[axis];
                alone || grid.frame.edge[axis] * (1.0 + 1e-12) >= reach + skin
            }),
            "sectors too narrow for the reach and the skin"
        );
        let at = |disc: u32| discs.position(disc as usize);
        let radius = |disc: u32| discs.get(RecordEntry::Radius, disc as usize).to_f64();
        let by_radii = discs.has(RecordEntry::Radius) && {
            let radii = (0..sectors.disc_count() as u32).map(radius);
            let [low, high] =
                radii.fold([f64::INFINITY, 0.0_f64], |[low, high], it| [low.min(it), high.max(it)]);
            // A law that reaches beyond contact lists all pairs within its reach.
            low < WIDE * high && reach <= 2.0 * high * (1.0 + 1e-6)
        };
        let limit_of = |disc: u32, partner: u32| match by_radii {
            true => (1.0 + 1e-9) * (radius(disc) + radius(partner) + skin).powi(2),
            false => limit,
        };
        let discs = sectors.disc_count();
        let cell_offsets = grid.cell_offsets();
        let part = |rows: Range<usize>| {
            let mut part = RowLists::default();
            for row in rows {
                part.rows.push(part.pairs.len() as u32);
                sectors.pairs_of_row(row, 0..grid.counts[0], |disc, partner, cell_offset| {
                    let (here, there) = (at(disc), at(partner));
                    let along = |axis: usize| (here[axis] - there[axis]) - cell_offsets[cell_offset][axis];
                    if along(0) * along(0) + along(1) * along(1) < limit_of(disc, partner) {
                        part.pairs.push([disc, partner | (cell_offset as u32) << DISC]);
                    }
                });
            }
            part
        };
        let parts = on_threads(pieces(0..grid.counts[1], ROWS), part);
        let all = parts.iter().map(|part| part.pairs.len()).sum::<usize>();
        let mut list = VerletList {
            grid,
            reach,
            by_radii,
            discs,
            rows: vec![0; grid.counts[1] + 1],
            pairs: vec![[0; 2]; all],
        };
        list.rows[grid.counts[1]] = all as u32;
        list.join(parts);
        list
    }

    /// Copies the lists of all parts to their final position, one behind the other.
    fn join(&mut self, parts: Vec<RowLists>) {
        let (mut rows, mut pairs) = (self.rows.as_mut_slice(), self.pairs.as_mut_slice());
        let mut before = 0;
        let copies = parts.into_iter().map(|part| {
            let (of_rows, behind) = std::mem::take(&mut rows).split_at_mut(part.rows.len());
            rows = behind;
            let (of_pairs, behind) = std::mem::take(&mut pairs).split_at_mut(part.pairs.len());
            pairs = behind;
            let from = before;
            before += part.pairs.len() as u32;
            (part, of_rows, of_pairs, from)
        });
        on_threads(copies, |(part, rows, pairs, before)| {
            rows.iter_mut().zip(part.rows).for_each(|(to, row)| *to = row + before);
            pairs.copy_from_slice(&part.pairs);
        });
    }

    /// Number of pairs listed.
    #[inline]
    pub fn entries(&self) -> usize {
        self.pairs.len()
    }

    /// Number of pairs listed in some rows.
    #[inline]
    pub fn entries_in_rows(&self, rows: Range<usize>) -> usize {
        (self.rows[rows.end] - self.rows[rows.start]) as usize
    }
}

// SAFETY: the lists hold members of sectors, which are numbers of discs below `discs`; the partners of a row's discs are in that
// row or the next.
unsafe impl<S: Element, P: Precision> Finder<S, P> for VerletList {
    type Found = PairBuffer<P>;

    #[inline]
    fn discs(&self) -> usize {
        self.discs
    }

    #[inline]
    fn rows(&self) -> RowLayout {
        self.grid.rows()
    }

    fn find(
        &self,
        discs: &StateRecords<S>,
        rows: Range<usize>,
        cursor: &mut SearchCursor,
        found: &mut PairBuffer<P>,
        _: InstructionSet,
    ) -> Result<(), ProgramError> {
        let mut near = DistanceFilter::new(discs, self.discs, &self.grid, (self.reach, self.by_radii), found);
        let pairs_of = |row: usize| self.rows[row] as usize..self.rows[row + 1] as usize;
        near.search(
            rows,
            cursor,
            |row| pairs_of(row).len().div_ceil(SOME),
            |near, row, along| {
                let Range { start, end } = pairs_of(row);
                let first = start + along * SOME;
                let some = self.pairs[first..(first + SOME).min(end)].iter();
                let some = some.map(|&[disc, partner]| {
                    ([disc, partner & ((1 << DISC) - 1)], (partner >> DISC) as usize)
                });
                // SAFETY: both are members of sectors and so discs, and `pairs_of_row` numbered the cell offset, below 5.
                unsafe { near.list_those_near(some) };
            },
        );
        Ok(())
    }

    #[inline]
    fn pairs<'a>(&'a self, found: &'a PairBuffer<P>) -> impl PairSequence<P> + 'a {
        found
    }
}
