//! Gear's predictor–corrector for second-order equations. BP93 appendix A; Allen & Tildesley, appendix E.
//!
//! The state has a row of scaled derivatives q_k = (dt^k/k!) d^k r/dt^k for each degree of freedom: x, y and, with rotation, the
//! angle.

use super::{Context, DERIVATIVES, Inertia, NOT_FINITE, Scheme, VELOCITY, gathered_acceleration};
use crate::backend::Registers;
use crate::isa::{Array, Element, Kernel, Machine, Predicate, Slot, Vector};
use std::marker::PhantomData;

/// Arrays of the state, a row for each degree of freedom: the position and its derivatives, scaled as the scheme requires.
pub const STATE: [[Array; DERIVATIVES]; 3] = [
    [Array::X0, Array::X1, Array::X2, Array::X3, Array::X4, Array::X5],
    [Array::Y0, Array::Y1, Array::Y2, Array::Y3, Array::Y4, Array::Y5],
    [Array::Phi0, Array::Phi1, Array::Phi2, Array::Phi3, Array::Phi4, Array::Phi5],
];

/// Arguments of the accelerations, which determine the first coefficient.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Acceleration {
    /// Positions only.
    OfPositions,
    /// Positions and velocities.
    OfVelocities,
}

/// Corrector coefficients c_0 … c_(values−1) for 4, 5 or 6 values (orders 3, 4, 5).
///
/// # Panics
/// If `values` is another number.
pub const fn coefficients(values: usize, acceleration: Acceleration) -> [f64; 6] {
    let of_velocities = matches!(acceleration, Acceleration::OfVelocities);
    match values {
        4 => [1.0 / 6.0, 5.0 / 6.0, 1.0, 1.0 / 3.0, 0.0, 0.0],
        5 => [
            if of_velocities { 19.0 / 90.0 } else { 19.0 / 120.0 },
            3.0 / 4.0,
            1.0,
            1.0 / 2.0,
            1.0 / 12.0,
            0.0,
        ],
        6 => {
            let c0 = if of_velocities { 3.0 / 16.0 } else { 3.0 / 20.0 };
            [c0, 251.0 / 360.0, 1.0, 11.0 / 18.0, 1.0 / 6.0, 1.0 / 60.0]
        }
        #[expect(clippy::panic, reason = "a constant: another number of values does not compile")]
        _ => panic!("Gear schemes have 4, 5 or 6 values"),
    }
}

/// Scale factors dt^k/k! of the derivatives in the state.
#[inline(always)]
fn scales(dt: f64) -> [f64; DERIVATIVES] {
    let second = 0.5 * dt * dt;
    let third = second * dt / 3.0;
    let fourth = third * dt / 4.0;
    [1.0, dt, second, third, fourth, fourth * dt / 5.0]
}

/// Taylor expansion of one row over a step: Pascal's triangle, computed with sums alone.
#[inline(always)]
fn advance<V: Vector, const VALUES: usize>(q: &mut [V]) {
    for lowest in 0..VALUES - 1 {
        for k in (lowest..VALUES - 1).rev() {
            q[k] = q[k] + q[k + 1];
        }
    }
}

/// Adds c_k Δ to every derivative.
#[inline(always)]
fn add_difference<V: Vector, const VALUES: usize>(
    coefficients: &[f64; 6],
    uniform: impl Fn(f64) -> V,
    q: &mut [V],
    difference: V,
) {
    for k in 0..VALUES {
        let c = coefficients[k];
        q[k] = q[k] + if c == 1.0 { difference } else { uniform(c) * difference };
    }
}

/// Gear's scheme of `VALUES` values.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gear<const VALUES: usize> {
    coefficients: [f64; 6],
}

impl<const VALUES: usize> Gear<VALUES> {
    /// Scheme for accelerations with these arguments.
    #[inline]
    pub const fn new(acceleration: Acceleration) -> Self {
        Gear { coefficients: coefficients(VALUES, acceleration) }
    }
}

impl<const VALUES: usize> Scheme for Gear<VALUES> {
    const CARRIED: usize = VALUES;

    #[inline(always)]
    fn scales(dt: f64) -> [f64; DERIVATIVES] {
        scales(dt)
    }

    #[inline(always)]
    fn begin<R: Registers>(&self, context: &Context<R>, row: &mut [R::V; DERIVATIVES], acceleration: R::V) {
        row[2] = acceleration * context.uniform(scales(context.dt())[2]);
    }

    #[inline(always)]
    fn correct<R: Registers>(&self, context: &Context<R>, row: &mut [R::V; DERIVATIVES], acceleration: R::V) {
        let difference = acceleration * context.uniform(scales(context.dt())[2]) - row[2];
        add_difference::<R::V, VALUES>(&self.coefficients, |c| context.uniform(c), row, difference);
    }

    #[inline(always)]
    fn predict<R: Registers>(&self, _: &Context<R>, row: &mut [R::V; DERIVATIVES]) {
        advance::<R::V, VALUES>(row);
    }
}

/// Loads the row of `VALUES` scaled derivatives of one degree of freedom.
#[inline(always)]
fn row<S: Element, M: Machine, const VALUES: usize>(m: M, freedom: usize) -> [M::V; VALUES] {
    let mut q = [m.uniform(0.0); VALUES];
    for k in 0..VALUES {
        q[k] = m.load(Slot::<S>::new(STATE[freedom][k]));
    }
    q
}

/// Predicts the state one step ahead and passes the velocities to the lattice. Vector length: the discs.
///
/// `S` is the state's precision, `P` the forces'; `FREEDOMS` is 2, or 3 with rotation.
#[derive(Clone, Copy, Debug)]
pub struct GearPredictor<S, P, const VALUES: usize, const FREEDOMS: usize> {
    inverse_dt: f64,
    precisions: PhantomData<(S, P)>,
}

impl<S: Element, P: Element, const VALUES: usize, const FREEDOMS: usize>
    GearPredictor<S, P, VALUES, FREEDOMS>
{
    /// Kernel for steps of `dt` (time).
    #[inline]
    pub fn new(dt: f64) -> Self {
        GearPredictor { inverse_dt: 1.0 / dt, precisions: PhantomData }
    }
}

// SAFETY: the slots depend on the const parameters only.
unsafe impl<S: Element, P: Element, const VALUES: usize, const FREEDOMS: usize> Kernel
    for GearPredictor<S, P, VALUES, FREEDOMS>
{
    type Lane = S;

    #[inline(always)]
    fn body<M: Machine<Lane = S>>(&self, m: M) {
        for freedom in 0..FREEDOMS {
            m.section("expansion");
            let mut q = row::<S, M, VALUES>(m, freedom);
            advance::<M::V, VALUES>(&mut q);
            for k in 0..VALUES - 1 {
                m.store(Slot::<S>::new(STATE[freedom][k]), q[k]);
            }
            m.section("velocities");
            m.store(Slot::<P>::new(VELOCITY[freedom]), q[1] * m.uniform(self.inverse_dt));
        }
    }
}

/// Gathers the forces from the lattice and corrects the predicted state. Vector length: the discs.
///
/// # As printed
/// Appendix A multiplies the coefficients by the new acceleration. It must be the difference from the predicted one: Δ =
/// (dt²/2)(a − a_predicted), q_k += c_k Δ.
#[derive(Clone, Copy, Debug)]
pub struct GearCorrector<S, P, const VALUES: usize, const FREEDOMS: usize> {
    dt: f64,
    coefficients: [f64; 6],
    inertia: Inertia,
    gravity: [f64; 2],
    checked: bool,
    precisions: PhantomData<(S, P)>,
}

impl<S: Element, P: Element, const VALUES: usize, const FREEDOMS: usize>
    GearCorrector<S, P, VALUES, FREEDOMS>
{
    /// Kernel for steps of `dt` (time) under `gravity` (length/time²); a component of 0 costs nothing.
    #[inline]
    pub fn new(dt: f64, acceleration: Acceleration, inertia: Inertia, gravity: [f64; 2]) -> Self {
        GearCorrector {
            dt,
            coefficients: coefficients(VALUES, acceleration),
            inertia,
            gravity,
            checked: false,
            precisions: PhantomData,
        }
    }

    /// Makes the kernel also count in [`NOT_FINITE`] the discs whose correction is not finite.
    #[must_use]
    #[inline]
    pub fn checked(self) -> Self {
        GearCorrector { checked: true, ..self }
    }
}

// SAFETY: the slots depend on the const parameters, the inertia and the non-zero components of gravity.
unsafe impl<S: Element, P: Element, const VALUES: usize, const FREEDOMS: usize> Kernel
    for GearCorrector<S, P, VALUES, FREEDOMS>
{
    type Lane = S;

    #[allow(clippy::needless_range_loop, reason = "several lists share one index")]
    #[inline(always)]
    fn body<M: Machine<Lane = S>>(&self, m: M) {
        m.section("gather");
        let cell = m.load_index(Slot::new(Array::DiscCell));
        let mut magnitude = m.uniform(0.0);
        for freedom in 0..FREEDOMS {
            let acceleration = gathered_acceleration::<S, P, M>(m, cell, freedom, self.inertia, self.gravity);
            m.section("correction");
            let mut q = row::<S, M, VALUES>(m, freedom);
            let difference = acceleration * m.uniform(scales(self.dt)[2]) - q[2];
            if self.checked {
                magnitude = magnitude + difference.abs();
            }
            add_difference::<M::V, VALUES>(&self.coefficients, |c| m.uniform(c), &mut q, difference);
            for k in 0..VALUES {
                m.store(Slot::<S>::new(STATE[freedom][k]), q[k]);
            }
        }
        if self.checked {
            m.section("check");
            m.count(NOT_FINITE, magnitude.less_than(m.uniform(f64::INFINITY)).not());
        }
    }
}
