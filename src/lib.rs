//! Stripmine: a SIMD vector machine for 2D particle dynamics.
//!
//! The equations of a method are written once, as operations on whole vectors (the crate `stripmine_kernels`). This
//! crate is the laboratory around that machine: methods that step particles, the model that predicts what a step
//! costs, studies that answer a user's question, and reports that show the answer.
//!
//! Run a scene and look at it:
//!
//! ```
//! use std::sync::atomic::AtomicBool;
//! use stripmine::method::observed::observed;
//! use stripmine::method::{METHODS, Purpose, load};
//!
//! let (prepared, method) = load("two-discs", &["run.steps=100".to_owned()], METHODS)?;
//! let mut simulation = prepared.start(Purpose::Run)?;
//! simulation.advance(&[prepared.schedule().until], &AtomicBool::new(false))?;
//! let [momentum] = observed(method.quantities, &simulation.observe(), ["momentum_x"])?;
//! assert!((momentum - 1.0).abs() < 1e-12);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
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
pub mod domain;
pub mod grid;
pub mod io;
pub mod memory;
pub mod method;
pub mod model;
pub mod near;
pub mod number;
pub mod observe;
pub mod origin;
pub mod particles;
pub mod placement;
pub mod quoted;
pub mod report;
pub mod reported;
pub mod results;
pub mod run;
pub mod scene;
pub mod signals;
pub mod start;
pub mod statistics;
pub mod study;
pub mod words;
