//! Values of the machine: vectors of numbers and vectors of truth values.

use super::list::for_each_op;

macro_rules! define_vectors {
    (operator { $(($ov:ident, $om:literal, $oc:ident, $od:literal, $trait:ident $of:ident)),* $(,)? }
     binary { $(($bv:ident, $bm:literal, $bc:ident, $bd:literal, $bf:ident)),* $(,)? }
     unary { $(($uv:ident, $um:literal, $uc:ident, $ud:literal, $uf:ident)),* $(,)? }
     compare { $(($cv:ident, $cm:literal, $cc:ident, $cd:literal, $cf:ident)),* $(,)? }
     connective { $(($av:ident, $am:literal, $ac:ident, $ad:literal, $af:ident)),* $(,)? }
     negation { $(($nv:ident, $nm:literal, $nc:ident, $nd:literal, $nf:ident)),* $(,)? }
     machine $machine:tt) => {
        /// A vector of truth values, one a lane. (A *mask* is always a neighbourhood.)
        pub trait Predicate: Copy {
            $(#[doc = concat!("The ", $ad, ", lane by lane.")] fn $af(self, other: Self) -> Self;)*
            $(#[doc = concat!("The ", $nd, ", lane by lane.")] fn $nf(self) -> Self;)*
        }

        /// A vector of numbers of one precision.
        ///
        /// Every operation is correctly rounded and never fused with another, so that all backends agree to the bit.
        pub trait Vector: Copy $(+ std::ops::$trait<Output = Self>)* {
            /// The vector of truth values that comparisons give.
            type Predicate: Predicate;

            $(#[doc = concat!("The ", $ud, ".")] fn $uf(self) -> Self;)*
            $(#[doc = concat!("Lane by lane ", $bd, ".")] fn $bf(self, other: Self) -> Self;)*
            $(
                #[doc = concat!("The ", $cd, ", a the vector itself; false where they do not compare.")]
                fn $cf(self, other: Self) -> Self::Predicate;
            )*
            /// `holds` where the predicate holds, else `fails`. Neither is disturbed by a NaN in the other.
            fn select(predicate: Self::Predicate, holds: Self, fails: Self) -> Self;

            /// `self · factor + addend`: two operations, each rounded. Only registers that estimate make one of them.
            #[inline(always)]
            fn times_plus(self, factor: Self, addend: Self) -> Self {
                self * factor + addend
            }

            /// `addend − self · factor`, likewise.
            #[inline(always)]
            fn times_from(self, factor: Self, addend: Self) -> Self {
                addend - self * factor
            }

            /// `one/(a √a)`, a the vector itself: three operations. Only registers that estimate take another way.
            #[inline(always)]
            fn inverse_three_halves(self, one: Self) -> Self {
                one / (self * self.sqrt())
            }
        }
    };
}
for_each_op!(define_vectors);

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
