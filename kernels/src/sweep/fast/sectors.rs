//! Pairs in sectors: cells as wide as a contact reaches, which hold any number of discs.
//!
//! A disc's partners are in its own sector and in the eight around it. Each pair of sectors is met from one side:
//!
//! ```text
//! row + 1     2  3  4        cell offsets from a sector to those ahead of it; 0 is itself
//! own row        0  1
//! ```
//!
//! `members` holds the discs in order of their sectors, `starts` where each sector begins, so that the sectors 0 and 1 are one
//! stretch of members, and 2, 3 and 4 another:
//!
//! ```text
//! starts    0  2  2  5 ...           sector 1 is empty
//! members   8  3  1  4  9 ...        within a sector in an order that does not depend on what went before
//! ```
//!
//! They are sorted by counting, on all threads: first how many discs each sector has, then where each begins, then the discs
//! are put there as they come, and at last each sector's few are sorted. So the result does not depend on the threads.
//!
//! Few sectors have many members, and nearly all of the work is comparing them: then all threads compare, each the partners of
//! some members, and the pairs are added up as on one.
//!
//! Inside the box a disc is compared with two stretches, each in one loop; at the rim, where a stretch ends or goes on at the
//! other side of the box, sector by sector.

use super::finder::{Cursor, Finder, Rows};
use super::grid::{AHEAD, Grid};
use super::near::Near;
use super::pairs::{Pairs, Touches};
use crate::InstructionSet;
use crate::backend::Precision;
use crate::isa::{Element, ProgramError};
use crate::threads::{PIECE, in_pieces, is_alone, on_threads, over_pieces, reordered, shared};
use std::ops::Range;
use std::sync::atomic::{AtomicU32, Ordering};

/// Who is in which sector. The discs of a sector are kept in an order that the caller gives, so that no sum's order depends on
/// what went before.
#[derive(Clone, Debug)]
pub struct Sectors {
    grid: Grid,
    reach: f64,
    /// The sector of each disc.
    sector: Vec<u32>,
    /// Where in `members` the discs of each sector begin, and the end.
    starts: Vec<u32>,
    members: Vec<u32>,
}

/// Members that one thread sorts at a time, about.
const MEMBERS: u32 = 4096;

/// The sector of a disc that is in none.
const NOWHERE: u32 = u32::MAX;

impl Sectors {
    /// Empty sectors for `discs` discs that touch when their centres are at most `reach` (length) apart.
    ///
    /// # Panics
    /// If there are 2²⁹ discs or more.
    #[inline]
    pub fn new(grid: Grid, discs: usize, reach: f64) -> Self {
        assert!(discs < 1 << 29, "{discs} discs are too many to number");
        let starts = vec![0; grid.counts[0] * grid.counts[1] + 1];
        Sectors { grid, reach, sector: vec![NOWHERE; discs], starts, members: vec![] }
    }

    /// The same sectors, with room for `discs` discs and none in them.
    #[inline]
    pub fn emptied(&self, discs: usize) -> Self {
        Sectors::new(self.grid, discs, self.reach)
    }

    /// Which sectors there are.
    #[inline]
    pub fn grid(&self) -> &Grid {
        &self.grid
    }

    /// How far contacts reach (length).
    #[inline]
    pub(super) fn reach(&self) -> f64 {
        self.reach
    }

    /// How many discs there are.
    #[inline]
    pub(super) fn disc_count(&self) -> usize {
        self.sector.len()
    }

    /// Column and row of a disc; none if it is in no sector.
    #[inline]
    pub fn cell(&self, disc: usize) -> Option<[usize; 2]> {
        let (sector, columns) = (self.sector[disc] as usize, self.grid.counts[0]);
        (self.sector[disc] != NOWHERE).then(|| [sector % columns, sector / columns])
    }

    /// Puts a disc into a sector, of which it is a member from the next [`arrange`](Self::arrange) on.
    ///
    /// # Panics
    /// If there is no such disc or sector.
    #[inline]
    pub fn enter(&mut self, disc: usize, [column, row]: [usize; 2]) {
        let [columns, rows] = self.grid.counts;
        assert!(column < columns && row < rows, "no sector in column {column}, row {row}");
        self.sector[disc] = (row * columns + column) as u32;
    }

    /// Takes a disc out of its sector, if it is in one.
    #[inline]
    pub fn leave(&mut self, disc: usize) {
        self.sector[disc] = NOWHERE;
    }

    /// Makes every disc a member of the sector it is in, those of a sector in order of their `number`, which no two have in
    /// common.
    pub fn arrange(&mut self, number: impl Fn(usize) -> usize + Sync) {
        let Sectors { sector, starts, members, .. } = self;
        // Additions that no other thread sees half done are slow: one thread alone goes without.
        let alone = is_alone(sector.len());
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
        // From the ends down, so that the starts are left.
        let (ends, places) = (shared(starts), shared(members));
        over_pieces(0..sector.len(), |discs| {
            inside(discs).for_each(|(disc, sector)| {
                // Adding 2³² − 1 takes one away.
                let place = add(&ends[sector], u32::MAX) - 1;
                places[place as usize].store(disc as u32, Ordering::Relaxed);
            });
        });
        let (starts, mut rest) = (&*starts, members.as_mut_slice());
        let parts = cut(starts).map(|sectors| {
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

    /// Renumbers the discs: disc `n` is from now on what disc `order[n]` was.
    ///
    /// # Panics
    /// If `order` does not name every disc once.
    pub fn renumber(&mut self, order: &[u32]) {
        assert_eq!(order.len(), self.sector.len(), "an order of all discs");
        let mut now = vec![NOWHERE; order.len()];
        let entries = shared(&mut now);
        over_pieces(0..order.len(), |discs| {
            for (disc, &before) in discs.clone().zip(&order[discs]) {
                entries[before as usize].store(disc as u32, Ordering::Relaxed);
            }
        });
        // As many names as discs: if none is left out, none is named twice.
        assert!(!now.contains(&NOWHERE), "an order that names every disc");
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

    /// The members of a sector and those that follow in the row, up to `more` sectors on.
    #[inline(always)]
    fn members(&self, sector: usize, more: usize) -> Range<usize> {
        self.starts[sector] as usize..self.starts[sector + more + 1] as usize
    }

    /// Calls `meet(disc, partner, number of the cell offset)` for every disc of some sectors of a row and every partner in the
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

    /// The same for those discs that are some of the members, in the same order.
    fn pairs_of_members(&self, some: Range<usize>, mut meet: impl FnMut(u32, u32, usize)) {
        let columns = self.grid.counts[0];
        // The last one that begins there: those before it are empty.
        let first = self.starts.partition_point(|&start| start as usize <= some.start).saturating_sub(1);
        let begin = self.starts[first..].iter().take_while(|&&start| (start as usize) < some.end);
        for (sector, _) in (first..).zip(begin) {
            self.pairs_of_sector([sector % columns, sector / columns], some.clone(), &mut meet);
        }
    }

    /// The same for those of the members of a sector that are among `some`.
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
            // Sectors that follow each other in a row are one stretch of members.
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
        let ahead = AHEAD.map(|ahead| match self.grid.beside([column, row], ahead) {
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

/// Sectors in pieces of [`PIECE`] of them, or of about as many members if that is fewer, by where in the members each begins.
fn cut(starts: &[u32]) -> impl Iterator<Item = Range<usize>> {
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

// SAFETY: members are numbers of discs below the length of `sector`; a pair is of sectors in the row and in it or the next.
unsafe impl<S: Element, P: Precision> Finder<S, P> for Sectors {
    type Found = Touches<P>;

    #[inline]
    fn discs(&self) -> usize {
        self.sector.len()
    }

    #[inline]
    fn rows(&self) -> Rows {
        self.grid.rows()
    }

    fn find(
        &self,
        places: [&[S]; 2],
        rows: Range<usize>,
        cursor: &mut Cursor,
        found: &mut Touches<P>,
        _: InstructionSet,
    ) -> Result<(), ProgramError> {
        let mut near = Near::new(places, self.sector.len(), &self.grid, self.reach, found);
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
                            (last, at) = (first, near.at(first));
                        }
                        near.meet(first, at, second, cell_offset);
                    }
                });
            },
        );
        Ok(())
    }

    #[inline]
    fn tried(&self) -> f64 {
        // The rest of a sector of its own, and four others.
        4.5 * self.members.len() as f64 / (self.starts.len() - 1) as f64
    }

    #[inline]
    fn searched(&self, rows: Range<usize>) -> Range<usize> {
        self.members_of_rows(rows)
    }

    fn find_part(&self, places: [&[S]; 2], part: Range<usize>, found: &mut Touches<P>) {
        let mut near = Near::new(places, self.sector.len(), &self.grid, self.reach, found);
        let (mut last, mut at) = (NOWHERE, [0.0; 2]);
        self.pairs_of_members(part, |first, second, cell_offset| {
            // SAFETY: `pairs_of_members` gives members of sectors, which are discs, and numbers of cell offsets below 5.
            unsafe {
                if first != last {
                    (last, at) = (first, near.at(first));
                }
                near.meet(first, at, second, cell_offset);
            }
        });
    }

    #[inline]
    fn pairs<'a>(&'a self, found: &'a Touches<P>) -> impl Pairs<P> + 'a {
        found
    }
}
