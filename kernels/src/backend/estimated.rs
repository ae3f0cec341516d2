//! Registers that trade the last bits for speed: fused products and sums, inverse roots from the processor's estimate.
//!
//! Sweeps on them guarantee an error bound, not bits: results depend on the instruction set.
//!
//! The estimate y of 1/√a has the relative error δ, so that e = 1 − a y² is about 2 δ, and
//!
//! ```text
//! 1/(a √a) = y³ (1 − e)^(−3/2) = y³ (1 + 3/2 e + 15/8 e² + 35/16 e³ + ...)
//! ```
//!
//! The correction is part of the cube: no root is ever rounded by itself. The number of terms depends on the precision: AVX-512
//! has δ < 2⁻¹⁴ in both precisions, AVX2 δ < 1.5 · 2⁻¹² in single precision only. Without an estimate, root and quotient are the
//! processor's own.

use super::pulp::{Pulp, PulpElement, PulpPredicate, PulpRegister};
use super::registers::Registers;
use super::values::{implement_operator, implement_vector};
use crate::isa::Vector;
use crate::isa::list::for_each_op;
use pulp::Simd;
#[cfg(target_arch = "x86_64")]
use pulp::x86::{V3, V4};
#[cfg(target_arch = "x86_64")]
use std::any::TypeId;

/// A precision with fused operations and estimates.
pub trait EstimatingElement: PulpElement {
    /// `a · b + c`, rounded once.
    fn fused<S: Simd>(simd: S, a: Self::V<S>, b: Self::V<S>, c: Self::V<S>) -> Self::V<S>;

    /// `c − a · b`, rounded once.
    fn fused_from<S: Simd>(simd: S, a: Self::V<S>, b: Self::V<S>, c: Self::V<S>) -> Self::V<S>;

    /// Returns 1/√a to a few digits and the terms of the correction; `None` if the processor has no such instruction.
    fn inverse_root<S: Simd>(simd: S, a: Self::V<S>) -> Option<(Self::V<S>, &'static [f64])>;
}

/// Terms of the correction after the 1.
#[cfg(target_arch = "x86_64")]
const TERMS: [f64; 3] = [3.0 / 2.0, 15.0 / 8.0, 35.0 / 16.0];

/// Applies `work` to the register in the processor's own type, if the instruction set `S` is `Set`.
#[cfg(target_arch = "x86_64")]
#[inline(always)]
fn apply_native<S: Simd, Set: Simd, R: Copy, Native: Copy>(
    simd: S,
    register: R,
    work: impl FnOnce(Set, Native) -> Native,
) -> Option<R> {
    if TypeId::of::<S>() != TypeId::of::<Set>() || size_of::<R>() != size_of::<Native>() {
        return None;
    }
    // SAFETY: S and Set are one type; the register and the processor's type are plain data of one size.
    let (set, native) = unsafe { (std::mem::transmute_copy(&simd), std::mem::transmute_copy(&register)) };
    let result = work(set, native);
    // SAFETY: R and Native are of one size, as the early return ensures, and both are plain data.
    Some(unsafe { std::mem::transmute_copy(&result) })
}

impl EstimatingElement for f32 {
    #[inline(always)]
    fn fused<S: Simd>(simd: S, a: S::f32s, b: S::f32s, c: S::f32s) -> S::f32s {
        simd.mul_add_f32s(a, b, c)
    }
    #[inline(always)]
    fn fused_from<S: Simd>(simd: S, a: S::f32s, b: S::f32s, c: S::f32s) -> S::f32s {
        simd.mul_add_f32s(simd.neg_f32s(a), b, c)
    }
    #[cfg_attr(not(target_arch = "x86_64"), expect(unused_variables, reason = "only x86-64 has estimates"))]
    #[inline(always)]
    fn inverse_root<S: Simd>(simd: S, a: S::f32s) -> Option<(S::f32s, &'static [f64])> {
        #[cfg(target_arch = "x86_64")]
        {
            if let Some(root) = apply_native(simd, a, |set: V4, a| set.avx512f._mm512_rsqrt14_ps(a)) {
                return Some((root, &TERMS[..1]));
            }
            if let Some(root) = apply_native(simd, a, |set: V3, a| set.avx._mm256_rsqrt_ps(a)) {
                return Some((root, &TERMS[..2]));
            }
        }
        None
    }
}

impl EstimatingElement for f64 {
    #[inline(always)]
    fn fused<S: Simd>(simd: S, a: S::f64s, b: S::f64s, c: S::f64s) -> S::f64s {
        simd.mul_add_f64s(a, b, c)
    }
    #[inline(always)]
    fn fused_from<S: Simd>(simd: S, a: S::f64s, b: S::f64s, c: S::f64s) -> S::f64s {
        simd.mul_add_f64s(simd.neg_f64s(a), b, c)
    }
    #[cfg_attr(not(target_arch = "x86_64"), expect(unused_variables, reason = "only x86-64 has estimates"))]
    #[inline(always)]
    fn inverse_root<S: Simd>(simd: S, a: S::f64s) -> Option<(S::f64s, &'static [f64])> {
        #[cfg(target_arch = "x86_64")]
        if let Some(root) = apply_native(simd, a, |set: V4, a| set.avx512f._mm512_rsqrt14_pd(a)) {
            return Some((root, &TERMS));
        }
        None
    }
}

/// Registers of the instruction set `S` with lanes of `T` that fuse and estimate. If `RAW`, estimates are not corrected.
#[derive(Clone, Copy)]
pub(crate) struct EstimatingRegisters<S, T, const RAW: bool>(Pulp<S, T>, S);

impl<S: Simd, T: EstimatingElement, const RAW: bool> EstimatingRegisters<S, T, RAW> {
    /// Registers whose existence `simd` proves.
    #[inline(always)]
    pub(super) fn new(simd: S) -> Self {
        EstimatingRegisters(Pulp::new(simd), simd)
    }
}

/// One register.
#[derive(Clone, Copy)]
pub(crate) struct EstimatedVector<S: Simd, T: PulpElement, const RAW: bool>(S, PulpRegister<S, T>);

impl<S: Simd, T: EstimatingElement, const RAW: bool> Registers for EstimatingRegisters<S, T, RAW> {
    type Lane = T;
    type V = EstimatedVector<S, T, RAW>;
    type Index = T::Index;
    type Single = Pulp<S, f32>;
    const LANES: usize = Pulp::<S, T>::LANES;

    #[inline(always)]
    fn single(self) -> Pulp<S, f32> {
        self.0.single()
    }
    #[inline(always)]
    fn splat(self, value: T) -> Self::V {
        EstimatedVector(self.1, self.0.splat(value))
    }
    #[inline(always)]
    unsafe fn load(self, from: *const T) -> Self::V {
        // SAFETY: the caller promises LANES numbers, and the register inside has as many lanes.
        EstimatedVector(self.1, unsafe { self.0.load(from) })
    }
    #[inline(always)]
    unsafe fn store(self, to: *mut T, value: Self::V) {
        // SAFETY: the caller promises space for LANES numbers, and the register inside has as many lanes.
        unsafe { self.0.store(to, value.1) };
    }
    #[inline(always)]
    fn none(self, predicate: PulpPredicate<S, T>) -> bool {
        self.0.none(predicate)
    }
    #[inline(always)]
    fn bits(self, predicate: PulpPredicate<S, T>) -> u64 {
        self.0.bits(predicate)
    }
}

/// Forwards an operation to the register inside.
macro_rules! of_register {
    (() V merge $op:ident $f:ident ($predicate:ident $a:ident $b:ident) $result:tt) => {
        EstimatedVector($a.0, PulpRegister::$f($predicate, $a.1, $b.1))
    };
    (() V $group:ident $op:ident $f:ident ($a:ident $($b:ident)*) $result:tt) => {
        EstimatedVector($a.0, $a.1.$f($($b.1)*))
    };
    (() P $group:ident $op:ident $f:ident ($a:ident $b:ident) $result:tt) => {
        $a.1.$f($b.1)
    };
}
for_each_op!(each implement_operator ([S: Simd, T: EstimatingElement, const RAW: bool] EstimatedVector<S, T, RAW>, of_register ()));

impl<S: Simd, T: EstimatingElement, const RAW: bool> Vector for EstimatedVector<S, T, RAW> {
    type Predicate = PulpPredicate<S, T>;
    for_each_op!(each implement_vector (of_register ()));

    #[inline(always)]
    fn times_plus(self, factor: Self, addend: Self) -> Self {
        let value = T::fused(self.0, self.1.value(), factor.1.value(), addend.1.value());
        EstimatedVector(self.0, PulpRegister::new(self.0, value))
    }
    #[inline(always)]
    fn times_from(self, factor: Self, addend: Self) -> Self {
        let value = T::fused_from(self.0, self.1.value(), factor.1.value(), addend.1.value());
        EstimatedVector(self.0, PulpRegister::new(self.0, value))
    }
    #[inline(always)]
    fn inverse_three_halves(self, one: Self) -> Self {
        let Some((root, terms)) = T::inverse_root(self.0, self.1.value()) else {
            return one / (self * self.sqrt());
        };
        let root = EstimatedVector(self.0, PulpRegister::new(self.0, root));
        let square = root * root;
        if RAW {
            return square * root;
        }
        let error = self.times_from(square, one);
        let registers = EstimatingRegisters::<S, T, RAW>::new(self.0);
        let term = |k: usize| registers.splat(T::from_f64(terms[k]));
        let correction = match terms.len() {
            1 => term(0),
            2 => error.times_plus(term(1), term(0)),
            _ => error.times_plus(error.times_plus(term(2), term(1)), term(0)),
        };
        square * root * error.times_plus(correction, one)
    }
}
