//! Every pair of bodies, each met once.
//!
//! Bodies are taken in groups of 16. A few bodies of one group (the *own* ones, spread over all lanes of a register each) meet
//! the bodies behind them, a register of partners at a time:
//!
//! ```text
//! own group I     1 2 3 4        their sums stay in registers, a sum a lane, until the row is done
//! partners        [J J J J J J J J J J J J J J J J] [...] [...]       their sums are loaded and stored once a block
//! own group I with itself: every body with all others of the group, without the partner's share
//! ```
//!
//! Rows of groups are cut into [`BANDS`] bands of about equal work. Each has sums of its own, and they are added up in the order
//! of the bands: what comes out is the same on any number of threads.
//!
//! By [`Arithmetic::Exact`] it is the same on every instruction set too, for own sums are kept by 16 lanes, however many a
//! register has.

pub mod shifts;
mod tile;

use crate::backend::{GROUP, InstructionSet, Precision, dispatch, dispatch_estimating};
use crate::isa::ProgramError;
use crate::law::{self, Field, Law};
use crate::threads::{on_threads, pieces};
use std::array::from_fn;
use std::ops::Range;
use tile::{Tile, asks_for_velocity};

/// Parts that rows are cut into where there are enough of them: a constant, for the order of summation depends on it.
pub const BANDS: usize = 32;

/// Groups of a band are at least as many.
const SMALLEST_BAND: usize = 4;

/// How products, sums and roots are formed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Arithmetic {
    /// Every operation is rounded: the same bits on every instruction set.
    Exact,
    /// Products and sums are fused, inverse roots come from the processor's estimate and a correction: to within a few units of
    /// the last place, and not the same bits on two instruction sets.
    Estimated,
    /// As [`Arithmetic::Estimated`] without the correction: forces to 4 or 5 digits, to show what that spoils. Their rates are
    /// corrected.
    Raw,
}

/// Bodies, an entry each; as many as [`padded`] says. Those behind the last body have no mass and are at the place of no other.
#[derive(Clone, Copy, Debug)]
pub struct Bodies<'a, P> {
    /// Positions (length).
    pub position: [&'a [P]; 3],
    /// Velocities (length/time); empty where the law does not ask for them.
    pub velocity: [&'a [P]; 3],
    /// Masses.
    pub mass: &'a [P],
}

/// How many entries columns have for `bodies` bodies: whole groups.
#[inline]
pub const fn padded(bodies: usize) -> usize {
    bodies.next_multiple_of(GROUP)
}

/// A band of rows and its sums.
#[derive(Clone, Debug)]
struct Band<P, const SUMS: usize> {
    groups: Range<usize>,
    /// For each sum, an entry for every body from the band's first on.
    sums: [Vec<P>; SUMS],
    /// Energy and virial.
    energy: [f64; 2],
}

/// All pairs of a number of bodies, with room for the sums of a law: 3, or 6 with the rates of the forces.
#[derive(Clone, Debug)]
pub struct AllPairs<P, const SUMS: usize = 3> {
    groups: usize,
    bands: Vec<Band<P, SUMS>>,
}

impl<P: Precision, const SUMS: usize> AllPairs<P, SUMS> {
    /// For a number of bodies.
    pub fn new(bodies: usize) -> Self {
        let groups = padded(bodies) / GROUP;
        let bands = rows_of_equal_work(groups, (groups / SMALLEST_BAND).clamp(1, BANDS));
        let band = |rows: Range<usize>| {
            let behind = (groups - rows.start) * GROUP;
            Band { groups: rows, sums: from_fn(|_| vec![P::default(); behind]), energy: [0.0; 2] }
        };
        AllPairs { groups, bands: bands.into_iter().map(band).collect() }
    }

    /// The sums of all pairs (forces; and their rates), and, if they are `observed`, their energy and virial (energy), else zeros.
    ///
    /// # Errors
    /// [`ProgramError`] if a column has not as many entries as [`padded`] says, the law asks for what it does not state, or the
    /// processor lacks the instruction set.
    pub fn sweep<L: Law<3> + Sync>(
        &mut self,
        law: &L,
        bodies: &Bodies<'_, P>,
        sums: [&mut [P]; SUMS],
        observed: bool,
        arithmetic: Arithmetic,
        set: InstructionSet,
    ) -> Result<[f64; 2], ProgramError> {
        law::check::<3, L>(law)?;
        let served = |field: &&Field| matches!(field, Field::Mass | Field::Velocity(_));
        if let Some(field) = L::FIELDS.iter().find(|field| !served(field)) {
            return Err(ProgramError::Unstated(field.name()));
        }
        if let Some(sum) = L::SUMS.iter().find(|sum| sum.column::<3>() >= SUMS) {
            return Err(ProgramError::Unstated(sum.name()));
        }
        let entries = self.groups * GROUP;
        let velocity = bodies.velocity.into_iter().filter(|_| asks_for_velocity(L::FIELDS));
        let columns = bodies.position.into_iter().chain([bodies.mass]).chain(velocity).map(<[P]>::len);
        for length in columns.chain(sums.iter().map(|sums| sums.len())) {
            if length != entries {
                let last = entries as isize - 1;
                return Err(ProgramError::TooShort { array: "the bodies", first: 0, last, length });
            }
        }
        let done = on_threads(&mut self.bands, |band| {
            band.sums.iter_mut().for_each(|sums| sums.fill(P::default()));
            band.energy = [0.0; 2];
            let sums = band.sums.each_mut().map(Vec::as_mut_slice);
            let energy = &mut band.energy;
            let groups = band.groups.clone();
            match arithmetic {
                Arithmetic::Exact => {
                    dispatch(set, Tile::<P, L, SUMS, true> { law, bodies, groups, sums, observed, energy })
                }
                // Nothing asks for rates of raw forces.
                Arithmetic::Raw if SUMS == 3 => dispatch_estimating::<_, _, true>(
                    set,
                    Tile::<P, L, SUMS, false> { law, bodies, groups, sums, observed, energy },
                ),
                Arithmetic::Estimated | Arithmetic::Raw => dispatch_estimating::<_, _, false>(
                    set,
                    Tile::<P, L, SUMS, false> { law, bodies, groups, sums, observed, energy },
                ),
            }
        });
        done.into_iter().collect::<Result<(), _>>()?;
        for (number, to) in sums.into_iter().enumerate() {
            self.add_up(number, to);
        }
        let sum = |of: usize| self.bands.iter().map(|band| band.energy[of]).sum();
        Ok([sum(0), sum(1)])
    }

    /// Adds up a sum of all bands in double precision, in the order of the bands.
    fn add_up(&self, number: usize, to: &mut [P]) {
        let share = |(range, to): (Range<usize>, &mut [P])| {
            let mut sum = vec![0.0; to.len()];
            for band in &self.bands {
                let first = band.groups.start * GROUP;
                let from = range.start.max(first);
                if from < range.end {
                    let sums = &band.sums[number][from - first..range.end - first];
                    let into = sum[from - range.start..].iter_mut();
                    into.zip(sums).for_each(|(into, &of_band)| *into += of_band.to_f64());
                }
            }
            to.iter_mut().zip(sum).for_each(|(to, sum)| *to = P::from_f64(sum));
        };
        const PIECE: usize = 4096;
        let ranges = pieces(0..to.len(), PIECE);
        on_threads(ranges.into_iter().zip(to.chunks_mut(PIECE)), share);
    }
}

/// Rows of a triangle of groups, cut into bands of about equal area; row I has `groups` − I.
fn rows_of_equal_work(groups: usize, bands: usize) -> Vec<Range<usize>> {
    let work = |row: usize| groups - row;
    let all: usize = (0..groups).map(work).sum();
    let (mut rows, mut start, mut done) = (vec![], 0, 0);
    for band in 1..=bands {
        let mut end = start;
        while end < groups && (end == start || done + work(end) / 2 < all * band / bands) {
            done += work(end);
            end += 1;
        }
        let end = if band == bands { groups } else { end };
        if start < end {
            rows.push(start..end);
        }
        start = end;
    }
    rows
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bands_cover_all_rows_once_with_about_equal_work() {
        for groups in [1, 2, 5, 33, 100, 1024] {
            for bands in [1, 2, 7, 32] {
                let rows = rows_of_equal_work(groups, bands);
                let covered: Vec<usize> = rows.iter().cloned().flatten().collect();
                assert_eq!(covered, (0..groups).collect::<Vec<_>>(), "{groups} groups, {bands} bands");
                let work = |rows: &Range<usize>| rows.clone().map(|row| groups - row).sum::<usize>();
                let share = (groups * (groups + 1) / 2).div_ceil(bands);
                assert!(
                    rows.iter().all(|rows| work(rows) <= share + 2 * groups),
                    "{groups} {bands} {rows:?}"
                );
            }
        }
    }
}
