//! The energy of undamped discs without friction: what is lost or gained is the integrator's or the digits' doing.

use super::gas::{Gas, SEEDS, place};
use crate::laboratory::lattice_md::study::StudyError;
use crate::results::{Meter, Progress};
use crate::statistics::{Spread, slope};
use serde::Serialize;
use std::ops::Range;
use stripmine_physics::method::lattice_md::keys::{
    ENGINE, FRICTION, INTEGRATOR, NORMAL_DAMPING, SHEAR_DAMPING, VALUES,
};
use stripmine_physics::method::lattice_md::options::{EngineChoice, IntegratorKind};
use stripmine_physics::observe::Observation;
use stripmine_physics::scene::{DT, PRECISION};

/// Discs, at least.
pub const PARTICLES: usize = 400;
/// Packing fraction: nearly a solid, where every disc is in contact nearly always. A thin gas makes its errors in its few
/// contacts only.
pub const PACKING_FRACTION: f64 = 0.84;
/// Steps of a run.
pub const STEPS: u64 = 100_000;
/// Steps between two looks at the energy.
pub const LOOK: u64 = 500;
/// Steps before the first look: Gear's scheme begins without the higher derivatives and takes some steps to find them.
pub const SETTLING: u64 = 500;
/// The precisions that are compared.
pub const PRECISIONS: [&str; 3] = ["f64", "mixed", "f32"];

/// An integrator with its step.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Stepping {
    /// Its name in a legend.
    pub name: &'static str,
    /// Values of Gear's scheme; none for velocity Verlet.
    pub gear_values: Option<u8>,
    /// Time step (time).
    pub dt: f64,
}

/// The integrators with their steps.
pub const STEPPINGS: [Stepping; 4] = [
    Stepping { name: "velocity Verlet", gear_values: None, dt: 0.005 },
    Stepping { name: "Gear, 6 values", gear_values: Some(6), dt: 0.005 },
    Stepping { name: "velocity Verlet", gear_values: None, dt: 0.0025 },
    Stepping { name: "Gear, 6 values", gear_values: Some(6), dt: 0.0025 },
];

/// One case over its seeds. Deviations of the energy are relative to its value at the first look.
#[derive(Clone, Debug, Serialize)]
pub struct EnergyCase {
    /// Integrator and step.
    pub stepping: Stepping,
    /// Precision.
    pub precision: &'static str,
    /// Mean times since the first look of windows that widen with them (time).
    pub times: Vec<f64>,
    /// Root of the mean square deviation over the seeds and the looks of each window.
    pub deviation: Vec<f64>,
    /// Largest magnitude of a run's deviation.
    pub largest: Spread,
    /// Deviation at the end of a run.
    pub last: Spread,
    /// Change over a run by the straight line of least squares through its looks.
    pub drift: Spread,
}

/// Every case. `progress` gets the share that is done.
///
/// # Errors
/// [`StudyError`] if a scene breaks.
pub fn energies(progress: Progress<'_>) -> Result<Vec<EnergyCase>, StudyError> {
    let cases: Vec<(Stepping, &str)> =
        STEPPINGS.iter().flat_map(|&stepping| PRECISIONS.map(|precision| (stepping, precision))).collect();
    let runs: Vec<_> = cases.iter().flat_map(|&case| SEEDS.map(|seed| (case, seed))).collect();
    let deviations = Meter::new(runs.len() as f64, progress)
        .each(&runs, |&((stepping, precision), seed)| deviations(stepping, precision, seed, STEPS))?;
    let cases = cases.into_iter().zip(deviations.chunks(SEEDS.len()));
    Ok(cases.map(|((stepping, precision), runs)| over_seeds(stepping, precision, runs)).collect())
}

/// What several runs say together.
fn over_seeds(stepping: Stepping, precision: &'static str, runs: &[Vec<f64>]) -> EnergyCase {
    let looks = runs.iter().map(Vec::len).min().unwrap_or(0);
    let times: Vec<f64> = (1..=looks).map(|look| (look as u64 * LOOK) as f64 * stepping.dt).collect();
    let over =
        |figure: &dyn Fn(&[f64]) -> f64| Spread::of(&runs.iter().map(|run| figure(run)).collect::<Vec<_>>());
    let mean = |window: &Range<usize>, value: &dyn Fn(usize) -> f64| {
        window.clone().map(value).sum::<f64>() / window.len() as f64
    };
    let mean_square =
        |look: usize| runs.iter().map(|run| run[look] * run[look]).sum::<f64>() / runs.len() as f64;
    let windows: Vec<Range<usize>> = windows(looks).collect();
    EnergyCase {
        stepping,
        precision,
        times: windows.iter().map(|window| mean(window, &|look| times[look])).collect(),
        deviation: windows.iter().map(|window| mean(window, &mean_square).sqrt()).collect(),
        largest: over(&|run| run.iter().fold(0.0, |largest, deviation| deviation.abs().max(largest))),
        last: over(&|run| run.last().copied().unwrap_or(0.0)),
        drift: over(&|run| slope(&times, run) * times.last().copied().unwrap_or(0.0)),
    }
}

/// Ranges that follow each other up to `count`, each about a third of where it ends.
fn windows(count: usize) -> impl Iterator<Item = Range<usize>> {
    let next = |start: usize| start..(start + start / 2 + 1);
    let all = std::iter::successors(Some(next(0)), move |window| Some(next(window.end)));
    all.take_while(move |window| window.start < count).map(move |window| window.start..window.end.min(count))
}

/// Deviations of the energy of one run, at every look after the first.
fn deviations(stepping: Stepping, precision: &str, seed: u64, steps: u64) -> Result<Vec<f64>, StudyError> {
    let place = place(PARTICLES, PACKING_FRACTION, seed);
    let undamped = place.set(&NORMAL_DAMPING, 0.0).set(&SHEAR_DAMPING, 0.0).set(&FRICTION, 0.0);
    let discs = Gas::equilibrated(&undamped)?;
    let overrides =
        undamped.set(&DT, stepping.dt).set(&ENGINE, EngineChoice::Fast).set(&PRECISION, precision);
    let overrides = match stepping.gear_values {
        Some(values) => overrides.set(&VALUES, u64::from(values)),
        None => overrides.set(&INTEGRATOR, IntegratorKind::VelocityVerlet),
    };
    let mut gas = Gas::begin(&overrides, Some(&discs))?;
    let energy = |gas: &Gas| {
        Observation::of(gas.method.steps(), gas.method.time(), &gas.method.particles(), &gas.scenery).energy()
    };
    gas.advance(SETTLING)?;
    let first = energy(&gas);
    let mut deviations = Vec::new();
    for _ in 0..steps / LOOK {
        gas.advance(LOOK)?;
        deviations.push((energy(&gas) - first) / first);
    }
    Ok(deviations)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn windows_follow_each_other_and_widen() {
        let all: Vec<Range<usize>> = windows(10).collect();
        assert_eq!(all, [0..1, 1..2, 2..4, 4..7, 7..10]);
        assert_eq!(windows(0).count(), 0);
    }

    /// By hand: two seeds, four looks.
    #[test]
    fn figures_are_over_seeds_and_windows() {
        let runs = [vec![1.0, -1.0, 3.0, 4.0], vec![1.0, 1.0, -3.0, -4.0]];
        let case = over_seeds(STEPPINGS[0], "f64", &runs);
        assert_eq!(case.deviation, [1.0, 1.0, 12.5f64.sqrt()]);
        assert_eq!(case.times, [2.5, 5.0, 8.75]);
        assert_eq!((case.largest.mean, case.last.mean, case.last.highest), (4.0, 0.0, 4.0));
        assert!((case.drift.highest - 1.3 * 4.0).abs() < 1e-12, "{:?}", case.drift);
    }

    /// No precision lets the energy run away, a smaller step keeps it better, and the precision asked for is the one
    /// that runs.
    #[test]
    fn energy_is_kept_in_every_precision() {
        let of = |stepping, precision| deviations(stepping, precision, 1, 3000).unwrap();
        let rms = |run: &[f64]| (run.iter().map(|d| d * d).sum::<f64>() / run.len() as f64).sqrt();
        let runs = PRECISIONS.map(|precision| of(STEPPINGS[0], precision));
        for (run, precision) in runs.iter().zip(PRECISIONS) {
            assert!(run.len() == 6 && rms(run) < 5e-5, "{precision}: {run:?}");
        }
        assert!(runs[0] != runs[1] && runs[1] != runs[2]);
        let finer = of(Stepping { dt: 0.00125, ..STEPPINGS[0] }, "f64");
        assert!(rms(&finer) < 0.5 * rms(&runs[0]), "{finer:?} {:?}", runs[0]);
    }
}
