//! Pairs of 16-bit coordinates, for a search that compares distances of many discs.
//!
//! A pair is one 32-bit word: x in the low half, y in the high half. A processor subtracts, squares and adds both coordinates of a
//! register of pairs in three instructions. Portable SIMD does not have them. The bits are the same everywhere.

use super::Registers;

/// A pair of coordinates.
#[inline(always)]
pub(crate) const fn coordinate_pair(x: i16, y: i16) -> u32 {
    x as u16 as u32 | (y as u16 as u32) << 16
}

/// Square of the sum of three numbers in the low halves, with saturation.
#[inline(always)]
const fn square_of_sum(a: u32, b: u32, c: u32) -> i32 {
    let sum = (a as i16).saturating_add(b as i16).saturating_add(c as i16) as i32;
    sum * sum
}

/// Square of the distance of two pairs, the first shifted back by an offset, with saturation.
#[inline(always)]
const fn square_of_distance(own: u32, offset: u32, other: u32) -> i32 {
    let dx = (own as i16).saturating_sub(offset as i16).saturating_sub(other as i16) as i32;
    let (own, offset, other) = (own >> 16, offset >> 16, other >> 16);
    let dy = (own as i16).saturating_sub(offset as i16).saturating_sub(other as i16) as i32;
    (dx * dx).wrapping_add(dy * dy)
}

/// As [`Registers::near_pairs`], pair by pair.
///
/// # Safety
/// As there.
#[inline(always)]
pub(in crate::backend) unsafe fn near_pairs<R: Registers>(
    own: *const u32,
    offset: u32,
    other: *const u32,
    limit: i32,
) -> u64 {
    let mut bits = 0;
    for lane in 0..R::LANES {
        // SAFETY: the caller promises LANES pairs in both places.
        let square = unsafe { square_of_distance(*own.add(lane), offset, *other.add(lane)) };
        bits |= u64::from(square < limit) << lane;
    }
    bits
}

/// As [`Registers::touching_pairs`], pair by pair.
///
/// # Safety
/// As there.
#[inline(always)]
pub(in crate::backend) unsafe fn touching_pairs<R: Registers>(
    [own, own_reach]: [*const u32; 2],
    offset: u32,
    [other, other_reach]: [*const u32; 2],
    beyond: u32,
) -> u64 {
    let mut bits = 0;
    for lane in 0..R::LANES {
        // SAFETY: the caller promises LANES pairs and LANES reaches in both places.
        let (square, limit) = unsafe {
            (
                square_of_distance(*own.add(lane), offset, *other.add(lane)),
                square_of_sum(*own_reach.add(lane), *other_reach.add(lane), beyond),
            )
        };
        bits |= u64::from(square < limit) << lane;
    }
    bits
}

/// Comparisons in the registers of AVX2 and AVX-512.
#[cfg(target_arch = "x86_64")]
pub(in crate::backend) mod native {
    use pulp::x86::{V3, V4};
    use std::arch::x86_64::{__m256i, __m512i, _mm256_loadu_si256, _mm512_loadu_si512};

    #[inline(always)]
    fn squares_v4(v4: V4, own: __m512i, offset: u32, other: __m512i) -> __m512i {
        let set = v4.avx512bw;
        let offset = v4.avx512f._mm512_set1_epi32(offset.cast_signed());
        let apart = set._mm512_subs_epi16(set._mm512_subs_epi16(own, offset), other);
        set._mm512_madd_epi16(apart, apart)
    }

    #[inline(always)]
    fn squares_v3(v3: V3, own: __m256i, offset: u32, other: __m256i) -> __m256i {
        let set = v3.avx2;
        let offset = v3.avx._mm256_set1_epi32(offset.cast_signed());
        let apart = set._mm256_subs_epi16(set._mm256_subs_epi16(own, offset), other);
        set._mm256_madd_epi16(apart, apart)
    }

    #[inline(always)]
    fn bits_below_v3(v3: V3, squares: __m256i, limits: __m256i) -> u64 {
        let below = v3.avx._mm256_castsi256_ps(v3.avx2._mm256_cmpgt_epi32(limits, squares));
        u64::from(v3.avx._mm256_movemask_ps(below).cast_unsigned())
    }

    /// # Safety
    /// There are 16 pairs in both places.
    #[inline(always)]
    pub(in crate::backend) unsafe fn near_pairs_v4(
        v4: V4,
        own: *const u32,
        offset: u32,
        other: *const u32,
        limit: i32,
    ) -> u64 {
        // SAFETY: the caller promises the pairs, and the token the instructions.
        let (own, other) = unsafe { (_mm512_loadu_si512(own.cast()), _mm512_loadu_si512(other.cast())) };
        let squares = squares_v4(v4, own, offset, other);
        v4.avx512f._mm512_cmplt_epi32_mask(squares, v4.avx512f._mm512_set1_epi32(limit)).into()
    }

    /// # Safety
    /// There are 8 pairs in both places.
    #[inline(always)]
    pub(in crate::backend) unsafe fn near_pairs_v3(
        v3: V3,
        own: *const u32,
        offset: u32,
        other: *const u32,
        limit: i32,
    ) -> u64 {
        // SAFETY: the caller promises the pairs, and the token the instructions.
        let (own, other) = unsafe { (_mm256_loadu_si256(own.cast()), _mm256_loadu_si256(other.cast())) };
        let squares = squares_v3(v3, own, offset, other);
        bits_below_v3(v3, squares, v3.avx._mm256_set1_epi32(limit))
    }

    /// # Safety
    /// There are 16 pairs and 16 reaches in both places.
    #[inline(always)]
    pub(in crate::backend) unsafe fn touching_pairs_v4(
        v4: V4,
        [own, own_reach]: [*const u32; 2],
        offset: u32,
        [other, other_reach]: [*const u32; 2],
        beyond: u32,
    ) -> u64 {
        // SAFETY: the caller promises the pairs, and the token the instructions.
        let (own, other) = unsafe { (_mm512_loadu_si512(own.cast()), _mm512_loadu_si512(other.cast())) };
        // SAFETY: the caller promises the reaches.
        let (own_reach, other_reach) =
            unsafe { (_mm512_loadu_si512(own_reach.cast()), _mm512_loadu_si512(other_reach.cast())) };
        let both = v4.avx512bw._mm512_adds_epi16(own_reach, other_reach);
        let beyond = v4.avx512f._mm512_set1_epi32(beyond.cast_signed());
        let reach = v4.avx512bw._mm512_adds_epi16(both, beyond);
        let limits = v4.avx512bw._mm512_madd_epi16(reach, reach);
        v4.avx512f._mm512_cmplt_epi32_mask(squares_v4(v4, own, offset, other), limits).into()
    }

    /// # Safety
    /// There are 8 pairs and 8 reaches in both places.
    #[inline(always)]
    pub(in crate::backend) unsafe fn touching_pairs_v3(
        v3: V3,
        [own, own_reach]: [*const u32; 2],
        offset: u32,
        [other, other_reach]: [*const u32; 2],
        beyond: u32,
    ) -> u64 {
        // SAFETY: the caller promises the pairs, and the token the instructions.
        let (own, other) = unsafe { (_mm256_loadu_si256(own.cast()), _mm256_loadu_si256(other.cast())) };
        // SAFETY: the caller promises the reaches.
        let (own_reach, other_reach) =
            unsafe { (_mm256_loadu_si256(own_reach.cast()), _mm256_loadu_si256(other_reach.cast())) };
        let both = v3.avx2._mm256_adds_epi16(own_reach, other_reach);
        let beyond = v3.avx._mm256_set1_epi32(beyond.cast_signed());
        let reach = v3.avx2._mm256_adds_epi16(both, beyond);
        let limits = v3.avx2._mm256_madd_epi16(reach, reach);
        bits_below_v3(v3, squares_v3(v3, own, offset, other), limits)
    }
}
