//! The vector machine of Stripmine.
//!
//! Equations are written once, as operations on whole vectors (a [`isa::Text`]). The same text is recorded, counted and
//! listed (a [`backend::Tape`]), executed the way a 1993 CRAY did it, strip-mined, and chained through the SIMD registers
//! of the processor at hand ([`Program::run`]): to the same bits.
//!
//! Slices in, slices out: this crate knows no scene, no time and no file.
//!
//! ```
//! use stripmine_kernels::isa::{Array, Machine, Memory, Slot, Text, Vector};
//! use stripmine_kernels::{Execution, InstructionSet, Program};
//!
//! /// fx = √(x² + y²), for every element.
//! struct Length;
//!
//! const X: Slot<f64> = Slot::new(Array::X);
//! const Y: Slot<f64> = Slot::new(Array::Y);
//! const FX: Slot<f64> = Slot::new(Array::Fx);
//!
//! // SAFETY: the body names the same slots whenever it is called.
//! unsafe impl Text for Length {
//!     type Lane = f64;
//!     fn body<M: Machine<Lane = f64>>(&self, m: M) {
//!         let [x, y] = [m.load(X), m.load(Y)];
//!         m.store(FX, (x * x + y * y).sqrt());
//!     }
//! }
//!
//! let program = Program::new(Length);
//! assert_eq!(program.tape().instructions().len(), 7);
//! assert!(program.tape().listing().to_string().contains("sqrt"));
//!
//! let (x, y, mut lengths) = ([3.0; 10], [4.0; 10], [0.0; 10]);
//! for execution in [Execution::Eager, Execution::Strip(4), Execution::Chained] {
//!     let memory = Memory::new().read(X, &x).read(Y, &y).write(FX, &mut lengths);
//!     program.run(&memory, 0..10, execution, InstructionSet::best())?;
//!     assert_eq!(lengths, [5.0; 10]);
//! }
//! # Ok::<(), stripmine_kernels::isa::ProgramError>(())
//! ```

#![warn(unreachable_pub)]
// Where a panic is possible, or an error is dropped, the reason stands beside it.
#![cfg_attr(
    not(test),
    warn(
        clippy::unwrap_used,
        clippy::expect_used,
        clippy::panic,
        clippy::unreachable,
        clippy::let_underscore_must_use
    )
)]

pub mod backend;
pub mod flight;
pub mod integrator;
pub mod isa;
pub mod law;
pub mod ledger;
pub mod mask;
pub mod noise;
pub mod printed;
mod program;
pub mod sweep;
mod threads;

pub(crate) use backend::GROUP;
pub use backend::InstructionSet;
pub use program::{Execution, Program, Runnable};
pub use threads::{
    alone_if, in_parts, in_pieces, keep_awake, over_parts, over_pieces, put_in_order, reordered,
};
