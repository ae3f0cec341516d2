//! Registers of the processor at hand, chosen at run time: AVX-512, AVX2, NEON, or scalar, from the crate `pulp`.

use super::registers::records::{self, QUAD, RecordPlaces, block};
use super::registers::{IndexLanes, Registers, coordinates};
use super::values::{implement_operator, implement_predicate, implement_vector};
use crate::isa::list::for_each_op;
use crate::isa::{Element, Predicate, Vector};
use pulp::Simd;
#[cfg(target_arch = "x86_64")]
use std::any::TypeId;
use std::marker::PhantomData;

/// Declares the operations of an element.
macro_rules! declare {
    (() machine $($row:tt)*) => {};
    (() operator $op:ident $doc:literal $trait:ident::$f:ident $($row:tt)*) => {
        declare!(() binary $op $doc $f $($row)*);
    };
    (() $group:ident $op:ident $doc:literal $f:ident($($x:ident: $kind:ident),+) -> $result:ident $meaning:tt) => {
        #[doc(hidden)]
        fn $f<S: Simd>(simd: S, $($x: Self::$kind<S>),+) -> Self::$result<S>;
    };
}

/// A precision with registers in `pulp`. Its operations are named per type, hence this table.
pub trait PulpElement: Element {
    /// A register of `S`.
    type V<S: Simd>: Copy;
    /// A register of truth values of `S`.
    type P<S: Simd>: Copy;
    /// Index vector, with as many entries as the widest registers have lanes. With more, loaded entries would be written to the
    /// stack and read back in wider pieces, which stalls.
    type Index: IndexLanes;

    #[doc(hidden)]
    fn splat<S: Simd>(simd: S, value: Self) -> Self::V<S>;
    for_each_op!(each declare ());
    #[doc(hidden)]
    fn none<S: Simd>(simd: S, a: Self::P<S>) -> bool;
    #[doc(hidden)]
    fn bits<S: Simd>(simd: S, a: Self::P<S>) -> u64;
}

/// Calls the function of a list for AVX-512 or AVX2 in double precision, or for these in single precision, or else evaluates the
/// last expression.
macro_rules! on_native {
    ($registers:ident, $module:ident::native::[$($names:ident)+]$arguments:tt, |$result:ident| $with:expr,
     $otherwise:expr) => {{
        #[cfg(target_arch = "x86_64")]
        {
            if let Some(v4) = same_value::<S, pulp::x86::V4>($registers.simd) {
                on_native!(v4, first, $module [$($names)+] $arguments, |$result| $with);
            }
            if let Some(v3) = same_value::<S, pulp::x86::V3>($registers.simd) {
                on_native!(v3, second, $module [$($names)+] $arguments, |$result| $with);
            }
        }
        $otherwise
    }};
    ($set:ident, first, $module:ident [$double:ident $_a:ident $single:ident $_b:ident] $arguments:tt,
     |$result:ident| $with:expr) => {
        on_native!($set, of_precision, $module [$double $single] $arguments, |$result| $with);
    };
    ($set:ident, second, $module:ident [$_a:ident $double:ident $_b:ident $single:ident] $arguments:tt,
     |$result:ident| $with:expr) => {
        on_native!($set, of_precision, $module [$double $single] $arguments, |$result| $with);
    };
    ($set:ident, of_precision, $module:ident [$double:ident $single:ident] ($($argument:expr),+),
     |$result:ident| $with:expr) => {
        if T::BYTES == size_of::<f64>() {
            let $result = $module::native::$double($set, $($argument),+);
            return $with;
        }
        let $result = $module::native::$single($set, $($argument),+);
        return $with;
    };
}

/// Forwards an operation of registers to their elements.
macro_rules! of_element {
    (() V $group:ident $op:ident $f:ident ($a:ident $($b:ident)*) $result:tt) => {
        PulpRegister($a.0, <T as PulpElement>::$f($a.0, $a.1 $(, $b.1)*))
    };
    (() P $group:ident $op:ident $f:ident ($a:ident $($b:ident)*) $result:tt) => {
        PulpPredicate($a.0, <T as PulpElement>::$f($a.0, $a.1 $(, $b.1)*))
    };
}
for_each_op!(each implement_operator ([S: Simd, T: PulpElement] PulpRegister<S, T>, of_element ()));

impl<S: Simd, T: PulpElement> Vector for PulpRegister<S, T> {
    type Predicate = PulpPredicate<S, T>;
    for_each_op!(each implement_vector (of_element ()));
}

impl<S: Simd, T: PulpElement> Predicate for PulpPredicate<S, T> {
    for_each_op!(each implement_predicate (of_element ()));
}

/// Defines the functions of an element: `V` is its register of numbers, `P` that of truth values.
macro_rules! instructions {
    ($simd:ident $v:ident $p:ident: $($f:ident($($operand:ident: $kind:ident),+) -> $result:ident $body:block)*) => {$(
        #[inline(always)]
        fn $f<S: Simd>($simd: S, $($operand: instructions!($kind $v $p)),+) -> instructions!($result $v $p) $body
    )*};
    (V $v:ident $p:ident) => { S::$v };
    (P $v:ident $p:ident) => { S::$p };
}

macro_rules! pulp_element {
    ($ty:ident, $register:ident, $truth:ident, $lanes:ident, $widest:literal,
     $splat:ident $add:ident $sub:ident $mul:ident $div:ident $min:ident $max:ident $sqrt:ident $abs:ident
     $less_than:ident $less_equal:ident $equal:ident $select:ident $and:ident $not:ident $first_true:ident
     $movemask:ident $bits:ident) => {
        impl PulpElement for $ty {
            type V<S: Simd> = S::$register;
            type P<S: Simd> = S::$truth;
            type Index = [u32; $widest];
            instructions! { simd $register $truth:
                add(a: V, b: V) -> V { simd.$add(a, b) }
                sub(a: V, b: V) -> V { simd.$sub(a, b) }
                mul(a: V, b: V) -> V { simd.$mul(a, b) }
                div(a: V, b: V) -> V { simd.$div(a, b) }
                min(a: V, b: V) -> V {
                    // Only x86's instruction equals the machine's "a < b ? a : b" to the bit.
                    if cfg!(target_arch = "x86_64") && !S::IS_SCALAR {
                        simd.$min(a, b)
                    } else {
                        simd.$select(simd.$less_than(a, b), a, b)
                    }
                }
                max(a: V, b: V) -> V {
                    if cfg!(target_arch = "x86_64") && !S::IS_SCALAR {
                        simd.$max(a, b)
                    } else {
                        simd.$select(simd.$less_than(b, a), a, b)
                    }
                }
                sqrt(a: V) -> V { simd.$sqrt(a) }
                abs(a: V) -> V { simd.$abs(a) }
                less_than(a: V, b: V) -> P { simd.$less_than(a, b) }
                less_equal(a: V, b: V) -> P { simd.$less_equal(a, b) }
                equal(a: V, b: V) -> P { simd.$equal(a, b) }
                select(truth: P, a: V, b: V) -> V { simd.$select(truth, a, b) }
                and(a: P, b: P) -> P { simd.$and(a, b) }
                not(a: P) -> P { simd.$not(a) }
            }
            #[inline(always)]
            fn splat<S: Simd>(simd: S, value: Self) -> S::$register {
                simd.$splat(value)
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
            fn none<S: Simd>(simd: S, a: S::$truth) -> bool {
                simd.$first_true(a) == S::$lanes
            }
            #[cfg_attr(
                not(target_arch = "x86_64"),
                expect(unused_variables, reason = "x86-64 has faster instructions")
            )]
            #[inline(always)]
            fn bits<S: Simd>(simd: S, a: S::$truth) -> u64 {
                #[cfg(target_arch = "x86_64")]
                {
                    if let (Some(v3), Some(truth)) = (same_value::<S, pulp::x86::V3>(simd), same_value(a)) {
                        return u64::from(v3.avx.$movemask(truth) as u32);
                    }
                    // Reads a mask register directly: through memory it would be a store and a load.
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

/// Converts a value to another type of the same size if the types allow it: `pulp` has no such instruction for all its sets.
#[cfg(target_arch = "x86_64")]
#[inline(always)]
fn same_value<A: Copy + 'static, B: Copy + 'static>(value: A) -> Option<B> {
    let register = [TypeId::of::<pulp::m64x4>(), TypeId::of::<pulp::m32x8>()].contains(&TypeId::of::<A>());
    let same = TypeId::of::<A>() == TypeId::of::<B>() || (register && size_of::<A>() == size_of::<B>());
    // SAFETY: A and B are one type, or A is a 256-bit register of truth values and B plain data of the same size, for which every
    // bit pattern is a value.
    (same && size_of::<A>() == size_of::<B>()).then(|| unsafe { std::mem::transmute_copy(&value) })
}

/// Registers in the type of another crate.
#[cfg(target_arch = "x86_64")]
#[inline(always)]
fn as_registers<A: Copy, B: Copy>(registers: [A; QUAD]) -> [B; QUAD] {
    assert!(size_of::<A>() == size_of::<B>(), "registers of different widths");
    // SAFETY: both are plain data of one size, for which every bit pattern is a value.
    unsafe { std::mem::transmute_copy(&registers) }
}

/// Registers of `pulp` inside.
#[cfg(target_arch = "x86_64")]
#[inline(always)]
fn inner<S: Simd, T: PulpElement>([x, y, u, v]: [PulpRegister<S, T>; QUAD]) -> [T::V<S>; QUAD] {
    [x.1, y.1, u.1, v.1]
}

/// Registers of `pulp` with the token of their instruction set.
#[cfg(target_arch = "x86_64")]
#[inline(always)]
fn wrapped<S: Simd, T: PulpElement>(simd: S, [x, y, u, v]: [T::V<S>; QUAD]) -> [PulpRegister<S, T>; QUAD] {
    [PulpRegister(simd, x), PulpRegister(simd, y), PulpRegister(simd, u), PulpRegister(simd, v)]
}

/// Converts truth values to bits. They are already bits (a register of them has at most 8 bytes), or lanes with all bits set or
/// clear.
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
    /// Registers whose existence `simd` proves.
    #[inline(always)]
    pub fn new(simd: S) -> Self {
        Pulp { simd, lane: PhantomData }
    }
}

/// One register.
#[derive(Clone, Copy)]
pub struct PulpRegister<S: Simd, T: PulpElement>(S, T::V<S>);

impl<S: Simd, T: PulpElement> PulpRegister<S, T> {
    /// Wraps a register of `pulp`.
    #[inline(always)]
    pub(super) fn new(simd: S, value: T::V<S>) -> Self {
        PulpRegister(simd, value)
    }

    /// The register of `pulp` inside.
    #[inline(always)]
    pub(super) fn value(self) -> T::V<S> {
        self.1
    }
}

/// One register of truth values.
#[derive(Clone, Copy)]
pub struct PulpPredicate<S: Simd, T: PulpElement>(S, T::P<S>);

impl<S: Simd, T: PulpElement> Registers for Pulp<S, T> {
    type Lane = T;
    type V = PulpRegister<S, T>;
    type Index = T::Index;
    type Single = Pulp<S, f32>;
    const LANES: usize = size_of::<T::V<S>>() / T::BYTES;

    #[inline(always)]
    fn single(self) -> Pulp<S, f32> {
        Pulp::new(self.simd)
    }
    #[inline(always)]
    fn splat(self, value: T) -> Self::V {
        PulpRegister(self.simd, T::splat(self.simd, value))
    }
    #[inline(always)]
    unsafe fn load(self, from: *const T) -> Self::V {
        // SAFETY: the caller promises LANES initialised numbers; a register consists of just those, allows any bits, and is read
        // unaligned.
        PulpRegister(self.simd, unsafe { from.cast::<T::V<S>>().read_unaligned() })
    }
    #[inline(always)]
    unsafe fn store(self, to: *mut T, value: Self::V) {
        // SAFETY: the caller promises space for LANES numbers; a register consists of just those, and is written unaligned.
        unsafe { to.cast::<T::V<S>>().write_unaligned(value.1) };
    }
    #[inline(always)]
    fn none(self, predicate: PulpPredicate<S, T>) -> bool {
        T::none(self.simd, predicate.1)
    }
    #[inline(always)]
    fn bits(self, predicate: PulpPredicate<S, T>) -> u64 {
        <T as PulpElement>::bits(self.simd, predicate.1)
    }
    #[inline(always)]
    unsafe fn near_pairs(self, own: *const u32, offset: u32, other: *const u32, limit: i32) -> u64 {
        // SAFETY: the caller makes the same promise; lanes of single precision are as wide as pairs.
        unsafe {
            #[cfg(target_arch = "x86_64")]
            if T::BYTES == size_of::<u32>() {
                if let Some(v4) = same_value::<S, pulp::x86::V4>(self.simd) {
                    return coordinates::native::near_pairs_v4(v4, own, offset, other, limit);
                }
                if let Some(v3) = same_value::<S, pulp::x86::V3>(self.simd) {
                    return coordinates::native::near_pairs_v3(v3, own, offset, other, limit);
                }
            }
            coordinates::near_pairs::<Self>(own, offset, other, limit)
        }
    }
    #[inline(always)]
    unsafe fn touching_pairs(
        self,
        own: [*const u32; 2],
        offset: u32,
        other: [*const u32; 2],
        beyond: u32,
    ) -> u64 {
        // SAFETY: the caller makes the same promise; lanes of single precision are as wide as pairs.
        unsafe {
            #[cfg(target_arch = "x86_64")]
            if T::BYTES == size_of::<u32>() {
                if let Some(v4) = same_value::<S, pulp::x86::V4>(self.simd) {
                    return coordinates::native::touching_pairs_v4(v4, own, offset, other, beyond);
                }
                if let Some(v3) = same_value::<S, pulp::x86::V3>(self.simd) {
                    return coordinates::native::touching_pairs_v3(v3, own, offset, other, beyond);
                }
            }
            coordinates::touching_pairs::<Self>(own, offset, other, beyond)
        }
    }
    #[inline(always)]
    unsafe fn load_blocks(self, places: RecordPlaces<'_, T>) -> [Self::V; QUAD] {
        // SAFETY: the caller makes the same promise; T is the precision of the function called.
        unsafe {
            on_native!(
                self,
                records::native::[load_blocks_f64_v4 load_blocks_f64_v3 load_blocks_f32_v4 load_blocks_f32_v3](places.cast()),
                |loaded| wrapped(self.simd, as_registers(loaded)),
                records::load_by_number(self, block::<T>(), places)
            )
        }
    }
    #[inline(always)]
    unsafe fn load_block_run(self, first: *const T) -> [Self::V; QUAD] {
        // SAFETY: as above.
        unsafe {
            on_native!(
                self,
                records::native::[load_block_run_f64_v4 load_block_run_f64_v3 load_quad_run_f32_v4 load_quad_run_f32_v3](first.cast()),
                |loaded| wrapped(self.simd, as_registers(loaded)),
                records::load_by_number(self, block::<T>(), RecordPlaces::run(first.cast_mut(), block::<T>()))
            )
        }
    }
    #[inline(always)]
    unsafe fn store_block_run(self, values: [Self::V; QUAD], first: *mut T) {
        // SAFETY: as above.
        unsafe {
            on_native!(
                self,
                records::native::[store_block_run_f64_v4 store_block_run_f64_v3 store_block_run_f32_v4 store_block_run_f32_v3](
                    as_registers(inner(values)), first.cast()
                ),
                |stored| stored,
                records::store_by_number(self, block::<T>(), values, RecordPlaces::run(first, block::<T>()))
            )
        }
    }
    #[inline(always)]
    unsafe fn load_quad_run(self, first: *const T) -> [Self::V; QUAD] {
        // SAFETY: as above.
        unsafe {
            on_native!(
                self,
                records::native::[load_quad_run_f64_v4 load_quad_run_f64_v3 load_quad_run_f32_v4 load_quad_run_f32_v3](first.cast()),
                |loaded| wrapped(self.simd, as_registers(loaded)),
                records::load_by_number(self, QUAD, RecordPlaces::run(first.cast_mut(), QUAD))
            )
        }
    }
    #[inline(always)]
    unsafe fn add_quads(
        self,
        count: usize,
        [added, subtracted]: [[Self::V; QUAD]; 2],
        [own, partner]: [RecordPlaces<'_, T>; 2],
    ) {
        // SAFETY: as above.
        unsafe {
            on_native!(
                self,
                records::native::[add_quads_f64_v4 add_quads_f64_v3 add_quads_f32_v4 add_quads_f32_v3](
                    count, [as_registers(inner(added)), as_registers(inner(subtracted))], [own.cast(), partner.cast()]
                ),
                |done| done,
                records::add_by_number(self, count, [added, subtracted], [own, partner])
            )
        }
    }
}
