//! Temperature and energy error: the definitions shared by all methods.

use crate::domain::Domain;

/// Motion along one axis, summed over particles.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct AxisMotion {
    /// Σ m v² (energy).
    pub(crate) twice_kinetic: f64,
    /// Σ m v (mass · length/time).
    pub momentum: f64,
}

/// Temperature kT by equipartition: Σ m v² over the thermal degrees of freedom.
///
/// Along an axis whose momentum is `conserved` (see [`conserved_axes`]) the mean motion is not thermal: it is subtracted and `count` − 1 degrees of
/// freedom are left; along the others there are `count`. `mass` is that of all particles. Without a degree of freedom (a single particle in a
/// periodic box) the value is NaN.
pub(crate) fn temperature(motion: [AxisMotion; 2], conserved: [bool; 2], mass: f64, count: f64) -> f64 {
    let (mut heat, mut freedoms) = (0.0, 0.0);
    for (AxisMotion { twice_kinetic, momentum }, conserved) in motion.into_iter().zip(conserved) {
        heat += twice_kinetic - if conserved { momentum * momentum / mass } else { 0.0 };
        freedoms += if conserved { count - 1.0 } else { count };
    }
    if freedoms > 0.0 { heat.max(0.0) / freedoms } else { f64::NAN }
}

/// Axes along which particles without a bath conserve their mean motion: the periodic ones. A closed side transfers momentum to the box.
pub(crate) fn conserved_axes(domain: &Domain) -> [bool; 2] {
    domain.periodic()
}

/// Error of the energy relative to the scale of the initial energies.
///
/// `change` is the total energy (kinetic and every potential term) minus its initial value and minus the work done on the particles since. The
/// scale is the larger of |E| and the kinetic energy at the start, so it does not vanish where E does (two bodies on a parabola). If both vanish,
/// it is the present kinetic energy.
pub(crate) fn relative_energy_error(change: f64, start: f64, kinetic_at_start: f64, kinetic: f64) -> f64 {
    let scale = start.abs().max(kinetic_at_start);
    match (scale > 0.0, kinetic > 0.0) {
        (true, _) => change / scale,
        (false, true) => change / kinetic,
        (false, false) => change,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Hand calculation: masses 1 and 3 with velocities (1, 2) and (−1, 0); Σ m v² = (4, 4), Σ m v = (−2, 2).
    #[test]
    fn temperature_counts_thermal_degrees_of_freedom() {
        let motion = [
            AxisMotion { twice_kinetic: 4.0, momentum: -2.0 },
            AxisMotion { twice_kinetic: 4.0, momentum: 2.0 },
        ];
        assert_eq!(temperature(motion, [false; 2], 4.0, 2.0), 2.0);
        assert_eq!(temperature(motion, [true; 2], 4.0, 2.0), 3.0);
        assert_eq!(temperature(motion, [true, false], 4.0, 2.0), (3.0 + 4.0) / 3.0);
        let single = [AxisMotion { twice_kinetic: 4.0, momentum: 2.0 }; 2];
        assert!(temperature(single, [true; 2], 1.0, 1.0).is_nan());
        assert_eq!(temperature(single, [true, false], 1.0, 1.0), 4.0);
    }

    #[test]
    fn energy_errors_have_a_nonzero_scale() {
        assert_eq!(relative_energy_error(0.1, -2.0, 1.0, 3.0), 0.05);
        assert_eq!(relative_energy_error(3e-8, 5.6e-17, 0.06, 0.01), 3e-8 / 0.06);
        assert_eq!(relative_energy_error(1e-3, 0.0, 0.0, 0.5), 2e-3);
        assert_eq!(relative_energy_error(0.0, 0.0, 0.0, 0.0), 0.0);
    }
}
