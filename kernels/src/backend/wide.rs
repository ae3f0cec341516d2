//! Registers of a width fixed at compile time, from the crate `wide`: for builds without run-time dispatch.

use super::registers::{IndexLanes, Registers};
use super::values::{implement_operator, implement_predicate, implement_vector};
use crate::isa::list::for_each_op;
use crate::isa::{Element, Predicate, Vector};
use ::wide::{f32x8, f64x4};
use std::marker::PhantomData;

/// A precision with a register in `wide`.
pub trait WideElement: Element {
    /// Register of 256 bits on every processor.
    type WideVector: WideRegister<Self>;
    /// Index vector of the same width.
    type Index: IndexLanes;
}

/// Operations of a `wide` register beyond [`Vector`].
pub trait WideRegister<T>: Vector {
    /// Broadcasts a number to every lane.
    fn splat(value: T) -> Self;
    /// True if the predicate is false in every lane.
    fn none(predicate: Self::Predicate) -> bool;
    /// Truth values as bits.
    fn bits(predicate: Self::Predicate) -> u64;
}

/// One register.
#[derive(Clone, Copy)]
pub struct WideVector<W>(W);

/// One register of truth values: all bits of a lane set or clear.
#[derive(Clone, Copy)]
pub struct WidePredicate<W>(W);

/// Registers of 256 bits.
#[derive(Clone, Copy, Default)]
pub struct Wide<T>(PhantomData<T>);

/// Instructions of the crate, those of numbers on the inner value of a register.
#[rustfmt::skip]
macro_rules! of_wide {
    (($ty:ident $wide:ident) V $group:ident $op:ident $f:ident ($($a:ident)*) $result:tt) => {
        WideVector(of_wide!($op $ty $wide $(($a.0))*))
    };
    (($ty:ident $wide:ident) P $group:ident $op:ident $f:ident ($($a:ident)*) $result:tt) => {
        WidePredicate(of_wide!($op $ty $wide $(($a.0))*))
    };
    (Add $ty:ident $wide:ident $a:tt $b:tt) => { $a + $b };
    (Subtract $ty:ident $wide:ident $a:tt $b:tt) => { $a - $b };
    (Multiply $ty:ident $wide:ident $a:tt $b:tt) => { $a * $b };
    (Divide $ty:ident $wide:ident $a:tt $b:tt) => { $a / $b };
    // Only x86's instruction equals the machine's "a < b ? a : b" to the bit.
    (Minimum $ty:ident $wide:ident $a:tt $b:tt) => {
        if cfg!(target_arch = "x86_64") { $a.fast_min($b) } else { $a.simd_lt($b).select($a, $b) }
    };
    (Maximum $ty:ident $wide:ident $a:tt $b:tt) => {
        if cfg!(target_arch = "x86_64") { $a.fast_max($b) } else { $b.simd_lt($a).select($a, $b) }
    };
    (SquareRoot $ty:ident $wide:ident $a:tt) => { $a.sqrt() };
    (Absolute $ty:ident $wide:ident $a:tt) => { $a.abs() };
    // The crate's own truncation loses the sign of zero on some targets.
    (Truncate $ty:ident $wide:ident $a:tt) => { $wide::from($a.to_array().map($ty::trunc)) };
    (LessThan $ty:ident $wide:ident $a:tt $b:tt) => { $a.simd_lt($b) };
    (LessEqual $ty:ident $wide:ident $a:tt $b:tt) => { $a.simd_le($b) };
    (Equal $ty:ident $wide:ident $a:tt $b:tt) => { $a.simd_eq($b) };
    (And $ty:ident $wide:ident $a:tt $b:tt) => { $a & $b };
    (Not $ty:ident $wide:ident $a:tt) => { !$a };
    (Select $ty:ident $wide:ident $p:tt $a:tt $b:tt) => { $p.select($a, $b) };
}

macro_rules! wide_element {
    ($ty:ident, $wide:ident, $lanes:literal) => {
        for_each_op!(each implement_operator ([] WideVector<$wide>, of_wide ($ty $wide)));

        impl Vector for WideVector<$wide> {
            type Predicate = WidePredicate<$wide>;
            for_each_op!(each implement_vector (of_wide ($ty $wide)));
        }

        impl Predicate for WidePredicate<$wide> {
            for_each_op!(each implement_predicate (of_wide ($ty $wide)));
        }

        impl WideRegister<$ty> for WideVector<$wide> {
            #[inline(always)]
            fn splat(value: $ty) -> Self {
                WideVector($wide::splat(value))
            }
            #[inline(always)]
            fn none(predicate: WidePredicate<$wide>) -> bool {
                !predicate.0.any()
            }
            #[inline(always)]
            fn bits(predicate: WidePredicate<$wide>) -> u64 {
                predicate.0.to_bitmask().into()
            }
        }

        impl WideElement for $ty {
            type WideVector = WideVector<$wide>;
            type Index = [u32; $lanes];
        }
    };
}
wide_element!(f64, f64x4, 4);
wide_element!(f32, f32x8, 8);

impl<T: WideElement> Registers for Wide<T> {
    type Lane = T;
    type V = T::WideVector;
    type Index = T::Index;
    type Single = Wide<f32>;
    const LANES: usize = size_of::<T::WideVector>() / T::BYTES;

    #[inline(always)]
    fn single(self) -> Wide<f32> {
        Wide::default()
    }
    #[inline(always)]
    fn splat(self, value: T) -> Self::V {
        T::WideVector::splat(value)
    }
    #[inline(always)]
    unsafe fn load(self, from: *const T) -> Self::V {
        // SAFETY: the caller promises LANES initialised numbers; a register consists of just those, allows any bits, and is read
        // unaligned.
        unsafe { from.cast::<T::WideVector>().read_unaligned() }
    }
    #[inline(always)]
    unsafe fn store(self, to: *mut T, value: Self::V) {
        // SAFETY: the caller promises space for LANES numbers; a register consists of just those, and is written unaligned.
        unsafe { to.cast::<T::WideVector>().write_unaligned(value) };
    }
    #[inline(always)]
    fn none(self, predicate: <T::WideVector as Vector>::Predicate) -> bool {
        T::WideVector::none(predicate)
    }
    #[inline(always)]
    fn bits(self, predicate: <T::WideVector as Vector>::Predicate) -> u64 {
        T::WideVector::bits(predicate)
    }
}
