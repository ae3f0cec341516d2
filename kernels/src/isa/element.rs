//! What a lane may hold and what memory may hold.

use super::memory::{Columns, Memory};
use super::vector::Vector;

mod sealed {
    pub trait Sealed {}
    impl Sealed for f64 {}
    impl Sealed for f32 {}
    impl Sealed for u32 {}
}

/// A type that arrays of the machine store: `f64`, `f32`, or `u32` for index vectors.
pub trait Storage: sealed::Sealed + Copy + Default + Send + Sync + std::fmt::Debug + 'static {
    /// The name in listings and errors.
    const NAME: &'static str;
    /// Bytes an element takes.
    const BYTES: usize;
    /// Which of a memory's tables holds columns of this type.
    #[doc(hidden)]
    fn columns<'m>(memory: &'m Memory<'_>) -> &'m Columns<Self>;
    #[doc(hidden)]
    fn columns_mut<'m>(memory: &'m mut Memory<'_>) -> &'m mut Columns<Self>;
}

/// A floating-point number of one of the two precisions; also the scalar oracle's vector of one lane.
pub trait Element: Storage + Vector<Predicate = bool> + PartialOrd {
    /// The nearest representable number.
    fn from_f64(value: f64) -> Self;
    /// The same number in double precision, exactly.
    fn to_f64(self) -> f64;
    /// The bit pattern, for comparisons that must be exact.
    fn bits(self) -> u64;
}

macro_rules! storage {
    ($ty:ident, $table:ident) => {
        impl Storage for $ty {
            const NAME: &'static str = stringify!($ty);
            const BYTES: usize = size_of::<$ty>();
            #[inline(always)]
            fn columns<'m>(memory: &'m Memory<'_>) -> &'m Columns<Self> {
                &memory.$table
            }
            #[inline(always)]
            fn columns_mut<'m>(memory: &'m mut Memory<'_>) -> &'m mut Columns<Self> {
                &mut memory.$table
            }
        }
    };
}
storage!(f64, f64s);
storage!(f32, f32s);
storage!(u32, u32s);

macro_rules! element {
    ($ty:ident) => {
        impl Element for $ty {
            #[inline(always)]
            fn from_f64(value: f64) -> Self {
                value as $ty
            }
            #[inline(always)]
            fn to_f64(self) -> f64 {
                self.into()
            }
            #[inline(always)]
            fn bits(self) -> u64 {
                self.to_bits().into()
            }
        }
    };
}
element!(f64);
element!(f32);
