//! Values in registers: vectors of numbers and vectors of truth values.

use super::list::for_each_op;
use std::ops::{Add, Div, Mul, Sub};

/// Declares the methods of vectors and of predicates, with the vector or predicate itself as first operand.
macro_rules! declare {
    (Vector merge $op:ident $doc:literal $f:ident($p:ident: P, $a:ident: V, $b:ident: V) -> V $result:tt) => {
        #[doc = concat!("Lane by lane ", $doc, ". A NaN in one does not affect the other.")]
        fn $f($p: Self::Predicate, $a: Self, $b: Self) -> Self;
    };
    (Vector $group:ident $op:ident $doc:literal $f:ident($a:ident: V $(, $b:ident: V)?) -> V $result:tt) => {
        #[doc = concat!("Lane by lane ", $doc, ".")]
        fn $f(self $(, $b: Self)?) -> Self;
    };
    (Vector $group:ident $op:ident $doc:literal $f:ident($a:ident: V, $b:ident: V) -> P $result:tt) => {
        #[doc = concat!("Lane by lane ", $doc, "; false if they are unordered.")]
        fn $f(self, $b: Self) -> Self::Predicate;
    };
    (Predicate $group:ident $op:ident $doc:literal $f:ident($a:ident: P $(, $b:ident: P)?) -> P $result:tt) => {
        #[doc = concat!("Lane by lane ", $doc, ".")]
        fn $f(self $(, $b: Self)?) -> Self;
    };
    ($($other:tt)*) => {};
}

/// Vector of truth values, one per lane. (A *mask* is always a neighbourhood.)
pub trait Predicate: Copy {
    for_each_op!(each declare Predicate);
}

/// A vector of numbers of one precision.
///
/// Every operation is correctly rounded and never fused with another, so that all backends agree to the bit.
pub trait Vector:
    Copy + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> + Div<Output = Self>
{
    /// Vector of truth values that comparisons return.
    type Predicate: Predicate;

    for_each_op!(each declare Vector);

    /// `self · factor + addend`: two operations, each rounded. Only registers that estimate fuse them.
    #[inline(always)]
    fn times_plus(self, factor: Self, addend: Self) -> Self {
        self * factor + addend
    }

    /// `addend − self · factor`: two operations, each rounded. Only registers that estimate fuse them.
    #[inline(always)]
    fn times_from(self, factor: Self, addend: Self) -> Self {
        addend - self * factor
    }

    /// `one/(a √a)` for `a = self`: three operations. Only registers that estimate compute it differently.
    #[inline(always)]
    fn inverse_three_halves(self, one: Self) -> Self {
        one / (self * self.sqrt())
    }
}
