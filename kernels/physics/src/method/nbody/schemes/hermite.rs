//! Fourth-order Hermite scheme with jerk: predict, evaluate, correct (Makino and Aarseth 1992).

use super::{
    AccelerationField, BodyIntegrator, IntegrationError, PointMasses, StateColumns, padded, resize_columns,
};
use crate::method::nbody::bodies::add;

/// Hermite scheme: one evaluation of acceleration and jerk per step, at the predicted positions.
#[derive(Clone, Debug, Default)]
pub(crate) struct Hermite {
    /// Acceleration and jerk at the beginning of the step.
    begin: [StateColumns; 2],
    /// Acceleration and jerk at the predicted end.
    end: [StateColumns; 2],
    position: StateColumns,
    velocity: StateColumns,
    is_known: bool,
}

impl BodyIntegrator for Hermite {
    fn step(
        &mut self,
        bodies: &mut PointMasses,
        dt: f64,
        field: &mut dyn AccelerationField,
    ) -> Result<(), IntegrationError> {
        self.begin.iter_mut().chain(&mut self.end).for_each(|columns| resize_columns(columns, bodies));
        if !self.is_known {
            field.derivatives(&bodies.position, &bodies.velocity, &mut self.begin)?;
            self.is_known = true;
        }
        let [a, j] = &self.begin;
        let PointMasses { position, velocity, .. } = bodies;
        self.position.clone_from(position);
        self.velocity.clone_from(velocity);
        add(&mut self.position, dt, velocity);
        add(&mut self.position, dt * dt / 2.0, a);
        add(&mut self.position, dt * dt * dt / 6.0, j);
        add(&mut self.velocity, dt, a);
        add(&mut self.velocity, dt * dt / 2.0, j);
        field.derivatives(&self.position, &self.velocity, &mut self.end)?;
        let [a_end, j_end] = &self.end;
        // The corrected position uses the mean of the old and the corrected velocity.
        add(position, dt / 2.0, velocity);
        add(velocity, dt / 2.0, a);
        add(velocity, dt / 2.0, a_end);
        add(velocity, dt * dt / 12.0, j);
        add(velocity, -dt * dt / 12.0, j_end);
        add(position, dt / 2.0, velocity);
        add(position, dt * dt / 12.0, a);
        add(position, -dt * dt / 12.0, a_end);
        std::mem::swap(&mut self.begin, &mut self.end);
        Ok(())
    }

    fn order(&self) -> u32 {
        4
    }

    fn carried_columns(&self) -> Vec<&StateColumns> {
        if self.is_known { self.begin.iter().collect() } else { vec![] }
    }

    fn carries(&self) -> usize {
        self.begin.len()
    }

    fn take_up(&mut self, bodies: &PointMasses, carried: Vec<StateColumns>) {
        self.is_known = !carried.is_empty();
        for (begin, columns) in self.begin.iter_mut().zip(carried) {
            *begin = padded(columns, bodies);
        }
    }
}
