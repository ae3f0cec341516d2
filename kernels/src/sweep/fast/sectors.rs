//! Pairs in sectors: cells as wide as a contact reaches, which hold any number of discs.

use super::SENTINELS;
use super::finder::{AT_ONCE, Cursor, Finder, MARGIN, Pairs, Rows};
use crate::InstructionSet;
use crate::backend::Precision;
use crate::isa::{Element, ProgramError};
use crate::sweep::lattice::Frame;
use std::ops::Range;

/// Rows of a band, at least.
pub(super) const BAND: usize = 16;

/// The sectors that lie ahead of a sector in the order of a sweep, itself first: columns and rows.
const AHEAD: [[isize; 2]; 5] = [[0, 0], [1, 0], [-1, 1], [0, 1], [1, 1]];

/// Discs for which a sector is wide enough, on the average: fewer make many empty sectors, more make many pairs to try.
const OCCUPANTS: f64 = 0.7;

/// Which sectors there are.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Grid {
    /// Where they lie.
    pub frame: Frame,
    /// Columns and rows.
    pub counts: [usize; 2],
    /// Which sides are periodic.
    pub periodic: [bool; 2],
}

impl Grid {
    /// Sectors at least `reach` wide (length) for `discs` discs in a box of some sides (length). None if a periodic side
    /// has no room for three: a pair would be met twice.
    pub fn new(
        origin: [f64; 2],
        sides: [f64; 2],
        periodic: [bool; 2],
        reach: f64,
        discs: usize,
    ) -> Option<Grid> {
        let room = OCCUPANTS * sides[0] * sides[1] / discs.max(1) as f64;
        let wide = reach.max(room.sqrt());
        let mut counts = [1, 1];
        for axis in 0..2 {
            let most = (sides[axis] / reach) as usize;
            let least = if periodic[axis] { 3 } else { 1 };
            if periodic[axis] && most < least {
                return None;
            }
            counts[axis] = ((sides[axis] / wide) as usize).max(least);
        }
        let edge = [sides[0] / counts[0] as f64, sides[1] / counts[1] as f64];
        Some(Grid { frame: Frame { origin, edge }, counts, periodic })
    }

    /// The sector that lies at most one column and one row from one.
    #[inline(always)]
    fn beside(&self, [column, row]: [usize; 2], [columns, rows]: [isize; 2]) -> Option<[usize; 2]> {
        let along = |axis: usize, from: usize, by: isize| {
            let (count, there) = (self.counts[axis] as isize, from as isize + by);
            // No division: that would cost more than what is done with the sector.
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

    /// From the centre of a sector to the one that lies so many columns and rows from it (length).
    fn way(&self, ahead: [isize; 2]) -> [f64; 2] {
        [0, 1].map(|axis| ahead[axis] as f64 * self.frame.edge[axis])
    }

    /// The ways to the sectors ahead, in their order.
    pub(super) fn ways(&self) -> [[f64; 2]; 5] {
        AHEAD.map(|ahead| self.way(ahead))
    }

    pub(super) fn rows(&self) -> Rows {
        Rows { count: self.counts[1], ahead: 1, band: BAND }
    }
}

/// Who is in which sector. The discs of a sector are kept in an order that is told with each, so that no sum's order
/// depends on what went before.
#[derive(Clone, Debug)]
pub struct Sectors {
    grid: Grid,
    reach: f64,
    /// Room for discs in each sector.
    room: usize,
    members: Vec<u32>,
    occupants: Vec<u32>,
    /// The sector of each disc.
    sector: Vec<u32>,
}

/// The sector of a disc that is in none.
const NOWHERE: u32 = u32::MAX;

impl Sectors {
    /// Empty sectors for `discs` discs that touch when their centres are at most `reach` (length) apart.
    ///
    /// # Panics
    /// If there are 2²⁹ discs or more.
    pub fn new(grid: Grid, discs: usize, reach: f64) -> Self {
        assert!(discs < 1 << 29, "{discs} discs are too many to number");
        let (sectors, room) = (grid.counts[0] * grid.counts[1], 4);
        Sectors {
            grid,
            reach,
            room,
            members: vec![0; sectors * room],
            occupants: vec![0; sectors],
            sector: vec![NOWHERE; discs],
        }
    }

    /// Which sectors there are.
    pub fn grid(&self) -> &Grid {
        &self.grid
    }

    /// How far contacts reach (length).
    pub(super) fn reach(&self) -> f64 {
        self.reach
    }

    /// How many discs there are.
    pub(super) fn disc_count(&self) -> usize {
        self.sector.len()
    }

    fn sector([column, row]: [usize; 2], grid: &Grid) -> usize {
        row * grid.counts[0] + column
    }

    /// Column and row of a disc; none if it is in no sector.
    pub fn cell(&self, disc: usize) -> Option<[usize; 2]> {
        let (sector, columns) = (self.sector[disc] as usize, self.grid.counts[0]);
        (self.sector[disc] != NOWHERE).then(|| [sector % columns, sector / columns])
    }

    /// The discs of a sector.
    pub(super) fn members(&self, cell: [usize; 2]) -> &[u32] {
        let sector = Self::sector(cell, &self.grid);
        &self.members[sector * self.room..][..self.occupants[sector] as usize]
    }

    /// Puts a disc into a sector, behind the discs there whose `number` is smaller.
    ///
    /// # Panics
    /// If the disc is in a sector already, or there is no such disc or sector.
    pub fn enter(&mut self, disc: usize, cell: [usize; 2], number: impl Fn(usize) -> usize) {
        assert!(self.sector[disc] == NOWHERE, "disc {disc} is in a sector already");
        assert!(cell[0] < self.grid.counts[0] && cell[1] < self.grid.counts[1], "no sector {cell:?}");
        let sector = Self::sector(cell, &self.grid);
        let occupants = self.occupants[sector] as usize;
        if occupants == self.room {
            self.make_room();
        }
        self.sector[disc] = sector as u32;
        self.occupants[sector] += 1;
        let members = &mut self.members[sector * self.room..][..occupants + 1];
        let own = number(disc);
        let before = members[..occupants].iter().take_while(|&&member| number(member as usize) < own).count();
        members.copy_within(before..occupants, before + 1);
        members[before] = disc as u32;
    }

    /// Empties all sectors and puts every disc into the one that `cell` says, those of a sector in order of their
    /// `number`.
    ///
    /// # Panics
    /// If there is no such sector.
    pub fn refill(&mut self, cell: impl Fn(usize) -> [usize; 2], number: impl Fn(usize) -> usize) {
        self.occupants.fill(0);
        for disc in 0..self.sector.len() {
            let cell = cell(disc);
            assert!(cell[0] < self.grid.counts[0] && cell[1] < self.grid.counts[1], "no sector {cell:?}");
            let sector = Self::sector(cell, &self.grid);
            let occupants = self.occupants[sector] as usize;
            if occupants == self.room {
                self.make_room();
            }
            self.members[sector * self.room + occupants] = disc as u32;
            self.occupants[sector] += 1;
            self.sector[disc] = sector as u32;
        }
        for (members, &occupants) in self.members.chunks_exact_mut(self.room).zip(&self.occupants) {
            if occupants > 1 {
                members[..occupants as usize].sort_unstable_by_key(|&disc| number(disc as usize));
            }
        }
    }

    /// Takes a disc out of its sector, if it is in one.
    pub fn leave(&mut self, disc: usize) {
        if self.sector[disc] == NOWHERE {
            return;
        }
        let sector = self.sector[disc] as usize;
        self.sector[disc] = NOWHERE;
        let occupants = self.occupants[sector] as usize;
        let members = &mut self.members[sector * self.room..][..occupants];
        if let Some(at) = members.iter().position(|&member| member as usize == disc) {
            members.copy_within(at + 1.., at);
            self.occupants[sector] -= 1;
        }
    }

    /// Twice the room in every sector.
    fn make_room(&mut self) {
        let room = 2 * self.room;
        let mut members = vec![0; self.occupants.len() * room];
        for (to, from) in members.chunks_exact_mut(room).zip(self.members.chunks_exact(self.room)) {
            to[..self.room].copy_from_slice(from);
        }
        (self.room, self.members) = (room, members);
    }

    /// The discs in order of their sectors, row by row.
    pub fn order(&self) -> Vec<u32> {
        let sectors = self.members.chunks_exact(self.room).zip(&self.occupants);
        sectors.flat_map(|(members, &occupants)| &members[..occupants as usize]).copied().collect()
    }

    /// Numbers the discs anew: disc `n` is from now on what disc `order[n]` was.
    ///
    /// # Panics
    /// If `order` does not name every disc once.
    pub fn renumber(&mut self, order: &[u32]) {
        assert_eq!(order.len(), self.sector.len(), "an order of all discs");
        let mut anew = vec![NOWHERE; order.len()];
        for (disc, &before) in order.iter().enumerate() {
            assert!(
                std::mem::replace(&mut anew[before as usize], disc as u32) == NOWHERE,
                "disc {before} is named twice"
            );
        }
        self.sector = order.iter().map(|&before| self.sector[before as usize]).collect();
        for (members, &occupants) in self.members.chunks_exact_mut(self.room).zip(&self.occupants) {
            members[..occupants as usize].iter_mut().for_each(|member| *member = anew[*member as usize]);
        }
    }

    /// Calls `meet(own, partner, number of the way)` for every pair of a row whose discs are in sectors that meet; the
    /// pairs of a disc one behind the other, discs without pairs announced by `own` too.
    #[inline(always)]
    pub(super) fn pairs_of_row(
        &self,
        row: usize,
        columns: Range<usize>,
        mut own: impl FnMut(u32),
        mut meet: impl FnMut(u32, u32, usize),
    ) {
        for column in columns {
            let members = self.members([column, row]);
            if members.is_empty() {
                continue;
            }
            let ahead = AHEAD.map(|ahead| {
                self.grid.beside([column, row], ahead).map_or(&[][..], |cell| self.members(cell))
            });
            for (at, &first) in members.iter().enumerate() {
                own(first);
                members[at + 1..].iter().for_each(|&second| meet(first, second, 0));
                for (way, there) in ahead.iter().enumerate().skip(1) {
                    there.iter().for_each(|&second| meet(first, second, way));
                }
            }
        }
    }
}

/// Two discs that may touch, and the way between where their places are seen from (length).
#[derive(Clone, Copy, Debug)]
pub struct Touch<P> {
    discs: [u32; 2],
    way: [P; 2],
}

/// A list of pairs.
#[derive(Clone, Debug, Default)]
pub struct Touches<P>(Vec<Touch<P>>);

impl<P: Precision> Touches<P> {
    /// Appends a pair.
    pub(super) fn push(&mut self, discs: [u32; 2], way: [f64; 2]) {
        self.0.push(Touch { discs, way: way.map(P::from_f64) });
    }
}

impl<P: Precision> Pairs<P> for &Touches<P> {
    #[inline(always)]
    fn count(&self) -> usize {
        self.0.len()
    }
    #[inline(always)]
    fn pair(&self, number: usize) -> ([u32; 2], [P; 2]) {
        let Touch { discs, way } = self.0[number];
        (discs, way)
    }
}

/// Lists the pairs nearer than some distance among those it is told.
pub(super) struct Near<'a, S, P> {
    places: [&'a [S]; 2],
    ways: [[f64; 2]; 5],
    limit: f64,
    touches: &'a mut Vec<Touch<P>>,
}

impl<'a, S: Element, P: Precision> Near<'a, S, P> {
    /// For `discs` discs that touch at most at a distance `reach` (length).
    ///
    /// # Panics
    /// If there are not so many places.
    pub(super) fn new(
        places: [&'a [S]; 2],
        discs: usize,
        grid: &Grid,
        reach: f64,
        touches: &'a mut Touches<P>,
    ) -> Self {
        assert!(places.iter().all(|place| place.len() == discs + SENTINELS), "a place for every disc");
        touches.0.clear();
        let limit = reach * reach * MARGIN;
        Near { places, ways: grid.ways(), limit, touches: &mut touches.0 }
    }

    pub(super) fn is_full(&self) -> bool {
        self.touches.len() >= AT_ONCE
    }

    /// Where a disc is.
    ///
    /// # Safety
    /// It is one of the discs.
    #[inline(always)]
    pub(super) unsafe fn at(&self, disc: u32) -> [f64; 2] {
        // SAFETY: there is a place for every disc, as `new` has made sure.
        self.places.map(|place| unsafe { place.get_unchecked(disc as usize) }.to_f64())
    }

    /// Lists a pair if it is near enough.
    ///
    /// # Safety
    /// `second` is one of the discs, and `way` below 5.
    #[inline(always)]
    pub(super) unsafe fn meet(&mut self, first: u32, at: [f64; 2], second: u32, way: usize) {
        // SAFETY: the caller's promise.
        let (there, way) = unsafe { (self.at(second), *self.ways.get_unchecked(way)) };
        let (dx, dy) = ((at[0] - there[0]) - way[0], (at[1] - there[1]) - way[1]);
        let length = self.touches.len();
        if length == self.touches.capacity() {
            self.touches.reserve(AT_ONCE);
        }
        // Written whether it is near or not: that spares a branch nobody can predict.
        let touch = Touch { discs: [first, second], way: way.map(P::from_f64) };
        // SAFETY: there is room for one more.
        unsafe {
            self.touches.as_mut_ptr().add(length).write(touch);
            self.touches.set_len(length + usize::from(dx * dx + dy * dy < self.limit));
        }
    }
}

// SAFETY: members are discs; pairs are of sectors in the row and the next.
unsafe impl<S: Element, P: Precision> Finder<S, P> for Sectors {
    type Found = Touches<P>;

    fn discs(&self) -> usize {
        self.sector.len()
    }

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
        while cursor.row < rows.end {
            while cursor.along < self.grid.counts[0] {
                if near.is_full() {
                    return Ok(());
                }
                let columns = cursor.along..cursor.along + 1;
                let (mut last, mut at) = (NOWHERE, [0.0; 2]);
                self.pairs_of_row(
                    cursor.row,
                    columns,
                    |_| {},
                    |first, second, way| {
                        // SAFETY: members are discs, and so many are the ways.
                        unsafe {
                            if first != last {
                                (last, at) = (first, near.at(first));
                            }
                            near.meet(first, at, second, way);
                        }
                    },
                );
                cursor.along += 1;
            }
            *cursor = Cursor::at(cursor.row + 1);
        }
        Ok(())
    }

    fn pairs<'a>(&'a self, found: &'a Touches<P>) -> impl Pairs<P> + 'a {
        found
    }
}
