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
//! By [`Arithmetic::Exact`] it is the same on every instruction set too, energy and virial included, for own sums are kept by 16
//! lanes, however many a register has.
//!
//! In single precision a position is a number and what rounding has left of it: two bodies that are near each other and far from
//! the origin are as exactly apart as two near the origin. A pair takes 6 more additions for it, 29 operations instead of 23.

pub mod shifts;
mod tile;

use crate::backend::{GROUP, InstructionSet, Precision, dispatch_estimating, dispatch_native};
use crate::isa::ProgramError;
use crate::isa::Storage;
use crate::law::{self, Field, Law};
use crate::threads::{alone_if, on_threads, pieces};
use std::array::from_fn;
use std::ops::Range;
use tile::{Rows, Tile, asks_for_velocity};

/// Parts that rows are cut into where there are enough of them: a constant, for the order of summation depends on it.
pub const BANDS: usize = 32;

/// Groups of a band are at least as many.
const SMALLEST_BAND: usize = 4;

/// Bodies up to which one thread meets all pairs: to wake others takes some ten microseconds, and so do these pairs.
const ALONE: usize = 512;

/// Whether positions of a precision come in two parts.
#[inline]
pub const fn is_split<P: Storage>() -> bool {
    P::BYTES < size_of::<f64>()
}

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

/// Bodies, an entry each; as many as [`padded`] says. Entries behind the last body have no mass; the one numbered n is at [`padding`] of n
/// along x.
#[derive(Clone, Copy, Debug)]
pub struct Bodies<'a, P> {
    /// Positions (length).
    pub position: [&'a [P]; 3],
    /// What rounding to single precision has left of them (length); in double precision empty and not read.
    pub rest: [&'a [P]; 3],
    /// Velocities (length/time); empty where the law does not ask for them.
    pub velocity: [&'a [P]; 3],
    /// Masses.
    pub mass: &'a [P],
}

/// How pairs are met.
#[derive(Clone, Copy)]
pub struct Manner<'a> {
    /// Whether energy and virial are summed up.
    pub observed: bool,
    /// How products, sums and roots are formed.
    pub arithmetic: Arithmetic,
    /// The instructions.
    pub set: InstructionSet,
    /// Asked before every group of own bodies: whether to stop there, the sums unfinished.
    pub interrupted: &'a (dyn Fn() -> bool + Sync),
}

/// How many entries columns have for `bodies` bodies: whole groups.
#[inline]
pub const fn padded(bodies: usize) -> usize {
    bodies.next_multiple_of(GROUP)
}

/// The place along x of the padding entry `n` behind the last body (length).
///
/// Bodies do not come near it, and no square or cube of a distance to it overflows: what has no mass then adds zeros, never
/// 0 · ∞. In single precision the unit of length must be about the size of the system.
#[inline]
pub fn padding<P: Precision>(n: usize) -> P {
    let far = if is_split::<P>() { 1e12 } else { 1e100 };
    P::from_f64(far * (1.0 + n as f64 / GROUP as f64))
}

/// A band of rows and its sums.
#[derive(Clone, Debug)]
struct Band<P, const SUMS: usize> {
    groups: Range<usize>,
    /// For each sum, an entry for every body from the band's first on.
    sums: [Vec<P>; SUMS],
    /// Energy and virial.
    energy: [f64; 2],
    /// Whether it was stopped on the way.
    is_stopped: bool,
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
            Band {
                groups: rows,
                sums: from_fn(|_| vec![P::default(); behind]),
                energy: [0.0; 2],
                is_stopped: false,
            }
        };
        AllPairs { groups, bands: bands.into_iter().map(band).collect() }
    }

    /// Bytes that the sums take for a number of bodies.
    pub fn bytes(bodies: usize) -> usize {
        let groups = padded(bodies) / GROUP;
        let bands = rows_of_equal_work(groups, (groups / SMALLEST_BAND).clamp(1, BANDS));
        bands.iter().map(|rows| (groups - rows.start) * GROUP * SUMS * P::BYTES).sum()
    }

    /// The sums of all pairs (forces; and their rates), and, if they are observed, their energy and virial (energy), else zeros.
    ///
    /// # Errors
    /// [`ProgramError`] if a column has not as many entries as [`padded`] says, the law asks for what it does not state, the
    /// processor lacks the instruction set, or it is interrupted.
    pub fn sweep<L: Law<3> + Sync>(
        &mut self,
        law: &L,
        bodies: &Bodies<'_, P>,
        sums: [&mut [P]; SUMS],
        manner: &Manner<'_>,
    ) -> Result<[f64; 2], ProgramError> {
        self.meet(law, bodies, 0..self.bands.len(), manner)?;
        self.finish(sums)
    }

    /// How many bands there are.
    #[inline]
    pub fn bands(&self) -> usize {
        self.bands.len()
    }

    /// The sums of a band, each with an entry for every body from the band's first on, and its energy and virial.
    #[inline]
    pub fn band(&self, number: usize) -> (&[Vec<P>; SUMS], [f64; 2]) {
        let Band { sums, energy, .. } = &self.bands[number];
        (sums, *energy)
    }

    /// The same, to be put there by who has met its pairs elsewhere.
    #[inline]
    pub fn band_mut(&mut self, number: usize) -> (&mut [Vec<P>; SUMS], &mut [f64; 2]) {
        let Band { sums, energy, .. } = &mut self.bands[number];
        (sums, energy)
    }

    /// Meets the pairs of some of the bands.
    ///
    /// # Errors
    /// As [`sweep`](Self::sweep).
    pub fn meet<L: Law<3> + Sync>(
        &mut self,
        law: &L,
        bodies: &Bodies<'_, P>,
        bands: Range<usize>,
        manner: &Manner<'_>,
    ) -> Result<(), ProgramError> {
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
        let rest = bodies.rest.into_iter().filter(|_| is_split::<P>());
        let columns = bodies.position.into_iter().chain([bodies.mass]).chain(rest).chain(velocity);
        columns.map(<[P]>::len).try_for_each(|length| suffices(length, entries))?;
        alone_if(entries <= ALONE, || self.meet_checked(law, bodies, bands, manner))
    }

    fn meet_checked<L: Law<3> + Sync>(
        &mut self,
        law: &L,
        bodies: &Bodies<'_, P>,
        bands: Range<usize>,
        manner: &Manner<'_>,
    ) -> Result<(), ProgramError> {
        let &Manner { observed, arithmetic, set, interrupted } = manner;
        let bands = &mut self.bands[bands];
        let done = on_threads(bands.iter_mut(), |band| {
            band.sums.iter_mut().for_each(|sums| sums.fill(P::default()));
            (band.energy, band.is_stopped) = ([0.0; 2], false);
            let sums = band.sums.each_mut().map(Vec::as_mut_slice);
            let (energy, is_stopped) = (&mut band.energy, &mut band.is_stopped);
            let work = Rows {
                law,
                bodies,
                groups: band.groups.clone(),
                sums,
                observed,
                energy,
                interrupted,
                is_stopped,
            };
            match arithmetic {
                Arithmetic::Exact => dispatch_native(set, Tile::<P, L, SUMS, true>(work)),
                // Nothing asks for rates of raw forces.
                Arithmetic::Raw if SUMS == 3 => {
                    dispatch_estimating::<_, _, true>(set, Tile::<P, L, SUMS, false>(work))
                }
                Arithmetic::Estimated | Arithmetic::Raw => {
                    dispatch_estimating::<_, _, false>(set, Tile::<P, L, SUMS, false>(work))
                }
            }
        });
        done.into_iter().collect::<Result<(), _>>()?;
        if bands.iter().any(|band| band.is_stopped) { Err(ProgramError::Interrupted) } else { Ok(()) }
    }

    /// Adds up what all bands have met.
    ///
    /// # Errors
    /// [`ProgramError`] if there is a sum that has not as many entries as [`padded`] says.
    pub fn finish(&self, sums: [&mut [P]; SUMS]) -> Result<[f64; 2], ProgramError> {
        let entries = self.groups * GROUP;
        sums.iter().try_for_each(|sums| suffices(sums.len(), entries))?;
        alone_if(entries <= ALONE, || self.finish_checked(sums))
    }

    fn finish_checked(&self, sums: [&mut [P]; SUMS]) -> Result<[f64; 2], ProgramError> {
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

/// Refuses a column that has not as many entries as there are.
fn suffices(length: usize, entries: usize) -> Result<(), ProgramError> {
    let last = entries as isize - 1;
    if length == entries {
        return Ok(());
    }
    Err(ProgramError::TooShort { array: "the bodies", first: 0, last, length })
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
