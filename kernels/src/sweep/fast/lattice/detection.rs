//! Contact search where many cells are occupied: registers of cells are compared with the same cells at every offset of the half
//! mask.
//!
//! ```text
//! for every group of 16 cells of a row that has a disc:
//!     for every offset of the half mask:
//!         d = position[group] - cell offset - position[group at the offset]    a register of cells at a time, x and y in one word
//!         16 bits: dx² + dy² < (1 + margin)²                               in units of the largest contact distance;
//!                                                                          (r_i + r_j)² instead of 1 where radii vary
//!     and these bits with those of the occupied cells                      four offsets share a word of 64 bits
//!     append a candidate for every remaining bit
//! ```
//!
//! Reasons for its speed:
//!
//! - *Shifts, not gathers.* Cells of a row are stored side by side, so all partners at an offset are one load.
//! - *16-bit coordinates.* Positions inside cells are copied as pairs of integers ([`Advance`](crate::sweep::fast::Advance)): two
//!   subtractions, one multiplication with addition and one comparison for 16 cells. A margin of 4·10⁻⁴ covers the rounding, so no
//!   contact is missed and 1 % of the candidates are none; the law decides in full precision.
//! - *No test whether the partner's cell is occupied.* The x of an empty cell is so far away that nothing is near it.
//! - *Bits, not branches.* Results stay bits until the end. Candidates are appended four at a time, even if there are fewer,
//!   because their number cannot be predicted.

use super::codes::{PackedCandidate, half_mask_offset, offset_count};
use super::occupancy::Occupancy;
use crate::GROUP;
use crate::backend::Registers;
use crate::backend::{RegisterTask, coordinate_pair};
use crate::sweep::fast::finder::SearchCursor;
use std::ops::Range;

/// Offsets of the mask whose results share a word: 16 cells each.
const OFFSETS: usize = 64 / GROUP;

/// Searches groups of cells from `cursor` to the end of the rows, until `full` candidates are found.
pub(super) struct DenseSearch<'a> {
    pub(super) occupancy: &'a Occupancy,
    /// Fraction of the contact distance by which a pair may be farther apart, in addition to the margin.
    pub(super) slack: f64,
    pub(super) rows: Range<usize>,
    pub(super) cursor: &'a mut SearchCursor,
    pub(super) full: usize,
    pub(super) found: &'a mut Vec<PackedCandidate>,
}

impl RegisterTask<f32> for DenseSearch<'_> {
    #[inline(always)]
    fn on<R: Registers<Lane = f32>>(self, registers: R) {
        match (self.occupancy.half_width(), self.occupancy.radii().is_some()) {
            (2, false) => self.with::<R, 2, false>(registers),
            (2, true) => self.with::<R, 2, true>(registers),
            (_, false) => self.with::<R, 3, false>(registers),
            (_, true) => self.with::<R, 3, true>(registers),
        }
    }
}

/// Words for the results of a group: 12 or 24 offsets.
#[inline]
const fn word_count(half_width: usize) -> usize {
    offset_count(half_width).div_ceil(OFFSETS)
}

impl DenseSearch<'_> {
    #[inline(always)]
    fn with<R: Registers<Lane = f32>, const H: usize, const VARY: bool>(self, registers: R) {
        let DenseSearch { occupancy, slack, rows, cursor, full, found } = self;
        let beyond = coordinate_pair(occupancy.beyond(slack) as i16, 0);
        let limits = (occupancy.limit(slack), beyond);
        let shape = occupancy.shape();
        let stride = shape.stride();
        let positions = occupancy.positions();
        let radii = if VARY { occupancy.radii().unwrap_or(&[]) } else { positions };
        let occupied = occupancy.occupied();
        let groups = shape.columns().div_ceil(GROUP);
        let end = (rows.end - 1 + H) * stride + shape.position(0, 0) + shape.columns() + GROUP + H;
        assert!(rows.end <= shape.rows() && end <= positions.len() && positions.len() == radii.len());
        assert!(end < occupied.positions());
        let (positions, radii) = (positions.as_ptr(), radii.as_ptr());
        let offsets: [u32; MOST] =
            std::array::from_fn(|number| occupancy.offset_pair(half_mask_offset(H, number)));
        while cursor.row < rows.end {
            while cursor.along < groups {
                let column = cursor.along * GROUP;
                let base = shape.position(column as isize, cursor.row as isize);
                let inside = (1 << GROUP.min(shape.columns() - column)) - 1;
                // SAFETY: the group begins before `end`, for which there are bits (asserted above).
                let own = unsafe { occupied.bits_from(base) } & inside;
                if own != 0 {
                    if found.len() >= full {
                        return;
                    }
                    // SAFETY: the group's cells and those at its offsets, up to H columns and rows on, are before `end`, and all
                    // columns have as many entries (asserted above).
                    let near = unsafe {
                        let own = [positions.add(base), radii.add(base)];
                        compare::<R, H, VARY>(registers, own, stride, &offsets, limits)
                    };
                    for (word, near) in near.into_iter().take(const { word_count(H) }).enumerate() {
                        let own = own * 0x0001_0001_0001_0001;
                        list_candidates(
                            found,
                            (base as u64) << PackedCandidate::CODE | (word as u64) << 6,
                            near & own,
                        );
                    }
                }
                cursor.along += 1;
            }
            *cursor = SearchCursor::at(cursor.row + 1);
        }
    }
}

/// Offsets of the half mask of the widest mask.
const MOST: usize = offset_count(3);

/// Finds the discs of a group that are near the disc at each offset: 16 bits per offset.
///
/// # Safety
/// The pointers are to the own cells of a group, positions and radii, and every cell of it exists at every offset.
#[inline(always)]
unsafe fn compare<R: Registers<Lane = f32>, const H: usize, const VARY: bool>(
    registers: R,
    [positions, radii]: [*const u32; 2],
    stride: usize,
    offsets: &[u32; MOST],
    (limit, beyond): (i32, u32),
) -> [u64; 6] {
    let mut near = [0; 6];
    let mut part = 0;
    while part < GROUP {
        // Unrolled by hand: if the compiler leaves a loop, the words stay in memory, at five times the cost.
        macro_rules! at_offsets {
            ($($number:literal)*) => {$(
                if $number < const { offset_count(H) } {
                    let [column, row] = const { half_mask_offset(H, $number) };
                    let shift = row * stride as isize + column + part as isize;
                    // SAFETY: part + LANES <= GROUP, and the caller promises that every cell of the group exists at every offset of
                    // the mask.
                    let touch = unsafe {
                        let (own, other) = (positions.add(part), positions.offset(shift));
                        if VARY {
                            let [own, other] = [[own, radii.add(part)], [other, radii.offset(shift)]];
                            registers.touching_pairs(own, offsets[$number], other, beyond)
                        } else {
                            registers.near_pairs(own, offsets[$number], other, limit)
                        }
                    };
                    near[$number / OFFSETS] |= touch << (GROUP * ($number % OFFSETS) + part);
                }
            )*};
        }
        at_offsets!(0 1 2 3 4 5 6 7 8 9 10 11 12 13 14 15 16 17 18 19 20 21 22 23);
        part += R::LANES;
    }
    near
}

/// Appends a candidate for every bit, lowest first.
#[inline(always)]
fn list_candidates(found: &mut Vec<PackedCandidate>, prefix: u64, bits: u64) {
    append_bits(found, bits, |bit| PackedCandidate(prefix | bit));
}

/// Appends `of(number)` for every set bit, lowest first.
#[inline(always)]
pub(super) fn append_bits<T: Copy>(list: &mut Vec<T>, mut bits: u64, of: impl Fn(u64) -> T) {
    // More than a few are rare: writing a few unconditionally avoids the branches.
    const AT_ONCE: usize = 4;
    let count = bits.count_ones() as usize;
    let length = list.len();
    list.reserve(64 + AT_ONCE);
    let mut listed = 0;
    while {
        for i in 0..AT_ONCE {
            // SAFETY: listed < 64 here, and `reserve` has left capacity for 64 more and AT_ONCE.
            unsafe { list.as_mut_ptr().add(length + listed + i).write(of(bits.trailing_zeros().into())) };
            bits &= bits.wrapping_sub(1);
        }
        listed += AT_ONCE;
        listed < count
    } {}
    // SAFETY: the loop has written `listed` >= `count` entries behind the first `length`.
    unsafe { list.set_len(length + count) };
}
