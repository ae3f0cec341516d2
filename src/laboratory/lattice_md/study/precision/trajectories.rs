//! Divergence of trajectories from one start in different precisions: collisions amplify every error.

use super::gas::{BenchGas, PACKING_FRACTIONS, SEEDS, bench_overrides};
use crate::frame::{FrameBuilder, ResultFrame, TableCell};
use crate::laboratory::lattice_md::study::StudyError;
use crate::results::run_in_parallel;
use crate::statistics::{RunSpread, slope};
use stripmine_physics::method::lattice_md::keys::{ENGINE, INTEGRATOR};
use stripmine_physics::method::lattice_md::options::IntegratorKind;
use stripmine_physics::scene::{self, Overrides, PRECISION};

/// Minimum number of discs.
const PARTICLES: usize = 400;
/// Time step.
const DT: f64 = 0.005;
/// Steps of a run.
const STEPS: u64 = 8000;
/// Steps between two samples.
const STRIDE: u64 = 100;
/// Name, precision and engine of the runs compared with the fast engine in f64; programs are chained.
const RIVALS: [[&str; 3]; 3] =
    [["f64, programs", "f64", "programs"], ["mixed", "mixed", "fast"], ["f32", "f32", "fast"]];
/// Multiple of the first distance above which growth is due to diverging trajectories, not to further rounding.
const PARTED: f64 = 10.0;
/// Distance (diameters) up to which growth is exponential; beyond it discs collide with different partners.
const LOST: f64 = 0.02;

/// Frames of every variant and of its distances over time.
pub(super) fn frames() -> Result<[ResultFrame; 2], StudyError> {
    let starts: Vec<(f64, u64)> =
        PACKING_FRACTIONS.iter().flat_map(|&fraction| SEEDS.map(|seed| (fraction, seed))).collect();
    let runs = run_in_parallel(&starts, |&(fraction, seed)| {
        distances(&bench_overrides(PARTICLES, fraction, seed), STEPS)
    })?;
    let times: Vec<f64> = (1..=STEPS / STRIDE).map(|sample| (sample * STRIDE) as f64 * DT).collect();
    // Packing fraction; variant; RMS distance between a disc and its twin over discs and seeds, at each sample; rate of exponential growth
    // between PARTED and LOST.
    let mut all = vec![];
    for (fraction, runs) in PACKING_FRACTIONS.iter().zip(runs.chunks(SEEDS.len())) {
        for (rival, [variant, ..]) in RIVALS.into_iter().enumerate() {
            let square = |sample: usize| runs.iter().map(move |run| run[rival][sample] * run[rival][sample]);
            let mean_square = |sample: usize| square(sample).sum::<f64>() / runs.len() as f64;
            let distances: Vec<f64> = (0..times.len()).map(|sample| mean_square(sample).sqrt()).collect();
            let rates: Vec<f64> = runs.iter().map(|run| growth_rate(&times, &run[rival])).collect();
            all.push((*fraction, variant, distances, RunSpread::of(&rates)));
        }
    }
    let lost = |distances: &[f64]| Some(times[distances.iter().position(|&distance| distance >= LOST)?]);
    let samples = all.iter().flat_map(|it| it.2.iter().zip(&times).map(move |sample| (it, sample)));
    Ok([
        FrameBuilder::of(&all)
            .number("packing fraction", 2, |(fraction, ..)| *fraction)
            .text("variant", |(_, variant, ..)| *variant)
            .short(format!("distance after {STRIDE} steps (diameters)"), |(_, _, distances, _)| distances[0])
            .cell("rate of growth (1/time)", |(.., rate)| TableCell::with_error(rate.mean, rate.error, 3))
            .number(format!("time until {LOST} diameters"), 1, |(_, _, distances, _)| lost(distances))
            .frame("trajectories", "Divergence of trajectories from those of the fast engine in f64"),
        FrameBuilder::of(samples)
            .number("packing fraction", 2, |((fraction, ..), _)| *fraction)
            .text("variant", |((_, variant, ..), _)| *variant)
            .number("time", 1, |(_, (_, time))| **time)
            .short("distance (diameters)", |(_, (distance, _))| **distance)
            .frame("distances", "Distance of a disc from its twin over time"),
    ])
}

/// RMS distance between the discs of each variant and of the reference, at every sample.
fn distances(place: &Overrides, steps: u64) -> Result<[Vec<f64>; RIVALS.len()], StudyError> {
    let discs = BenchGas::equilibrated(place)?;
    let begin = |[_, precision, engine]: [&str; 3]| {
        let overrides = place.clone().set(&INTEGRATOR, IntegratorKind::VelocityVerlet).set(&scene::DT, DT);
        BenchGas::begin(&overrides.set(&PRECISION, precision).set(&ENGINE, engine), Some(&discs))
    };
    let mut reference = begin(["", "f64", "fast"])?;
    let mut rivals = Vec::new();
    for rival in RIVALS {
        rivals.push(begin(rival)?);
    }
    let mut distances = [const { Vec::new() }; RIVALS.len()];
    for _ in 0..steps / STRIDE {
        reference.advance(STRIDE)?;
        let there = reference.method.particles();
        for (gas, distances) in rivals.iter_mut().zip(&mut distances) {
            gas.advance(STRIDE)?;
            let here = gas.method.particles();
            let squares = here.all().iter().zip(there.all()).map(|(a, b)| {
                let [dx, dy] = gas.scenery.domain.displacement(a.planar_position(), b.planar_position());
                dx * dx + dy * dy
            });
            distances.push((squares.sum::<f64>() / there.len() as f64).sqrt());
        }
    }
    Ok(distances)
}

/// Rate of exponential growth of a distance between the limits set by [`PARTED`] and [`LOST`].
fn growth_rate(times: &[f64], distances: &[f64]) -> f64 {
    let first = distances.first().copied().unwrap_or(0.0);
    let points = times.iter().zip(distances).skip_while(|(_, distance)| **distance <= PARTED * first);
    let growing = points.take_while(|(_, distance)| **distance < LOST);
    let (times, logarithms): (Vec<f64>, Vec<f64>) =
        growing.map(|(&time, &distance)| (time, libm::log(distance))).unzip();
    slope(&times, &logarithms)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn growth_rate_of_an_exponential_is_recovered() {
        let times: Vec<f64> = (0..200).map(|i| 0.1 * f64::from(i)).collect();
        let distances: Vec<f64> = times.iter().map(|t| (1e-12 + 1e-13 * (2.0 * t).exp()).min(0.3)).collect();
        assert!((growth_rate(&times, &distances) - 2.0).abs() < 0.05);
        assert_eq!(growth_rate(&[], &[]), 0.0);
    }

    /// Trajectories diverge earlier at lower precision, starting from an error of the size of rounding.
    #[test]
    fn lower_precision_diverges_earlier() {
        let [double, mixed, single] = distances(&bench_overrides(PARTICLES, 0.84, 1), 200).unwrap();
        for sample in 0..2 {
            assert!(double[sample] < 1e-3 * mixed[sample] && mixed[sample] < single[sample]);
        }
        assert!(double[0] < 1e-12 && single[0] < 1e-3, "{} {}", double[0], single[0]);
    }
}
