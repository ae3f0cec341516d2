//! A vector register longer than the hardware's: a fixed number of registers that act as one.

use super::registers::{IndexLanes, Registers};
use crate::isa::{Predicate, Vector};
use std::ops::{Add, Div, Mul, Sub};

/// `K` registers of `R` that act as one: strip-mining with the strip length a constant of the program.
#[derive(Clone, Copy)]
pub struct Block<R, const K: usize>(pub R);

/// The value of a [`Block`].
#[derive(Clone, Copy)]
pub struct Blocked<T, const K: usize>([T; K]);

/// The index vector of a [`Block`].
#[derive(Clone, Copy)]
pub struct BlockedIndex<R: Registers, const K: usize>([R::Index; K]);

// Loops, not closures: a closure that is not inlined loses the caller's instruction set.
macro_rules! lanewise {
    ($k:ident, |$i:ident| $value:expr, $first:expr) => {{
        let mut out = [$first; $k];
        let mut $i = 0;
        while $i < $k {
            out[$i] = $value;
            $i += 1;
        }
        out
    }};
}

macro_rules! operator {
    ($trait:ident, $method:ident) => {
        impl<V: Vector, const K: usize> $trait for Blocked<V, K> {
            type Output = Self;
            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                Blocked(lanewise!(K, |i| self.0[i].$method(other.0[i]), self.0[0]))
            }
        }
    };
}
operator!(Add, add);
operator!(Sub, sub);
operator!(Mul, mul);
operator!(Div, div);

impl<P: Predicate, const K: usize> Predicate for Blocked<P, K> {
    #[inline(always)]
    fn and(self, other: Self) -> Self {
        Blocked(lanewise!(K, |i| self.0[i].and(other.0[i]), self.0[0]))
    }
    #[inline(always)]
    fn not(self) -> Self {
        Blocked(lanewise!(K, |i| self.0[i].not(), self.0[0]))
    }
}

macro_rules! unary {
    ($($method:ident),*) => {$(
        #[inline(always)]
        fn $method(self) -> Self {
            Blocked(lanewise!(K, |i| self.0[i].$method(), self.0[0]))
        }
    )*};
}
macro_rules! binary {
    ($($method:ident),*) => {$(
        #[inline(always)]
        fn $method(self, other: Self) -> Self {
            Blocked(lanewise!(K, |i| self.0[i].$method(other.0[i]), self.0[0]))
        }
    )*};
}
macro_rules! comparison {
    ($($method:ident),*) => {$(
        #[inline(always)]
        fn $method(self, other: Self) -> Self::Predicate {
            let first = self.0[0].$method(other.0[0]);
            Blocked(lanewise!(K, |i| self.0[i].$method(other.0[i]), first))
        }
    )*};
}

impl<V: Vector, const K: usize> Vector for Blocked<V, K> {
    type Predicate = Blocked<V::Predicate, K>;

    unary!(sqrt, abs, truncate);
    binary!(min, max);
    comparison!(less_than, less_equal, equal);

    #[inline(always)]
    fn select(predicate: Self::Predicate, holds: Self, fails: Self) -> Self {
        Blocked(lanewise!(K, |i| V::select(predicate.0[i], holds.0[i], fails.0[i]), holds.0[0]))
    }
}

impl<R: Registers, const K: usize> IndexLanes for BlockedIndex<R, K> {
    #[inline(always)]
    fn none() -> Self {
        BlockedIndex([R::Index::none(); K])
    }
    #[inline(always)]
    fn lane(&self, lane: usize) -> u32 {
        self.0[lane / R::LANES].lane(lane % R::LANES)
    }
    #[inline(always)]
    fn set_lane(&mut self, lane: usize, number: u32) {
        self.0[lane / R::LANES].set_lane(lane % R::LANES, number);
    }
}

impl<R: Registers, const K: usize> Registers for Block<R, K> {
    type Lane = R::Lane;
    type V = Blocked<R::V, K>;
    type Index = BlockedIndex<R, K>;
    const LANES: usize = K * R::LANES;

    #[inline(always)]
    fn splat(self, value: R::Lane) -> Self::V {
        Blocked([self.0.splat(value); K])
    }
    #[inline(always)]
    unsafe fn load(self, from: *const R::Lane) -> Self::V {
        // SAFETY: the caller promises K · R::LANES elements.
        unsafe { Blocked(lanewise!(K, |i| self.0.load(from.add(i * R::LANES)), self.0.load(from))) }
    }
    #[inline(always)]
    unsafe fn store(self, to: *mut R::Lane, value: Self::V) {
        let mut i = 0;
        while i < K {
            // SAFETY: the caller promises K · R::LANES elements.
            unsafe { self.0.store(to.add(i * R::LANES), value.0[i]) };
            i += 1;
        }
    }
    #[inline(always)]
    fn none(self, predicate: Blocked<<R::V as Vector>::Predicate, K>) -> bool {
        let mut none = true;
        let mut i = 0;
        while i < K {
            none &= self.0.none(predicate.0[i]);
            i += 1;
        }
        none
    }
    #[inline(always)]
    fn bits(self, predicate: Blocked<<R::V as Vector>::Predicate, K>) -> u64 {
        let mut bits = 0;
        let mut i = 0;
        while i < K {
            bits |= self.0.bits(predicate.0[i]) << (i * R::LANES);
            i += 1;
        }
        bits
    }
}
