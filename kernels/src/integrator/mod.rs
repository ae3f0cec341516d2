//! Integrators, one file each.

pub mod gear;
pub mod velocity_verlet;

use crate::isa::Vector;

/// A predictor and a corrector for one degree of freedom, on the scaled derivatives q_k = (dt^k/k!) d^k r/dt^k.
pub trait Scheme: Copy + Send + Sync {
    /// How many scaled derivatives a step hands on to the next, where corrector and next predictor are one.
    const CARRIED: usize;

    /// Corrects the predicted row with the acceleration found, `second` = (dt²/2) a.
    fn correct<V: Vector>(&self, uniform: impl Fn(f64) -> V, row: &mut [V; 6], second: V);
    /// Predicts the row one step ahead.
    fn predict<V: Vector>(&self, row: &mut [V; 6]);
}
