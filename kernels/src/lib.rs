//! The vector machine of Stripmine.
//!
//! Equations are written once, as operations on whole vectors: a kernel ([`isa::Kernel`]). A kernel is recorded, counted and listed
//! (a [`backend::Tape`]). It is executed as on a CRAY in 1993, strip-mined, or chained through the SIMD registers of the
//! processor at hand ([`Program::run`]), with the same bits.
//!
//! Slices in, slices out: this crate knows no scene, no time and no file.
//!
//! | task | entry point |
//! |---|---|
//! | write equations as a kernel, list it, run it | [`isa::Kernel`], [`Program`] |
//! | write a kernel over arrays with names of your own, without `unsafe` | [`own::OwnKernel`] |
//! | count its operations, by part of a step | [`isa::OpCounts`], [`ledger::Ledger`] |
//! | evaluate pair laws | [`law`]; their sums over all pairs, lists, lattices, sectors: [`sweep`] |
//! | run BP93's own program, line by line | [`printed`] |
//! | move particles under forces | [`integrator`]; from collision to collision: [`flight`] |
//! | draw random numbers that depend on no order | [`noise`] |
//!
//! A kernel of seven operations, in three executions:
//!
//! ```
//! use stripmine_kernels::isa::{Array, Machine, Memory, Slot, Kernel, Vector};
//! use stripmine_kernels::{Execution, InstructionSet, Program};
//!
//! /// fx = √(x² + y²), for every element.
//! struct VectorLength;
//!
//! const X: Slot<f64> = Slot::new(Array::X);
//! const Y: Slot<f64> = Slot::new(Array::Y);
//! const FX: Slot<f64> = Slot::new(Array::Fx);
//!
//! // SAFETY: the body names the same slots in every call.
//! unsafe impl Kernel for VectorLength {
//!     type Lane = f64;
//!     fn body<M: Machine<Lane = f64>>(&self, m: M) {
//!         let [x, y] = [m.load(X), m.load(Y)];
//!         m.store(FX, (x * x + y * y).sqrt());
//!     }
//! }
//!
//! let program = Program::new(VectorLength);
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
//!
//! Number of operations NOP of BP93's predictor: five derivatives of two coordinates take 15 products and 15 sums each:
//!
//! ```
//! use stripmine_kernels::Program;
//! use stripmine_kernels::isa::OpClass;
//! use stripmine_kernels::ledger::{Ledger, VectorLength};
//! use stripmine_kernels::printed::PrintedPredictor;
//!
//! let mut ledger = Ledger::default();
//! ledger.enter("predictor", VectorLength::Grains, &Program::new(PrintedPredictor::<f64, 6, 2>::new(1e-4)));
//! let counts = ledger.part("predictor");
//! assert_eq!((counts.of_class(OpClass::Multiply), counts.of_class(OpClass::Add)), (30, 30));
//! ```
//!
//! Force between two particles at a distance of one diameter: a Lennard-Jones pair repels with 24 ε/σ:
//!
//! ```
//! use stripmine_kernels::law::lennard_jones::LennardJones;
//! use stripmine_kernels::law::potential::CutOff;
//! use stripmine_kernels::sweep::pair::{PairBody, Pair};
//!
//! let law = CutOff::new(LennardJones::new(1.0, 1.0), 2.5);
//! let pair = Pair { bodies: [PairBody::at(0.0, 0.0), PairBody::at(1.0, 0.0)] };
//! let [[own, ..], [partner, ..]] = pair.sums(&law);
//! assert_eq!((own, partner), (-24.0, 24.0));
//! ```

#![warn(unreachable_pub)]
// Every possible panic and every dropped error has its reason beside it.
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
pub mod emit;
pub mod flight;
pub mod integrator;
pub mod isa;
pub mod law;
pub mod ledger;
pub mod mask;
pub mod noise;
pub mod own;
pub mod printed;
mod program;
pub mod sweep;
mod threads;

pub(crate) use backend::GROUP;
pub use backend::InstructionSet;
pub use program::{Execution, Program, Runnable};
pub use threads::{
    in_pieces, keep_awake, over_parts, over_pieces, reorder_into, reordered, single_threaded_if,
};
