//! Records of a few neighbouring numbers, transposed between memory and registers.
//!
//! ```text
//! memory                      registers
//! lane 0:  x0 y0              x0 x1 x2 x3
//! lane 1:  x1 y1      <->     y0 y1 y2 y3
//! lane 2:  x2 y2
//! lane 3:  x3 y3
//! ```
//!
//! One load of a record replaces loads from several columns. Two sizes are used:
//!
//! - a *block* of 16 bytes, the widest load that joins the others in a register without a shuffle: two numbers in double precision,
//!   four in single precision;
//! - a *quad* of four numbers, for sums: one load, one addition and one store for all of them.
//!
//! Portable SIMD has no such instructions. AVX2 and AVX-512 transpose in registers; elsewhere numbers are moved one by one. The bits
//! are the same.

#[cfg(target_arch = "x86_64")]
pub(in crate::backend) mod native;

use super::{MAX_LANES, Registers};
use crate::isa::Storage;

/// Numbers of a quad.
pub(crate) const QUAD: usize = 4;

/// Numbers of a block of 16 bytes, at most [`QUAD`].
pub(crate) const fn block<T: Storage>() -> usize {
    16 / T::BYTES
}

/// Records of the lanes of a register.
#[derive(Clone, Copy, Debug)]
pub struct RecordPlaces<'a, T> {
    /// Numbers of the record 0.
    pub first: *mut T,
    /// Distance of two records (numbers).
    pub stride: usize,
    /// Record of each lane.
    pub records: &'a [u32; MAX_LANES],
}

impl<'a, T> RecordPlaces<'a, T> {
    /// Records one behind the other.
    #[inline(always)]
    pub(crate) fn run(first: *mut T, stride: usize) -> RecordPlaces<'a, T> {
        RecordPlaces { first, stride, records: &[0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15] }
    }

    /// Records of the same places as numbers of another type.
    #[cfg(target_arch = "x86_64")]
    #[inline(always)]
    pub(in crate::backend) fn cast<U>(self) -> RecordPlaces<'a, U> {
        RecordPlaces { first: self.first.cast(), stride: self.stride, records: self.records }
    }

    /// The record of a lane.
    ///
    /// # Safety
    /// It exists in the allocation of `first`.
    #[inline(always)]
    unsafe fn at(self, lane: usize) -> *mut T {
        // SAFETY: the caller promises a record of that number.
        unsafe { self.first.add(self.records[lane] as usize * self.stride) }
    }
}

/// Loads records of up to four numbers, number by number; the other registers are zero.
///
/// # Safety
/// Every lane's record has at least `numbers` initialised numbers.
#[inline(always)]
pub(in crate::backend) unsafe fn load_by_number<R: Registers>(
    registers: R,
    numbers: usize,
    places: RecordPlaces<'_, R::Lane>,
) -> [R::V; QUAD] {
    let mut columns = [[R::Lane::default(); MAX_LANES]; QUAD];
    for lane in 0..R::LANES {
        for (k, column) in columns.iter_mut().enumerate().take(numbers) {
            // SAFETY: the caller promises the numbers there.
            column[lane] = unsafe { *places.at(lane).add(k) };
        }
    }
    registers_of(registers, &columns)
}

/// Registers with the first numbers of four columns.
#[inline(always)]
pub(crate) fn registers_of<R: Registers>(
    registers: R,
    [x, y, u, v]: &[[R::Lane; MAX_LANES]; QUAD],
) -> [R::V; QUAD] {
    // SAFETY: every column has MAX_LANES >= LANES entries.
    unsafe {
        [
            registers.load(x.as_ptr()),
            registers.load(y.as_ptr()),
            registers.load(u.as_ptr()),
            registers.load(v.as_ptr()),
        ]
    }
}

/// Numbers of some registers, lane by lane.
#[inline(always)]
fn spilled<R: Registers>(registers: R, [x, y, u, v]: [R::V; QUAD]) -> [[R::Lane; MAX_LANES]; QUAD] {
    let mut numbers = [[R::Lane::default(); MAX_LANES]; QUAD];
    // SAFETY: there is space for MAX_LANES >= LANES numbers.
    unsafe {
        registers.store(numbers[0].as_mut_ptr(), x);
        registers.store(numbers[1].as_mut_ptr(), y);
        registers.store(numbers[2].as_mut_ptr(), u);
        registers.store(numbers[3].as_mut_ptr(), v);
    }
    numbers
}

/// Stores records of up to four numbers, number by number.
///
/// # Safety
/// Every lane's record has space for `numbers` numbers.
#[inline(always)]
pub(in crate::backend) unsafe fn store_by_number<R: Registers>(
    registers: R,
    numbers: usize,
    values: [R::V; QUAD],
    places: RecordPlaces<'_, R::Lane>,
) {
    let columns = spilled(registers, values);
    for lane in 0..R::LANES {
        for (k, column) in columns.iter().enumerate().take(numbers) {
            // SAFETY: the caller promises space for the numbers there.
            unsafe { *places.at(lane).add(k) = column[lane] };
        }
    }
}

/// As [`Registers::add_quads`], number by number.
///
/// # Safety
/// As for [`Registers::add_quads`].
#[inline(always)]
pub(in crate::backend) unsafe fn add_by_number<R: Registers>(
    registers: R,
    count: usize,
    [added, subtracted]: [[R::V; QUAD]; 2],
    [own, partner]: [RecordPlaces<'_, R::Lane>; 2],
) {
    let (added, subtracted) = (spilled(registers, added), spilled(registers, subtracted));
    for lane in 0..R::LANES {
        if lane == count {
            break;
        }
        // SAFETY: the caller promises four numbers for both.
        unsafe {
            let (own, partner) = (own.at(lane), partner.at(lane));
            for (k, column) in added.iter().enumerate() {
                *own.add(k) = *own.add(k) + column[lane];
            }
            for (k, column) in subtracted.iter().enumerate() {
                *partner.add(k) = *partner.add(k) - column[lane];
            }
        }
    }
}
