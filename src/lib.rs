//! Stripmine: a SIMD vector machine for 2D particle dynamics.
//!
//! The equations of a method are written once, as operations on whole vectors (the crate `stripmine_kernels`), and everything that a
//! run needs is a library (the crate `stripmine_physics`). This crate is the laboratory around them, and the command: the model
//! that predicts what a step costs, studies that answer a user's question, and reports that show the answer.
//!
//! Draw what came out:
//!
//! ```
//! use stripmine::report::figure::{Axis, Chart, Style, svg};
//!
//! let figure = Chart::of(Axis::logarithmic("particles", None), Axis::logarithmic("time", Some("ms")))
//!     .series("all pairs", Style::Joined, 0, (1..=10).map(|n| (f64::from(n), f64::from(n * n))))
//!     .figure("cost", "Cost");
//! assert!(svg(&figure)?.contains("time (ms)"));
//! # Ok::<(), stripmine::report::figure::FigureError>(())
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

pub mod claims;
pub mod cli;
pub mod console;
pub mod frame;
mod laboratory;
pub mod model;
pub(crate) mod pages;
pub mod provenance;
pub mod report;
pub mod results;
pub mod statistics;
mod study;
