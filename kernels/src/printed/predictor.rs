//! Appendix A, step 1: positions and derivatives one step ahead.

use crate::integrator::gear::STATE;
use crate::isa::{Element, Kernel, Machine, Slot};
use std::marker::PhantomData;

/// Taylor expansion of `VALUES` unscaled derivatives of each of `FREEDOMS` degrees of freedom: r_k ← r_k + δt r_{k+1} + ½ δt²
/// r_{k+2} + …, term by term from the left. Vector length: the discs that move.
#[derive(Clone, Copy, Debug)]
pub struct PrintedPredictor<S, const VALUES: usize, const FREEDOMS: usize> {
    dt: f64,
    precision: PhantomData<S>,
}

impl<S: Element, const VALUES: usize, const FREEDOMS: usize> PrintedPredictor<S, VALUES, FREEDOMS> {
    /// Kernel for steps of `dt` (time).
    #[inline]
    pub fn new(dt: f64) -> Self {
        PrintedPredictor { dt, precision: PhantomData }
    }
}

/// δt^k/k!.
#[inline(always)]
pub(super) fn factor(dt: f64, k: usize) -> f64 {
    (1..=k).fold(1.0, |factor, k| factor * dt / k as f64)
}

// SAFETY: the slots depend on the const parameters only.
unsafe impl<S: Element, const VALUES: usize, const FREEDOMS: usize> Kernel
    for PrintedPredictor<S, VALUES, FREEDOMS>
{
    type Lane = S;

    #[allow(clippy::needless_range_loop, reason = "several lists share one index")]
    #[inline(always)]
    fn body<M: Machine<Lane = S>>(&self, m: M) {
        m.section("A 1");
        for row in &STATE[..FREEDOMS] {
            let r = row.map(Slot::<S>::new);
            let mut q = [m.uniform(0.0); VALUES];
            for k in 0..VALUES {
                q[k] = m.load(r[k]);
            }
            for k in 0..VALUES - 1 {
                for term in 1..VALUES - k {
                    q[k] = q[k] + m.uniform(factor(self.dt, term)) * q[k + term];
                }
                m.store(r[k], q[k]);
            }
        }
    }
}
