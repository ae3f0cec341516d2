//! Classical fourth-order Runge–Kutta scheme. Its energy drifts.

use super::{AccelerationField, BodyIntegrator, IntegrationError, PointMasses, StateColumns, resize_columns};
use crate::method::nbody::bodies::add;

/// Runge–Kutta scheme: four evaluations per step, no carried values.
#[derive(Clone, Debug, Default)]
pub(crate) struct RungeKutta {
    /// Accelerations of the four stages.
    stages: [StateColumns; 4],
    at: StateColumns,
}

impl BodyIntegrator for RungeKutta {
    fn step(
        &mut self,
        bodies: &mut PointMasses,
        dt: f64,
        field: &mut dyn AccelerationField,
    ) -> Result<(), IntegrationError> {
        self.stages.iter_mut().for_each(|stage| resize_columns(stage, bodies));
        let PointMasses { position, velocity, .. } = bodies;
        // Stage velocities are v + c dt a of the previous stage, so positions use a of the stage before that.
        for stage in 0..4 {
            let [c, before] = [[0.0, 0.0], [0.5, 0.0], [0.5, 0.25], [1.0, 0.5]][stage];
            self.at.clone_from(position);
            add(&mut self.at, c * dt, velocity);
            if stage >= 2 {
                add(&mut self.at, before * dt * dt, &self.stages[stage - 2]);
            }
            let (at, into) = (&self.at, &mut self.stages[stage]);
            field.acceleration(at, into)?;
        }
        add(position, dt, velocity);
        for (stage, [to_position, to_velocity]) in
            [[1.0, 1.0], [1.0, 2.0], [1.0, 2.0], [0.0, 1.0]].into_iter().enumerate()
        {
            add(position, to_position * dt * dt / 6.0, &self.stages[stage]);
            add(velocity, to_velocity * dt / 6.0, &self.stages[stage]);
        }
        Ok(())
    }

    fn order(&self) -> u32 {
        4
    }

    fn take_up(&mut self, _: &PointMasses, _: Vec<StateColumns>) {}
}
