//! Registers of a width fixed at compile time, by the crate `wide`: what a build without run-time dispatch gets.

use super::registers::{IndexLanes, Registers};
use crate::isa::list::for_each_op;
use crate::isa::{Element, Predicate, Vector};
use ::wide::{f32x8, f64x4};
use std::marker::PhantomData;

/// A precision that `wide` has a register for.
pub trait WideElement: Element {
    /// The register: 256 bits, whatever the processor.
    type Register: WideRegister<Self>;
    /// An index vector as wide.
    type Index: IndexLanes;
}

/// A register of `wide` as the machine needs it.
pub trait WideRegister<T>: Vector {
    /// The same number in every lane.
    fn splat(value: T) -> Self;
    /// Whether no lane holds.
    fn none(predicate: Self::Predicate) -> bool;
    /// The truth values as bits.
    fn bits(predicate: Self::Predicate) -> u64;
}

/// One register.
#[derive(Clone, Copy)]
pub struct Register<W>(W);

/// One register of truth values: all bits of a lane set or clear.
#[derive(Clone, Copy)]
pub struct Truth<W>(W);

/// Registers of 256 bits.
#[derive(Clone, Copy, Default)]
pub struct Wide<T>(PhantomData<T>);

macro_rules! operators {
    (operator { $(($variant:ident, $mnemonic:literal, $class:ident, $doc:literal, $trait:ident $method:ident)),* $(,)? }
     $($others:tt)*) => {$(
        impl<W: std::ops::$trait<Output = W>> std::ops::$trait for Register<W> {
            type Output = Self;
            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                Register(std::ops::$trait::$method(self.0, other.0))
            }
        }
    )*};
}
for_each_op!(operators);

macro_rules! wide_element {
    ($ty:ident, $wide:ident, $lanes:literal) => {
        impl Predicate for Truth<$wide> {
            #[inline(always)]
            fn and(self, other: Self) -> Self {
                Truth(self.0 & other.0)
            }
            #[inline(always)]
            fn not(self) -> Self {
                Truth(!self.0)
            }
        }

        impl Vector for Register<$wide> {
            type Predicate = Truth<$wide>;
            #[inline(always)]
            fn sqrt(self) -> Self {
                Register(self.0.sqrt())
            }
            #[inline(always)]
            fn abs(self) -> Self {
                Register(self.0.abs())
            }
            #[inline(always)]
            fn truncate(self) -> Self {
                // The crate's own truncation loses the sign of zero on some targets.
                Register($wide::from(self.0.to_array().map($ty::trunc)))
            }
            #[inline(always)]
            fn min(self, other: Self) -> Self {
                // Only x86's instruction is the machine's "a < b ? a : b" to the bit.
                if cfg!(target_arch = "x86_64") {
                    Register(self.0.fast_min(other.0))
                } else {
                    Self::select(self.less_than(other), self, other)
                }
            }
            #[inline(always)]
            fn max(self, other: Self) -> Self {
                if cfg!(target_arch = "x86_64") {
                    Register(self.0.fast_max(other.0))
                } else {
                    Self::select(other.less_than(self), self, other)
                }
            }
            #[inline(always)]
            fn less_than(self, other: Self) -> Self::Predicate {
                Truth(self.0.simd_lt(other.0))
            }
            #[inline(always)]
            fn less_equal(self, other: Self) -> Self::Predicate {
                Truth(self.0.simd_le(other.0))
            }
            #[inline(always)]
            fn equal(self, other: Self) -> Self::Predicate {
                Truth(self.0.simd_eq(other.0))
            }
            #[inline(always)]
            fn select(predicate: Self::Predicate, holds: Self, fails: Self) -> Self {
                Register(predicate.0.select(holds.0, fails.0))
            }
        }

        impl WideRegister<$ty> for Register<$wide> {
            #[inline(always)]
            fn splat(value: $ty) -> Self {
                Register($wide::splat(value))
            }
            #[inline(always)]
            fn none(predicate: Truth<$wide>) -> bool {
                !predicate.0.any()
            }
            #[inline(always)]
            fn bits(predicate: Truth<$wide>) -> u64 {
                predicate.0.to_bitmask().into()
            }
        }

        impl WideElement for $ty {
            type Register = Register<$wide>;
            type Index = [u32; $lanes];
        }
    };
}
wide_element!(f64, f64x4, 4);
wide_element!(f32, f32x8, 8);

impl<T: WideElement> Registers for Wide<T> {
    type Lane = T;
    type V = T::Register;
    type Index = T::Index;
    const LANES: usize = size_of::<T::Register>() / T::BYTES;

    #[inline(always)]
    fn splat(self, value: T) -> Self::V {
        T::Register::splat(value)
    }
    #[inline(always)]
    unsafe fn load(self, from: *const T) -> Self::V {
        // SAFETY: the caller promises LANES initialised numbers; a register is those and no more, of any bits, and is
        // read without its own alignment.
        unsafe { from.cast::<T::Register>().read_unaligned() }
    }
    #[inline(always)]
    unsafe fn store(self, to: *mut T, value: Self::V) {
        // SAFETY: the caller promises room for LANES numbers; a register is those and no more, and is written without its
        // own alignment.
        unsafe { to.cast::<T::Register>().write_unaligned(value) };
    }
    #[inline(always)]
    fn none(self, predicate: <T::Register as Vector>::Predicate) -> bool {
        T::Register::none(predicate)
    }
    #[inline(always)]
    fn bits(self, predicate: <T::Register as Vector>::Predicate) -> u64 {
        T::Register::bits(predicate)
    }
}
