//! State of the discs in records, and the sums of their forces.
//!
//! A sweep reads several quantities of two discs that it meets by chance. In records they are neighbours. A record has four entries,
//! six if discs rotate, eight if they vary, in blocks of 16 bytes with a column of their own each:
//!
//! ```text
//! double precision    x y | vx vy | angle omega | radius 1/m
//! single precision    x y   vx vy | angle omega   radius 1/m
//! sums                Fx Fy torque 0
//! ```
//!
//! Whole records of 64 bytes in one column were slower: a pass over the discs transposes them at the cost of 3 ns a disc, and spends
//! the bandwidth of memory on entries that nothing reads.

use super::pairs::SENTINELS;
use crate::backend::{QUAD, block};
use crate::isa::{AlignedColumn, Element};
use crate::law::ParticleField;
use crate::threads::{in_pieces, in_record_parts, reorder_into};
use std::ops::Range;

/// Entries of a record at most.
pub(super) const ENTRIES: usize = 8;

/// An entry of a record.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RecordEntry {
    /// Position along x relative to the centre of the cell (length).
    X,
    /// Position along y relative to the centre of the cell (length).
    Y,
    /// Velocity along x, in the unit of time of the records.
    Vx,
    /// Velocity along y, in the same unit.
    Vy,
    /// Angle.
    Angle,
    /// Angular velocity, in the same unit.
    Omega,
    /// Radius (length).
    Radius,
    /// Inverse mass; 0 for a fixed disc.
    InverseMass,
}

impl RecordEntry {
    /// Entries in their order.
    pub const ALL: [RecordEntry; ENTRIES] = {
        use RecordEntry::{Angle, InverseMass, Omega, Radius, Vx, Vy, X, Y};
        [X, Y, Vx, Vy, Angle, Omega, Radius, InverseMass]
    };

    /// Value (derivative 0) and rate of change (1) of a degree of freedom: x, y or the angle.
    #[inline(always)]
    pub const fn of(freedom: usize, derivative: usize) -> RecordEntry {
        let number = if freedom < 2 { freedom + 2 * derivative } else { 4 + derivative };
        RecordEntry::ALL[number]
    }

    /// The entry of a quantity, if records have it.
    #[inline(always)]
    pub(super) const fn of_field(field: ParticleField) -> Option<RecordEntry> {
        match field {
            ParticleField::Velocity(axis) => Some(RecordEntry::of(axis as usize, 1)),
            ParticleField::Omega => Some(RecordEntry::Omega),
            ParticleField::Radius => Some(RecordEntry::Radius),
            ParticleField::InverseMass => Some(RecordEntry::InverseMass),
            ParticleField::Mass | ParticleField::Occupied => None,
        }
    }
}

/// One record per disc, and [`SENTINELS`] more.
#[derive(Clone, Debug)]
pub struct StateRecords<S> {
    /// Blocks, one per disc and sentinel.
    columns: Vec<AlignedColumn<S>>,
    /// Scratch column for [`renumber`](Self::renumber), after the first.
    spare: AlignedColumn<S>,
    discs: usize,
    /// Entries of a record: 4, 6 or 8.
    entries: usize,
    per_time: f64,
}

impl<S: Element> StateRecords<S> {
    /// Records of zeros. `per_time` is one over the unit of time of velocities; `alignment` numbers the first column.
    #[inline]
    pub fn zeros(alignment: usize, discs: usize, [rotate, vary]: [bool; 2], per_time: f64) -> Self {
        let entries = if vary { ENTRIES } else { 4 + 2 * usize::from(rotate) };
        let numbers = block::<S>();
        let columns = (0..entries.div_ceil(numbers))
            .map(|block| AlignedColumn::zeros(alignment + block, (discs + SENTINELS) * numbers))
            .collect();
        StateRecords { columns, spare: AlignedColumn::default(), discs, entries, per_time }
    }

    /// Number of discs.
    #[inline]
    pub fn discs(&self) -> usize {
        self.discs
    }

    /// One over the unit of time.
    #[inline]
    pub fn per_time(&self) -> f64 {
        self.per_time
    }

    /// True if records have an entry.
    #[inline]
    pub fn has(&self, entry: RecordEntry) -> bool {
        (entry as usize) < self.entries
    }

    /// True if records have all of these quantities.
    #[inline]
    pub(super) fn have(&self, fields: &[ParticleField]) -> bool {
        let mut entries = fields.iter().map(|&field| RecordEntry::of_field(field));
        entries.all(|entry| entry.is_some_and(|entry| self.has(entry)))
    }

    /// An entry of a disc or sentinel.
    ///
    /// # Panics
    /// If there is no such disc or entry.
    #[inline]
    pub fn get(&self, entry: RecordEntry, disc: usize) -> S {
        let [column, at] = place::<S>(self.entries, entry, disc);
        self.columns[column][at]
    }

    /// Sets an entry of a disc or sentinel.
    ///
    /// # Panics
    /// If there is no such disc or entry.
    #[inline]
    pub fn set(&mut self, entry: RecordEntry, disc: usize, value: S) {
        let [column, at] = place::<S>(self.entries, entry, disc);
        self.columns[column][at] = value;
    }

    /// Sets an entry of all discs and sentinels on all threads.
    ///
    /// # Panics
    /// If there is no such entry.
    pub fn fill(&mut self, entry: RecordEntry, value: impl Fn(usize) -> S + Sync) {
        let ([column, offset], numbers) = (place::<S>(self.entries, entry, 0), block::<S>());
        in_pieces(&mut self.columns[column], |first, piece| {
            let blocks = piece.chunks_exact_mut(numbers).enumerate();
            blocks.for_each(|(number, block)| block[offset] = value(first / numbers + number));
        });
    }

    /// Applies `work` to every part of the records on all threads, with the number of its first disc, and returns the results in
    /// their order. The last part has the sentinels.
    pub fn in_parts<R: Send>(&mut self, work: impl Fn(usize, &mut RecordPart<'_, S>) -> R + Sync) -> Vec<R> {
        let (entries, numbers) = (self.entries, block::<S>());
        let mut columns = [(); MOST_BLOCKS].map(|()| &mut [][..]);
        columns.iter_mut().zip(&mut self.columns).for_each(|(to, column)| *to = &mut column[..]);
        in_record_parts(columns, numbers, |first, columns| work(first, &mut RecordPart { columns, entries }))
    }

    /// Position of a disc relative to the centre of its cell (length).
    #[inline]
    pub fn position(&self, disc: usize) -> [f64; 2] {
        let block = &self.columns[0][disc * block::<S>()..][..2];
        [block[0].to_f64(), block[1].to_f64()]
    }

    /// Positions of all discs and sentinels.
    #[inline(always)]
    pub(super) fn positions(&self) -> RecordPositions<'_, S> {
        RecordPositions(&self.columns[0])
    }

    /// Renumbers the discs: the new disc `n` is the old disc `order[n]`. Sentinels stay.
    ///
    /// # Panics
    /// If `order` names a disc that does not exist, or does not have one entry per disc.
    pub fn renumber(&mut self, order: &[u32]) {
        let discs = self.discs;
        assert_eq!(order.len(), discs, "the order must have one entry per disc");
        let order: Vec<u32> = order.iter().copied().chain(discs as u32..(discs + SENTINELS) as u32).collect();
        for column in &mut self.columns {
            match block::<S>() {
                2 => renumber::<S, 2>(column, &mut self.spare, &order),
                _ => renumber::<S, 4>(column, &mut self.spare, &order),
            }
        }
    }

    /// Columns of the blocks that hold the first `entries` entries.
    #[inline(always)]
    pub(super) fn blocks(&self, entries: usize) -> [*const S; MOST_BLOCKS] {
        let mut pointers = [std::ptr::null(); MOST_BLOCKS];
        let columns = &self.columns[..entries.div_ceil(block::<S>())];
        pointers.iter_mut().zip(columns).for_each(|(pointer, column)| *pointer = column.as_ptr());
        pointers
    }

    /// Columns of all blocks, to change them.
    #[inline(always)]
    pub(super) fn blocks_mut(&mut self) -> [*mut S; MOST_BLOCKS] {
        let mut pointers = [std::ptr::null_mut(); MOST_BLOCKS];
        pointers.iter_mut().zip(&mut self.columns).for_each(|(to, column)| *to = column.as_mut_ptr());
        pointers
    }
}

/// Positions in records. A search keeps the column at hand: reached through the records, a position takes two more loads.
#[derive(Clone, Copy, Debug)]
pub(super) struct RecordPositions<'a, S>(&'a [S]);

impl<S: Element> RecordPositions<'_, S> {
    /// Position of a disc or sentinel relative to the centre of its cell (length).
    ///
    /// # Safety
    /// There is such a disc or sentinel.
    #[inline(always)]
    pub(super) unsafe fn of(self, disc: u32) -> [f64; 2] {
        let first = disc as usize * block::<S>();
        // SAFETY: the column has a block for every disc and sentinel, which begins with its position.
        unsafe { [self.0.get_unchecked(first).to_f64(), self.0.get_unchecked(first + 1).to_f64()] }
    }
}

/// Some records in a row.
pub struct RecordPart<'a, S> {
    columns: [&'a mut [S]; MOST_BLOCKS],
    entries: usize,
}

impl<S: Element> RecordPart<'_, S> {
    /// Number of records.
    #[inline]
    pub fn records(&self) -> usize {
        self.columns[0].len() / block::<S>()
    }

    /// Sets an entry of a record.
    ///
    /// # Panics
    /// If there is no such record or entry.
    #[inline]
    pub fn set(&mut self, entry: RecordEntry, record: usize, value: S) {
        let [column, at] = place::<S>(self.entries, entry, record);
        self.columns[column][at] = value;
    }
}

/// Column of an entry, and the index in it for a record, for records of a number of entries.
#[inline(always)]
fn place<S: Element>(entries: usize, entry: RecordEntry, record: usize) -> [usize; 2] {
    assert!((entry as usize) < entries, "these records have no entry {entry:?}");
    let numbers = block::<S>();
    [entry as usize / numbers, record * numbers + entry as usize % numbers]
}

/// Blocks of a record at most.
pub(super) const MOST_BLOCKS: usize = ENTRIES / 2;

/// Sums over the pairs of each disc: force along x, force along y, torque.
#[derive(Clone, Debug)]
pub struct ForceRecords<P> {
    /// [`QUAD`] numbers a disc; the last is 0.
    numbers: AlignedColumn<P>,
    spare: AlignedColumn<P>,
}

impl<P: Element> ForceRecords<P> {
    /// No forces on any disc. `alignment` numbers the column.
    #[inline]
    pub fn zeros(alignment: usize, discs: usize) -> Self {
        ForceRecords {
            numbers: AlignedColumn::zeros(alignment, discs * QUAD),
            spare: AlignedColumn::default(),
        }
    }

    /// Number of discs.
    #[inline]
    pub fn discs(&self) -> usize {
        self.numbers.len() / QUAD
    }

    /// The three sums of a disc.
    ///
    /// # Panics
    /// If there is no such disc.
    #[inline]
    pub fn of(&self, disc: usize) -> [P; 3] {
        let sums = &self.numbers[disc * QUAD..][..3];
        [sums[0], sums[1], sums[2]]
    }

    /// Sets a sum of a disc.
    ///
    /// # Panics
    /// If there is no such disc or sum.
    #[inline]
    pub fn set(&mut self, sum: usize, disc: usize, value: P) {
        assert!(sum < 3, "a disc has three sums");
        self.numbers[disc * QUAD + sum] = value;
    }

    /// Sets the sums of some discs to zero.
    ///
    /// # Panics
    /// If there is no such disc.
    #[inline]
    pub fn clear(&mut self, discs: Range<usize>) {
        self.numbers[discs.start * QUAD..discs.end * QUAD].fill(P::default());
    }

    /// Renumbers the discs: the new disc `n` is the old disc `order[n]`.
    ///
    /// # Panics
    /// If `order` names a disc that does not exist, or does not have one entry per disc.
    pub fn renumber(&mut self, order: &[u32]) {
        assert_eq!(order.len(), self.discs(), "the order must have one entry per disc");
        renumber::<P, QUAD>(&mut self.numbers, &mut self.spare, order);
    }

    /// The numbers of all discs.
    #[inline(always)]
    pub(super) fn numbers_mut(&mut self) -> *mut P {
        self.numbers.as_mut_ptr()
    }
}

/// Brings records of `N` numbers into another order.
fn renumber<T: Element, const N: usize>(
    numbers: &mut AlignedColumn<T>,
    spare: &mut AlignedColumn<T>,
    order: &[u32],
) {
    if spare.len() != numbers.len() {
        *spare = AlignedColumn::zeros(numbers.number(), numbers.len());
    }
    reorder_into(spare.as_chunks_mut::<N>().0, numbers.as_chunks::<N>().0, order);
    std::mem::swap(numbers, spare);
}

#[cfg(test)]
mod tests {
    use super::*;

    fn entries<S: Element>(records: &StateRecords<S>) -> Vec<f64> {
        let discs = 0..records.discs() + SENTINELS;
        let of = |disc: usize| {
            RecordEntry::ALL.into_iter().filter(|&it| records.has(it)).map(move |it| (it, disc))
        };
        discs.flat_map(of).map(|(entry, disc)| records.get(entry, disc).to_f64()).collect()
    }

    fn parts_are_whole<S: Element>(discs: usize, kind: [bool; 2]) {
        let value = |entry: RecordEntry, disc: usize| S::from_f64((8 * disc + entry as usize) as f64);
        let mut records = StateRecords::<S>::zeros(0, discs, kind, 1.0);
        let mut expected = records.clone();
        let has: Vec<RecordEntry> = RecordEntry::ALL.into_iter().filter(|&it| records.has(it)).collect();
        has.iter().for_each(|&entry| expected.fill(entry, |disc| value(entry, disc)));
        let counts = records.in_parts(|first, part| {
            for at in 0..part.records() {
                has.iter().for_each(|&entry| part.set(entry, at, value(entry, first + at)));
            }
            part.records()
        });
        assert_eq!(counts.into_iter().sum::<usize>(), discs + SENTINELS);
        assert_eq!(entries(&records), entries(&expected));
    }

    /// Compared with entries filled one by one, for all kinds of records, parts that end with the discs among them.
    #[test]
    fn parts_hold_every_record_once() {
        for kind in [[false, false], [true, false], [false, true], [true, true]] {
            for discs in [1, 2046, 2047, 2048, 5000] {
                parts_are_whole::<f64>(discs, kind);
                parts_are_whole::<f32>(discs, kind);
            }
        }
    }
}
