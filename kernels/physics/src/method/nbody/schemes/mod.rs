//! Integrators of bodies, one file each. The state is positions and velocities; schemes may carry further values.

mod composed;
mod euler;
mod gear;
mod hermite;
mod ias15;
mod runge_kutta;

use super::bodies::{PointMasses, StateColumns};
use super::encounter::NearestPair;
use crate::words::define_words;
use stripmine_kernels::isa::ProgramError;

pub(crate) use composed::ComposedLeapfrog;
pub(crate) use euler::{DampedEuler, Euler};
pub(crate) use gear::SixValueGear;
pub(crate) use hermite::Hermite;
pub(crate) use ias15::Ias15;
pub(crate) use runge_kutta::RungeKutta;

/// Force field as schemes use it.
pub trait AccelerationField {
    /// Calculates the accelerations at these positions (length/time²).
    ///
    /// # Errors
    /// [`ProgramError`] if the processor lacks the instruction set, or the evaluation is interrupted.
    fn acceleration(&mut self, position: &StateColumns, into: &mut StateColumns) -> Result<(), ProgramError>;

    /// Calculates the accelerations at the end of a step, whose energy may be needed next.
    ///
    /// # Errors
    /// As [`AccelerationField::acceleration`].
    fn last_acceleration(
        &mut self,
        position: &StateColumns,
        into: &mut StateColumns,
    ) -> Result<(), ProgramError> {
        self.acceleration(position, into)
    }

    /// Calculates the accelerations at positions with low parts below their rounding.
    ///
    /// # Errors
    /// As [`AccelerationField::acceleration`].
    fn precise_acceleration(
        &mut self,
        position: &StateColumns,
        low: &StateColumns,
        into: &mut StateColumns,
    ) -> Result<(), ProgramError>;

    /// Calculates the accelerations and their time derivatives, one per entry of `orders`, the acceleration first.
    ///
    /// # Errors
    /// As [`AccelerationField::acceleration`].
    fn derivatives(
        &mut self,
        position: &StateColumns,
        velocity: &StateColumns,
        orders: &mut [StateColumns],
    ) -> Result<(), ProgramError>;
}

/// Reason why a step was not made.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum IntegrationError {
    /// The field failed.
    #[error(transparent)]
    Field(#[from] ProgramError),
    /// The tolerance needs a step that the clock cannot resolve.
    #[error(
        "at time {time} the tolerance needs a step below {step}, which is less than the rounding of the time"
    )]
    Unresolved {
        /// Time at the beginning of the step (time).
        time: f64,
        /// Step (time).
        step: f64,
    },
}

/// Steps of an integrator whose steps adapt.
#[derive(Clone, Copy, Debug)]
pub struct AdaptiveSteps {
    /// Accepted steps since the start.
    pub(crate) accepted: u64,
    /// Rejected steps since the start.
    pub(crate) rejected: u64,
    /// Length of the shortest accepted step (time).
    pub(crate) shortest: f64,
    /// Tolerance of a step.
    pub(crate) tolerance: f64,
    /// Nearest pair at the ends of steps in the last output interval.
    pub(in crate::method::nbody) nearest: Option<NearestPair>,
}

/// Integrator of the equations of motion.
pub trait BodyIntegrator: Send {
    /// Advances the bodies by `dt` (time).
    ///
    /// # Errors
    /// [`IntegrationError`] of the field or of a step that cannot be resolved; bodies and scheme are then left within the step.
    fn step(
        &mut self,
        bodies: &mut PointMasses,
        dt: f64,
        field: &mut dyn AccelerationField,
    ) -> Result<(), IntegrationError>;

    /// Order of convergence: with n times as many steps the error at a fixed time is about n^order smaller.
    fn order(&self) -> u32;

    /// Values carried between steps that cannot be calculated from positions and velocities.
    fn carried_columns(&self) -> Vec<&StateColumns> {
        vec![]
    }

    /// Number of columns of [`carried_columns`](Self::carried_columns) after a step.
    fn carries(&self) -> usize {
        0
    }

    /// Restores the values of [`carried_columns`](Self::carried_columns), without padding; the bodies are already restored.
    fn take_up(&mut self, bodies: &PointMasses, carried: Vec<StateColumns>);

    /// Numbers carried between steps, by name.
    fn carried_numbers(&self) -> Vec<(&'static str, f64)> {
        vec![]
    }

    /// Restores the numbers of [`carried_numbers`](Self::carried_numbers), in their order.
    fn take_up_numbers(&mut self, _numbers: &[f64]) {}

    /// Checks that the present numbers are those of a state after some intervals of `dt` (time).
    ///
    /// # Errors
    /// A message if they are not.
    fn check_numbers(&self, _intervals: u64, _dt: f64) -> Result<(), String> {
        Ok(())
    }

    /// Low parts of the positions of the bodies, below their rounding; none if the scheme has none.
    fn position_low(&self) -> Option<&StateColumns> {
        None
    }

    /// Steps inside the intervals of `dt`; none if a step is `dt`.
    fn adaptive_steps(&self) -> Option<AdaptiveSteps> {
        None
    }

    /// True if the scheme dissipates energy on purpose.
    fn is_dissipative(&self) -> bool {
        false
    }
}

define_words! {
    /// Names of the integrators.
    pub enum SchemeName {
        /// PWP's scheme: velocities first, damped at every step, then positions.
        DampedEuler = "damped-euler",
        /// Explicit Euler, with the old velocities: shows how it fails.
        Euler = "euler",
        /// Explicit Euler with the ½ a dt² that PWP misses: shows that it is worse.
        EulerWithHalf = "euler-with-half",
        /// Kick, drift, kick.
        Leapfrog = "leapfrog",
        /// Three leapfrogs.
        Yoshida4 = "yoshida-4",
        /// Seven leapfrogs.
        Yoshida6 = "yoshida-6",
        /// Fifteen leapfrogs.
        Yoshida8 = "yoshida-8",
        /// The classical Runge–Kutta scheme.
        RungeKutta4 = "runge-kutta-4",
        /// Hermite scheme: predict, evaluate, correct with the jerk.
        Hermite4 = "hermite-4",
        /// Gear's six-value predictor and corrector, started exactly.
        Gear6 = "gear-6",
        /// Rein and Spiegel's integrator of order 15, whose steps adapt.
        Ias15 = "ias15",
    }
}

impl SchemeName {
    /// Creates the scheme; `damping` is the factor of the velocities at every step of PWP's scheme, `tolerance` that of steps that adapt.
    pub fn scheme(self, damping: f64, tolerance: f64) -> Box<dyn BodyIntegrator> {
        match self {
            SchemeName::DampedEuler => Box::new(DampedEuler::new(damping)),
            SchemeName::Euler => Box::new(Euler::new(0.0)),
            SchemeName::EulerWithHalf => Box::new(Euler::new(0.5)),
            SchemeName::Leapfrog => Box::new(ComposedLeapfrog::leapfrog()),
            SchemeName::Yoshida4 => Box::new(ComposedLeapfrog::yoshida_4()),
            SchemeName::Yoshida6 => Box::new(ComposedLeapfrog::yoshida_6()),
            SchemeName::Yoshida8 => Box::new(ComposedLeapfrog::yoshida_8()),
            SchemeName::RungeKutta4 => Box::new(RungeKutta::default()),
            SchemeName::Hermite4 => Box::new(Hermite::default()),
            SchemeName::Gear6 => Box::new(SixValueGear::default()),
            SchemeName::Ias15 => Box::new(Ias15::new(tolerance)),
        }
    }
}

impl SchemeName {
    /// True if steps adapt, and `dt` is an interval of output.
    pub fn is_adaptive(self) -> bool {
        self == SchemeName::Ias15
    }

    /// Numbers of three-axis quantities per body that a scheme stores, and that it carries between steps.
    pub fn stored_quantities(self) -> [usize; 2] {
        match self {
            SchemeName::DampedEuler | SchemeName::Euler | SchemeName::EulerWithHalf => [1, 0],
            SchemeName::Leapfrog | SchemeName::Yoshida4 | SchemeName::Yoshida6 | SchemeName::Yoshida8 => {
                [1, 1]
            }
            SchemeName::RungeKutta4 => [5, 0],
            SchemeName::Hermite4 => [6, 2],
            // Includes the Taylor series of its start.
            SchemeName::Gear6 => [12, 4],
            SchemeName::Ias15 => [44, 20],
        }
    }
}

/// Resizes columns to the entries of `bodies`.
fn resize_columns(columns: &mut StateColumns, bodies: &PointMasses) {
    for column in columns {
        column.resize(bodies.entries(), 0.0);
    }
}

/// Extends columns by the padding of the bodies.
fn padded(mut columns: StateColumns, bodies: &PointMasses) -> StateColumns {
    resize_columns(&mut columns, bodies);
    columns
}
