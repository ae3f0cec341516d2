//! Pressure and collision rate of the equilibrium fluid, over the packing fraction.

use crate::laboratory::running::Running;
use crate::results::{Meter, Progress};
use crate::study::StudyError;
use serde::Serialize;
use stripmine_physics::scene::{COUNT, Overrides, PACKING_FRACTION};

pub use crate::statistics::Mean;

/// Packing fraction, Z, and collisions of a disc in a unit of time (diameter = m = kT = 1), measured by two independent codes with
/// 250 000 discs, good to about 0.1 %.
pub const KNOWN: [[f64; 3]; 7] = [
    [0.10, 1.2359, 0.5328],
    [0.20, 1.5704, 1.287],
    [0.30, 2.0632, 2.3995],
    [0.40, 2.829, 4.130],
    [0.50, 4.1094, 7.017],
    [0.60, 6.455, 12.30],
    [0.65, 8.41, 16.72],
];

/// Parts of a run, each a measurement; their scatter and correlation give the error.
const PARTS: u64 = 200;

/// How much is measured.
#[derive(Clone, Copy, Debug)]
pub struct Effort {
    /// Discs, at least.
    pub discs: u64,
    /// Collisions that are measured.
    pub collisions: u64,
}

/// A fluid.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct State {
    /// Area of the discs over that of the box.
    pub packing_fraction: f64,
    /// p A/(N kT), from the virial of the collisions.
    pub compressibility: Mean,
    /// Collisions of a disc in a unit of time, at kT = 1.
    pub rate: Mean,
    /// The kinetic energy at the end less that at the start, over the latter.
    pub energy_error: f64,
    /// What other programs have measured: Z and the rate.
    pub known: [f64; 2],
}

/// Every fluid.
#[derive(Clone, Debug, Serialize)]
pub struct Fluids {
    /// Discs.
    pub discs: u64,
    /// Collisions measured at each packing fraction.
    pub collisions: u64,
    /// The fluids.
    pub states: Vec<State>,
}

impl State {
    /// By how much it is off what is known, relative to that: Z and the rate.
    pub fn off(&self) -> [Mean; 2] {
        [self.compressibility.off(self.known[0]), self.rate.off(self.known[1])]
    }
}

/// Henderson's compressibility of the fluid.
pub fn henderson(packing_fraction: f64) -> f64 {
    let nu = packing_fraction;
    (1.0 + nu * nu / 8.0) / ((1.0 - nu) * (1.0 - nu))
}

/// Luding's, Z = 1 + 2 ν g₄ with g₄ = g − ν³/(128 (1 − ν)⁴) and g = (1 − 7ν/16)/(1 − ν)².
pub fn luding(packing_fraction: f64) -> f64 {
    let nu = packing_fraction;
    let contact_value =
        (1.0 - 7.0 * nu / 16.0) / (1.0 - nu).powi(2) - nu.powi(3) / (128.0 * (1.0 - nu).powi(4));
    1.0 + 2.0 * nu * contact_value
}

/// Measures every packing fraction that is known.
///
/// # Errors
/// [`StudyError`] if a scene breaks.
pub fn fluids(effort: &Effort, progress: Progress<'_>) -> Result<Fluids, StudyError> {
    let meter = Meter::new(KNOWN.len() as f64, progress);
    let states = meter
        .each_from_last(&KNOWN, |&[packing_fraction, z, rate]| state(packing_fraction, [z, rate], effort))?;
    Ok(Fluids { discs: effort.discs, collisions: effort.collisions, states })
}

fn state(packing_fraction: f64, known: [f64; 2], effort: &Effort) -> Result<State, StudyError> {
    let overrides = Overrides::new().set(&PACKING_FRACTION, packing_fraction).set(&COUNT, effort.discs);
    let mut fluid = Running::begin("hard-disks", &overrides)?;
    let discs = fluid.simulation.particles().grain_count() as f64;
    // The lattice of the start melts within some tens of collisions of each disc.
    fluid.events((100.0 * discs) as u64)?;
    let names = ["time", "virial", "collisions", "temperature", "energy_error"];
    let mut before = fluid.observed(names)?;
    let (mut pressures, mut rates) = (vec![], vec![]);
    for _ in 0..PARTS {
        fluid.events(effort.collisions / PARTS)?;
        let after = fluid.observed(names)?;
        let [time, virial, collisions] = [0, 1, 2].map(|which| after[which] - before[which]);
        let temperature = after[3];
        pressures.push(1.0 + virial / (2.0 * discs * temperature * time));
        rates.push(2.0 * collisions / (discs * time * temperature.sqrt()));
        before = after;
    }
    Ok(State {
        packing_fraction,
        compressibility: Mean::of_course(&pressures),
        rate: Mean::of_course(&rates),
        energy_error: before[4],
        known,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Both equations of state are those of the table to their own accuracy.
    #[test]
    fn equations_of_state_agree_with_what_is_known() {
        for [packing_fraction, z, rate] in KNOWN {
            assert!((luding(packing_fraction) / z - 1.0).abs() < 0.006, "{packing_fraction}");
            assert!((henderson(packing_fraction) / z - 1.0).abs() < 0.025, "{packing_fraction}");
            // ω = 4 (Z − 1)/√π.
            let of_z = 4.0 * (z - 1.0) / std::f64::consts::PI.sqrt();
            assert!((of_z / rate - 1.0).abs() < 0.002, "{packing_fraction}: {of_z}");
        }
    }
}
