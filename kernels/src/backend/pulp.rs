//! Registers of the processor at hand, chosen at run time: AVX-512, AVX2, NEON, or scalar, by the crate `pulp`.

use super::registers::{IndexLanes, Registers};
use crate::isa::list::for_each_op;
use crate::isa::{Element, Predicate, Vector};
use pulp::Simd;
#[cfg(target_arch = "x86_64")]
use std::any::TypeId;
use std::marker::PhantomData;

macro_rules! define_pulp_element {
    (operator { $(($ov:ident, $om:literal, $oc:ident, $od:literal, $trait:ident $of:ident)),* $(,)? }
     binary { $(($bv:ident, $bm:literal, $bc:ident, $bd:literal, $bf:ident)),* $(,)? }
     unary { $(($uv:ident, $um:literal, $uc:ident, $ud:literal, $uf:ident)),* $(,)? }
     compare { $(($cv:ident, $cm:literal, $cc:ident, $cd:literal, $cf:ident)),* $(,)? }
     connective { $(($av:ident, $am:literal, $ac:ident, $ad:literal, $af:ident)),* $(,)? }
     negation { $(($nv:ident, $nm:literal, $nc:ident, $nd:literal, $nf:ident)),* $(,)? }
     machine $machine:tt) => {
        /// A precision that `pulp` has registers for. Its operations are named per type, hence this table.
        pub trait PulpElement: Element {
            /// A register of `S`.
            type Register<S: Simd>: Copy;
            /// A register of truth values of `S`.
            type Truth<S: Simd>: Copy;
            /// An index vector, of as many entries as the widest registers have lanes: with more, what is loaded would be
            /// laid out on the stack and read back in wider pieces, which waits.
            type Index: IndexLanes;

            #[doc(hidden)]
            fn splat<S: Simd>(simd: S, value: Self) -> Self::Register<S>;
            $(
                #[doc(hidden)]
                fn $of<S: Simd>(simd: S, a: Self::Register<S>, b: Self::Register<S>) -> Self::Register<S>;
            )*
            $(
                #[doc(hidden)]
                fn $bf<S: Simd>(simd: S, a: Self::Register<S>, b: Self::Register<S>) -> Self::Register<S>;
            )*
            $(
                #[doc(hidden)]
                fn $uf<S: Simd>(simd: S, a: Self::Register<S>) -> Self::Register<S>;
            )*
            $(
                #[doc(hidden)]
                fn $cf<S: Simd>(simd: S, a: Self::Register<S>, b: Self::Register<S>) -> Self::Truth<S>;
            )*
            $(
                #[doc(hidden)]
                fn $af<S: Simd>(simd: S, a: Self::Truth<S>, b: Self::Truth<S>) -> Self::Truth<S>;
            )*
            $(
                #[doc(hidden)]
                fn $nf<S: Simd>(simd: S, a: Self::Truth<S>) -> Self::Truth<S>;
            )*
            #[doc(hidden)]
            fn select<S: Simd>(
                simd: S,
                truth: Self::Truth<S>,
                holds: Self::Register<S>,
                fails: Self::Register<S>,
            ) -> Self::Register<S>;
            #[doc(hidden)]
            fn none<S: Simd>(simd: S, a: Self::Truth<S>) -> bool;
            #[doc(hidden)]
            fn bits<S: Simd>(simd: S, a: Self::Truth<S>) -> u64;
        }

        $(
            impl<S: Simd, T: PulpElement> std::ops::$trait for Register<S, T> {
                type Output = Self;
                #[inline(always)]
                fn $of(self, other: Self) -> Self {
                    Register(self.0, <T as PulpElement>::$of(self.0, self.1, other.1))
                }
            }
        )*

        impl<S: Simd, T: PulpElement> Predicate for Truth<S, T> {
            $(
                #[inline(always)]
                fn $af(self, other: Self) -> Self {
                    Truth(self.0, <T as PulpElement>::$af(self.0, self.1, other.1))
                }
            )*
            $(
                #[inline(always)]
                fn $nf(self) -> Self {
                    Truth(self.0, <T as PulpElement>::$nf(self.0, self.1))
                }
            )*
        }

        impl<S: Simd, T: PulpElement> Vector for Register<S, T> {
            type Predicate = Truth<S, T>;
            $(
                #[inline(always)]
                fn $uf(self) -> Self {
                    Register(self.0, <T as PulpElement>::$uf(self.0, self.1))
                }
            )*
            $(
                #[inline(always)]
                fn $bf(self, other: Self) -> Self {
                    Register(self.0, <T as PulpElement>::$bf(self.0, self.1, other.1))
                }
            )*
            $(
                #[inline(always)]
                fn $cf(self, other: Self) -> Truth<S, T> {
                    Truth(self.0, <T as PulpElement>::$cf(self.0, self.1, other.1))
                }
            )*
            #[inline(always)]
            fn select(predicate: Truth<S, T>, holds: Self, fails: Self) -> Self {
                Register(holds.0, <T as PulpElement>::select(holds.0, predicate.1, holds.1, fails.1))
            }
        }
    };
}
for_each_op!(define_pulp_element);

macro_rules! pulp_element {
    ($ty:ident, $register:ident, $truth:ident, $lanes:ident, $widest:literal,
     $splat:ident $add:ident $sub:ident $mul:ident $div:ident $min:ident $max:ident $sqrt:ident $abs:ident
     $less_than:ident $less_equal:ident $equal:ident $select:ident $and:ident $not:ident $first_true:ident
     $movemask:ident $bits:ident) => {
        impl PulpElement for $ty {
            type Register<S: Simd> = S::$register;
            type Truth<S: Simd> = S::$truth;
            type Index = [u32; $widest];
            #[inline(always)]
            fn splat<S: Simd>(simd: S, value: Self) -> S::$register {
                simd.$splat(value)
            }
            #[inline(always)]
            fn add<S: Simd>(simd: S, a: S::$register, b: S::$register) -> S::$register {
                simd.$add(a, b)
            }
            #[inline(always)]
            fn sub<S: Simd>(simd: S, a: S::$register, b: S::$register) -> S::$register {
                simd.$sub(a, b)
            }
            #[inline(always)]
            fn mul<S: Simd>(simd: S, a: S::$register, b: S::$register) -> S::$register {
                simd.$mul(a, b)
            }
            #[inline(always)]
            fn div<S: Simd>(simd: S, a: S::$register, b: S::$register) -> S::$register {
                simd.$div(a, b)
            }
            #[inline(always)]
            fn min<S: Simd>(simd: S, a: S::$register, b: S::$register) -> S::$register {
                // Only x86's instruction is the machine's "a < b ? a : b" to the bit.
                if cfg!(target_arch = "x86_64") && !S::IS_SCALAR {
                    simd.$min(a, b)
                } else {
                    simd.$select(simd.$less_than(a, b), a, b)
                }
            }
            #[inline(always)]
            fn max<S: Simd>(simd: S, a: S::$register, b: S::$register) -> S::$register {
                if cfg!(target_arch = "x86_64") && !S::IS_SCALAR {
                    simd.$max(a, b)
                } else {
                    simd.$select(simd.$less_than(b, a), a, b)
                }
            }
            #[inline(always)]
            fn sqrt<S: Simd>(simd: S, a: S::$register) -> S::$register {
                simd.$sqrt(a)
            }
            #[inline(always)]
            fn abs<S: Simd>(simd: S, a: S::$register) -> S::$register {
                simd.$abs(a)
            }
            #[inline(always)]
            fn truncate<S: Simd>(_: S, mut a: S::$register) -> S::$register {
                // pulp has no rounding; the compiler vectorises this loop inside the dispatched function.
                for lane in pulp::bytemuck::cast_slice_mut::<S::$register, $ty>(std::slice::from_mut(&mut a))
                {
                    *lane = lane.trunc();
                }
                a
            }
            #[inline(always)]
            fn less_than<S: Simd>(simd: S, a: S::$register, b: S::$register) -> S::$truth {
                simd.$less_than(a, b)
            }
            #[inline(always)]
            fn less_equal<S: Simd>(simd: S, a: S::$register, b: S::$register) -> S::$truth {
                simd.$less_equal(a, b)
            }
            #[inline(always)]
            fn equal<S: Simd>(simd: S, a: S::$register, b: S::$register) -> S::$truth {
                simd.$equal(a, b)
            }
            #[inline(always)]
            fn select<S: Simd>(
                simd: S,
                truth: S::$truth,
                holds: S::$register,
                fails: S::$register,
            ) -> S::$register {
                simd.$select(truth, holds, fails)
            }
            #[inline(always)]
            fn and<S: Simd>(simd: S, a: S::$truth, b: S::$truth) -> S::$truth {
                simd.$and(a, b)
            }
            #[inline(always)]
            fn not<S: Simd>(simd: S, a: S::$truth) -> S::$truth {
                simd.$not(a)
            }
            #[inline(always)]
            fn none<S: Simd>(simd: S, a: S::$truth) -> bool {
                simd.$first_true(a) == S::$lanes
            }
            #[cfg_attr(
                not(target_arch = "x86_64"),
                expect(unused_variables, reason = "x86-64 has more ways")
            )]
            #[inline(always)]
            fn bits<S: Simd>(simd: S, a: S::$truth) -> u64 {
                #[cfg(target_arch = "x86_64")]
                {
                    if let (Some(v3), Some(truth)) = (same_value::<S, pulp::x86::V3>(simd), same_value(a)) {
                        return u64::from(v3.avx.$movemask(truth) as u32);
                    }
                    // From a mask register: by way of memory it would be a store and a load.
                    if let Some(truth) = same_value::<_, pulp::$bits>(a) {
                        return u64::from(truth.0);
                    }
                }
                bits_by_lane(pulp::bytemuck::bytes_of(&a), S::$lanes)
            }
        }
    };
}

pulp_element!(
    f64, f64s, m64s, F64_LANES, 8, splat_f64s add_f64s sub_f64s mul_f64s div_f64s min_f64s max_f64s sqrt_f64s abs_f64s
    less_than_f64s less_than_or_equal_f64s equal_f64s select_f64s and_m64s not_m64s first_true_m64s _mm256_movemask_pd b8
);
pulp_element!(
    f32, f32s, m32s, F32_LANES, 16, splat_f32s add_f32s sub_f32s mul_f32s div_f32s min_f32s max_f32s sqrt_f32s abs_f32s
    less_than_f32s less_than_or_equal_f32s equal_f32s select_f32s and_m32s not_m32s first_true_m32s _mm256_movemask_ps b16
);

/// A value whose type turns out to be another of the same size: `pulp` has no instruction for this in all its sets.
#[cfg(target_arch = "x86_64")]
#[inline(always)]
fn same_value<A: Copy + 'static, B: Copy + 'static>(value: A) -> Option<B> {
    let register = [TypeId::of::<pulp::m64x4>(), TypeId::of::<pulp::m32x8>()].contains(&TypeId::of::<A>());
    let same = TypeId::of::<A>() == TypeId::of::<B>() || (register && size_of::<A>() == size_of::<B>());
    // SAFETY: A and B are one type, or A is a 256-bit register of truth values and B plain data of the same size, for which
    // every pattern of bits is a value.
    (same && size_of::<A>() == size_of::<B>()).then(|| unsafe { std::mem::transmute_copy(&value) })
}

/// Truth values as bits: already bits (a register of them is at most 8 bytes), or all bits of a lane set or clear.
#[inline(always)]
fn bits_by_lane(bytes: &[u8], lanes: usize) -> u64 {
    if bytes.len() < lanes {
        return bytes.iter().rev().fold(0, |bits, &byte| bits << 8 | u64::from(byte));
    }
    let lane = bytes.len() / lanes;
    (0..lanes).fold(0, |bits, i| bits | u64::from(bytes[i * lane] & 1) << i)
}

/// Registers of the instruction set `S` with lanes of `T`.
#[derive(Clone, Copy)]
pub struct Pulp<S, T> {
    simd: S,
    lane: PhantomData<T>,
}

impl<S: Simd, T: PulpElement> Pulp<S, T> {
    /// The registers that `simd` proves to exist.
    #[inline(always)]
    pub fn new(simd: S) -> Self {
        Pulp { simd, lane: PhantomData }
    }
}

/// One register.
#[derive(Clone, Copy)]
pub struct Register<S: Simd, T: PulpElement>(S, T::Register<S>);

impl<S: Simd, T: PulpElement> Register<S, T> {
    /// Of what `pulp` has it made.
    #[inline(always)]
    pub(super) fn new(simd: S, value: T::Register<S>) -> Self {
        Register(simd, value)
    }

    /// What `pulp` has it made of.
    #[inline(always)]
    pub(super) fn value(self) -> T::Register<S> {
        self.1
    }
}

/// One register of truth values.
#[derive(Clone, Copy)]
pub struct Truth<S: Simd, T: PulpElement>(S, T::Truth<S>);

impl<S: Simd, T: PulpElement> Registers for Pulp<S, T> {
    type Lane = T;
    type V = Register<S, T>;
    type Index = T::Index;
    const LANES: usize = size_of::<T::Register<S>>() / T::BYTES;

    #[inline(always)]
    fn splat(self, value: T) -> Self::V {
        Register(self.simd, T::splat(self.simd, value))
    }
    #[inline(always)]
    unsafe fn load(self, from: *const T) -> Self::V {
        // SAFETY: the caller promises LANES initialised numbers; a register is those and no more, of any bits, and is
        // read without its own alignment.
        Register(self.simd, unsafe { from.cast::<T::Register<S>>().read_unaligned() })
    }
    #[inline(always)]
    unsafe fn store(self, to: *mut T, value: Self::V) {
        // SAFETY: the caller promises room for LANES numbers; a register is those and no more, and is written without its
        // own alignment.
        unsafe { to.cast::<T::Register<S>>().write_unaligned(value.1) };
    }
    #[inline(always)]
    fn none(self, predicate: Truth<S, T>) -> bool {
        T::none(self.simd, predicate.1)
    }
    #[inline(always)]
    fn bits(self, predicate: Truth<S, T>) -> u64 {
        <T as PulpElement>::bits(self.simd, predicate.1)
    }
}
