//! Integrators, one file each, and their common parts: F/m + g, and the context of a scheme beside the state.

pub mod gear;
pub mod langevin;
pub mod single;
pub mod velocity_verlet;

use crate::backend::Registers;
use crate::isa::{Array, Element, LaneCounter, Machine, Slot, Vector};

/// Largest number of entries in a row of the state: the position and its derivatives.
pub const DERIVATIVES: usize = 6;

const VELOCITY: [Array; 3] = [Array::DiscVx, Array::DiscVy, Array::DiscOmega];
pub(crate) const FORCE: [Array; 3] = [Array::Fx, Array::Fy, Array::Torque];

/// Counts discs whose new state is not finite. Written by kernels that are [`checked`](gear::GearCorrector::checked).
pub const NOT_FINITE: LaneCounter = LaneCounter(3);

/// Divisor of the forces.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Inertia {
    /// Equal discs: inverse mass and inverse moment of inertia.
    Equal {
        /// Inverse mass.
        inverse_mass: f64,
        /// Inverse moment of inertia.
        inverse_inertia: f64,
    },
    /// Individual values, from arrays.
    Varying,
}

impl Inertia {
    /// Inverse mass, or inverse moment of inertia for the third degree of freedom; `own` returns individual values.
    #[inline(always)]
    pub fn inverse<V>(self, freedom: usize, uniform: impl Fn(f64) -> V, own: impl FnOnce() -> V) -> V {
        match (self, freedom) {
            (Inertia::Equal { inverse_mass, .. }, 0 | 1) => uniform(inverse_mass),
            (Inertia::Equal { inverse_inertia, .. }, _) => uniform(inverse_inertia),
            (Inertia::Varying, _) => own(),
        }
    }
}

/// F/m + g of one degree of freedom: x, y or the angle. A zero component of gravity costs nothing.
#[inline(always)]
pub(crate) fn acceleration<V: Vector>(
    uniform: impl Fn(f64) -> V,
    gravity: [f64; 2],
    freedom: usize,
    force: V,
    inverse: V,
) -> V {
    with_gravity(uniform, gravity, freedom, force * inverse)
}

/// Adds gravity to an acceleration.
#[inline(always)]
fn with_gravity<V: Vector>(
    uniform: impl Fn(f64) -> V,
    gravity: [f64; 2],
    freedom: usize,
    acceleration: V,
) -> V {
    if freedom < 2 && gravity[freedom] != 0.0 {
        acceleration + uniform(gravity[freedom])
    } else {
        acceleration
    }
}

/// Acceleration of one degree of freedom, from the force gathered from the lattice.
#[inline(always)]
fn gathered_acceleration<S: Element, P: Element, M: Machine>(
    m: M,
    cell: M::I,
    freedom: usize,
    inertia: Inertia,
    gravity: [f64; 2],
) -> M::V {
    m.section("gather");
    let force = m.gather(Slot::<P>::new(FORCE[freedom]), cell, m.uniform(0.0));
    m.section("acceleration");
    let uniform = |value: f64| m.uniform(value);
    let own = [Array::DiscInverseMass, Array::DiscInverseInertia][freedom / 2];
    let inverse = inertia.inverse(freedom, uniform, || m.load(Slot::<S>::new(own)));
    let acceleration = force * inverse;
    m.section("gravity");
    with_gravity(uniform, gravity, freedom, acceleration)
}

/// Context of a scheme beside a row of the state: the step, and the discs in the lanes.
#[derive(Clone, Copy, Debug)]
pub struct Context<R: Registers> {
    pub(crate) registers: R,
    pub(crate) dt: f64,
    pub(crate) inverse: R::V,
    pub(crate) normal: R::V,
}

impl<R: Registers> Context<R> {
    /// Broadcasts a number to every lane.
    #[inline(always)]
    pub fn uniform(&self, value: f64) -> R::V {
        self.registers.splat(R::Lane::from_f64(value))
    }

    /// Time step (time).
    #[inline(always)]
    pub fn dt(&self) -> f64 {
        self.dt
    }

    /// Inverse mass of the discs, or inverse moment of inertia for the angle.
    #[inline(always)]
    pub fn inverse(&self) -> R::V {
        self.inverse
    }

    /// A standard normal number for every disc and degree of freedom at the point where the scheme [draws](Scheme::DRAWS), NaN
    /// elsewhere. It depends on the run's seed, the disc's id and the step alone.
    #[inline(always)]
    pub fn normal(&self) -> R::V {
        self.normal
    }
}

/// Point of a step at which a scheme draws a random number for each degree of freedom.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Draws {
    /// Never.
    Never,
    /// In the corrector, and at the start.
    InCorrector,
    /// In the predictor.
    InPredictor,
}

/// A predictor and a corrector for one degree of freedom.
///
/// The state has a row for each degree of freedom, q_k = s_k d^k r/dt^k, with the scheme's own [scales](Self::scales) s_k. Code
/// that sets or reads velocities applies them; accelerations are in the scene's units.
pub trait Scheme: Copy + Send + Sync {
    /// Number of derivatives passed from step to step if corrector and next predictor are fused.
    const CARRIED: usize;
    /// Point at which it draws random numbers, which requires the discs' ids.
    const DRAWS: Draws = Draws::Never;

    /// Scales s_k of the row for steps of `dt` (time). The scale of the position is 1.
    fn scales(dt: f64) -> [f64; DERIVATIVES];

    /// Sets the initial acceleration (length/time²) of an initial row.
    fn begin<R: Registers>(&self, context: &Context<R>, row: &mut [R::V; DERIVATIVES], acceleration: R::V);
    /// Corrects the predicted row with the acceleration found (length/time²).
    fn correct<R: Registers>(&self, context: &Context<R>, row: &mut [R::V; DERIVATIVES], acceleration: R::V);
    /// Weights with which the normal numbers of `parts` shorter steps add up to that of a step, in order of time. Their squares
    /// sum to 1.
    fn noise_weights(&self, parts: u32) -> Vec<f64> {
        vec![1.0 / f64::from(parts).sqrt(); parts as usize]
    }
    /// Predicts the row one step ahead.
    fn predict<R: Registers>(&self, context: &Context<R>, row: &mut [R::V; DERIVATIVES]);
}
