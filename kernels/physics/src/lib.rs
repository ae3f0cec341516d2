//! The physics of Stripmine: everything that a run needs, and nothing else.
//!
//! A scene is read ([`scene`]), its particles are placed ([`start`]), a method of the [list](method::METHODS) steps them
//! ([`method`]), and a run is recorded ([`run`]). All SIMD code of a step is compiled in this crate; it knows nothing of studies,
//! reports or a command line.
//!
//! ```
//! use std::sync::atomic::AtomicBool;
//! use stripmine_physics::method::observed::observed;
//! use stripmine_physics::method::{METHODS, Purpose, load};
//!
//! let (prepared, method) = load("two-discs", &["run.steps=100".to_owned()], METHODS)?;
//! let mut simulation = prepared.start(Purpose::Run)?;
//! simulation.advance(&[prepared.schedule.until], &AtomicBool::new(false))?;
//! let [momentum] = observed(method.quantities, &simulation.observe(), ["momentum_x"])?;
//! assert!((momentum - 1.0).abs() < 1e-12);
//! # Ok::<(), Box<dyn std::error::Error>>(())
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
pub mod words;
