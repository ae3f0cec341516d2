//! Pressure and collision rate of the equilibrium fluid against the packing fraction.

use crate::console::CommandFailure;
use crate::frame::{FrameBuilder, TableCell};
use crate::laboratory::running::RunningScene;
use crate::results::{FinishedItem, ProgressMeter, StudyEnvironment, StudySize};
use crate::statistics::MeanWithBar;
use crate::study::StudyError;
use std::f64::consts::PI;
use stripmine_physics::scene::{COUNT, Overrides, PACKING_FRACTION};

/// Reference up to a packing fraction of 0.5.
const VIRIAL: &str = "virial series, Padé [4/5] (Clisby and McCoy 2006)";
/// Reference for denser fluids, where the approximants of the series differ.
const LUDING: &str = "equation of state (Luding 2001)";
/// Compressibility at a packing fraction of 0.5; Padé approximants of other degrees differ by a relative 3·10⁻⁵.
pub(super) const Z_AT_HALF: f64 = 4.106_24;
/// Packing fractions with their reference compressibility and its origin.
const KNOWN: [(f64, f64, &str); 7] = [
    (0.10, 1.236_143_6, VIRIAL),
    (0.20, 1.570_366, VIRIAL),
    (0.30, 2.063_26, VIRIAL),
    (0.40, 2.829_32, VIRIAL),
    (0.50, Z_AT_HALF, VIRIAL),
    (0.60, 6.452_15, LUDING),
    (0.65, 8.408_52, LUDING),
];
/// Minimum number of discs.
const DISCS: u64 = 10_000;
/// Measured collisions.
const COLLISIONS: u64 = 10_000_000;
/// Blocks of a run; the error follows from the scatter and correlation of the block means.
const PARTS: u64 = 200;

/// Compressibility of the virial series at one of its packing fractions.
pub(super) fn virial_value(nu: f64) -> Option<f64> {
    KNOWN.iter().find(|(known, _, source)| *known == nu && *source == VIRIAL).map(|(_, z, _)| *z)
}

/// Luding's compressibility, Z = 1 + 2 ν g₄ with g₄ = g − ν³/(128 (1 − ν)⁴) and g = (1 − 7ν/16)/(1 − ν)².
pub(super) fn luding(nu: f64) -> f64 {
    let contact_value =
        (1.0 - 7.0 * nu / 16.0) / (1.0 - nu).powi(2) - nu.powi(3) / (128.0 * (1.0 - nu).powi(4));
    1.0 + 2.0 * nu * contact_value
}

/// Henderson's compressibility.
fn henderson(nu: f64) -> f64 {
    (1.0 + nu * nu / 8.0) / ((1.0 - nu) * (1.0 - nu))
}

/// Collisions of a disc per unit of time (diameter = m = kT = 1), from the virial theorem.
pub(super) fn collision_rate(compressibility: f64) -> f64 {
    4.0 * (compressibility - 1.0) / PI.sqrt()
}

/// Compressibility of discs, from the virial of their collisions in a time.
pub(super) fn compressibility(discs: f64, [virial, time]: [f64; 2], temperature: f64) -> f64 {
    1.0 + virial / (2.0 * discs * temperature * time)
}

/// Measures every packing fraction with a reference.
pub(crate) fn reproduce(lab: &StudyEnvironment<'_>, _: StudySize) -> Result<FinishedItem, CommandFailure> {
    let states = ProgressMeter::new(KNOWN.len() as f64, lab.progress)
        .run_cases_from_last(&KNOWN, |known| measure_state(known.0))?;
    let states = KNOWN.iter().zip(states);
    let off = |mean: MeanWithBar, known: f64| {
        let off = mean.relative_to(known).percent();
        TableCell::with_error(off.value, Some(off.bar), 2)
    };
    Ok(FinishedItem::of([
        FrameBuilder::of(states)
            .number("ν", 2, |((nu, ..), _)| *nu)
            .mean("Z", 4, |(_, (z, ..))| *z)
            .number("Z known", 4, |((_, known, _), _)| *known)
            .text("reference", |((.., reference), _)| *reference)
            .cell("off (%)", |((_, known, _), (z, ..))| off(*z, *known))
            .mean("ω", 4, |(_, (_, rate, _))| *rate)
            .number("ω known", 4, |((_, known, _), _)| collision_rate(*known))
            .cell("off (%)", |((_, known, _), (_, rate, _))| off(*rate, collision_rate(*known)))
            .number("Henderson's Z", 4, |((nu, ..), _)| henderson(*nu))
            .number("Luding's Z", 4, |((nu, ..), _)| luding(*nu))
            .short("energy error", |(_, (.., energy_error))| *energy_error)
            .frame(
                "fluid",
                "Compressibility and collisions of a disc in a unit of time (diameter = m = kT = 1)",
            ),
        FrameBuilder::of((1..=68).map(|at| 0.01 * f64::from(at)))
            .number("packing fraction ν", 2, |nu| *nu)
            .number("compressibility Z", 4, |nu| luding(*nu))
            .frame("luding", "Luding's equation of state"),
    ])
    .with_seeds([1]))
}

/// Compressibility, collision rate, and the relative change of the kinetic energy.
fn measure_state(packing_fraction: f64) -> Result<(MeanWithBar, MeanWithBar, f64), StudyError> {
    let overrides = Overrides::new().set(&PACKING_FRACTION, packing_fraction).set(&COUNT, DISCS);
    let mut fluid = RunningScene::begin("hard-disks", &overrides)?;
    let discs = fluid.simulation.particles().grain_count() as f64;
    // The initial lattice melts within some tens of collisions per disc.
    fluid.advance_events((100.0 * discs) as u64)?;
    let names = ["time", "virial", "collisions", "temperature", "energy_error"];
    let mut before = fluid.observed_values(names)?;
    let (mut pressures, mut rates) = (vec![], vec![]);
    for _ in 0..PARTS {
        fluid.advance_events(COLLISIONS / PARTS)?;
        let after = fluid.observed_values(names)?;
        let [time, virial, collisions] = [0, 1, 2].map(|which| after[which] - before[which]);
        let temperature = after[3];
        pressures.push(compressibility(discs, [virial, time], temperature));
        rates.push(2.0 * collisions / (discs * time * temperature.sqrt()));
        before = after;
    }
    Ok((MeanWithBar::of_time_series(&pressures), MeanWithBar::of_time_series(&rates), before[4]))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Virial series with coefficients B₂ … B₁₀ over powers of B₂ (Clisby and McCoy 2006, table 1); the first three are exact.
    fn virial_series(nu: f64) -> f64 {
        let third = 4.0 / 3.0 - 3f64.sqrt() / PI;
        let fourth = 2.0 - 4.5 * 3f64.sqrt() / PI + 10.0 / (PI * PI);
        let numerical = [0.333_556_04, 0.198_842_5, 0.114_872_8, 0.064_993, 0.036_219_3, 0.019_953_7];
        let all = [1.0, 1.0, third, fourth].into_iter().chain(numerical);
        all.zip(0..).map(|(coefficient, power)| coefficient * (2.0 * nu).powi(power)).sum()
    }

    #[test]
    fn references_agree_with_series_and_equations_of_state() {
        for ((nu, z, _), within) in KNOWN.into_iter().zip([1e-7, 2e-6, 5e-5, 8e-4]) {
            assert!((virial_series(nu) / z - 1.0).abs() < within, "{nu}");
        }
        for (nu, z, reference) in KNOWN {
            let within = if reference == LUDING { 1e-6 } else { 8e-4 };
            assert!((luding(nu) / z - 1.0).abs() < within, "{nu}");
            assert!((henderson(nu) / z - 1.0).abs() < 0.025, "{nu}");
        }
    }
}
