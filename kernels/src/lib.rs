//! The vector machine of Stripmine.
//!
//! Equations are written once, as operations on whole vectors (a [`isa::Text`]). The same text is recorded, counted and
//! listed (a [`backend::Tape`]), executed the way a 1993 CRAY did it, strip-mined, and chained through the SIMD registers
//! of the processor at hand ([`Program::run`]): to the same bits.
//!
//! Slices in, slices out: this crate knows no scene, no time and no file.

pub mod backend;
pub mod integrator;
pub mod isa;
pub mod law;
pub mod ledger;
pub mod mask;
pub mod noise;
mod program;
pub mod sweep;

pub use program::{Execution, GROUP, InstructionSet, Program, Runnable};
