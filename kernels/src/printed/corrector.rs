//! Section 2, step 5 and appendix A, steps 2 and 3: gathers the forces for the discs and corrects the state.

use super::index::CELL;
use super::predictor::factor;
use crate::integrator::gear::{Acceleration, STATE, coefficients};
use crate::integrator::{FORCE, NOT_FINITE};
use crate::isa::{Array, Element, Kernel, Machine, Predicate, Slot, Vector};
use std::marker::PhantomData;

/// r_k ← r_k + C_k (r''corr − r''pr) for `VALUES` unscaled derivatives of each of `FREEDOMS` degrees of freedom. C_k = c_k k!/2
/// δt^(2−k), so that C_2 = 1 as printed. Vector length: the discs that move.
///
/// # As printed
/// Appendix A multiplies the coefficients by r''corr; it must be the difference from the predicted one.
#[derive(Clone, Copy, Debug)]
pub struct PrintedCorrector<S, P, const VALUES: usize, const FREEDOMS: usize> {
    coefficients: [f64; 6],
    gravity: [f64; 2],
    checked: bool,
    precisions: PhantomData<(S, P)>,
}

impl<S: Element, P: Element, const VALUES: usize, const FREEDOMS: usize>
    PrintedCorrector<S, P, VALUES, FREEDOMS>
{
    /// Kernel for steps of `dt` (time) under `gravity` (length/time²); a component of 0 costs nothing.
    #[inline]
    pub fn new(dt: f64, acceleration: Acceleration, gravity: [f64; 2]) -> Self {
        let mut coefficients = coefficients(VALUES, acceleration);
        for (k, c) in coefficients.iter_mut().enumerate() {
            *c *= factor(dt, 2) / factor(dt, k);
        }
        // Exactly 1 for any dt.
        coefficients[2] = 1.0;
        PrintedCorrector { coefficients, gravity, checked: false, precisions: PhantomData }
    }

    /// Makes the kernel also count in [`NOT_FINITE`] the discs whose correction is not finite.
    #[must_use]
    #[inline]
    pub fn checked(self) -> Self {
        PrintedCorrector { checked: true, ..self }
    }
}

// SAFETY: the slots depend on the const parameters only.
unsafe impl<S: Element, P: Element, const VALUES: usize, const FREEDOMS: usize> Kernel
    for PrintedCorrector<S, P, VALUES, FREEDOMS>
{
    type Lane = S;

    #[allow(clippy::needless_range_loop, reason = "several lists share one index")]
    #[inline(always)]
    fn body<M: Machine<Lane = S>>(&self, m: M) {
        m.section("step 5");
        let cell = m.load_index(CELL);
        let mut magnitude = m.uniform(0.0);
        for freedom in 0..FREEDOMS {
            m.section("step 5");
            let force = m.gather(Slot::<P>::new(FORCE[freedom]), cell, m.uniform(0.0));
            m.section("(1)");
            let inverse = [Array::DiscInverseMass, Array::DiscInverseInertia][freedom / 2];
            let mut acceleration = m.load(Slot::<S>::new(inverse)) * force;
            if freedom < 2 && self.gravity[freedom] != 0.0 {
                m.section("gravity");
                acceleration = acceleration + m.uniform(self.gravity[freedom]);
            }
            m.section("A 3");
            let r = STATE[freedom].map(Slot::<S>::new);
            let difference = acceleration - m.load(r[2]);
            for k in 0..VALUES {
                let c = self.coefficients[k];
                let step = if k == 2 { difference } else { m.uniform(c) * difference };
                m.store(r[k], m.load(r[k]) + step);
            }
            if self.checked {
                magnitude = magnitude + difference.abs();
            }
        }
        if self.checked {
            m.section("check");
            m.count(NOT_FINITE, magnitude.less_than(m.uniform(f64::INFINITY)).not());
        }
    }
}
