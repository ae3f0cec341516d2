//! Integrators, one file each, and what they share: F/m + g, and what a scheme may know beside the state.

pub mod gear;
pub mod langevin;
pub mod single;
pub mod velocity_verlet;

use crate::backend::Registers;
use crate::isa::{Array, Counter, Element, Machine, Slot, Vector};

/// Most entries that a row of the state has: the position and its derivatives.
pub const DERIVATIVES: usize = 6;

const VELOCITY: [Array; 3] = [Array::DiscVx, Array::DiscVy, Array::DiscOmega];
pub(crate) const FORCE: [Array; 3] = [Array::Fx, Array::Fy, Array::Torque];

/// Counts discs whose new state is no finite number. Written by programs that are
/// [`checked`](gear::Corrector::checked).
pub const NOT_FINITE: Counter = Counter(3);

/// What the forces are divided by.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Inertia {
    /// All discs alike: inverse mass and inverse moment of inertia.
    Equal {
        /// Inverse mass.
        inverse_mass: f64,
        /// Inverse moment of inertia.
        inverse_inertia: f64,
    },
    /// Each disc its own, from arrays.
    Varying,
}

impl Inertia {
    /// Inverse mass, or moment of inertia for the third degree of freedom; `own` gives the discs' where they vary.
    #[inline(always)]
    pub fn inverse<V>(self, freedom: usize, uniform: impl Fn(f64) -> V, own: impl FnOnce() -> V) -> V {
        match (self, freedom) {
            (Inertia::Equal { inverse_mass, .. }, 0 | 1) => uniform(inverse_mass),
            (Inertia::Equal { inverse_inertia, .. }, _) => uniform(inverse_inertia),
            (Inertia::Varying, _) => own(),
        }
    }
}

/// F/m + g of one degree of freedom: along x, along y, of the angle. A component of gravity that is 0 costs nothing.
#[inline(always)]
pub(crate) fn acceleration<V: Vector>(
    uniform: impl Fn(f64) -> V,
    gravity: [f64; 2],
    freedom: usize,
    force: V,
    inverse: V,
) -> V {
    pulled(uniform, gravity, freedom, force * inverse)
}

/// An acceleration with that of gravity added.
#[inline(always)]
fn pulled<V: Vector>(uniform: impl Fn(f64) -> V, gravity: [f64; 2], freedom: usize, acceleration: V) -> V {
    if freedom < 2 && gravity[freedom] != 0.0 {
        acceleration + uniform(gravity[freedom])
    } else {
        acceleration
    }
}

/// The acceleration of one degree of freedom, from the force gathered from the lattice.
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
    pulled(uniform, gravity, freedom, acceleration)
}

/// What a scheme may know beside a row of the state: of the step, and of the discs in the lanes.
#[derive(Clone, Copy, Debug)]
pub struct Context<R: Registers> {
    pub(crate) registers: R,
    pub(crate) dt: f64,
    pub(crate) inverse: R::V,
    pub(crate) normal: R::V,
}

impl<R: Registers> Context<R> {
    /// The same number in every lane.
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

    /// A standard normal number for every disc, of its own for each degree of freedom, where the scheme [draws](Scheme::DRAWS)
    /// at this place; no number elsewhere. It depends on the run's seed, the disc's id and the step alone.
    #[inline(always)]
    pub fn normal(&self) -> R::V {
        self.normal
    }
}

/// Where a scheme draws a random number for each degree of freedom.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Draws {
    /// Nowhere.
    Never,
    /// In the corrector, and at the start.
    InCorrector,
    /// In the predictor.
    InPredictor,
}

/// A predictor and a corrector for one degree of freedom.
///
/// The state is a row for each degree of freedom, q_k = s_k d^k r/dt^k, in which s_k are the scheme's own
/// [scales](Self::scales). What puts velocities in or reads them asks for these; the acceleration comes in the scene's units.
pub trait Scheme: Copy + Send + Sync {
    /// How many derivatives a step hands on to the next, where corrector and next predictor are one.
    const CARRIED: usize;
    /// Where it draws random numbers, for which the discs' ids are needed.
    const DRAWS: Draws = Draws::Never;

    /// The scales s_k of the row for steps of `dt` (time). That of the position is 1.
    fn scales(dt: f64) -> [f64; DERIVATIVES];

    /// Takes up the acceleration of the start (length/time²): the row is that of the start already.
    fn begin<R: Registers>(&self, context: &Context<R>, row: &mut [R::V; DERIVATIVES], acceleration: R::V);
    /// Corrects the predicted row with the acceleration found (length/time²).
    fn correct<R: Registers>(&self, context: &Context<R>, row: &mut [R::V; DERIVATIVES], acceleration: R::V);
    /// The weights of the normal numbers of as many shorter steps in that of a step, the first first. Their squares add up to 1.
    fn noise_weights(&self, parts: u32) -> Vec<f64> {
        vec![1.0 / f64::from(parts).sqrt(); parts as usize]
    }
    /// Predicts the row one step ahead.
    fn predict<R: Registers>(&self, context: &Context<R>, row: &mut [R::V; DERIVATIVES]);
}
