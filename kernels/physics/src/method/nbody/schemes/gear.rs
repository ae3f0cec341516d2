//! Gear's six-value predictor and corrector for second-order equations.

use super::{
    AccelerationField, BodyIntegrator, IntegrationError, PointMasses, StateColumns, padded, resize_columns,
};
use crate::method::nbody::bodies::{add, zeros};
use stripmine_kernels::isa::ProgramError;

/// Number of values: q_k = dt^k/k! d^k r/dt^k.
const VALUES: usize = 6;

/// Corrector coefficients of the values, for forces independent of velocities.
const CORRECTOR: [f64; VALUES] = [3.0 / 20.0, 251.0 / 360.0, 1.0, 11.0 / 18.0, 1.0 / 6.0, 1.0 / 60.0];

/// Gear's scheme, started exactly: with zeros for the higher derivatives it would be of second order only.
#[derive(Clone, Debug, Default)]
pub(crate) struct SixValueGear {
    /// q_2 to q_5; q_0 and q_1 are position and velocity · dt.
    higher: Vec<StateColumns>,
    acceleration: StateColumns,
    is_known: bool,
}

impl SixValueGear {
    /// Initialises the higher values from the exact derivatives of the acceleration.
    fn start(
        &mut self,
        bodies: &PointMasses,
        dt: f64,
        field: &mut dyn AccelerationField,
    ) -> Result<(), ProgramError> {
        self.higher = (2..VALUES).map(|_| zeros(bodies.entries())).collect();
        field.derivatives(&bodies.position, &bodies.velocity, &mut self.higher)?;
        let mut scale = dt;
        for (k, columns) in (2..).zip(&mut self.higher) {
            scale *= dt / f64::from(k);
            columns.iter_mut().flatten().for_each(|q| *q *= scale);
        }
        Ok(())
    }
}

impl BodyIntegrator for SixValueGear {
    fn step(
        &mut self,
        bodies: &mut PointMasses,
        dt: f64,
        field: &mut dyn AccelerationField,
    ) -> Result<(), IntegrationError> {
        resize_columns(&mut self.acceleration, bodies);
        if !self.is_known {
            self.start(bodies, dt, field)?;
            self.is_known = true;
        }
        for axis in 0..3 {
            for n in 0..bodies.entries() {
                let mut q = [0.0; VALUES];
                q[0] = bodies.position[axis][n];
                q[1] = dt * bodies.velocity[axis][n];
                (2..VALUES).for_each(|k| q[k] = self.higher[k - 2][axis][n]);
                // Pascal's triangle.
                for first in 0..VALUES - 1 {
                    (first..VALUES - 1).rev().for_each(|k| q[k] += q[k + 1]);
                }
                bodies.position[axis][n] = q[0];
                bodies.velocity[axis][n] = q[1] / dt;
                (2..VALUES).for_each(|k| self.higher[k - 2][axis][n] = q[k]);
            }
        }
        field.acceleration(&bodies.position, &mut self.acceleration)?;
        let mut difference = self.acceleration.clone();
        for (difference, q) in difference.iter_mut().zip(&self.higher[0]) {
            difference.iter_mut().zip(q).for_each(|(a, q)| *a = 0.5 * dt * dt * *a - q);
        }
        add(&mut bodies.position, CORRECTOR[0], &difference);
        add(&mut bodies.velocity, CORRECTOR[1] / dt, &difference);
        for (k, columns) in (2..).zip(&mut self.higher) {
            add(columns, CORRECTOR[k], &difference);
        }
        Ok(())
    }

    fn order(&self) -> u32 {
        5
    }

    fn carried_columns(&self) -> Vec<&StateColumns> {
        self.higher.iter().collect()
    }

    fn carries(&self) -> usize {
        VALUES - 2
    }

    fn take_up(&mut self, bodies: &PointMasses, carried: Vec<StateColumns>) {
        self.is_known = !carried.is_empty();
        self.higher = carried.into_iter().map(|columns| padded(columns, bodies)).collect();
    }
}
