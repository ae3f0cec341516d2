//! Conserved quantities of the motion.

use super::bodies::PointMasses;

/// Sums over all bodies that gravity conserves.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct ConservedQuantities {
    /// Kinetic energy.
    pub kinetic: f64,
    /// Potential energy of the softened pairs.
    pub potential: f64,
    pub momentum: [f64; 3],
    /// Angular momentum about the origin.
    pub(crate) angular_momentum: [f64; 3],
    /// Centre of mass (length).
    pub centre: [f64; 3],
}

impl ConservedQuantities {
    /// Sums the quantities of bodies with this potential energy of the pairs.
    pub(super) fn of(bodies: &PointMasses, potential: f64) -> Self {
        let mut sums = ConservedQuantities { potential, ..ConservedQuantities::default() };
        let mut mass = 0.0;
        for body in 0..bodies.len() {
            let (m, [x, y, z], [u, v, w]) =
                (bodies.mass[body], bodies.position_of(body), bodies.velocity_of(body));
            mass += m;
            sums.kinetic += 0.5 * m * (u * u + v * v + w * w);
            let turn = [y * w - z * v, z * u - x * w, x * v - y * u];
            for axis in 0..3 {
                sums.momentum[axis] += m * [u, v, w][axis];
                sums.angular_momentum[axis] += m * turn[axis];
                sums.centre[axis] += m * [x, y, z][axis];
            }
        }
        sums.centre = sums.centre.map(|sum| sum / mass);
        sums
    }

    /// True if all sums are finite.
    pub(super) fn is_finite(&self) -> bool {
        let vectors = [self.momentum, self.angular_momentum, self.centre];
        vectors.iter().flatten().chain([&self.kinetic, &self.potential]).all(|sum| sum.is_finite())
    }

    /// Total energy.
    pub(super) fn energy(&self) -> f64 {
        self.kinetic + self.potential
    }
}
