//! Wall time over the number of sectors along a side, on one thread and on two; where the time goes.

use crate::laboratory::running::{Running, on_threads, prepared};
use crate::results::Progress;
use crate::statistics::median;
use crate::study::StudyError;
use serde::Serialize;
use std::collections::BTreeMap;
use std::time::Instant;
use stripmine_physics::io::extxyz::{self, Frame};
use stripmine_physics::method::langevin::keys::{LAW, PER_SIDE, SEARCH, SORT};
use stripmine_physics::method::langevin::options::{By, PairLaw, SortKind};
use stripmine_physics::scene::{COUNT, Overrides, SIDES, SPACING};
use stripmine_physics::words::Words;

/// Wall seconds of the source, on one thread and on two, over the sectors along a side.
pub const SOURCE: [(u64, [f64; 2]); 8] = [
    (3, [1008.0, 526.0]),
    (5, [205.0, 132.0]),
    (10, [51.2, 34.4]),
    (20, [13.2, 12.5]),
    (100, [4.2, 6.8]),
    (200, [4.0, 6.6]),
    (400, [4.3, 6.8]),
    (800, [5.7, 8.1]),
];
/// Threads compared.
pub const THREADS: [usize; 2] = [1, 2];
/// The source's number of steps, for which times are given.
const STEPS: f64 = 100.0;

/// How much is measured.
#[derive(Clone, Copy, Debug)]
pub struct Effort {
    /// Sectors along a side, at least.
    pub fewest: u64,
    /// Seconds of a measurement, about.
    pub seconds: f64,
    /// Alternating repeats.
    pub rounds: usize,
}

/// Wall time of the source's run.
#[derive(Clone, Debug, Serialize)]
pub struct Row {
    /// Sectors along a side; none for neighbour lists.
    pub per_side: Option<u64>,
    /// Seconds for 100 steps, on one thread and on two: medians.
    pub seconds: [f64; 2],
    /// What the source has.
    pub source: Option<[f64; 2]>,
}

/// A way to find pairs: its name, and what it sets.
pub type Way = (&'static str, fn(Overrides) -> Overrides);

/// Ways to find pairs that are compared.
pub const SEARCHES: [Way; 4] = [
    ("lattice", |scene| scene.set(&SEARCH, By::Lattice)),
    ("sectors, sorted when needed", |scene| scene.set(&SEARCH, By::Sectors).set(&SORT, SortKind::WhenNeeded)),
    ("sectors, sorted at every step", |scene| {
        scene.set(&SEARCH, By::Sectors).set(&SORT, SortKind::EveryStep)
    }),
    ("lists", |scene| scene.set(&SEARCH, By::NeighborList)),
];
/// Particles of the scenes in which they are compared, and their densities N σ²/A.
const COMPARED: u32 = 4000;
const DENSITIES: [f64; 5] = [0.05, 0.2, 0.4, 0.6, 0.7];

/// A fluid by every search.
#[derive(Clone, Debug, Serialize)]
pub struct Fluid {
    /// The pair law.
    pub law: &'static str,
    /// Density N σ²/A.
    pub density: f64,
    /// Seconds of a step on one thread, by the ways of [`SEARCHES`]; none where one does not serve.
    pub seconds: Vec<Option<f64>>,
    /// The way that `auto` takes.
    pub auto: String,
}

/// What came out.
#[derive(Clone, Debug, Serialize)]
pub struct Sectors {
    /// Fluids by every search.
    pub fluids: Vec<Fluid>,
    /// Particles.
    pub particles: usize,
    /// Wall times.
    pub rows: Vec<Row>,
    /// Seconds of 100 steps in each phase, on one thread and by lists, and of writing ten frames.
    pub phases: BTreeMap<String, f64>,
}

/// Seconds of a step on some threads, measured for about so long.
fn seconds_of_a_step(
    preset: &str,
    overrides: &[String],
    threads: usize,
    seconds: f64,
) -> Result<f64, StudyError> {
    on_threads(threads, || {
        let mut running = Running::timed(preset, overrides)?;
        running.steps(1)?;
        let (mut steps, mut in_all) = (1, 0.0);
        loop {
            let begun = Instant::now();
            running.steps(steps)?;
            in_all += begun.elapsed().as_secs_f64();
            if in_all > seconds {
                let done = running.simulation.clock().steps - 1;
                return Ok(in_all / done as f64);
            }
            steps = (2 * steps).min(200);
        }
    })
}

/// Measures every number of sectors, and neighbour lists.
///
/// # Errors
/// [`StudyError`] if a scene is refused.
pub fn sectors(effort: &Effort, progress: Progress<'_>) -> Result<Sectors, StudyError> {
    let counts = SOURCE.iter().filter(|(count, _)| *count >= effort.fewest);
    let ways: Vec<(Option<u64>, Option<[f64; 2]>)> =
        counts.map(|&(count, seconds)| (Some(count), Some(seconds))).chain([(None, None)]).collect();
    let mut rows = vec![];
    for (number, &(per_side, source)) in ways.iter().enumerate() {
        let overrides = match per_side {
            Some(count) => Overrides::new().set(&SEARCH, By::Sectors).set(&PER_SIDE, count),
            None => Overrides::new().set(&SEARCH, By::NeighborList),
        };
        let mut found = [vec![], vec![]];
        for _ in 0..effort.rounds {
            for (times, threads) in found.iter_mut().zip(THREADS) {
                times
                    .push(STEPS * seconds_of_a_step("langevin-report", &overrides, threads, effort.seconds)?);
            }
        }
        rows.push(Row { per_side, seconds: found.map(|times| median(times.into_iter())), source });
        progress((number + 1) as f64 / (ways.len() + 1) as f64);
    }
    let phases = phases()?;
    let laws = [PairLaw::Wca, PairLaw::LennardJones];
    let fluids = laws.into_iter().flat_map(|law| DENSITIES.map(|density| (law, density)));
    let fluids = fluids.map(|(law, density)| fluid(law, density, effort)).collect::<Result<_, _>>()?;
    progress(1.0);
    let particles = prepared("langevin-report", &[])?.particles().len();
    Ok(Sectors { fluids, particles, rows, phases })
}

/// A fluid by every search that serves it, in turns.
fn fluid(law: PairLaw, density: f64, effort: &Effort) -> Result<Fluid, StudyError> {
    let side = (f64::from(COMPARED) / density).sqrt();
    let scene = Overrides::new().set(&LAW, law).set(&COUNT, u64::from(COMPARED));
    let scene = scene.set(&SIDES, [side; 2]).set(&SPACING, 1.13);
    let mut found: Vec<Vec<f64>> = vec![vec![]; SEARCHES.len()];
    for _ in 0..effort.rounds {
        for (times, (_, searched)) in found.iter_mut().zip(SEARCHES) {
            let overrides = searched(scene.clone());
            if prepared("langevin-dense", &overrides).is_ok() {
                times.push(seconds_of_a_step("langevin-dense", &overrides, 1, 0.25 * effort.seconds)?);
            }
        }
    }
    let middle = |times: Vec<f64>| (!times.is_empty()).then(|| median(times.into_iter()));
    let auto = prepared("langevin-dense", &scene)?.settings["search"].as_str().unwrap_or("").to_owned();
    Ok(Fluid { law: law.word(), density, seconds: found.into_iter().map(middle).collect(), auto })
}

/// Seconds of the source's run in each phase on one thread, and of the ten frames that it would write.
fn phases() -> Result<BTreeMap<String, f64>, StudyError> {
    on_threads(1, || {
        let mut running = Running::timed("langevin-report", &[])?;
        running.steps(50)?;
        running.simulation.reset_phases();
        let steps = 500;
        running.steps(steps)?;
        let share = STEPS / steps as f64;
        let named = running.simulation.phases().into_iter();
        let mut phases: BTreeMap<String, f64> =
            named.map(|(name, seconds)| (name.to_owned(), share * seconds)).collect();
        let begun = Instant::now();
        for step in 0..10 {
            let frame = Frame {
                particles: running.simulation.particles(),
                cell: running.domain.lengths(),
                origin: running.domain.corner(),
                periodic: Some(running.domain.periodic()),
                time: 0.0,
                step,
                seed: None,
                has_raised_ids: false,
            };
            // What goes nowhere finds no obstacle.
            drop(extxyz::write(&frame, &mut std::io::sink()));
        }
        phases.insert("ten frames as text".to_owned(), begun.elapsed().as_secs_f64());
        Ok(phases)
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use stripmine_physics::particles::Particle;

    /// Positions and velocities after some steps of a number of particles in sectors, to the bit, and the positions.
    fn moved(count: u64, per_side: Option<u64>, threads: usize) -> (Vec<[u64; 4]>, Vec<[f64; 2]>) {
        // Dense, so that sums have many terms, whose order counts.
        let side = (count as f64 / 0.7).sqrt();
        let scene = Overrides::new().set(&COUNT, count).set(&SIDES, [side; 2]);
        let scene = match per_side {
            Some(per_side) => scene.set(&SEARCH, By::Sectors).set(&PER_SIDE, per_side),
            None => scene.set(&SEARCH, By::NeighborList),
        };
        let particles = on_threads(threads, || {
            let mut running = Running::timed("langevin-dense", &scene)?;
            running.steps(6)?;
            Ok(running.simulation.particles())
        });
        let particles = particles.unwrap();
        let bits = |it: &Particle| {
            let ([x, y], [u, v]) = (it.place(), it.planar_velocity());
            [x, y, u, v].map(f64::to_bits)
        };
        let all = particles.all();
        (all.iter().map(bits).collect(), all.iter().map(Particle::place).collect())
    }

    /// Few large sectors, whose pairs all threads find together, move particles to the same bits on any number of threads, and as lists
    /// do but for rounding; so do more and smaller ones, which threads share.
    #[test]
    fn sectors_of_every_size_give_the_same_bits_on_any_number_of_threads() {
        let count = 5200;
        let (_, by_lists) = moved(count, None, 1);
        for per_side in [3, 20, 34] {
            let (alone, places) = moved(count, Some(per_side), 1);
            for threads in [2, 3] {
                assert!(
                    moved(count, Some(per_side), threads).0 == alone,
                    "{per_side} a side, {threads} threads"
                );
            }
            let off = places.iter().zip(&by_lists).map(|(a, b)| (a[0] - b[0]).hypot(a[1] - b[1]));
            let far = off.filter(|off| (1e-8..30.0).contains(off)).count();
            assert_eq!(far, 0, "{per_side} a side");
        }
    }
}
