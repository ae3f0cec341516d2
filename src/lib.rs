//! Stripmine: a SIMD vector machine for 2D particle dynamics.
//!
//! The equations of a method are written once, as operations on whole vectors (the crate `stripmine_kernels`). Everything that a
//! run needs is a library (the crate `stripmine_physics`). This crate adds the laboratory and the command: a model that predicts
//! the cost of a step, studies that answer a user's question, and reports that show the answer.
//!
//! | task | entry point |
//! |---|---|
//! | the command, from within a program | [`cli::run_with`] |
//! | cost of a program on a vector machine | [`model::clock`], [`model::machines`] |
//! | predict a run on this host | [`model::host`] |
//! | count, list, time and price a program of your own | [`workbench::examine`] |
//! | draw a chart | [`report::figure`] |
//! | tables with units, and expressions over their cells | [`frame`] |
//! | check claims against tables | [`claims`] |
//! | read committed results | [`results::Folder`] |
//!
//! BP93's cost of a program, NOP·(n + D), on its machine with D = 20: two loads, a product and a store over 100 elements:
//!
//! ```
//! use stripmine::model::clock::{Clock, ProgramWork};
//! use stripmine::model::machines;
//! use stripmine_kernels::Program;
//! use stripmine_kernels::isa::{Array, Machine, Slot, Kernel};
//!
//! /// fx = x y, for every element.
//! struct Product;
//!
//! const X: Slot<f64> = Slot::new(Array::X);
//! const Y: Slot<f64> = Slot::new(Array::Y);
//! const FX: Slot<f64> = Slot::new(Array::Fx);
//!
//! // SAFETY: the body names the same slots whenever it is called.
//! unsafe impl Kernel for Product {
//!     type Lane = f64;
//!     fn body<M: Machine<Lane = f64>>(&self, m: M) {
//!         m.store(FX, m.load(X) * m.load(Y));
//!     }
//! }
//!
//! let work = ProgramWork::of(&Program::new(Product));
//! let paper = machines::preset("paper")?;
//! assert_eq!(Clock::Paper.clocks(&paper, &work, 100), 4.0 * (100.0 + 20.0));
//! assert_eq!(Clock::Scalar.clocks(&paper, &work, 100), 4.0 * 100.0 * 20.0);
//! # Ok::<(), stripmine::model::machines::MachineError>(())
//! ```
//!
//! A table, and an expression over its cells, as in claims:
//!
//! ```
//! use stripmine::frame::{Expressions, FrameBuilder, ExpressionScope};
//!
//! let rates = FrameBuilder::of([(100_u64, 2.0), (200, 3.0)])
//!     .count("particles", |&(particles, _)| particles)
//!     .number("rate", 1, |&(_, rate)| rate)
//!     .frame("rates", "Rates");
//! let scope = ExpressionScope::of([rates]);
//! let value = Expressions::new().value("rates.at(particles=200).rate / rates.at(particles=100).rate", &scope)?;
//! assert_eq!(value.to_string(), "1.5");
//! # Ok::<(), String>(())
//! ```
//!
//! A chart with logarithmic axes:
//!
//! ```
//! use stripmine::report::figure::{ChartAxis, Chart, Style, svg};
//!
//! let figure = Chart::of(ChartAxis::logarithmic("particles", None), ChartAxis::logarithmic("time", Some("ms")))
//!     .series("all pairs", Style::Joined, 0, (1..=10).map(|n| (f64::from(n), f64::from(n * n))))
//!     .figure("cost", "Cost");
//! assert!(svg(&figure)?.contains("time (ms)"));
//! # Ok::<(), stripmine::report::figure::FigureError>(())
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

pub mod claims;
pub mod cli;
pub mod console;
mod emission;
pub mod frame;
mod laboratory;
pub mod model;
pub(crate) mod pages;
pub mod provenance;
pub mod report;
pub mod results;
pub mod statistics;
mod study;
pub mod workbench;
