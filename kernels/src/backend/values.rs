//! Implementation of vectors and predicates of any kind, each operation by one expression.
//!
//! The macros are called for each row of the table. They call the macro `$by` for the expression, with `$with`, the kind of the
//! result, the group and the name of the operation, its method, the operands, and the result for one lane from the table.

/// Implements the operators of a vector.
macro_rules! implement_operator {
    (([$($generics:tt)*] $vector:ty, $by:ident $with:tt)
     operator $op:ident $doc:literal $trait:ident::$f:ident($a:ident: V, $b:ident: V) -> V $result:tt) => {
        impl<$($generics)*> std::ops::$trait for $vector {
            type Output = Self;
            #[inline(always)]
            fn $f(self, $b: Self) -> Self {
                let $a = self;
                $by!($with V operator $op $f ($a $b) $result)
            }
        }
    };
    ($($other:tt)*) => {};
}
pub(crate) use implement_operator;

/// Implements the methods of a vector.
macro_rules! implement_vector {
    (($by:ident $with:tt) merge $op:ident $doc:literal
     $f:ident($p:ident: P, $a:ident: V, $b:ident: V) -> V $result:tt) => {
        #[inline(always)]
        fn $f($p: Self::Predicate, $a: Self, $b: Self) -> Self {
            $by!($with V merge $op $f ($p $a $b) $result)
        }
    };
    (($by:ident $with:tt) $group:ident $op:ident $doc:literal
     $f:ident($a:ident: V $(, $b:ident: V)?) -> V $result:tt) => {
        #[inline(always)]
        fn $f(self $(, $b: Self)?) -> Self {
            let $a = self;
            $by!($with V $group $op $f ($a $($b)?) $result)
        }
    };
    (($by:ident $with:tt) $group:ident $op:ident $doc:literal
     $f:ident($a:ident: V, $b:ident: V) -> P $result:tt) => {
        #[inline(always)]
        fn $f(self, $b: Self) -> Self::Predicate {
            let $a = self;
            $by!($with P $group $op $f ($a $b) $result)
        }
    };
    ($($other:tt)*) => {};
}
pub(crate) use implement_vector;

/// Implements the methods of a predicate.
macro_rules! implement_predicate {
    (($by:ident $with:tt) $group:ident $op:ident $doc:literal
     $f:ident($a:ident: P $(, $b:ident: P)?) -> P $result:tt) => {
        #[inline(always)]
        fn $f(self $(, $b: Self)?) -> Self {
            let $a = self;
            $by!($with P $group $op $f ($a $($b)?) $result)
        }
    };
    ($($other:tt)*) => {};
}
pub(crate) use implement_predicate;
