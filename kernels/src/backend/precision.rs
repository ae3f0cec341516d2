//! Precisions of kernels.

use super::dispatch::InstructionSet;
use super::estimated::EstimatingElement;
use super::tape::Tape;
use super::wide::WideElement;
use crate::isa::{Memory, ProgramError};
use std::ops::Range;

/// A precision supported by every register file. The interpreter of tapes is compiled here, once per precision, and not in every
/// crate that has a kernel.
pub trait Precision: EstimatingElement + WideElement {
    /// As [`Tape::interpret`].
    #[doc(hidden)]
    fn interpret(
        tape: &Tape<Self>,
        memory: &Memory<'_>,
        range: Range<usize>,
        strip: usize,
        set: InstructionSet,
    ) -> Result<(), ProgramError>;

    /// As [`Tape::register_bytes`].
    #[doc(hidden)]
    fn register_bytes(
        tape: &Tape<Self>,
        strip: usize,
        set: InstructionSet,
    ) -> Result<[usize; 3], ProgramError>;
}

macro_rules! precisions {
    ($($lane:ty)*) => {$(
        impl Precision for $lane {
            fn interpret(
                tape: &Tape<Self>,
                memory: &Memory<'_>,
                range: Range<usize>,
                strip: usize,
                set: InstructionSet,
            ) -> Result<(), ProgramError> {
                tape.interpret(memory, range, strip, set)
            }

            fn register_bytes(
                tape: &Tape<Self>,
                strip: usize,
                set: InstructionSet,
            ) -> Result<[usize; 3], ProgramError> {
                tape.register_bytes(strip, set)
            }
        }
    )*};
}

precisions! { f64 f32 }
