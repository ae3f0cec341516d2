//! Step matrix of a scheme on a spring and damper, and the largest step at which its powers do not grow.

use crate::method::lattice_md::model::{GearValues, GranularScheme};
use stripmine_kernels::integrator::gear::{Acceleration, Gear};
use stripmine_kernels::integrator::single::SingleFreedom;
use stripmine_kernels::integrator::velocity_verlet::VelocityVerlet;
use stripmine_kernels::integrator::{self, DERIVATIVES};

/// Step matrix, sized for the scheme with the most values.
type StepMatrix = [[f64; DERIVATIVES]; DERIVATIVES];

/// Gain of a disturbance during half a period of the spring above which errors count as growing.
const GAIN: f64 = 0.1;
/// Squarings of the matrix: its power is two to this.
const SQUARINGS: i32 = 40;
/// Rounding error of a factor 1.
const ROUNDING: f64 = 1e-9;
/// Bisections of a limit.
const BISECTIONS: u32 = 50;

/// Returns the spectral radius of the step matrix of x″ = −ω² x − γ x′; `spring` is (ω dt)², `damper` γ dt.
pub(crate) fn spectral_radius(scheme: GranularScheme, spring: f64, damper: f64) -> f64 {
    let kind = if damper == 0.0 { Acceleration::OfPositions } else { Acceleration::OfVelocities };
    match scheme {
        GranularScheme::Gear(GearValues::Four) => {
            radius_of(Gear::<4>::new(kind), scheme.values(), spring, damper)
        }
        GranularScheme::Gear(GearValues::Five) => {
            radius_of(Gear::<5>::new(kind), scheme.values(), spring, damper)
        }
        GranularScheme::Gear(GearValues::Six) => {
            radius_of(Gear::<6>::new(kind), scheme.values(), spring, damper)
        }
        GranularScheme::VelocityVerlet => radius_of(VelocityVerlet, scheme.values(), spring, damper),
    }
}

/// Returns the spectral radius for a scheme that carries `values` derivatives.
fn radius_of<C: integrator::Scheme>(scheme: C, values: usize, spring: f64, damper: f64) -> f64 {
    let mut matrix = [[0.0; DERIVATIVES]; DERIVATIVES];
    // Transposed, with the same eigenvalues.
    for (unit, image) in matrix.iter_mut().enumerate().take(values) {
        let mut single = SingleFreedom::new(scheme, 1.0);
        single.row[unit] = 1.0;
        single.step(|position, velocity| -spring * position - damper * velocity);
        image[..values].copy_from_slice(&single.row[..values]);
    }
    largest_eigenvalue(matrix)
}

/// Computed from the norm of a high power: ‖A^n‖^(1/n).
fn largest_eigenvalue(mut matrix: StepMatrix) -> f64 {
    let mut logarithm = 0.0;
    for squaring in 0..SQUARINGS {
        let norm = matrix.iter().flatten().fold(0.0, |norm: f64, entry| norm.max(entry.abs()));
        if norm == 0.0 {
            return 0.0;
        }
        if !norm.is_finite() {
            return f64::INFINITY;
        }
        logarithm += libm::log(norm) * 0.5f64.powi(squaring);
        matrix.iter_mut().flatten().for_each(|entry| *entry /= norm);
        matrix = squared(&matrix);
    }
    libm::exp(logarithm)
}

fn squared(matrix: &StepMatrix) -> StepMatrix {
    let product =
        |row: usize, column: usize| (0..DERIVATIVES).map(|k| matrix[row][k] * matrix[k][column]).sum();
    std::array::from_fn(|row| std::array::from_fn(|column| product(row, column)))
}

/// Returns the largest step (time) at which errors do not grow on a spring of frequency² `spring` (1/time²) and a damper of rate `damper` (1/time).
/// Growth means more than a tenth within half a period of the spring, or at all without a spring. None without spring and damper.
pub(crate) fn largest_step(scheme: GranularScheme, spring: f64, damper: f64) -> Option<f64> {
    let frequency = spring.sqrt().max(damper);
    if frequency.is_nan() || frequency <= 0.0 || frequency.is_infinite() {
        return None;
    }
    let grows = |scaled: f64| {
        let dt = scaled / frequency;
        let radius = spectral_radius(scheme, spring * dt * dt, damper * dt);
        let half_period = std::f64::consts::PI / (spring.sqrt() * dt);
        if half_period.is_infinite() {
            radius > 1.0 + ROUNDING
        } else {
            radius.powf(half_period.max(1.0)) > 1.0 + GAIN
        }
    };
    // Increase the step until errors grow; no scheme is stable beyond a few radians.
    let mut high = 1.0 / 64.0;
    while !grows(high) {
        high *= 1.0625;
        if high > 64.0 {
            return None;
        }
    }
    let mut low = high / 1.0625;
    for _ in 0..BISECTIONS {
        let middle = 0.5 * (low + high);
        *(if grows(middle) { &mut high } else { &mut low }) = middle;
    }
    Some(low / frequency)
}

#[cfg(test)]
mod tests {
    use super::*;
    use stripmine_kernels::backend::Registers;
    use stripmine_kernels::integrator::Context;

    const GEAR: [GranularScheme; 3] = [
        GranularScheme::Gear(GearValues::Four),
        GranularScheme::Gear(GearValues::Five),
        GranularScheme::Gear(GearValues::Six),
    ];

    #[test]
    fn velocity_verlet_limit_is_two_radians() {
        for below in [0.1, 1.0, 1.9] {
            let radius = spectral_radius(GranularScheme::VelocityVerlet, below * below, 0.0);
            assert!((radius - 1.0).abs() < 1e-8, "{radius}");
        }
        assert!(spectral_radius(GranularScheme::VelocityVerlet, 2.1 * 2.1, 0.0) > 1.1);
        let limit = largest_step(GranularScheme::VelocityVerlet, 4.0, 0.0).unwrap();
        assert!((limit - 1.0).abs() < 0.01, "{limit}");
    }

    /// On a spring alone, the eigenvalues of velocity Verlet are the roots of λ² − (2 − ω² dt²) λ + 1.
    #[test]
    fn radii_match_the_characteristic_polynomial() {
        for spring in [4.5f64, 6.0, 10.0] {
            let half = 1.0 - 0.5 * spring;
            let expected = half.abs() + (half * half - 1.0).sqrt();
            let radius = spectral_radius(GranularScheme::VelocityVerlet, spring, 0.0);
            assert!((radius / expected - 1.0).abs() < 1e-9, "{radius} {expected}");
        }
    }

    /// Limits are 6/11, 3/10 and, measured in runs, 0.163.
    #[test]
    fn drag_limits_match_measurements() {
        for (scheme, measured) in GEAR.into_iter().zip([6.0 / 11.0, 0.3, 0.1633]) {
            let limit = largest_step(scheme, 0.0, 1.0).unwrap();
            assert!((limit - measured).abs() < 1e-4, "{scheme:?} {limit}");
        }
    }

    /// Scheme with a wrong coefficient.
    #[derive(Clone, Copy)]
    struct WrongScheme;

    impl integrator::Scheme for WrongScheme {
        const CARRIED: usize = 4;

        fn scales(dt: f64) -> [f64; DERIVATIVES] {
            <Gear<4> as integrator::Scheme>::scales(dt)
        }

        fn begin<R: Registers>(
            &self,
            context: &Context<R>,
            row: &mut [R::V; DERIVATIVES],
            acceleration: R::V,
        ) {
            integrator::Scheme::begin(&right(), context, row, acceleration);
        }

        fn correct<R: Registers>(
            &self,
            context: &Context<R>,
            row: &mut [R::V; DERIVATIVES],
            acceleration: R::V,
        ) {
            let before = *row;
            integrator::Scheme::correct(&right(), context, row, acceleration);
            // Corrects the acceleration three times as much as it should.
            let once = row[2] - before[2];
            row[2] = row[2] + once + once;
        }

        fn predict<R: Registers>(&self, context: &Context<R>, row: &mut [R::V; DERIVATIVES]) {
            integrator::Scheme::predict(&right(), context, row);
        }
    }

    fn right() -> Gear<4> {
        Gear::new(Acceleration::OfPositions)
    }

    #[test]
    fn wrong_coefficient_is_detected() {
        let radius = radius_of(right(), 4, 0.01, 0.0);
        assert!(radius < 1.001, "{radius}");
        let radius = radius_of(WrongScheme, 4, 0.01, 0.0);
        assert!(radius > 1.5, "{radius}");
    }
}
