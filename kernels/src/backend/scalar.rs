//! The scalar oracle: plain numbers, one lane, no SIMD. Every other backend must agree to the bit.

use super::registers::Registers;
use super::values::{implement_predicate, implement_vector};
use crate::isa::list::for_each_op;
use crate::isa::{Element, Predicate, Vector};
use std::marker::PhantomData;

/// Result for one lane, from the table.
macro_rules! as_listed {
    (() $kind:ident $group:ident $op:ident $method:ident $operands:tt $result:tt) => {
        $result
    };
}

impl Vector for f64 {
    type Predicate = bool;
    for_each_op!(each implement_vector (as_listed ()));
}

impl Vector for f32 {
    type Predicate = bool;
    for_each_op!(each implement_vector (as_listed ()));
}

impl Predicate for bool {
    for_each_op!(each implement_predicate (as_listed ()));
}

/// Registers of one lane.
#[derive(Clone, Copy, Default)]
pub struct Scalar<T>(PhantomData<T>);

impl<T: Element> Registers for Scalar<T> {
    type Lane = T;
    type V = T;
    type Index = [u32; 1];
    type Single = Scalar<f32>;
    const LANES: usize = 1;

    #[inline(always)]
    fn single(self) -> Scalar<f32> {
        Scalar::default()
    }
    #[inline(always)]
    fn splat(self, value: T) -> T {
        value
    }
    #[inline(always)]
    unsafe fn load(self, from: *const T) -> T {
        // SAFETY: the caller promises LANES = 1 initialised number, aligned; a copy of it is read.
        unsafe { *from }
    }
    #[inline(always)]
    unsafe fn store(self, to: *mut T, value: T) {
        // SAFETY: the caller promises aligned space for LANES = 1 number, which has no destructor.
        unsafe { *to = value }
    }
    #[inline(always)]
    fn none(self, predicate: bool) -> bool {
        !predicate
    }
    #[inline(always)]
    fn bits(self, predicate: bool) -> u64 {
        predicate.into()
    }
}
