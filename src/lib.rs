//! Stripmine: a SIMD vector machine for 2D particle dynamics.
//!
//! The equations of a method are written once, as operations on whole vectors (the crate `stripmine_kernels`). This
//! crate is the laboratory around that machine: methods that step particles, the model that predicts what a step
//! costs, studies that answer a user's question, and reports that show the answer.

pub mod cli;
pub mod domain;
pub mod grid;
pub mod io;
pub mod method;
pub mod model;
pub mod observe;
pub mod particles;
pub mod placement;
pub mod report;
pub mod run;
pub mod scene;
pub mod study;
