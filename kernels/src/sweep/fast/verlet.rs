//! Pairs from Verlet lists: of every disc the partners that were near when the lists were made.
//!
//! Lists hold every pair nearer than contact and skin. While no disc has moved by half the skin since, no other pair can
//! touch. They are made from [`Sectors`] and lie one behind the other:
//!
//! ```text
//! rows      0           2     3     4    where in `own` the discs of each row of sectors begin, and the end
//! own       4     9     2     7          the discs in order of their sectors
//! first     0     3     4     5     5    where in `partners` those of each begin, and the end
//! partners  9 2 7 2     7                each with the number of the cell offset in its upper three bits
//! ```
//!
//! A pair is listed once, with the disc that comes first in the order of the sectors. The *cell offset* is one of the five from a
//! sector to those ahead of it (itself first), and stands for the difference of the places from which the two discs are seen;
//! so a pair across a periodic side costs no more than any other, and no position is ever wrapped.

use super::finder::{Cursor, Finder, Rows};
use super::grid::Grid;
use super::near::Near;
use super::pairs::{Pairs, Touches};
use super::sectors::Sectors;
use crate::InstructionSet;
use crate::backend::Precision;
use crate::isa::{Element, ProgramError};
use crate::threads::{on_threads, pieces};
use std::ops::Range;

/// Bits of a partner that number the disc; those above number the cell offset.
const DISC: u32 = 29;

/// Rows of sectors whose lists one thread makes at a time.
const ROWS: usize = 8;

/// Each pair nearer than contact and skin, once, with the disc that comes first in the order of the sectors.
///
/// Places stay those seen from the sectors in which discs were when the lists were made.
#[derive(Clone, Debug, PartialEq)]
pub struct VerletList {
    grid: Grid,
    reach: f64,
    discs: usize,
    /// Where in `own` the discs of each row of sectors begin, and the end.
    rows: Vec<u32>,
    own: Vec<u32>,
    /// Where in `partners` those of each own disc begin, and the end.
    first: Vec<u32>,
    partners: Vec<u32>,
}

/// The lists of some rows.
#[derive(Default)]
struct Part {
    rows: Vec<u32>,
    own: Vec<u32>,
    first: Vec<u32>,
    partners: Vec<u32>,
}

impl VerletList {
    /// Lists the pairs of the discs in sectors, at their places there, that are at most `skin` (length) from contact.
    ///
    /// # Panics
    /// If the sectors are not wide enough for that, or there are not as many places as discs and sentinels.
    pub fn new<S: Element>(sectors: &Sectors, places: [&[S]; 2], skin: f64) -> Self {
        let (grid, reach) = (*sectors.grid(), sectors.reach());
        let limit = (reach + skin) * (reach + skin);
        assert!(
            // A single sector along an open side has nothing beyond it.
            (0..2).all(|axis| {
                let alone = grid.counts[axis] == 1 && !grid.periodic[axis];
                alone || grid.frame.edge[axis] * (1.0 + 1e-12) >= reach + skin
            }),
            "sectors too narrow"
        );
        let discs = sectors.disc_count();
        let at = |disc: u32| places.map(|place| place[disc as usize].to_f64());
        let cell_offsets = grid.cell_offsets();
        let part = |rows: Range<usize>| {
            let mut part = Part::default();
            let Part { own, first, partners, .. } = &mut part;
            let mut starts = Vec::new();
            for row in rows {
                starts.push(own.len() as u32);
                let partners = std::cell::RefCell::new(&mut *partners);
                sectors.pairs_of_row(
                    row,
                    0..grid.counts[0],
                    |disc| {
                        own.push(disc);
                        first.push(partners.borrow().len() as u32);
                    },
                    |disc, partner, cell_offset| {
                        let (here, there) = (at(disc), at(partner));
                        let along =
                            |axis: usize| (here[axis] - there[axis]) - cell_offsets[cell_offset][axis];
                        if along(0) * along(0) + along(1) * along(1) < limit {
                            partners.borrow_mut().push(partner | (cell_offset as u32) << DISC);
                        }
                    },
                );
            }
            part.rows = starts;
            part
        };
        let parts = on_threads(pieces(0..grid.counts[1], ROWS), part);
        let of_all =
            |column: fn(&Part) -> &Vec<u32>| parts.iter().map(|part| column(part).len()).sum::<usize>();
        let (all_own, all_partners) = (of_all(|part| &part.own), of_all(|part| &part.partners));
        let mut list = VerletList {
            grid,
            reach,
            discs,
            rows: vec![0; grid.counts[1] + 1],
            own: vec![0; all_own],
            first: vec![0; all_own + 1],
            partners: vec![0; all_partners],
        };
        list.rows[grid.counts[1]] = all_own as u32;
        list.first[all_own] = all_partners as u32;
        list.join(parts);
        list
    }

    /// Copies the lists of all parts to where they belong, one behind the other.
    fn join(&mut self, parts: Vec<Part>) {
        let VerletList { rows, own, first, partners, .. } = self;
        let mut rest = [rows, own, first, partners].map(Vec::as_mut_slice);
        let mut before = [0; 2];
        let copies = parts.into_iter().map(|part| {
            let lengths = [part.rows.len(), part.own.len(), part.first.len(), part.partners.len()];
            let mut to = rest.each_mut().into_iter().zip(lengths).map(|(rest, length)| {
                let (here, behind) = std::mem::take(rest).split_at_mut(length);
                *rest = behind;
                here
            });
            let to: [&mut [u32]; 4] = std::array::from_fn(|_| to.next().unwrap_or_default());
            let from = before;
            before = [before[0] + part.own.len() as u32, before[1] + part.partners.len() as u32];
            (part, to, from)
        });
        on_threads(copies, |(part, [rows, own, first, partners], [own_before, partners_before])| {
            rows.iter_mut().zip(part.rows).for_each(|(to, row)| *to = row + own_before);
            own.copy_from_slice(&part.own);
            first.iter_mut().zip(part.first).for_each(|(to, first)| *to = first + partners_before);
            partners.copy_from_slice(&part.partners);
        });
    }

    /// Pairs listed.
    #[inline]
    pub fn entries(&self) -> usize {
        self.partners.len()
    }
}

// SAFETY: the lists hold members of sectors, which are numbers of discs below `discs`; a pair is of sectors in the row and in it
// or the next.
unsafe impl<S: Element, P: Precision> Finder<S, P> for VerletList {
    type Found = Touches<P>;

    #[inline]
    fn discs(&self) -> usize {
        self.discs
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
        let mut near = Near::new(places, self.discs, &self.grid, self.reach, found);
        let discs_of = |row: usize| self.rows[row] as usize..self.rows[row + 1] as usize;
        near.search(
            rows,
            cursor,
            |row| discs_of(row).len(),
            |near, row, along| {
                let number = discs_of(row).start + along;
                let disc = self.own[number];
                let partners = &self.partners[self.first[number] as usize..self.first[number + 1] as usize];
                // SAFETY: `own` holds numbers of discs: the lists were made of the sectors' members.
                let at = unsafe { near.at(disc) };
                for &partner in partners {
                    let (second, cell_offset) = (partner & ((1 << DISC) - 1), (partner >> DISC) as usize);
                    // SAFETY: a partner is a member of a sector and so a disc, and `pairs_of_row` numbered its cell offset, below 5.
                    unsafe { near.meet(disc, at, second, cell_offset) };
                }
            },
        );
        Ok(())
    }

    #[inline]
    fn pairs<'a>(&'a self, found: &'a Touches<P>) -> impl Pairs<P> + 'a {
        found
    }
}
