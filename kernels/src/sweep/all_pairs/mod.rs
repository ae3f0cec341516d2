//! All pairs of bodies, each visited once.
//!
//! Bodies form groups of 16. A few bodies of one group (the *own* ones, each broadcast to all lanes of a register) are paired
//! with the bodies behind them, one register of partners at a time:
//!
//! ```text
//! own group I     1 2 3 4        their sums stay in registers, one per lane, until the row is done
//! partners        [J J J J J J J J J J J J J J J J] [...] [...]       their sums are loaded and stored once per block
//! own group I with itself: every body with all others of the group, without the partner's share
//! ```
//!
//! Rows of groups are cut into [`BANDS`] bands of about equal work. Each has sums of its own, which are added up in the order of
//! the bands: the result is the same on any number of threads.
//!
//! With [`Arithmetic::Exact`] it is also the same on every instruction set, energy and virial included: own sums are always kept
//! in 16 lanes, for any register width.
//!
//! In single precision a position has two parts, a number and its rounding residue. So the distance of two close bodies is as
//! exact far from the origin as near it. It costs 6 more additions per pair, 29 operations instead of 23.

pub mod shifts;
mod tile;

use crate::backend::{GROUP, InstructionSet, Precision, dispatch_estimating, dispatch_native};
use crate::isa::ProgramError;
use crate::isa::{AlignedColumn, Storage};
use crate::law::{self, Law, ParticleField};
use crate::threads::{on_threads, pieces, single_threaded_if};
use std::array::from_fn;
use std::ops::Range;
use tile::{BandRows, Tile, reads_velocity};

/// Largest number of bands: a constant, because the order of summation depends on it.
pub const BANDS: usize = 32;

/// Least number of groups in a band.
const SMALLEST_BAND: usize = 4;

/// Alignment number of a band's first sum; columns of bodies have smaller ones.
const FIRST_SUM: usize = 10;

/// Largest number of bodies for one thread: waking others takes some ten microseconds, and so do these pairs.
const ALONE: usize = 512;

/// True if positions of this precision have two parts.
#[inline]
pub const fn is_split<P: Storage>() -> bool {
    P::BYTES < size_of::<f64>()
}

/// Evaluation of products, sums and roots.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Arithmetic {
    /// Every operation is rounded: the same bits on every instruction set.
    Exact,
    /// Products and sums are fused; inverse roots are the processor's estimate with a correction. Accurate to a few units in the
    /// last place, and not bit-equal across instruction sets.
    Estimated,
    /// As [`Arithmetic::Estimated`] without the correction: forces are accurate to 4 or 5 digits, to demonstrate the effect.
    /// Their rates are corrected.
    Raw,
}

/// Columns of the bodies, each of [`padded_length`] length. Entries behind the last body have no mass; padding entry n has the x
/// coordinate [`padding_position`] of n.
#[derive(Clone, Copy, Debug)]
pub struct BodyColumns<'a, P> {
    /// Positions (length).
    pub position: [&'a [P]; 3],
    /// Rounding residue of the positions in single precision (length); empty and unread in double precision.
    pub rest: [&'a [P]; 3],
    /// Velocities (length/time); empty if the law does not read them.
    pub velocity: [&'a [P]; 3],
    /// Masses.
    pub mass: &'a [P],
}

/// Options of a sweep.
#[derive(Clone, Copy)]
pub struct AllPairsOptions<'a> {
    /// True to sum up energy and virial.
    pub observed: bool,
    /// Evaluation of products, sums and roots.
    pub arithmetic: Arithmetic,
    /// Instruction set.
    pub set: InstructionSet,
    /// Called before every group of own bodies; true stops the sweep there with unfinished sums.
    pub interrupted: &'a (dyn Fn() -> bool + Sync),
}

/// Length of a column for `bodies` bodies: whole groups.
#[inline]
pub const fn padded_length(bodies: usize) -> usize {
    bodies.next_multiple_of(GROUP)
}

/// The x coordinate of padding entry `n` behind the last body (length).
///
/// Bodies do not come near it, and no square or cube of a distance to it overflows: entries without mass then add zeros, never 0
/// · ∞. In single precision the unit of length must be about the size of the system.
#[inline]
pub fn padding_position<P: Precision>(n: usize) -> P {
    let far = if is_split::<P>() { 1e12 } else { 1e100 };
    P::from_f64(far * (1.0 + n as f64 / GROUP as f64))
}

/// A band of rows and its sums.
#[derive(Clone, Debug)]
struct TriangleBand<P, const SUMS: usize> {
    groups: Range<usize>,
    /// For each sum, one entry per body from the band's first on.
    sums: [AlignedColumn<P>; SUMS],
    /// Energy and virial.
    energy: [f64; 2],
    /// True if it was interrupted.
    is_stopped: bool,
}

/// All pairs of a number of bodies, with buffers for the sums of a law: 3, or 6 with the rates of the forces.
#[derive(Clone, Debug)]
pub struct AllPairs<P, const SUMS: usize = 3> {
    groups: usize,
    bands: Vec<TriangleBand<P, SUMS>>,
}

impl<P: Precision, const SUMS: usize> AllPairs<P, SUMS> {
    /// Bands and buffers for a number of bodies.
    pub fn new(bodies: usize) -> Self {
        let groups = padded_length(bodies) / GROUP;
        let bands = rows_of_equal_work(groups, (groups / SMALLEST_BAND).clamp(1, BANDS));
        let band = |rows: Range<usize>| {
            let behind = (groups - rows.start) * GROUP;
            TriangleBand {
                groups: rows,
                sums: from_fn(|sum| AlignedColumn::zeros(FIRST_SUM + sum, behind)),
                energy: [0.0; 2],
                is_stopped: false,
            }
        };
        AllPairs { groups, bands: bands.into_iter().map(band).collect() }
    }

    /// Memory in bytes of the sums for a number of bodies.
    pub fn bytes(bodies: usize) -> usize {
        let groups = padded_length(bodies) / GROUP;
        let bands = rows_of_equal_work(groups, (groups / SMALLEST_BAND).clamp(1, BANDS));
        bands.iter().map(|rows| (groups - rows.start) * GROUP * SUMS * P::BYTES).sum()
    }

    /// Writes the sums of all pairs (forces, and their rates). Returns energy and virial (energy) if they are observed, else
    /// zeros.
    ///
    /// # Errors
    /// [`ProgramError`] if the length of a column is not [`padded_length`], the law reads a quantity it does not state, the processor
    /// lacks the instruction set, or the sweep is interrupted.
    pub fn sweep<L: Law<3> + Sync>(
        &mut self,
        law: &L,
        bodies: &BodyColumns<'_, P>,
        sums: [&mut [P]; SUMS],
        manner: &AllPairsOptions<'_>,
    ) -> Result<[f64; 2], ProgramError> {
        self.sweep_bands(law, bodies, 0..self.bands.len(), manner)?;
        self.finish(sums)
    }

    /// Number of bands.
    #[inline]
    pub fn bands(&self) -> usize {
        self.bands.len()
    }

    /// Sums of a band, each with one entry per body from the band's first on, and its energy and virial.
    #[inline]
    pub fn band(&self, number: usize) -> (&[AlignedColumn<P>; SUMS], [f64; 2]) {
        let TriangleBand { sums, energy, .. } = &self.bands[number];
        (sums, *energy)
    }

    /// Mutable sums of a band, for results computed elsewhere.
    #[inline]
    pub fn band_mut(&mut self, number: usize) -> (&mut [AlignedColumn<P>; SUMS], &mut [f64; 2]) {
        let TriangleBand { sums, energy, .. } = &mut self.bands[number];
        (sums, energy)
    }

    /// Evaluates the pairs of some of the bands.
    ///
    /// # Errors
    /// As [`sweep`](Self::sweep).
    pub fn sweep_bands<L: Law<3> + Sync>(
        &mut self,
        law: &L,
        bodies: &BodyColumns<'_, P>,
        bands: Range<usize>,
        manner: &AllPairsOptions<'_>,
    ) -> Result<(), ProgramError> {
        law::check::<3, L>(law)?;
        let served =
            |field: &&ParticleField| matches!(field, ParticleField::Mass | ParticleField::Velocity(_));
        if let Some(field) = L::FIELDS.iter().find(|field| !served(field)) {
            return Err(ProgramError::Unstated(field.name()));
        }
        if let Some(sum) = L::SUMS.iter().find(|sum| sum.column::<3>() >= SUMS) {
            return Err(ProgramError::Unstated(sum.name()));
        }
        let entries = self.groups * GROUP;
        let velocity = bodies.velocity.into_iter().filter(|_| reads_velocity(L::FIELDS));
        let rest = bodies.rest.into_iter().filter(|_| is_split::<P>());
        let columns = bodies.position.into_iter().chain([bodies.mass]).chain(rest).chain(velocity);
        columns.map(<[P]>::len).try_for_each(|length| check_length(length, entries))?;
        single_threaded_if(entries <= ALONE, || self.sweep_checked_bands(law, bodies, bands, manner))
    }

    fn sweep_checked_bands<L: Law<3> + Sync>(
        &mut self,
        law: &L,
        bodies: &BodyColumns<'_, P>,
        bands: Range<usize>,
        manner: &AllPairsOptions<'_>,
    ) -> Result<(), ProgramError> {
        let &AllPairsOptions { observed, arithmetic, set, interrupted } = manner;
        let bands = &mut self.bands[bands];
        let done = on_threads(bands.iter_mut(), |band| {
            band.sums.iter_mut().for_each(|sums| sums.fill(P::default()));
            (band.energy, band.is_stopped) = ([0.0; 2], false);
            let sums = band.sums.each_mut().map(|sums| &mut **sums);
            let (energy, is_stopped) = (&mut band.energy, &mut band.is_stopped);
            let work = BandRows {
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
                // No law requests rates of raw forces.
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

    /// Adds up the sums of all bands.
    ///
    /// # Errors
    /// [`ProgramError`] if the length of a sum is not [`padded_length`].
    pub fn finish(&self, sums: [&mut [P]; SUMS]) -> Result<[f64; 2], ProgramError> {
        let entries = self.groups * GROUP;
        sums.iter().try_for_each(|sums| check_length(sums.len(), entries))?;
        single_threaded_if(entries <= ALONE, || self.finish_checked(sums))
    }

    fn finish_checked(&self, sums: [&mut [P]; SUMS]) -> Result<[f64; 2], ProgramError> {
        for (number, to) in sums.into_iter().enumerate() {
            self.add_up(number, to);
        }
        let sum = |of: usize| self.bands.iter().map(|band| band.energy[of]).sum();
        Ok([sum(0), sum(1)])
    }

    /// Adds up one sum of all bands in double precision, in the order of the bands.
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

/// Returns an error unless a column has `entries` entries.
fn check_length(length: usize, entries: usize) -> Result<(), ProgramError> {
    let last = entries as isize - 1;
    if length == entries {
        return Ok(());
    }
    Err(ProgramError::TooShort { array: "a column of the bodies", first: 0, last, length })
}

/// Cuts the rows of a triangle of groups into bands of about equal area; row I has `groups` − I.
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
    fn bands_cover_rows_with_equal_work() {
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
