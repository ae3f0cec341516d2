//! Pair search in sectors: cells as wide as the reach of a contact, which hold any number of discs.
//!
//! The partners of a disc are in its own sector and in the eight around it. Each pair of sectors is visited from one side:
//!
//! ```text
//! row + 1     2  3  4        cell offsets from a sector to those ahead of it; 0 is itself
//! own row        0  1
//! ```
//!
//! `members` stores the discs in order of their sectors, `starts` the beginning of each sector. So sectors 0 and 1 are one
//! contiguous range of members, and 2, 3 and 4 another:
//!
//! ```text
//! starts    0  2  2  5 ...           sector 1 is empty
//! members   8  3  1  4  9 ...        within a sector in an order that does not depend on the past
//! ```
//!
//! They are sorted by counting, on all threads: count the discs of each sector, compute where each begins, store the discs as
//! they come, and finally sort the few members of each sector. So the result does not depend on the threads.
//!
//! If there are few sectors with many members, nearly all of the work is comparing them. Then all threads compare, each the
//! partners of some members, and the pairs are added up in the order of a single thread.
//!
//! Inside the box a disc is compared with two ranges, each in one loop. At the edge, where a range ends or continues at the other
//! side of the box, it is compared sector by sector.

use super::finder::{Finder, RowLayout, SearchCursor};
use super::grid::{AHEAD, CellGrid};
use super::near::DistanceFilter;
use super::pairs::{PairBuffer, PairSequence};
use super::records::StateRecords;
use crate::InstructionSet;
use crate::backend::Precision;
use crate::isa::{Element, ProgramError};
use crate::threads::{PIECE, in_pieces, is_single_threaded, on_threads, over_pieces, reordered, shared};
use std::ops::Range;
use std::sync::atomic::{AtomicU32, Ordering};

/// Assignment of discs to sectors. The caller gives the order of the discs within a sector, so that no order of summation depends
/// on the past.
#[derive(Clone, Debug)]
pub struct Sectors {
    grid: CellGrid,
    reach: f64,
    /// The sector of each disc.
    sector: Vec<u32>,
    /// Index in `members` of the first disc of each sector, and the end.
    starts: Vec<u32>,
    members: Vec<u32>,
}

/// Approximate number of members that one thread sorts in one piece.
const MEMBERS: u32 = 4096;

/// Sector number of a disc outside all sectors.
const NOWHERE: u32 = u32::MAX;

impl Sectors {
    /// Empty sectors for `discs` discs that touch when their centres are at most `reach` (length) apart.
    ///
    /// # Panics
    /// If there are 2²⁹ discs or more.
    #[inline]
    pub fn new(grid: CellGrid, discs: usize, reach: f64) -> Self {
        assert!(discs < 1 << 29, "{discs} discs are too many to number: sectors hold fewer than 2^29");
        let starts = vec![0; grid.counts[0] * grid.counts[1] + 1];
        Sectors { grid, reach, sector: vec![NOWHERE; discs], starts, members: vec![] }
    }

    /// Empty copy of the sectors for `discs` discs.
    #[inline]
    pub fn empty_copy(&self, discs: usize) -> Self {
        Sectors::new(self.grid, discs, self.reach)
    }

    /// Grid of the sectors.
    #[inline]
    pub fn grid(&self) -> &CellGrid {
        &self.grid
    }

    /// Reach of a contact (length).
    #[inline]
    pub(super) fn reach(&self) -> f64 {
        self.reach
    }

    /// Number of discs.
    #[inline]
    pub(super) fn disc_count(&self) -> usize {
        self.sector.len()
    }

    /// Column and row of a disc; `None` if it is in no sector.
    #[inline]
    pub fn cell(&self, disc: usize) -> Option<[usize; 2]> {
        let (sector, columns) = (self.sector[disc] as usize, self.grid.counts[0]);
        (self.sector[disc] != NOWHERE).then(|| [sector % columns, sector / columns])
    }

    /// Moves a disc into a sector; the next [`arrange`](Self::arrange) makes it a member.
    ///
    /// # Panics
    /// If there is no such disc or sector.
    #[inline]
    pub fn enter(&mut self, disc: usize, [column, row]: [usize; 2]) {
        let [columns, rows] = self.grid.counts;
        assert!(
            column < columns && row < rows,
            "no sector in column {column}, row {row}: there are {columns} columns and {rows} rows"
        );
        self.sector[disc] = (row * columns + column) as u32;
    }

    /// Removes a disc from its sector, if it is in one.
    #[inline]
    pub fn leave(&mut self, disc: usize) {
        self.sector[disc] = NOWHERE;
    }

    /// Makes every disc a member of its sector. Members of a sector are ordered by their `number`, which is unique.
    pub fn arrange(&mut self, number: impl Fn(usize) -> usize + Sync) {
        let Sectors { sector, starts, members, .. } = self;
        // Atomic additions are slow: a single thread avoids them.
        let alone = is_single_threaded(sector.len());
        let add = |count: &AtomicU32, more: u32| match alone {
            true => {
                let before = count.load(Ordering::Relaxed);
                count.store(before.wrapping_add(more), Ordering::Relaxed);
                before
            }
            false => count.fetch_add(more, Ordering::Relaxed),
        };
        let inside = |discs: Range<usize>| {
            let sectors = discs.clone().zip(&sector[discs]);
            sectors.filter(|&(_, &sector)| sector != NOWHERE).map(|(disc, &sector)| (disc, sector as usize))
        };
        starts.fill(0);
        let counts = shared(starts);
        over_pieces(0..sector.len(), |discs| {
            inside(discs).for_each(|(_, sector)| _ = add(&counts[sector], 1));
        });
        let mut end = 0;
        for start in starts.iter_mut() {
            end += *start;
            *start = end;
        }
        members.resize(end as usize, 0);
        // From the ends down, so that the ends become the starts.
        let (ends, slots) = (shared(starts), shared(members));
        over_pieces(0..sector.len(), |discs| {
            inside(discs).for_each(|(disc, sector)| {
                // Adding 2³² − 1 subtracts one.
                let slot = add(&ends[sector], u32::MAX) - 1;
                slots[slot as usize].store(disc as u32, Ordering::Relaxed);
            });
        });
        let (starts, mut rest) = (&*starts, members.as_mut_slice());
        let parts = balanced_pieces(starts).map(|sectors| {
            let length = (starts[sectors.end] - starts[sectors.start]) as usize;
            let (here, behind) = std::mem::take(&mut rest).split_at_mut(length);
            rest = behind;
            (sectors, here)
        });
        on_threads(parts, |(sectors, members)| {
            let first = starts[sectors.start];
            for ends in starts[sectors.start..=sectors.end].windows(2).filter(|ends| ends[1] - ends[0] > 1) {
                members[(ends[0] - first) as usize..(ends[1] - first) as usize]
                    .sort_unstable_by_key(|&disc| number(disc as usize));
            }
        });
    }

    /// The discs in order of their sectors, row by row.
    #[inline]
    pub fn order(&self) -> Vec<u32> {
        self.members.clone()
    }

    /// Renumbers the discs: the new disc `n` is the old disc `order[n]`.
    ///
    /// # Panics
    /// If `order` does not name every disc once.
    pub fn renumber(&mut self, order: &[u32]) {
        assert_eq!(order.len(), self.sector.len(), "the order must have one entry per disc");
        let mut now = vec![NOWHERE; order.len()];
        let entries = shared(&mut now);
        over_pieces(0..order.len(), |discs| {
            for (disc, &before) in discs.clone().zip(&order[discs]) {
                entries[before as usize].store(disc as u32, Ordering::Relaxed);
            }
        });
        // As many names as discs: if none is left out, none is named twice.
        assert!(!now.contains(&NOWHERE), "the order must name every disc once");
        self.sector = reordered(&self.sector, order);
        in_pieces(&mut self.members, |_, members| {
            members.iter_mut().for_each(|member| *member = now[*member as usize]);
        });
    }

    /// The members of the sectors of some rows.
    fn members_of_rows(&self, rows: Range<usize>) -> Range<usize> {
        let [columns, _] = self.grid.counts;
        self.starts[rows.start * columns] as usize..self.starts[rows.end * columns] as usize
    }

    /// Members of a sector and of the `more` sectors that follow it in the row.
    #[inline(always)]
    fn members(&self, sector: usize, more: usize) -> Range<usize> {
        self.starts[sector] as usize..self.starts[sector + more + 1] as usize
    }

    /// Calls `meet(disc, partner, number of the cell offset)` for every disc in some sectors of a row and every partner in the
    /// sectors ahead.
    #[inline(always)]
    pub(super) fn pairs_of_row(
        &self,
        row: usize,
        columns: Range<usize>,
        mut meet: impl FnMut(u32, u32, usize),
    ) {
        for column in columns {
            self.pairs_of_sector([column, row], 0..usize::MAX, &mut meet);
        }
    }

    /// Calls `meet` as [`pairs_of_row`](Self::pairs_of_row) does, for a range of members and in the same order.
    fn pairs_of_members(&self, some: Range<usize>, mut meet: impl FnMut(u32, u32, usize)) {
        let columns = self.grid.counts[0];
        // The last sector that begins there: those before it are empty.
        let first = self.starts.partition_point(|&start| start as usize <= some.start).saturating_sub(1);
        let begin = self.starts[first..].iter().take_while(|&&start| (start as usize) < some.end);
        for (sector, _) in (first..).zip(begin) {
            self.pairs_of_sector([sector % columns, sector / columns], some.clone(), &mut meet);
        }
    }

    /// Calls `meet` as [`pairs_of_row`](Self::pairs_of_row) does, for those members of one sector that are in `some`.
    #[inline(always)]
    fn pairs_of_sector(
        &self,
        [column, row]: [usize; 2],
        some: Range<usize>,
        meet: &mut impl FnMut(u32, u32, usize),
    ) {
        let [all, rows] = self.grid.counts;
        let sector = row * all + column;
        let Range { start, end } = self.members(sector, 0);
        let here = start.max(some.start)..end.min(some.end);
        if here.is_empty() {
            return;
        }
        if column > 0 && column + 1 < all && row + 1 < rows {
            // Consecutive sectors of a row are one range of members.
            let (beside, above) = (self.members(sector, 1).end, self.members(sector + all - 1, 2));
            for at in here {
                let first = self.members[at];
                for &second in &self.members[at + 1..beside] {
                    meet(first, second, self.sector[second as usize] as usize - sector);
                }
                for &second in &self.members[above.clone()] {
                    meet(first, second, self.sector[second as usize] as usize + 3 - (sector + all));
                }
            }
            return;
        }
        let ahead = AHEAD.map(|ahead| match self.grid.adjacent_cell([column, row], ahead) {
            Some([column, row]) => self.members(row * all + column, 0),
            None => 0..0,
        });
        for at in here {
            let first = self.members[at];
            self.members[at + 1..end].iter().for_each(|&second| meet(first, second, 0));
            for (cell_offset, there) in ahead.iter().enumerate().skip(1) {
                self.members[there.clone()].iter().for_each(|&second| meet(first, second, cell_offset));
            }
        }
    }
}

/// Cuts sectors into pieces of [`PIECE`] sectors, or of about [`MEMBERS`] members if that is fewer, from the starts.
fn balanced_pieces(starts: &[u32]) -> impl Iterator<Item = Range<usize>> {
    let mut begin = 0;
    std::iter::from_fn(move || {
        let sectors = starts.len() - 1;
        if begin == sectors {
            return None;
        }
        let filled = starts[begin].saturating_add(MEMBERS);
        let most = sectors.min(begin + PIECE);
        let end = begin + 1 + starts[begin + 1..most].partition_point(|&start| start < filled);
        Some(std::mem::replace(&mut begin, end)..end)
    })
}

// SAFETY: members are numbers of discs below the length of `sector`; the partners of a row's discs are in that row or the next.
unsafe impl<S: Element, P: Precision> Finder<S, P> for Sectors {
    type Found = PairBuffer<P>;

    #[inline]
    fn discs(&self) -> usize {
        self.sector.len()
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
        let mut near = DistanceFilter::new(discs, self.sector.len(), &self.grid, (self.reach, false), found);
        near.search(
            rows,
            cursor,
            |_| self.grid.counts[0],
            |near, row, column| {
                let (mut last, mut at) = (NOWHERE, [0.0; 2]);
                self.pairs_of_row(row, column..column + 1, |first, second, cell_offset| {
                    // SAFETY: `pairs_of_row` gives members of sectors, which are discs, and numbers of cell offsets below 5.
                    unsafe {
                        if first != last {
                            (last, at) = (first, near.disc_position(first));
                        }
                        near.list_if_near(first, at, second, cell_offset);
                    }
                });
            },
        );
        Ok(())
    }

    #[inline]
    fn pairs_tried(&self) -> f64 {
        // The rest of the disc's own sector, and four others.
        4.5 * self.members.len() as f64 / (self.starts.len() - 1) as f64
    }

    #[inline]
    fn search_items(&self, rows: Range<usize>) -> Range<usize> {
        self.members_of_rows(rows)
    }

    fn find_part(&self, discs: &StateRecords<S>, part: Range<usize>, found: &mut PairBuffer<P>) {
        let mut near = DistanceFilter::new(discs, self.sector.len(), &self.grid, (self.reach, false), found);
        let (mut last, mut at) = (NOWHERE, [0.0; 2]);
        self.pairs_of_members(part, |first, second, cell_offset| {
            // SAFETY: `pairs_of_members` gives members of sectors, which are discs, and numbers of cell offsets below 5.
            unsafe {
                if first != last {
                    (last, at) = (first, near.disc_position(first));
                }
                near.list_if_near(first, at, second, cell_offset);
            }
        });
    }

    #[inline]
    fn pairs<'a>(&'a self, found: &'a PairBuffer<P>) -> impl PairSequence<P> + 'a {
        found
    }
}
