//! Distributions of single-disc properties: velocities and positions.

use super::discs::SampledDiscs;
use super::setting::StructureSetting;

/// Width of the bins of velocities, and their number: from −5 to 5.
const VELOCITIES: (f64, usize) = (0.1, 100);
/// Number of slices of the box along an axis.
const SLICES: usize = 100;

/// Centres of the bins of velocities.
pub(super) fn speeds(_: &StructureSetting) -> Vec<f64> {
    let (width, count) = VELOCITIES;
    (0..count).map(|bin| (bin as f64 + 0.5 - 0.5 * count as f64) * width).collect()
}

/// Computes the density of the components of v/√(kT/m), and their kurtosis, which is 3 for a Maxwell distribution.
pub(super) fn velocities(discs: &SampledDiscs, values: &mut [f64], weights: &mut [f64]) {
    let (width, count) = VELOCITIES;
    let components = 2.0 * discs.x.len() as f64;
    let moving = || discs.vx.iter().zip(&discs.vy).zip(&discs.mass);
    let temperature = moving().map(|((x, y), mass)| mass * (x * x + y * y)).sum::<f64>() / components;
    if temperature <= 0.0 {
        // Discs at rest have no distribution.
        weights.fill(0.0);
        return;
    }
    let mut counts = [0_u32; VELOCITIES.1];
    for ((x, y), mass) in moving() {
        let scale = (mass / temperature).sqrt();
        for v in [x * scale, y * scale] {
            let bin = v * (1.0 / width) + 0.5 * count as f64;
            if (0.0..count as f64).contains(&bin) {
                counts[bin as usize] += 1;
            }
            values[count] += v * v * v * v;
        }
    }
    values[count] /= components;
    values.iter_mut().zip(counts).for_each(|(value, count)| *value = f64::from(count) / (components * width));
}

/// Centres of slices of the box along an axis (length).
pub(super) fn slices<const AXIS: usize>(setting: &StructureSetting) -> Vec<f64> {
    let (origin, width) = (setting.domain.origin[AXIS], setting.domain.length(AXIS) / SLICES as f64);
    (0..SLICES).map(|slice| origin + (slice as f64 + 0.5) * width).collect()
}

/// Number of discs, mass, momentum and twice the kinetic energy in each slice. Discs above an open top are in none.
fn sums<const AXIS: usize>(setting: &StructureSetting, discs: &SampledDiscs) -> [[f64; 5]; SLICES] {
    let StructureSetting { domain, has_open_top, .. } = setting;
    let by_length = SLICES as f64 / domain.length(AXIS);
    let places = if AXIS == 0 { &discs.x } else { &discs.y };
    let mut sums = [[0.0; 5]; SLICES];
    for (disc, &place) in places.iter().enumerate() {
        let slice = ((place - domain.origin[AXIS]) * by_length) as usize;
        if AXIS == 1 && *has_open_top && slice >= SLICES {
            continue;
        }
        let (mass, [x, y]) = (discs.mass[disc], [discs.vx[disc], discs.vy[disc]]);
        let adds = [1.0, mass, mass * x, mass * y, mass * (x * x + y * y)];
        sums[slice.min(SLICES - 1)].iter_mut().zip(adds).for_each(|(sum, it)| *sum += it);
    }
    sums
}

/// Number density of discs (1/length²) in each slice. With an open top, slices along the floor extend to the highest centre and are weighted by
/// their area.
pub(super) fn density<const AXIS: usize>(
    setting: &StructureSetting,
    discs: &SampledDiscs,
    values: &mut [f64],
    weights: &mut [f64],
) {
    let StructureSetting { domain, has_open_top, .. } = setting;
    let mut area = domain.area();
    if AXIS == 0 && *has_open_top {
        let height = discs.y.iter().fold(0.0, |most: f64, y| most.max(y - domain.origin[1]));
        area = domain.length(0) * height;
        weights.fill(area);
    }
    let one = SLICES as f64 / area;
    values.iter_mut().zip(sums::<AXIS>(setting, discs)).for_each(|(value, [discs, ..])| *value = discs * one);
}

/// Velocity across the axis (length/time): Σmv/Σm, weighted by the mass in the slice; 0 without discs.
pub(super) fn flow<const AXIS: usize>(
    setting: &StructureSetting,
    discs: &SampledDiscs,
    values: &mut [f64],
    weights: &mut [f64],
) {
    let slices = values.iter_mut().zip(weights).zip(sums::<AXIS>(setting, discs));
    for ((value, weight), [_, mass, x, y, _]) in slices {
        let momentum = if AXIS == 0 { y } else { x };
        (*value, *weight) = if mass > 0.0 { (momentum / mass, mass) } else { (0.0, 0.0) };
    }
}

/// kT of both components relative to the flow of the slice, which removes one disc's degrees of freedom: Σm|v − u|²/(2(n − 1)), weighted by n − 1;
/// 0 for fewer than two discs.
pub(super) fn temperature<const AXIS: usize>(
    setting: &StructureSetting,
    discs: &SampledDiscs,
    values: &mut [f64],
    weights: &mut [f64],
) {
    let slices = values.iter_mut().zip(weights).zip(sums::<AXIS>(setting, discs));
    for ((value, weight), [discs, mass, x, y, square]) in slices {
        let freedoms = (discs - 1.0).max(0.0);
        (*value, *weight) = match freedoms > 0.0 {
            true => ((square - (x * x + y * y) / mass) / (2.0 * freedoms), freedoms),
            false => (0.0, 0.0),
        };
    }
}
