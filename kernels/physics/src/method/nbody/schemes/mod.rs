//! Integrators of bodies, one file each. State is positions and velocities; what a scheme carries beside them is its own.

mod composed;
mod euler;
mod gear;
mod hermite;
mod runge_kutta;

use super::bodies::{Bodies, Columns};
use crate::words::define_words;
use stripmine_kernels::isa::ProgramError;

pub(crate) use composed::Composed;
pub(crate) use euler::{DampedEuler, Euler};
pub(crate) use gear::Gear;
pub(crate) use hermite::Hermite;
pub(crate) use runge_kutta::RungeKutta;

/// What bodies do to each other, as far as a scheme asks.
pub trait Field {
    /// Accelerations of bodies at these positions (length/time²).
    ///
    /// # Errors
    /// [`ProgramError`] if the processor lacks what is asked for, or it was interrupted.
    fn acceleration(&mut self, position: &Columns, into: &mut Columns) -> Result<(), ProgramError>;

    /// The same at the positions that a step ends with, whose energy may be wanted next.
    ///
    /// # Errors
    /// As [`Field::acceleration`].
    fn last_acceleration(&mut self, position: &Columns, into: &mut Columns) -> Result<(), ProgramError> {
        self.acceleration(position, into)
    }

    /// Accelerations and their time derivatives, as many as `orders` has room for, the acceleration first.
    ///
    /// # Errors
    /// As [`Field::acceleration`].
    fn derivatives(
        &mut self,
        position: &Columns,
        velocity: &Columns,
        orders: &mut [Columns],
    ) -> Result<(), ProgramError>;
}

/// An integrator.
pub trait Scheme: Send {
    /// Advances the bodies by `dt` (time).
    ///
    /// # Errors
    /// [`ProgramError`] of the field; bodies and scheme are then somewhere in the step.
    fn step(&mut self, bodies: &mut Bodies, dt: f64, field: &mut dyn Field) -> Result<(), ProgramError>;

    /// The order of convergence: with n times as many steps the error at a fixed time is about n^order smaller.
    fn order(&self) -> u32;

    /// What is carried from step to step beside positions and velocities and cannot be had from them.
    fn carried(&self) -> Vec<&Columns> {
        vec![]
    }

    /// How many columns [`carried`](Self::carried) gives after a step.
    fn carries(&self) -> usize {
        0
    }

    /// Takes up what [`carried`](Self::carried) gave, without the padding; the bodies are those of that moment already.
    fn take_up(&mut self, bodies: &Bodies, carried: Vec<Columns>);

    /// Whether it takes energy out on purpose.
    fn drains(&self) -> bool {
        false
    }
}

define_words! {
    /// Integrators by name.
    pub enum SchemeName {
        /// The source's: velocities first, damped at every step, then positions.
        DampedEuler = "damped-euler",
        /// Positions by the old velocities: to show how it fails.
        Euler = "euler",
        /// Euler with the ½ a dt² that the source misses: to show that it is worse.
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
        /// Predicted, evaluated, corrected with the jerk.
        Hermite4 = "hermite-4",
        /// Gear's predictor and corrector with six values, started exactly.
        Gear6 = "gear-6",
    }
}

impl SchemeName {
    /// The scheme; `damping` is what velocities are multiplied by at every step of the source's.
    pub fn scheme(self, damping: f64) -> Box<dyn Scheme> {
        match self {
            SchemeName::DampedEuler => Box::new(DampedEuler::new(damping)),
            SchemeName::Euler => Box::new(Euler::new(0.0)),
            SchemeName::EulerWithHalf => Box::new(Euler::new(0.5)),
            SchemeName::Leapfrog => Box::new(Composed::leapfrog()),
            SchemeName::Yoshida4 => Box::new(Composed::yoshida_4()),
            SchemeName::Yoshida6 => Box::new(Composed::yoshida_6()),
            SchemeName::Yoshida8 => Box::new(Composed::yoshida_8()),
            SchemeName::RungeKutta4 => Box::new(RungeKutta::default()),
            SchemeName::Hermite4 => Box::new(Hermite::default()),
            SchemeName::Gear6 => Box::new(Gear::default()),
        }
    }
}

impl SchemeName {
    /// Quantities along three axes that a scheme holds for every body, and those of them that it carries from step to step.
    pub fn held(self) -> [usize; 2] {
        match self {
            SchemeName::DampedEuler | SchemeName::Euler | SchemeName::EulerWithHalf => [1, 0],
            SchemeName::Leapfrog | SchemeName::Yoshida4 | SchemeName::Yoshida6 | SchemeName::Yoshida8 => {
                [1, 1]
            }
            SchemeName::RungeKutta4 => [5, 0],
            SchemeName::Hermite4 => [6, 2],
            // Its start takes paths and what else is found of them.
            SchemeName::Gear6 => [12, 4],
        }
    }
}

/// Columns as long as those of `bodies`, made where they are not there yet.
fn room(columns: &mut Columns, bodies: &Bodies) {
    for column in columns {
        column.resize(bodies.entries(), 0.0);
    }
}

/// Columns with room for the padding of the bodies.
fn padded(mut columns: Columns, bodies: &Bodies) -> Columns {
    room(&mut columns, bodies);
    columns
}
