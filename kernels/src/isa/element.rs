//! Types of the elements in registers and in memory.

use super::vector::Vector;

mod sealed {
    pub trait Sealed {}
    impl Sealed for f64 {}
    impl Sealed for f32 {}
    impl Sealed for u32 {}
}

/// Element type of the machine's arrays: `f64`, `f32`, or `u32` for index vectors.
pub trait Storage: sealed::Sealed + Copy + Default + Send + Sync + std::fmt::Debug + 'static {
    /// Name in listings and errors.
    const NAME: &'static str;
    /// Size of an element in bytes.
    const BYTES: usize;
    /// Number of the memory table with columns of this type, below [`TABLES`].
    #[doc(hidden)]
    const TABLE: usize;
}

/// Number of tables of a memory: one per type.
pub(super) const TABLES: usize = 3;

/// Floating-point number of one of the two precisions; also the scalar oracle's vector of one lane.
pub trait Element: Storage + Vector<Predicate = bool> + PartialOrd {
    /// Rounds to the nearest representable number.
    fn from_f64(value: f64) -> Self;
    /// Converts to double precision, exactly.
    fn to_f64(self) -> f64;
    /// Bit pattern, for exact comparisons.
    fn bits(self) -> u64;
}

macro_rules! storage {
    ($ty:ident, $table:literal) => {
        impl Storage for $ty {
            const NAME: &'static str = stringify!($ty);
            const BYTES: usize = size_of::<$ty>();
            const TABLE: usize = $table;
        }
    };
}
storage!(f64, 0);
storage!(f32, 1);
storage!(u32, 2);

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
