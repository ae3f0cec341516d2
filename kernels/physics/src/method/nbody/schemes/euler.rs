//! First-order schemes: PWP's damped Euler and the explicit Euler.

use super::{AccelerationField, BodyIntegrator, IntegrationError, PointMasses, StateColumns, resize_columns};
use crate::method::nbody::bodies::add;

/// PWP's scheme: v ← damping · (v + a dt), r ← r + v dt. With damping 1 it is symplectic: the energy error stays bounded.
///
/// # As printed
/// PWP says that the ½ a dt² is missing and that the scheme gains energy; neither is true. Damping below 1 acts at every step, as a
/// friction −ln(damping)/dt: the smaller dt, the sooner an orbit is lost.
#[derive(Clone, Debug)]
pub(crate) struct DampedEuler {
    damping: f64,
    acceleration: StateColumns,
}

impl DampedEuler {
    /// Creates the scheme with the factor of the velocities at every step.
    pub(crate) fn new(damping: f64) -> Self {
        DampedEuler { damping, acceleration: StateColumns::default() }
    }
}

impl BodyIntegrator for DampedEuler {
    fn step(
        &mut self,
        bodies: &mut PointMasses,
        dt: f64,
        field: &mut dyn AccelerationField,
    ) -> Result<(), IntegrationError> {
        resize_columns(&mut self.acceleration, bodies);
        field.acceleration(&bodies.position, &mut self.acceleration)?;
        add(&mut bodies.velocity, dt, &self.acceleration);
        bodies.velocity.iter_mut().flatten().for_each(|v| *v *= self.damping);
        let PointMasses { position, velocity, .. } = bodies;
        add(position, dt, velocity);
        Ok(())
    }

    fn order(&self) -> u32 {
        1
    }

    fn take_up(&mut self, _: &PointMasses, _: Vec<StateColumns>) {}

    fn is_dissipative(&self) -> bool {
        self.damping < 1.0
    }
}

/// Explicit Euler scheme: r ← r + v dt + share · a dt², v ← v + a dt, both with the values before the step. It gains energy.
#[derive(Clone, Debug)]
pub(crate) struct Euler {
    share: f64,
    acceleration: StateColumns,
}

impl Euler {
    /// Creates the scheme with a share of a dt² in the positions: 0 or ½.
    pub(crate) fn new(share: f64) -> Self {
        Euler { share, acceleration: StateColumns::default() }
    }
}

impl BodyIntegrator for Euler {
    fn step(
        &mut self,
        bodies: &mut PointMasses,
        dt: f64,
        field: &mut dyn AccelerationField,
    ) -> Result<(), IntegrationError> {
        resize_columns(&mut self.acceleration, bodies);
        field.acceleration(&bodies.position, &mut self.acceleration)?;
        let PointMasses { position, velocity, .. } = bodies;
        add(position, dt, velocity);
        add(position, self.share * dt * dt, &self.acceleration);
        add(velocity, dt, &self.acceleration);
        Ok(())
    }

    fn order(&self) -> u32 {
        1
    }

    fn take_up(&mut self, _: &PointMasses, _: Vec<StateColumns>) {}
}
