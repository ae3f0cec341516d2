//! The velocity Verlet scheme: half a kick, a drift, the forces, half a kick.
//!
//! The state is position, velocity and acceleration. Half a kick is v += (dt/2) a, and a drift is r += dt v. Forces that depend
//! on velocities use those after the first half kick, as is usual.

use super::gear::STATE;
use super::{Context, DERIVATIVES, Inertia, NOT_FINITE, Scheme, VELOCITY, gathered_acceleration};
use crate::backend::Registers;
use crate::isa::{Array, Element, Kernel, Machine, Predicate, Slot, Vector};
use std::marker::PhantomData;

/// The velocity Verlet scheme.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct VelocityVerlet;

impl Scheme for VelocityVerlet {
    // The acceleration is recomputed from the forces.
    const CARRIED: usize = 2;

    #[inline(always)]
    fn scales(_: f64) -> [f64; DERIVATIVES] {
        [1.0; DERIVATIVES]
    }

    #[inline(always)]
    fn begin<R: Registers>(&self, _: &Context<R>, row: &mut [R::V; DERIVATIVES], acceleration: R::V) {
        row[2] = acceleration;
    }

    #[inline(always)]
    fn correct<R: Registers>(&self, context: &Context<R>, row: &mut [R::V; DERIVATIVES], acceleration: R::V) {
        kick(|value| context.uniform(value), context.dt(), row, acceleration);
    }

    #[inline(always)]
    fn predict<R: Registers>(&self, context: &Context<R>, row: &mut [R::V; DERIVATIVES]) {
        drift(|value| context.uniform(value), context.dt(), row);
    }
}

/// Applies the second half kick.
#[inline(always)]
pub(super) fn kick<V: Vector>(
    uniform: impl Fn(f64) -> V,
    dt: f64,
    row: &mut [V; DERIVATIVES],
    acceleration: V,
) {
    row[1] = row[1] + acceleration * uniform(0.5 * dt);
    row[2] = acceleration;
}

/// Applies the first half kick and the drift.
#[inline(always)]
pub(super) fn drift<V: Vector>(uniform: impl Fn(f64) -> V, dt: f64, row: &mut [V; DERIVATIVES]) {
    row[1] = row[1] + row[2] * uniform(0.5 * dt);
    row[0] = row[0] + row[1] * uniform(dt);
}

/// Applies the first half kick and the drift, and passes the velocities to the lattice. Vector length: the discs.
///
/// `S` is the state's precision, `P` the forces'; `FREEDOMS` is 2, or 3 with rotation.
#[derive(Clone, Copy, Debug)]
pub struct VerletDrift<S, P, const FREEDOMS: usize> {
    dt: f64,
    precisions: PhantomData<(S, P)>,
}

impl<S: Element, P: Element, const FREEDOMS: usize> VerletDrift<S, P, FREEDOMS> {
    /// Kernel for steps of `dt` (time).
    #[inline]
    pub fn new(dt: f64) -> Self {
        VerletDrift { dt, precisions: PhantomData }
    }
}

/// Loads the row of one degree of freedom; entries that the scheme does not use are zero.
#[inline(always)]
fn row<S: Element, M: Machine>(m: M, freedom: usize) -> [M::V; DERIVATIVES] {
    let mut row = [m.uniform(0.0); DERIVATIVES];
    for (k, q) in row.iter_mut().enumerate().take(3) {
        *q = m.load(Slot::<S>::new(STATE[freedom][k]));
    }
    row
}

// SAFETY: the slots depend on the const parameters only.
unsafe impl<S: Element, P: Element, const FREEDOMS: usize> Kernel for VerletDrift<S, P, FREEDOMS> {
    type Lane = S;

    #[inline(always)]
    fn body<M: Machine<Lane = S>>(&self, m: M) {
        for freedom in 0..FREEDOMS {
            m.section("drift");
            let mut q = row::<S, M>(m, freedom);
            drift(|value| m.uniform(value), self.dt, &mut q);
            m.store(Slot::<S>::new(STATE[freedom][0]), q[0]);
            m.store(Slot::<S>::new(STATE[freedom][1]), q[1]);
            m.section("velocities");
            m.store(Slot::<P>::new(VELOCITY[freedom]), q[1]);
        }
    }
}

/// Gathers the forces from the lattice and applies the second half kick. Vector length: the discs.
#[derive(Clone, Copy, Debug)]
pub struct VerletKick<S, P, const FREEDOMS: usize> {
    dt: f64,
    inertia: Inertia,
    gravity: [f64; 2],
    checked: bool,
    precisions: PhantomData<(S, P)>,
}

impl<S: Element, P: Element, const FREEDOMS: usize> VerletKick<S, P, FREEDOMS> {
    /// Kernel for steps of `dt` (time) under `gravity` (length/time²); a component of 0 costs nothing.
    #[inline]
    pub fn new(dt: f64, inertia: Inertia, gravity: [f64; 2]) -> Self {
        VerletKick { dt, inertia, gravity, checked: false, precisions: PhantomData }
    }

    /// Makes the kernel also count in [`NOT_FINITE`] the discs whose acceleration is not finite.
    #[must_use]
    #[inline]
    pub fn checked(self) -> Self {
        VerletKick { checked: true, ..self }
    }
}

// SAFETY: the slots depend on the const parameters, the inertia and the non-zero components of gravity.
unsafe impl<S: Element, P: Element, const FREEDOMS: usize> Kernel for VerletKick<S, P, FREEDOMS> {
    type Lane = S;

    #[allow(clippy::needless_range_loop, reason = "several lists share one index")]
    #[inline(always)]
    fn body<M: Machine<Lane = S>>(&self, m: M) {
        m.section("gather");
        let cell = m.load_index(Slot::new(Array::DiscCell));
        let mut magnitude = m.uniform(0.0);
        for freedom in 0..FREEDOMS {
            let acceleration = gathered_acceleration::<S, P, M>(m, cell, freedom, self.inertia, self.gravity);
            m.section("kick");
            if self.checked {
                magnitude = magnitude + acceleration.abs();
            }
            let mut q = row::<S, M>(m, freedom);
            kick(|value| m.uniform(value), self.dt, &mut q, acceleration);
            m.store(Slot::<S>::new(STATE[freedom][1]), q[1]);
            m.store(Slot::<S>::new(STATE[freedom][2]), q[2]);
        }
        if self.checked {
            m.section("check");
            m.count(NOT_FINITE, magnitude.less_than(m.uniform(f64::INFINITY)).not());
        }
    }
}
