//! Transposition in the registers of AVX2 and AVX-512. There are no closures: one that is not inlined is compiled without these
//! instructions.

use super::{QUAD, RecordPlaces};
use pulp::x86::{V3, V4};
use std::arch::x86_64::{__m128, __m128d, __m256, __m256d, __m512, __m512d, _mm_loadu_pd, _mm_loadu_ps};
use std::arch::x86_64::{_mm_storeu_ps, _mm256_loadu_pd, _mm256_storeu_pd};
use std::arch::x86_64::{_mm512_loadu_pd, _mm512_loadu_ps, _mm512_storeu_pd, _mm512_storeu_ps};

/// Defines [`Registers::load_blocks`](super::Registers::load_blocks) for a precision and an instruction set.
macro_rules! load_blocks {
    ($name:ident $set:ty, $number:ty, $v:ty, $load:ident $split:ident, $($lane:literal)+) => {
        /// # Safety
        /// As for [`Registers::load_blocks`](super::Registers::load_blocks).
        #[inline(always)]
        pub(in crate::backend) unsafe fn $name(set: $set, places: RecordPlaces<'_, $number>) -> [$v; QUAD] {
            // SAFETY: the caller promises a block for every lane, and the token the instructions.
            unsafe { $split(set, [$($load(places.at($lane))),+]) }
        }
    };
}
load_blocks!(load_blocks_f64_v4 V4, f64, __m512d, _mm_loadu_pd split_pairs_v4, 0 1 2 3 4 5 6 7);
load_blocks!(load_blocks_f64_v3 V3, f64, __m256d, _mm_loadu_pd split_pairs_v3, 0 1 2 3);
load_blocks!(load_blocks_f32_v4 V4, f32, __m512, _mm_loadu_ps split_f32_v4, 0 1 2 3 4 5 6 7 8 9 10 11 12 13 14 15);
load_blocks!(load_blocks_f32_v3 V3, f32, __m256, _mm_loadu_ps split_f32_v3, 0 1 2 3 4 5 6 7);

/// Defines [`Registers::add_quads`](super::Registers::add_quads) for a precision and an instruction set.
macro_rules! add_quads {
    ($name:ident $set:ty, $number:ty, $v:ty, $family:ident $load:ident $store:ident $add:ident $subtract:ident,
     $join:ident, $($lane:literal)+) => {
        /// # Safety
        /// As for [`Registers::add_quads`](super::Registers::add_quads).
        #[inline(always)]
        pub(in crate::backend) unsafe fn $name(
            set: $set,
            count: usize,
            [added, subtracted]: [[$v; QUAD]; 2],
            [own, partner]: [RecordPlaces<'_, $number>; 2],
        ) {
            let (added, subtracted) = ($join(set, added), $join(set, subtracted));
            $(
                if $lane == count {
                    return;
                }
                // SAFETY: the caller promises four numbers for each disc of the first `count` lanes, and the token the
                // instructions.
                unsafe {
                    let (own, partner) = (own.at($lane), partner.at($lane));
                    $store(own, set.$family.$add($load(own), added[$lane]));
                    $store(partner, set.$family.$subtract($load(partner), subtracted[$lane]));
                }
            )+
        }
    };
}
add_quads!(
    add_quads_f64_v4 V4, f64, __m512d, avx _mm256_loadu_pd _mm256_storeu_pd _mm256_add_pd _mm256_sub_pd,
    join_f64_v4, 0 1 2 3 4 5 6 7
);
add_quads!(
    add_quads_f64_v3 V3, f64, __m256d, avx _mm256_loadu_pd _mm256_storeu_pd _mm256_add_pd _mm256_sub_pd,
    square_f64_v3, 0 1 2 3
);
add_quads!(
    add_quads_f32_v4 V4, f32, __m512, sse _mm_loadu_ps _mm_storeu_ps _mm_add_ps _mm_sub_ps,
    join_f32_v4, 0 1 2 3 4 5 6 7 8 9 10 11 12 13 14 15
);
add_quads!(
    add_quads_f32_v3 V3, f32, __m256, sse _mm_loadu_ps _mm_storeu_ps _mm_add_ps _mm_sub_ps,
    join_f32_v3, 0 1 2 3 4 5 6 7
);

// Double precision in 512 bits.

/// Even and odd numbers of two registers.
#[inline(always)]
fn parted_f64_v4(v4: V4, a: __m512d, b: __m512d) -> (__m512d, __m512d) {
    let set = v4.avx512f;
    let even = set._mm512_setr_epi64(0, 2, 4, 6, 8, 10, 12, 14);
    let odd = set._mm512_setr_epi64(1, 3, 5, 7, 9, 11, 13, 15);
    (set._mm512_permutex2var_pd(a, even, b), set._mm512_permutex2var_pd(a, odd, b))
}

#[inline(always)]
fn four_pairs_v4(v4: V4, [a, b, c, d]: [__m128d; 4]) -> __m512d {
    let two = v4.avx512dq._mm512_insertf64x2::<1>(v4.avx512f._mm512_castpd128_pd512(a), b);
    v4.avx512dq._mm512_insertf64x2::<3>(v4.avx512dq._mm512_insertf64x2::<2>(two, c), d)
}

#[inline(always)]
fn split_pairs_v4(v4: V4, p: [__m128d; 8]) -> [__m512d; QUAD] {
    let set = v4.avx512f;
    let a = four_pairs_v4(v4, [p[0], p[2], p[4], p[6]]);
    let b = four_pairs_v4(v4, [p[1], p[3], p[5], p[7]]);
    let zero = set._mm512_setzero_pd();
    [set._mm512_unpacklo_pd(a, b), set._mm512_unpackhi_pd(a, b), zero, zero]
}

/// # Safety
/// `first` points to the blocks of eight lanes.
#[inline(always)]
pub(in crate::backend) unsafe fn load_block_run_f64_v4(v4: V4, first: *const f64) -> [__m512d; QUAD] {
    // SAFETY: the caller promises 16 numbers, and the token the instructions.
    let (x, y) =
        parted_f64_v4(v4, unsafe { _mm512_loadu_pd(first) }, unsafe { _mm512_loadu_pd(first.add(8)) });
    let zero = v4.avx512f._mm512_setzero_pd();
    [x, y, zero, zero]
}

/// # Safety
/// `first` points to space for the blocks of eight lanes.
#[inline(always)]
pub(in crate::backend) unsafe fn store_block_run_f64_v4(
    v4: V4,
    [x, y, ..]: [__m512d; QUAD],
    first: *mut f64,
) {
    let set = v4.avx512f;
    let low = set._mm512_setr_epi64(0, 8, 1, 9, 2, 10, 3, 11);
    let high = set._mm512_setr_epi64(4, 12, 5, 13, 6, 14, 7, 15);
    // SAFETY: the caller promises space for 16 numbers, and the token the instructions.
    unsafe {
        _mm512_storeu_pd(first, set._mm512_permutex2var_pd(x, low, y));
        _mm512_storeu_pd(first.add(8), set._mm512_permutex2var_pd(x, high, y));
    }
}

/// # Safety
/// `first` points to the quads of eight lanes.
#[inline(always)]
pub(in crate::backend) unsafe fn load_quad_run_f64_v4(v4: V4, first: *const f64) -> [__m512d; QUAD] {
    // SAFETY: the caller promises 32 numbers, and the token the instructions.
    let (a, b) = unsafe { (_mm512_loadu_pd(first), _mm512_loadu_pd(first.add(8))) };
    // SAFETY: as above.
    let (c, d) = unsafe { (_mm512_loadu_pd(first.add(16)), _mm512_loadu_pd(first.add(24))) };
    // x0 u0 x1 u1 ..., y0 v0 y1 v1 ...
    let ((xu, yv), (more_xu, more_yv)) = (parted_f64_v4(v4, a, b), parted_f64_v4(v4, c, d));
    let ((x, u), (y, v)) = (parted_f64_v4(v4, xu, more_xu), parted_f64_v4(v4, yv, more_yv));
    [x, y, u, v]
}

#[inline(always)]
fn join_f64_v4(v4: V4, [x, y, u, v]: [__m512d; QUAD]) -> [__m256d; 8] {
    let set = v4.avx512f;
    let first = set._mm512_setr_epi64(0, 1, 8, 9, 4, 5, 12, 13);
    let second = set._mm512_setr_epi64(2, 3, 10, 11, 6, 7, 14, 15);
    let (xu, more_xu) = (set._mm512_permutex2var_pd(x, first, u), set._mm512_permutex2var_pd(x, second, u));
    let (yv, more_yv) = (set._mm512_permutex2var_pd(y, first, v), set._mm512_permutex2var_pd(y, second, v));
    let (a, b) = (set._mm512_unpacklo_pd(xu, yv), set._mm512_unpackhi_pd(xu, yv));
    let (c, d) = (set._mm512_unpacklo_pd(more_xu, more_yv), set._mm512_unpackhi_pd(more_xu, more_yv));
    [
        set._mm512_castpd512_pd256(a),
        set._mm512_castpd512_pd256(b),
        set._mm512_castpd512_pd256(c),
        set._mm512_castpd512_pd256(d),
        set._mm512_extractf64x4_pd::<1>(a),
        set._mm512_extractf64x4_pd::<1>(b),
        set._mm512_extractf64x4_pd::<1>(c),
        set._mm512_extractf64x4_pd::<1>(d),
    ]
}

// Double precision in 256 bits.

#[inline(always)]
fn split_pairs_v3(v3: V3, p: [__m128d; 4]) -> [__m256d; QUAD] {
    let set = v3.avx;
    let a = set._mm256_insertf128_pd::<1>(set._mm256_castpd128_pd256(p[0]), p[2]);
    let b = set._mm256_insertf128_pd::<1>(set._mm256_castpd128_pd256(p[1]), p[3]);
    let zero = set._mm256_setzero_pd();
    [set._mm256_unpacklo_pd(a, b), set._mm256_unpackhi_pd(a, b), zero, zero]
}

/// # Safety
/// `first` points to the blocks of four lanes.
#[inline(always)]
pub(in crate::backend) unsafe fn load_block_run_f64_v3(v3: V3, first: *const f64) -> [__m256d; QUAD] {
    let set = v3.avx;
    // SAFETY: the caller promises 8 numbers, and the token the instructions.
    let (a, b) = unsafe { (_mm256_loadu_pd(first), _mm256_loadu_pd(first.add(4))) };
    let (c, d) = (set._mm256_permute2f128_pd::<0x20>(a, b), set._mm256_permute2f128_pd::<0x31>(a, b));
    let zero = set._mm256_setzero_pd();
    [set._mm256_unpacklo_pd(c, d), set._mm256_unpackhi_pd(c, d), zero, zero]
}

/// # Safety
/// `first` points to space for the blocks of four lanes.
#[inline(always)]
pub(in crate::backend) unsafe fn store_block_run_f64_v3(
    v3: V3,
    [x, y, ..]: [__m256d; QUAD],
    first: *mut f64,
) {
    let set = v3.avx;
    let (c, d) = (set._mm256_unpacklo_pd(x, y), set._mm256_unpackhi_pd(x, y));
    // SAFETY: the caller promises space for 8 numbers, and the token the instructions.
    unsafe {
        _mm256_storeu_pd(first, set._mm256_permute2f128_pd::<0x20>(c, d));
        _mm256_storeu_pd(first.add(4), set._mm256_permute2f128_pd::<0x31>(c, d));
    }
}

/// # Safety
/// `first` points to the quads of four lanes.
#[inline(always)]
pub(in crate::backend) unsafe fn load_quad_run_f64_v3(v3: V3, first: *const f64) -> [__m256d; QUAD] {
    // SAFETY: the caller promises 16 numbers, and the token the instructions.
    let quads = unsafe {
        [
            _mm256_loadu_pd(first),
            _mm256_loadu_pd(first.add(4)),
            _mm256_loadu_pd(first.add(8)),
            _mm256_loadu_pd(first.add(12)),
        ]
    };
    square_f64_v3(v3, quads)
}

/// The transpose of four quads, which are a square: it is its own inverse.
#[inline(always)]
fn square_f64_v3(v3: V3, quads: [__m256d; 4]) -> [__m256d; QUAD] {
    let set = v3.avx;
    let (xu, more_xu) =
        (set._mm256_unpacklo_pd(quads[0], quads[1]), set._mm256_unpacklo_pd(quads[2], quads[3]));
    let (yv, more_yv) =
        (set._mm256_unpackhi_pd(quads[0], quads[1]), set._mm256_unpackhi_pd(quads[2], quads[3]));
    [
        set._mm256_permute2f128_pd::<0x20>(xu, more_xu),
        set._mm256_permute2f128_pd::<0x20>(yv, more_yv),
        set._mm256_permute2f128_pd::<0x31>(xu, more_xu),
        set._mm256_permute2f128_pd::<0x31>(yv, more_yv),
    ]
}

// Single precision. A block is a quad.

/// The four quads of each part of 128 bits are a square, which is transposed; it is its own inverse.
macro_rules! transposed_squares {
    ($name:ident $token:ty, $family:ident, $v:ty, $ps_lo:ident $ps_hi:ident $pd_lo:ident $pd_hi:ident
     $to_pd:ident $to_ps:ident) => {
        #[inline(always)]
        fn $name(token: $token, [a, b, c, d]: [$v; QUAD]) -> [$v; QUAD] {
            let set = token.$family;
            let (low, more_low) = (set.$to_pd(set.$ps_lo(a, b)), set.$to_pd(set.$ps_lo(c, d)));
            let (high, more_high) = (set.$to_pd(set.$ps_hi(a, b)), set.$to_pd(set.$ps_hi(c, d)));
            [
                set.$to_ps(set.$pd_lo(low, more_low)),
                set.$to_ps(set.$pd_hi(low, more_low)),
                set.$to_ps(set.$pd_lo(high, more_high)),
                set.$to_ps(set.$pd_hi(high, more_high)),
            ]
        }
    };
}
transposed_squares!(
    squares_v4 V4, avx512f, __m512, _mm512_unpacklo_ps _mm512_unpackhi_ps _mm512_unpacklo_pd _mm512_unpackhi_pd
    _mm512_castps_pd _mm512_castpd_ps
);
transposed_squares!(
    squares_v3 V3, avx, __m256, _mm256_unpacklo_ps _mm256_unpackhi_ps _mm256_unpacklo_pd _mm256_unpackhi_pd
    _mm256_castps_pd _mm256_castpd_ps
);

/// Quads of the lanes n, n + 4, n + 8 and n + 12.
#[inline(always)]
fn four_v4(v4: V4, [a, b, c, d]: [__m128; 4]) -> __m512 {
    let set = v4.avx512f;
    let two = set._mm512_insertf32x4::<1>(set._mm512_castps128_ps512(a), b);
    set._mm512_insertf32x4::<3>(set._mm512_insertf32x4::<2>(two, c), d)
}

#[inline(always)]
fn split_f32_v4(v4: V4, q: [__m128; 16]) -> [__m512; QUAD] {
    let a = four_v4(v4, [q[0], q[4], q[8], q[12]]);
    let b = four_v4(v4, [q[1], q[5], q[9], q[13]]);
    let c = four_v4(v4, [q[2], q[6], q[10], q[14]]);
    let d = four_v4(v4, [q[3], q[7], q[11], q[15]]);
    squares_v4(v4, [a, b, c, d])
}

#[inline(always)]
fn join_f32_v4(v4: V4, values: [__m512; QUAD]) -> [__m128; 16] {
    let set = v4.avx512f;
    let [a, b, c, d] = squares_v4(v4, values);
    [
        set._mm512_castps512_ps128(a),
        set._mm512_castps512_ps128(b),
        set._mm512_castps512_ps128(c),
        set._mm512_castps512_ps128(d),
        set._mm512_extractf32x4_ps::<1>(a),
        set._mm512_extractf32x4_ps::<1>(b),
        set._mm512_extractf32x4_ps::<1>(c),
        set._mm512_extractf32x4_ps::<1>(d),
        set._mm512_extractf32x4_ps::<2>(a),
        set._mm512_extractf32x4_ps::<2>(b),
        set._mm512_extractf32x4_ps::<2>(c),
        set._mm512_extractf32x4_ps::<2>(d),
        set._mm512_extractf32x4_ps::<3>(a),
        set._mm512_extractf32x4_ps::<3>(b),
        set._mm512_extractf32x4_ps::<3>(c),
        set._mm512_extractf32x4_ps::<3>(d),
    ]
}

#[inline(always)]
fn two_v3(v3: V3, a: __m128, b: __m128) -> __m256 {
    v3.avx._mm256_insertf128_ps::<1>(v3.avx._mm256_castps128_ps256(a), b)
}

#[inline(always)]
fn split_f32_v3(v3: V3, q: [__m128; 8]) -> [__m256; QUAD] {
    let (a, b) = (two_v3(v3, q[0], q[4]), two_v3(v3, q[1], q[5]));
    let (c, d) = (two_v3(v3, q[2], q[6]), two_v3(v3, q[3], q[7]));
    squares_v3(v3, [a, b, c, d])
}

#[inline(always)]
fn join_f32_v3(v3: V3, values: [__m256; QUAD]) -> [__m128; 8] {
    let set = v3.avx;
    let [a, b, c, d] = squares_v3(v3, values);
    [
        set._mm256_castps256_ps128(a),
        set._mm256_castps256_ps128(b),
        set._mm256_castps256_ps128(c),
        set._mm256_castps256_ps128(d),
        set._mm256_extractf128_ps::<1>(a),
        set._mm256_extractf128_ps::<1>(b),
        set._mm256_extractf128_ps::<1>(c),
        set._mm256_extractf128_ps::<1>(d),
    ]
}

/// Even and odd numbers of two registers.
#[inline(always)]
fn parted_f32_v4(v4: V4, a: __m512, b: __m512) -> (__m512, __m512) {
    let set = v4.avx512f;
    let even = set._mm512_setr_epi32(0, 2, 4, 6, 8, 10, 12, 14, 16, 18, 20, 22, 24, 26, 28, 30);
    let odd = set._mm512_setr_epi32(1, 3, 5, 7, 9, 11, 13, 15, 17, 19, 21, 23, 25, 27, 29, 31);
    (set._mm512_permutex2var_ps(a, even, b), set._mm512_permutex2var_ps(a, odd, b))
}

/// # Safety
/// `first` points to the quads of sixteen lanes.
#[inline(always)]
pub(in crate::backend) unsafe fn load_quad_run_f32_v4(v4: V4, first: *const f32) -> [__m512; QUAD] {
    // SAFETY: the caller promises 64 numbers, and the token the instructions.
    let (a, b) = unsafe { (_mm512_loadu_ps(first), _mm512_loadu_ps(first.add(16))) };
    // SAFETY: as above.
    let (c, d) = unsafe { (_mm512_loadu_ps(first.add(32)), _mm512_loadu_ps(first.add(48))) };
    let ((xu, yv), (more_xu, more_yv)) = (parted_f32_v4(v4, a, b), parted_f32_v4(v4, c, d));
    let ((x, u), (y, v)) = (parted_f32_v4(v4, xu, more_xu), parted_f32_v4(v4, yv, more_yv));
    [x, y, u, v]
}

/// Numbers of two registers by turns: those of the lower halves, then those of the upper.
#[inline(always)]
fn by_turns_f32_v4(v4: V4, a: __m512, b: __m512) -> (__m512, __m512) {
    let set = v4.avx512f;
    let low = set._mm512_setr_epi32(0, 16, 1, 17, 2, 18, 3, 19, 4, 20, 5, 21, 6, 22, 7, 23);
    let high = set._mm512_setr_epi32(8, 24, 9, 25, 10, 26, 11, 27, 12, 28, 13, 29, 14, 30, 15, 31);
    (set._mm512_permutex2var_ps(a, low, b), set._mm512_permutex2var_ps(a, high, b))
}

/// # Safety
/// `first` points to space for the blocks of sixteen lanes.
#[inline(always)]
pub(in crate::backend) unsafe fn store_block_run_f32_v4(
    v4: V4,
    [x, y, u, v]: [__m512; QUAD],
    first: *mut f32,
) {
    let ((xu, more_xu), (yv, more_yv)) = (by_turns_f32_v4(v4, x, u), by_turns_f32_v4(v4, y, v));
    let ((a, b), (c, d)) = (by_turns_f32_v4(v4, xu, yv), by_turns_f32_v4(v4, more_xu, more_yv));
    // SAFETY: the caller promises space for 64 numbers, and the token the instructions.
    unsafe {
        _mm512_storeu_ps(first, a);
        _mm512_storeu_ps(first.add(16), b);
        _mm512_storeu_ps(first.add(32), c);
        _mm512_storeu_ps(first.add(48), d);
    }
}

/// # Safety
/// `first` points to the quads of eight lanes.
#[inline(always)]
pub(in crate::backend) unsafe fn load_quad_run_f32_v3(v3: V3, first: *const f32) -> [__m256; QUAD] {
    // SAFETY: the caller promises 32 numbers, and the token the instructions.
    unsafe { load_blocks_f32_v3(v3, RecordPlaces::run(first.cast_mut(), QUAD)) }
}

/// # Safety
/// `first` points to space for the blocks of eight lanes.
#[inline(always)]
pub(in crate::backend) unsafe fn store_block_run_f32_v3(v3: V3, values: [__m256; QUAD], first: *mut f32) {
    let q = join_f32_v3(v3, values);
    // SAFETY: the caller promises space for 32 numbers, and the token the instructions.
    unsafe {
        _mm_storeu_ps(first, q[0]);
        _mm_storeu_ps(first.add(4), q[1]);
        _mm_storeu_ps(first.add(8), q[2]);
        _mm_storeu_ps(first.add(12), q[3]);
        _mm_storeu_ps(first.add(16), q[4]);
        _mm_storeu_ps(first.add(20), q[5]);
        _mm_storeu_ps(first.add(24), q[6]);
        _mm_storeu_ps(first.add(28), q[7]);
    }
}
