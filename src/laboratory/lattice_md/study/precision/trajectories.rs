//! How fast trajectories of one start run apart when digits differ: collisions multiply every error.

use super::gas::{Gas, PACKING_FRACTIONS, SEEDS, place};
use crate::laboratory::lattice_md::study::StudyError;
use crate::statistics::{Spread, slope};
use rayon::iter::{IntoParallelRefIterator, ParallelIterator};
use serde::Serialize;
use stripmine_physics::method::lattice_md::keys::{ENGINE, INTEGRATOR};
use stripmine_physics::method::lattice_md::options::IntegratorKind;
use stripmine_physics::scene::{self, Overrides, PRECISION};

/// Discs, at least.
pub const PARTICLES: usize = 400;
/// Time step (time).
pub const DT: f64 = 0.005;
/// Steps of a run.
pub const STEPS: u64 = 8000;
/// Steps between two looks.
pub const LOOK: u64 = 100;
/// Precision and engine of those that run beside the fast engine in f64.
pub const RIVALS: [(&str, &str); 3] = [("f64", "programs"), ("mixed", "fast"), ("f32", "fast")];
/// From this multiple of its first value on a distance grows because trajectories part, not because rounding goes on.
pub const PARTED: f64 = 10.0;
/// Up to this distance (length) the growth is exponential: beyond it discs meet other partners.
pub const LOST: f64 = 0.02;

/// A trajectory beside that of the fast engine in f64.
#[derive(Clone, Debug, Serialize)]
pub struct Divergence {
    /// Packing fraction.
    pub packing_fraction: f64,
    /// Precision.
    pub precision: &'static str,
    /// Engine; programs are chained.
    pub engine: &'static str,
    /// Times of the looks (time).
    pub times: Vec<f64>,
    /// Root of the mean square distance between a disc and its twin, over discs and seeds, at each look (length).
    pub distance: Vec<f64>,
    /// Rate of the exponential growth from [`PARTED`] on and up to [`LOST`] (1/time).
    pub rate: Spread,
}

/// Every divergence.
///
/// # Errors
/// [`StudyError`] if a scene breaks.
pub fn divergences() -> Result<Vec<Divergence>, StudyError> {
    let starts: Vec<(f64, u64)> =
        PACKING_FRACTIONS.iter().flat_map(|&fraction| SEEDS.map(|seed| (fraction, seed))).collect();
    let runs = starts.par_iter().map(|&(fraction, seed)| distances(&place(PARTICLES, fraction, seed), STEPS));
    let runs: Vec<[Vec<f64>; RIVALS.len()]> = runs.collect::<Result<_, StudyError>>()?;
    let times: Vec<f64> = (1..=STEPS / LOOK).map(|look| (look * LOOK) as f64 * DT).collect();
    let mut divergences = Vec::new();
    for (&packing_fraction, runs) in PACKING_FRACTIONS.iter().zip(runs.chunks(SEEDS.len())) {
        for (rival, (precision, engine)) in RIVALS.into_iter().enumerate() {
            let mean_square = |look: usize| {
                runs.iter().map(|run| run[rival][look] * run[rival][look]).sum::<f64>() / runs.len() as f64
            };
            let rates: Vec<f64> = runs.iter().map(|run| growth(&times, &run[rival])).collect();
            divergences.push(Divergence {
                packing_fraction,
                precision,
                engine,
                distance: (0..times.len()).map(|look| mean_square(look).sqrt()).collect(),
                rate: Spread::of(&rates),
                times: times.clone(),
            });
        }
    }
    Ok(divergences)
}

/// Root of the mean square distance between the discs of each rival and those of the reference, at every look.
fn distances(place: &Overrides, steps: u64) -> Result<[Vec<f64>; RIVALS.len()], StudyError> {
    let discs = Gas::equilibrated(place)?;
    let begin = |(precision, engine): (&str, &str)| {
        let overrides = place.clone().set(&INTEGRATOR, IntegratorKind::VelocityVerlet).set(&scene::DT, DT);
        Gas::begin(&overrides.set(&PRECISION, precision).set(&ENGINE, engine), Some(&discs))
    };
    let mut reference = begin(("f64", "fast"))?;
    let mut rivals = Vec::new();
    for rival in RIVALS {
        rivals.push(begin(rival)?);
    }
    let mut distances = [const { Vec::new() }; RIVALS.len()];
    for _ in 0..steps / LOOK {
        reference.advance(LOOK)?;
        let there = reference.method.particles();
        for (gas, distances) in rivals.iter_mut().zip(&mut distances) {
            gas.advance(LOOK)?;
            let here = gas.method.particles();
            let squares = here.all().iter().zip(there.all()).map(|(a, b)| {
                let [dx, dy] = gas.scenery.domain.displacement(a.place(), b.place());
                dx * dx + dy * dy
            });
            distances.push((squares.sum::<f64>() / there.len() as f64).sqrt());
        }
    }
    Ok(distances)
}

/// Rate of exponential growth while a distance is neither rounding nor loss.
fn growth(times: &[f64], distances: &[f64]) -> f64 {
    let first = distances.first().copied().unwrap_or(0.0);
    let grown = |&&(_, distance): &&(f64, f64)| distance > PARTED * first;
    let points: Vec<(f64, f64)> = times.iter().copied().zip(distances.iter().copied()).collect();
    let growing =
        points.iter().skip_while(|point| !grown(point)).take_while(|&&(_, distance)| distance < LOST);
    let (times, logarithms): (Vec<f64>, Vec<f64>) =
        growing.map(|&(time, distance)| (time, libm::log(distance))).unzip();
    slope(&times, &logarithms)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn growth_is_that_of_an_exponential_between_rounding_and_loss() {
        let times: Vec<f64> = (0..200).map(|i| 0.1 * f64::from(i)).collect();
        let distances: Vec<f64> = times.iter().map(|t| (1e-12 + 1e-13 * (2.0 * t).exp()).min(0.3)).collect();
        assert!((growth(&times, &distances) - 2.0).abs() < 0.05);
        assert_eq!(growth(&[], &[]), 0.0);
    }

    /// The fewer digits, the sooner the parting; and it starts as small as the digits say.
    #[test]
    fn trajectories_part_in_the_order_of_their_digits() {
        let [double, mixed, single] = distances(&place(PARTICLES, 0.84, 1), 200).unwrap();
        for look in 0..2 {
            assert!(double[look] < 1e-3 * mixed[look] && mixed[look] < single[look]);
        }
        assert!(double[0] < 1e-12 && single[0] < 1e-3, "{} {}", double[0], single[0]);
    }
}
