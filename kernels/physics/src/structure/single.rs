//! Distributions of what each disc has alone: velocities and places.

use super::setting::Setting;
use crate::particles::Particle;

/// Width of the bins of velocities, and their number: from −5 to 5.
const VELOCITIES: (f64, usize) = (0.1, 100);
/// Slices of the box along an axis.
const SLICES: usize = 100;

/// The middles of the bins of velocities.
pub(super) fn speeds(_: &Setting) -> Vec<f64> {
    let (width, count) = VELOCITIES;
    (0..count).map(|bin| (bin as f64 + 0.5 - 0.5 * count as f64) * width).collect()
}

/// The density of the components of v/√(kT/m), and their kurtosis, which is 3 by Maxwell.
pub(super) fn velocities(_: &Setting, discs: &[Particle]) -> Vec<f64> {
    let (width, count) = VELOCITIES;
    let square = |[x, y]: [f64; 2]| x * x + y * y;
    let components = 2.0 * discs.len() as f64;
    let temperature =
        discs.iter().map(|disc| disc.mass * square(disc.planar_velocity())).sum::<f64>() / components;
    let mut values = vec![0.0; count + 1];
    if temperature <= 0.0 {
        return values;
    }
    for disc in discs {
        let scale = (disc.mass / temperature).sqrt();
        for v in disc.planar_velocity().map(|v| v * scale) {
            let bin = v / width + 0.5 * count as f64;
            if (0.0..count as f64).contains(&bin) {
                values[bin as usize] += 1.0 / (components * width);
            }
            values[count] += v * v * v * v / components;
        }
    }
    values
}

/// The middles of slices of the box along an axis (length).
pub(super) fn slices(setting: &Setting, axis: usize) -> Vec<f64> {
    let (origin, width) = (setting.domain.origin[axis], setting.domain.length(axis) / SLICES as f64);
    (0..SLICES).map(|slice| origin + (slice as f64 + 0.5) * width).collect()
}

/// Centres of discs by area (1/length²) in each of these slices.
pub(super) fn density(setting: &Setting, discs: &[Particle], axis: usize) -> Vec<f64> {
    let (origin, length) = (setting.domain.origin[axis], setting.domain.length(axis));
    let one = SLICES as f64 / setting.domain.area();
    let mut values = vec![0.0; SLICES];
    for disc in discs {
        let slice = (disc.position[axis] - origin) / length * SLICES as f64;
        values[(slice as usize).min(SLICES - 1)] += one;
    }
    values
}
