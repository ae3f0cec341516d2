//! Stripmine: a SIMD vector machine for 2D particle dynamics.
//!
//! The equations of a method are written once, as operations on whole vectors (the crate `stripmine_kernels`), and everything that a
//! run needs is a library (the crate `stripmine_physics`). This crate is the laboratory around them, and the command: the model
//! that predicts what a step costs, studies that answer a user's question, and reports that show the answer.
//!
//! Draw what came out:
//!
//! ```
//! use stripmine::report::figure::{Axis, Chart, Figure, Picture, Point, Series, Style, svg};
//!
//! let points = (1..=10).map(|n| Point::at(f64::from(n), f64::from(n * n))).collect();
//! let picture = Picture::Chart(Chart {
//!     x: Axis::logarithmic("particles", None),
//!     y: Axis::logarithmic("time", Some("ms")),
//!     series: vec![Series { name: "all pairs".into(), style: Style::Joined, hue: 0, points }],
//!     bands: vec![],
//! });
//! let figure = Figure { name: "cost".into(), title: "Cost".into(), caption: String::new(), picture };
//! assert!(svg(&figure)?.contains("time (ms)"));
//! # Ok::<(), stripmine::report::figure::FigureError>(())
//! ```

pub mod cli;
pub mod console;
pub mod laboratory;
pub mod model;
pub mod provenance;
pub mod report;
pub mod results;
pub mod statistics;
pub mod study;
