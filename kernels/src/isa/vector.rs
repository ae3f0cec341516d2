//! Values of the machine: vectors of numbers and vectors of truth values.

use std::ops::{Add, Div, Mul, Sub};

/// A vector of truth values, one a lane. (A *mask* is always a neighbourhood.)
pub trait Predicate: Copy {
    /// Conjunction, lane by lane.
    fn and(self, other: Self) -> Self;
    /// Negation, lane by lane.
    fn not(self) -> Self;
}

/// A vector of numbers of one precision.
///
/// Every operation is correctly rounded and never fused with another, so that all backends agree to the bit.
pub trait Vector:
    Copy + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> + Div<Output = Self>
{
    /// The vector of truth values that comparisons give.
    type Predicate: Predicate;

    /// Square root.
    fn sqrt(self) -> Self;
    /// Magnitude: the sign bit cleared.
    fn abs(self) -> Self;
    /// Integer part, rounded towards zero.
    fn truncate(self) -> Self;
    /// `self` where `self < other`, else `other` (also where they do not compare).
    fn min(self, other: Self) -> Self;
    /// `self` where `self > other`, else `other` (also where they do not compare).
    fn max(self, other: Self) -> Self;
    /// `self < other`; false where they do not compare.
    fn less_than(self, other: Self) -> Self::Predicate;
    /// `self <= other`; false where they do not compare.
    fn less_equal(self, other: Self) -> Self::Predicate;
    /// `self = other`; false where they do not compare.
    fn equal(self, other: Self) -> Self::Predicate;
    /// `holds` where the predicate holds, else `fails`. Neither is disturbed by a NaN in the other.
    fn select(predicate: Self::Predicate, holds: Self, fails: Self) -> Self;
}

impl Predicate for bool {
    #[inline(always)]
    fn and(self, other: Self) -> Self {
        self & other
    }
    #[inline(always)]
    fn not(self) -> Self {
        !self
    }
}

macro_rules! scalar_vector {
    ($ty:ident) => {
        impl Vector for $ty {
            type Predicate = bool;
            #[inline(always)]
            fn sqrt(self) -> Self {
                $ty::sqrt(self)
            }
            #[inline(always)]
            fn abs(self) -> Self {
                $ty::abs(self)
            }
            #[inline(always)]
            fn truncate(self) -> Self {
                $ty::trunc(self)
            }
            #[inline(always)]
            fn min(self, other: Self) -> Self {
                if self < other { self } else { other }
            }
            #[inline(always)]
            fn max(self, other: Self) -> Self {
                if self > other { self } else { other }
            }
            #[inline(always)]
            fn less_than(self, other: Self) -> bool {
                self < other
            }
            #[inline(always)]
            fn less_equal(self, other: Self) -> bool {
                self <= other
            }
            #[inline(always)]
            fn equal(self, other: Self) -> bool {
                self == other
            }
            #[inline(always)]
            fn select(predicate: bool, holds: Self, fails: Self) -> Self {
                if predicate { holds } else { fails }
            }
        }
    };
}
scalar_vector!(f64);
scalar_vector!(f32);
