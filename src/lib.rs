//! Stripmine: a SIMD vector machine for 2D particle dynamics.
//!
//! The equations of a method are written once, as operations on whole vectors (the crate `stripmine_kernels`). This
//! crate is the laboratory around that machine: methods that step particles, the model that predicts what a step
//! costs, studies that answer a user's question, and reports that show the answer.
//!
//! Step a scene and look at it:
//!
//! ```
//! use stripmine::method::Method;
//! use stripmine::observe::{Observation, Scenery};
//! use stripmine::run::{assemble, model};
//! use stripmine::scene::Document;
//!
//! let checked = Document::load("two-discs", &["run.steps=100".to_owned()])?.check()?;
//! let mut method = assemble(&checked)?;
//! for _ in 0..checked.scene.run.steps {
//!     method.step()?;
//! }
//! let seen = Observation::of(method.steps(), method.time(), &method.particles(), &Scenery::of(&model(&checked)));
//! assert!((seen.momentum_x - 1.0).abs() < 1e-12);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! Ask what a step costs, by the source's count and by the programs that run:
//!
//! ```
//! use stripmine::model::machines;
//! use stripmine::study::efficiency_table::{Question, efficiency_table};
//!
//! let table = efficiency_table(&Question::default(), &machines::preset("paper")?)?;
//! let forces = table.parts.iter().find(|row| row.part == "forces").expect("a step has forces");
//! assert_eq!(forces.printed, Some(1656));
//! assert!(forces.counted < 1656);
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
pub mod domain;
pub mod grid;
pub mod io;
pub mod machine_memory;
pub mod method;
pub mod model;
pub mod observe;
pub mod origin;
pub mod particles;
pub mod placement;
pub mod quoted;
pub mod report;
pub mod run;
pub mod scene;
mod signals;
pub mod study;
