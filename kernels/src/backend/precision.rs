//! The precisions that programs may have.

use super::estimated::Estimates;
use super::wide::WideElement;

/// A precision that every register file has lanes for.
pub trait Precision: Estimates + WideElement {}

impl Precision for f64 {}
impl Precision for f32 {}
