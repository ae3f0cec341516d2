//! Energy of undamped discs without friction, which changes only by the integrator or the precision.

use super::gas::{BenchGas, SEEDS, bench_overrides};
use crate::frame::{FrameBuilder, ResultFrame, TableCell};
use crate::laboratory::lattice_md::study::StudyError;
use crate::results::{Progress, ProgressMeter};
use crate::statistics::{RunSpread, slope};
use std::ops::Range;
use stripmine_physics::method::lattice_md::keys::{
    ENGINE, FRICTION, INTEGRATOR, NORMAL_DAMPING, SHEAR_DAMPING, VALUES,
};
use stripmine_physics::method::lattice_md::options::{EngineChoice, IntegratorKind};
use stripmine_physics::observe::Observation;
use stripmine_physics::scene::{DT, PRECISION};

/// Minimum number of discs.
const PARTICLES: usize = 400;
/// Packing fraction of a near solid, in which nearly every disc is always in contact. In a thin gas errors arise only in the few contacts.
const PACKING_FRACTION: f64 = 0.84;
/// Steps of a run.
const STEPS: u64 = 100_000;
/// Steps between two samples of the energy.
const STRIDE: u64 = 500;
/// Steps before the first sample: Gear's scheme starts without higher derivatives and needs some steps to build them up.
const SETTLING: u64 = 500;
/// Compared precisions.
const PRECISIONS: [&str; 3] = ["f64", "mixed", "f32"];

/// Name, values of Gear's scheme (`None` for velocity Verlet), and time step.
type IntegratorStep = (&'static str, Option<u64>, f64);

/// Compared integrators and steps.
const STEPPINGS: [IntegratorStep; 4] = [
    ("velocity Verlet", None, 0.005),
    ("Gear, 6 values", Some(6), 0.005),
    ("velocity Verlet", None, 0.0025),
    ("Gear, 6 values", Some(6), 0.0025),
];

/// Statistics of a case over its seeds. Deviations of the energy are relative to its value at the first sample.
struct SeedStatistics {
    /// Mean time since the first sample and RMS deviation over seeds and samples, for windows that widen with time.
    deviations: Vec<(f64, f64)>,
    /// Largest deviation of a run, deviation at its end, and drift over the run by a least-squares line.
    spreads: [RunSpread; 3],
}

/// Frames of every case and of the deviations over time. `progress` receives the completed share.
pub(super) fn frames(progress: Progress<'_>) -> Result<[ResultFrame; 2], StudyError> {
    let cases: Vec<(IntegratorStep, &str)> =
        STEPPINGS.iter().flat_map(|&stepping| PRECISIONS.map(|precision| (stepping, precision))).collect();
    let runs: Vec<_> = cases.iter().flat_map(|&case| SEEDS.map(|seed| (case, seed))).collect();
    let deviations = ProgressMeter::new(runs.len() as f64, progress)
        .run_cases(&runs, |&((stepping, precision), seed)| deviations(stepping, precision, seed, STEPS))?;
    let over = deviations.chunks(SEEDS.len()).zip(&cases).map(|(runs, ((.., dt), _))| over_seeds(*dt, runs));
    let cases: Vec<_> = cases.iter().zip(over).collect();
    let samples = cases.iter().flat_map(|(case, over)| over.deviations.iter().map(move |at| (case, at)));
    let headings = ["largest deviation (10⁻⁶)", "deviation at the end (10⁻⁶)", "drift (10⁻⁶)"];
    let with_error =
        |it: RunSpread| TableCell::with_error(1e6 * it.mean, it.error.map(|error| 1e6 * error), 2);
    Ok([
        FrameBuilder::of(&cases)
            .text("integrator", |(((name, ..), _), _)| *name)
            .number("dt", 4, |(((.., dt), _), _)| *dt)
            .text("precision", |((_, precision), _)| *precision)
            .cells(headings, |(_, over)| over.spreads.map(with_error))
            .frame("energy", "Energy over 100,000 undamped steps"),
        FrameBuilder::of(samples)
            .text("integrator", |(((name, ..), _), _)| *name)
            .number("dt", 4, |(((.., dt), _), _)| *dt)
            .text("precision", |((_, precision), _)| *precision)
            .number("time", 2, |(_, (time, _))| *time)
            .short("deviation", |(_, (_, deviation))| *deviation)
            .frame("deviations", "Root of the mean square deviation of the energy over time"),
    ])
}

/// Statistics over the runs of a case with the step `dt`.
fn over_seeds(dt: f64, runs: &[Vec<f64>]) -> SeedStatistics {
    let samples = runs.iter().map(Vec::len).min().unwrap_or(0);
    let times: Vec<f64> = (1..=samples).map(|sample| (sample as u64 * STRIDE) as f64 * dt).collect();
    let over = |figure: &dyn Fn(&[f64]) -> f64| {
        RunSpread::of(&runs.iter().map(|run| figure(run)).collect::<Vec<_>>())
    };
    let mean = |window: &Range<usize>, value: &dyn Fn(usize) -> f64| {
        window.clone().map(value).sum::<f64>() / window.len() as f64
    };
    let mean_square =
        |sample: usize| runs.iter().map(|run| run[sample] * run[sample]).sum::<f64>() / runs.len() as f64;
    let deviations =
        windows(samples).map(|it| (mean(&it, &|sample| times[sample]), mean(&it, &mean_square).sqrt()));
    SeedStatistics {
        deviations: deviations.collect(),
        spreads: [
            over(&|run| run.iter().fold(0.0, |largest, deviation| deviation.abs().max(largest))),
            over(&|run| run.last().copied().unwrap_or(0.0)),
            over(&|run| slope(&times, run) * times.last().copied().unwrap_or(0.0)),
        ],
    }
}

/// Consecutive ranges up to `count`, each with a length of about a third of its end.
fn windows(count: usize) -> impl Iterator<Item = Range<usize>> {
    let next = |start: usize| start..(start + start / 2 + 1);
    let all = std::iter::successors(Some(next(0)), move |window| Some(next(window.end)));
    all.take_while(move |window| window.start < count).map(move |window| window.start..window.end.min(count))
}

/// Energy deviations of one run at every sample after the first.
fn deviations(
    (_, values, dt): IntegratorStep,
    precision: &str,
    seed: u64,
    steps: u64,
) -> Result<Vec<f64>, StudyError> {
    let place = bench_overrides(PARTICLES, PACKING_FRACTION, seed);
    let undamped = place.set(&NORMAL_DAMPING, 0.0).set(&SHEAR_DAMPING, 0.0).set(&FRICTION, 0.0);
    let discs = BenchGas::equilibrated(&undamped)?;
    let overrides = undamped.set(&DT, dt).set(&ENGINE, EngineChoice::Fast).set(&PRECISION, precision);
    let overrides = match values {
        Some(values) => overrides.set(&VALUES, values),
        None => overrides.set(&INTEGRATOR, IntegratorKind::VelocityVerlet),
    };
    let mut gas = BenchGas::begin(&overrides, Some(&discs))?;
    let energy = |gas: &BenchGas| {
        Observation::of(gas.method.steps(), gas.method.time(), &gas.method.particles(), &gas.scenery).energy()
    };
    gas.advance(SETTLING)?;
    let first = energy(&gas);
    let mut deviations = Vec::new();
    for _ in 0..steps / STRIDE {
        gas.advance(STRIDE)?;
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

    /// Two seeds and four samples, computed by hand.
    #[test]
    fn statistics_cover_seeds_and_windows() {
        let runs = [vec![1.0, -1.0, 3.0, 4.0], vec![1.0, 1.0, -3.0, -4.0]];
        let SeedStatistics { deviations, spreads: [largest, last, drift] } =
            over_seeds(STEPPINGS[0].2, &runs);
        assert_eq!(deviations, [(2.5, 1.0), (5.0, 1.0), (8.75, 12.5f64.sqrt())]);
        assert_eq!((largest.mean, last.mean, last.highest), (4.0, 0.0, 4.0));
        assert!((drift.highest - 1.3 * 4.0).abs() < 1e-12, "{drift:?}");
    }

    /// The energy stays bounded in every precision, a smaller step conserves it better, and the runs use the requested precision.
    #[test]
    fn energy_is_bounded_in_every_precision() {
        let of = |stepping, precision| deviations(stepping, precision, 1, 3000).unwrap();
        let rms = |run: &[f64]| (run.iter().map(|d| d * d).sum::<f64>() / run.len() as f64).sqrt();
        let runs = PRECISIONS.map(|precision| of(STEPPINGS[0], precision));
        for (run, precision) in runs.iter().zip(PRECISIONS) {
            assert!(run.len() == 6 && rms(run) < 5e-5, "{precision}: {run:?}");
        }
        assert!(runs[0] != runs[1] && runs[1] != runs[2]);
        let finer = of(("velocity Verlet", None, 0.00125), "f64");
        assert!(rms(&finer) < 0.5 * rms(&runs[0]), "{finer:?} {:?}", runs[0]);
    }
}
