//! Instruction sets, and dispatch of work to a function compiled for one of them.

use super::estimated::EstimatingRegisters;
use super::precision::Precision;
use super::pulp::Pulp;
use super::registers::{MAX_LANES, Registers};
use super::scalar::Scalar;
use super::wide::Wide;
use crate::isa::ProgramError;
use pulp::{Simd, WithSimd};
use std::marker::PhantomData;

/// Lanes of the widest register. Lattice vectors, bands and spans begin and end at multiples of it, so that they depend on no
/// instruction set and no precision.
pub(crate) const GROUP: usize = MAX_LANES;

macro_rules! define_instruction_sets {
    ($(($variant:ident, $name:literal, $doc:literal)),* $(,)?) => {
        /// Instruction set that a kernel is compiled for.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
        pub enum InstructionSet {
            $(#[doc = $doc] $variant,)*
        }

        impl InstructionSet {
            /// Every set, in the order of the list.
            pub const ALL: &'static [InstructionSet] = &[$(InstructionSet::$variant),*];

            /// Name on the command line.
            #[inline]
            pub const fn name(self) -> &'static str {
                match self { $(InstructionSet::$variant => $name),* }
            }
        }
    };
}

define_instruction_sets! {
    (Scalar, "scalar", "One lane, no SIMD: the oracle."),
    (Wide, "wide", "256 bits, with the instructions of the build's target; fast sweeps on x86-64 and ARM one lane at a time."),
    (Neon, "neon", "128 bits, 64-bit ARM."),
    (Avx2, "avx2", "256 bits, x86-64-v3."),
    (Avx512, "avx512", "512 bits, x86-64-v4."),
}

impl InstructionSet {
    /// True if this processor has the instruction set.
    #[inline]
    pub fn is_available(self) -> bool {
        match self {
            InstructionSet::Scalar | InstructionSet::Wide => true,
            #[cfg(target_arch = "x86_64")]
            InstructionSet::Avx2 => pulp::x86::V3::is_available(),
            #[cfg(target_arch = "x86_64")]
            InstructionSet::Avx512 => pulp::x86::V4::is_available(),
            #[cfg(target_arch = "aarch64")]
            InstructionSet::Neon => pulp::aarch64::Neon::is_available(),
            _ => false,
        }
    }

    /// Instruction sets of this processor, in the order of the list.
    #[inline]
    pub fn available() -> impl Iterator<Item = InstructionSet> {
        Self::ALL.iter().copied().filter(|set| set.is_available())
    }

    /// Widest instruction set of this processor.
    #[inline]
    pub fn best() -> InstructionSet {
        Self::available().last().unwrap_or(InstructionSet::Scalar)
    }
}

/// A task compiled once for each register file. Everything between it and the registers must be inlined: a separate function is
/// compiled for the build's target.
pub trait RegisterTask<L: Precision> {
    /// Runs the task on one register file.
    fn on<R: Registers<Lane = L>>(self, registers: R);
}

/// Runs a task in the function compiled for the instruction set.
///
/// # Errors
/// [`ProgramError::NoSuchInstructionSet`] if this processor lacks it.
#[inline]
pub(crate) fn dispatch<L: Precision, T: RegisterTask<L>>(
    set: InstructionSet,
    task: T,
) -> Result<(), ProgramError> {
    match set {
        InstructionSet::Scalar => task.on(Scalar::default()),
        InstructionSet::Wide => task.on(Wide::default()),
        _ => return vectorized(set, OnSimd(task, PhantomData)),
    }
    Ok(())
}

/// As `dispatch`, for work that compiles slowly and is not worth a version on `wide` registers where the target has others:
/// `wide` is then one lane at a time, with the same bits.
///
/// # Errors
/// As for `dispatch`.
#[inline]
pub fn dispatch_native<L: Precision, T: RegisterTask<L>>(
    set: InstructionSet,
    task: T,
) -> Result<(), ProgramError> {
    match set {
        #[cfg(not(any(target_arch = "x86_64", target_arch = "aarch64")))]
        InstructionSet::Wide => task.on(Wide::default()),
        InstructionSet::Scalar | InstructionSet::Wide => task.on(Scalar::default()),
        _ => return vectorized(set, OnSimd(task, PhantomData)),
    }
    Ok(())
}

/// As [`dispatch_native`], on the widest set of this processor.
#[expect(clippy::unreachable, reason = "an available set is chosen above")]
#[inline]
pub fn dispatch_best<L: Precision, T: RegisterTask<L>>(task: T) {
    if let Err(absent) = dispatch_native(InstructionSet::best(), task) {
        unreachable!("{absent}, but the best set is always available");
    }
}

/// As [`dispatch`], on registers that fuse products and sums and estimate inverse roots, if the set has such instructions.
pub(crate) fn dispatch_estimating<L: Precision, T: RegisterTask<L>, const RAW: bool>(
    set: InstructionSet,
    task: T,
) -> Result<(), ProgramError> {
    match set {
        InstructionSet::Scalar | InstructionSet::Wide => dispatch_native(set, task),
        _ => vectorized(set, OnEstimating::<T, L, RAW>(task, PhantomData)),
    }
}

/// Runs a task in the function that `pulp` compiles for a set.
fn vectorized(set: InstructionSet, task: impl WithSimd<Output = ()>) -> Result<(), ProgramError> {
    let absent = ProgramError::NoSuchInstructionSet(set.name());
    match set {
        #[cfg(target_arch = "x86_64")]
        InstructionSet::Avx2 => Simd::vectorize(pulp::x86::V3::try_new().ok_or(absent)?, task),
        #[cfg(target_arch = "x86_64")]
        InstructionSet::Avx512 => Simd::vectorize(pulp::x86::V4::try_new().ok_or(absent)?, task),
        #[cfg(target_arch = "aarch64")]
        InstructionSet::Neon => Simd::vectorize(pulp::aarch64::Neon::try_new().ok_or(absent)?, task),
        _ => return Err(absent),
    }
    Ok(())
}

/// Adapter of a task for `pulp`.
struct OnSimd<T, L>(T, PhantomData<L>);

impl<L: Precision, T: RegisterTask<L>> WithSimd for OnSimd<T, L> {
    type Output = ();
    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        self.0.on(Pulp::<S, L>::new(simd));
    }
}

/// Adapter of a task for `pulp`, on registers that estimate.
struct OnEstimating<T, L, const RAW: bool>(T, PhantomData<L>);

impl<L: Precision, T: RegisterTask<L>, const RAW: bool> WithSimd for OnEstimating<T, L, RAW> {
    type Output = ();
    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        self.0.on(EstimatingRegisters::<S, L, RAW>::new(simd));
    }
}
