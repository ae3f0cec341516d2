//! Physics of Stripmine: everything that a run needs.
//!
//! [`scene`] reads a scene, [`start`] places its particles, a [`method`] of the [list](method::METHODS) advances them, and [`run`] records the run.
//! All SIMD code of a step is compiled in this crate. The crate depends on no study, no report and no command line.
//!
//! | task | entry point |
//! |---|---|
//! | read a scene, with changes of its keys | [`method::load`] |
//! | start it, advance it, observe it | [`method::Prepared`], [`method::Simulation`] |
//! | record it in a folder; resume it | [`run::run`] |
//! | read what runs wrote: averages, structure, particles | [`run::FinishedRun`], [`run::function_of`], [`io::extxyz`], [`io::checkpoint`] |
//! | averages with their errors | [`averages`] |
//! | structure of given particles | [`structure`] |
//! | a run on several ranks | [`ranks`] |
//!
//! Two discs that collide keep their momentum:
//!
//! ```
//! use std::sync::atomic::AtomicBool;
//! use stripmine_physics::method::observed::observed;
//! use stripmine_physics::method::{METHODS, StartPurpose, load};
//!
//! let (prepared, method) = load("two-discs", &["run.steps=100".to_owned()], METHODS)?;
//! let mut simulation = prepared.start(StartPurpose::Run)?;
//! simulation.advance(&[prepared.schedule.until], &AtomicBool::new(false))?;
//! let [momentum] = observed(method.quantities, &simulation.observe(), ["momentum_x"])?;
//! assert!((momentum - 1.0).abs() < 1e-12);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! A run in a folder, and the mean of a column of its table:
//!
//! ```
//! use std::sync::atomic::AtomicBool;
//! use stripmine_physics::method::{METHODS, load};
//! use stripmine_physics::origin::Origin;
//! use stripmine_physics::run::{ExistingRun, FinishedRun, RunJob, averages_of, run};
//!
//! let changes = ["run.steps=200".to_owned(), "run.thermo_every=10".to_owned()];
//! let (prepared, method) = load("two-discs", &changes, METHODS)?;
//! let folder = std::env::temp_dir().join(format!("two-discs-{}", std::process::id()));
//! let program = Origin {
//!     version: "0".to_owned(),
//!     commit: "unknown".to_owned(),
//!     dirty: false,
//!     target: "any".to_owned(),
//! };
//! let job = RunJob { prepared: prepared.into(), quantities: method.quantities, program: &program, is_open_ended: false };
//! run(job, &folder, ExistingRun::Overwrite, &AtomicBool::new(false), |_, _| (), |_| ())?;
//!
//! let averages = averages_of(&[FinishedRun::read(&folder, METHODS)?])?;
//! assert_eq!((averages.rows, averages.runs), (21, 1));
//! assert!(averages.quantities.iter().any(|it| it.quantity == "momentum_x"));
//! # std::fs::remove_dir_all(&folder)?;
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! Hexatic order of seven discs in a hexagon: the central disc has ψ₆ = 1:
//!
//! ```
//! use std::f64::consts::TAU;
//! use stripmine_physics::domain::Domain;
//! use stripmine_physics::particles::{ParticleKind, Particle, Particles, in_space};
//! use stripmine_physics::structure::{StructureSetting, hexatic_orders};
//!
//! let disc = |id, [x, y]: [f64; 2]| Particle {
//!     id,
//!     kind: ParticleKind::Grain,
//!     species: 0,
//!     position: in_space([5.0 + x, 4.0 + y]),
//!     velocity: [0.0; 3],
//!     angle: 0.0,
//!     omega: 0.0,
//!     radius: 0.5,
//!     mass: 1.0,
//! };
//! let corner = |id: u32| disc(id, [(f64::from(id) / 6.0 * TAU).cos(), (f64::from(id) / 6.0 * TAU).sin()]);
//! let discs = Particles::new((1..=6).map(corner).chain([disc(7, [0.0; 2])]).collect());
//!
//! let setting = StructureSetting::new(Domain::planar([0.0; 2], [10.0, 8.0], [false; 2]), &discs);
//! let [real, imaginary] = hexatic_orders(&setting, &discs)[6];
//! assert!((real - 1.0).abs() < 1e-12 && imaginary.abs() < 1e-12);
//! ```

#![warn(unreachable_pub)]
// Code that may panic or drops an error gives its reason beside it.
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

pub mod averages;
pub mod domain;
pub(crate) mod grid;
pub mod input;
pub mod io;
pub mod memory;
pub mod method;
pub mod near;
pub mod number;
pub mod observe;
pub mod origin;
pub mod particles;
pub mod placement;
pub mod quoted;
pub mod ranks;
pub mod reported;
pub mod run;
pub mod scene;
pub mod signals;
pub mod start;
pub mod structure;
pub mod units;
pub mod words;
