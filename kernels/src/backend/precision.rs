//! The precisions that programs may have.

use super::pulp::PulpElement;
use super::wide::WideElement;

/// A precision that every register file has lanes for.
pub trait Precision: PulpElement + WideElement {}

impl Precision for f64 {}
impl Precision for f32 {}
