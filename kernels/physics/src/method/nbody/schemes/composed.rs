//! Leapfrog, and its compositions of higher order (Yoshida 1990). All are symplectic and reversible.

use super::{
    AccelerationField, BodyIntegrator, IntegrationError, PointMasses, StateColumns, padded, resize_columns,
};
use crate::method::nbody::bodies::add;

/// Sequence of leapfrogs (kick, drift, kick), each over a fraction of the step.
#[derive(Clone, Debug)]
pub(crate) struct ComposedLeapfrog {
    order: u32,
    /// Fractions of the step; their sum is 1.
    parts: Vec<f64>,
    acceleration: StateColumns,
    /// True if the acceleration belongs to the current positions.
    is_known: bool,
}

impl ComposedLeapfrog {
    /// Composes a scheme from the fractions on either side of the middle one, listed outwards.
    fn new(order: u32, outwards: &[f64]) -> Self {
        let middle = 1.0 - 2.0 * outwards.iter().sum::<f64>();
        let parts = outwards.iter().rev().copied().chain([middle]).chain(outwards.iter().copied()).collect();
        ComposedLeapfrog { order, parts, acceleration: StateColumns::default(), is_known: false }
    }

    /// Leapfrog, second order.
    pub(crate) fn leapfrog() -> Self {
        ComposedLeapfrog::new(2, &[])
    }

    /// Fourth order.
    pub(crate) fn yoshida_4() -> Self {
        ComposedLeapfrog::new(4, &[1.0 / (2.0 - libm::cbrt(2.0))])
    }

    /// Sixth order, Yoshida's solution A.
    pub(crate) fn yoshida_6() -> Self {
        ComposedLeapfrog::new(6, &[-1.177_679_984_178_87, 0.235_573_213_359_357, 0.784_513_610_477_56])
    }

    /// Eighth order, Yoshida's solution D.
    pub(crate) fn yoshida_8() -> Self {
        let outwards = [
            0.102_799_849_391_985,
            -1.960_610_232_975_49,
            1.938_139_137_622_76,
            -0.158_240_635_368_243,
            -1.444_852_236_860_48,
            0.253_693_336_566_229,
            0.914_844_246_229_74,
        ];
        ComposedLeapfrog::new(8, &outwards)
    }
}

impl BodyIntegrator for ComposedLeapfrog {
    fn step(
        &mut self,
        bodies: &mut PointMasses,
        dt: f64,
        field: &mut dyn AccelerationField,
    ) -> Result<(), IntegrationError> {
        resize_columns(&mut self.acceleration, bodies);
        let PointMasses { position, velocity, .. } = bodies;
        if !self.is_known {
            field.acceleration(position, &mut self.acceleration)?;
            self.is_known = true;
        }
        for (number, part) in self.parts.iter().enumerate() {
            let h = part * dt;
            add(velocity, 0.5 * h, &self.acceleration);
            add(position, h, velocity);
            if number + 1 < self.parts.len() {
                field.acceleration(position, &mut self.acceleration)?;
            } else {
                field.last_acceleration(position, &mut self.acceleration)?;
            }
            add(velocity, 0.5 * h, &self.acceleration);
        }
        Ok(())
    }

    fn order(&self) -> u32 {
        self.order
    }

    fn carried_columns(&self) -> Vec<&StateColumns> {
        // Recalculating it would give the same bits, but needs another sweep.
        if self.is_known { vec![&self.acceleration] } else { vec![] }
    }

    fn carries(&self) -> usize {
        1
    }

    fn take_up(&mut self, bodies: &PointMasses, carried: Vec<StateColumns>) {
        self.is_known = !carried.is_empty();
        if let Some(acceleration) = carried.into_iter().next() {
            self.acceleration = padded(acceleration, bodies);
        }
    }
}
