//! What do more threads give? One thread, all threads on one scene, and, as the measure of what the machine gives at all,
//! as many scenes side by side, each on a thread of its own.

use super::running;
use crate::statistics::median;
use rayon::ThreadPool;
use serde::Serialize;
use std::time::Instant;
use stripmine_kernels::InstructionSet;
use stripmine_physics::method::lattice_md::Document;
use stripmine_physics::method::lattice_md::keys::{ENGINE, INTEGRATOR, SEARCH};
use stripmine_physics::method::lattice_md::options::{By, EngineChoice, IntegratorKind};
use stripmine_physics::method::throughput::{MeasurementError, TimedRun};
use stripmine_physics::scene::{COUNT, Overrides, PACKING_FRACTION};

/// How much is measured.
#[derive(Clone, Debug)]
pub struct Effort {
    /// Numbers of discs.
    pub particles: Vec<usize>,
    /// Packing fractions.
    pub packing_fractions: Vec<f64>,
    /// Rounds: each of them runs every variant once, so that a disturbance affects them alike.
    pub rounds: usize,
    /// Particle-steps that one thread does in a round, about.
    pub particle_steps: usize,
}

/// A scene under threads. Rates are discs times steps in a second of wall time, round by round.
#[derive(Clone, Debug, Serialize)]
pub struct Scaling {
    /// Discs.
    pub particles: usize,
    /// Area of the discs over that of the box.
    pub packing_fraction: f64,
    /// One scene on one thread, nothing beside it.
    pub alone: Vec<f64>,
    /// One scene on all threads.
    pub together: Vec<f64>,
    /// A scene for each thread, all at once: their sum.
    pub side_by_side: Vec<f64>,
}

impl Scaling {
    /// How many times as fast as on one thread, in the median round.
    pub fn speedup(&self) -> f64 {
        median_ratio(&self.together, &self.alone)
    }

    /// How many times as much as one scene alone the machine does of scenes side by side, in the median round.
    pub fn ceiling(&self) -> f64 {
        median_ratio(&self.side_by_side, &self.alone)
    }

    /// What is reached of that, in the median round.
    pub fn efficiency(&self) -> f64 {
        median_ratio(&self.together, &self.side_by_side)
    }
}

fn median_ratio(of: &[f64], over: &[f64]) -> f64 {
    median(of.iter().zip(over).map(|(of, over)| of / over))
}

/// The dataset.
#[derive(Clone, Debug, Serialize)]
pub struct Threads {
    /// Instructions.
    pub instruction_set: &'static str,
    /// How many threads.
    pub threads: usize,
    /// Every scene.
    pub scenes: Vec<Scaling>,
}

/// Measures the fast lattice on `threads` threads. `progress` gets the share that is done.
///
/// # Errors
/// [`MeasurementError`] if the scene breaks, or there are no threads to be had.
pub fn threads(
    threads: usize,
    effort: &Effort,
    progress: impl Fn(f64) + Sync,
) -> Result<Threads, MeasurementError> {
    let pool = |threads: usize| {
        rayon::ThreadPoolBuilder::new().num_threads(threads).build().map_err(MeasurementError::Threads)
    };
    let (all, single) = (pool(threads)?, (0..threads).map(|_| pool(1)).collect::<Result<Vec<_>, _>>()?);
    let mut scenes = vec![];
    let cases: Vec<(usize, f64)> = effort
        .particles
        .iter()
        .flat_map(|&n| effort.packing_fractions.iter().map(move |&phi| (n, phi)))
        .collect();
    for &(particles, packing_fraction) in &cases {
        let steps = (effort.particle_steps / particles).max(2) as u64;
        let mut copies = single
            .iter()
            .map(|pool| pool.install(|| begin(particles, packing_fraction, steps)))
            .collect::<Result<Vec<_>, _>>()?;
        let mut whole = all.install(|| begin(particles, packing_fraction, threads as u64 * steps))?;
        let mut scaling =
            Scaling { particles, packing_fraction, alone: vec![], together: vec![], side_by_side: vec![] };
        let work = particles as f64 * steps as f64;
        for round in 0..effort.rounds {
            scaling.alone.push(work / timed(&single[0], &mut copies[0])?);
            scaling.together.push(threads as f64 * work / timed(&all, &mut whole)?);
            let each = side_by_side(&single, &mut copies)?;
            scaling.side_by_side.push(each.into_iter().map(|seconds| work / seconds).sum());
            let done = scenes.len() as f64 + (round + 1) as f64 / effort.rounds as f64;
            progress(done / cases.len() as f64);
        }
        scenes.push(scaling);
    }
    Ok(Threads { instruction_set: InstructionSet::best().name(), threads, scenes })
}

fn begin(particles: usize, packing_fraction: f64, steps: u64) -> Result<TimedRun, MeasurementError> {
    let scene = Overrides::new().set(&COUNT, particles).set(&PACKING_FRACTION, packing_fraction);
    let overrides = scene
        .set(&SEARCH, By::Lattice)
        .set(&ENGINE, EngineChoice::Fast)
        .set(&INTEGRATOR, IntegratorKind::VelocityVerlet);
    running(Document::load("bench", &overrides)?, 200, steps)
}

/// Wall seconds of a repeat.
fn timed(pool: &ThreadPool, running: &mut TimedRun) -> Result<f64, MeasurementError> {
    let start = Instant::now();
    pool.install(|| running.repeat())?;
    Ok(start.elapsed().as_secs_f64())
}

/// Wall seconds of each, all at once.
fn side_by_side(pools: &[ThreadPool], copies: &mut [TimedRun]) -> Result<Vec<f64>, MeasurementError> {
    let mut seconds: Vec<Result<f64, MeasurementError>> = copies.iter().map(|_| Ok(0.0)).collect();
    std::thread::scope(|scope| {
        for ((pool, running), seconds) in pools.iter().zip(copies).zip(&mut seconds) {
            scope.spawn(move || *seconds = timed(pool, running));
        }
    });
    seconds.into_iter().collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_way_is_measured_in_every_round() {
        let effort =
            Effort { particles: vec![300], packing_fractions: vec![0.6], rounds: 3, particle_steps: 3000 };
        let data = threads(2, &effort, |_| ()).unwrap();
        let [scene] = data.scenes.as_slice() else { panic!("one scene") };
        for rates in [&scene.alone, &scene.together, &scene.side_by_side] {
            assert!(rates.len() == 3 && rates.iter().all(|rate| *rate > 0.0));
        }
    }

    #[test]
    fn ratios_are_those_of_the_same_round() {
        let scene = Scaling {
            particles: 1,
            packing_fraction: 0.5,
            alone: vec![1.0, 2.0, 4.0],
            together: vec![1.5, 4.0, 7.0],
            side_by_side: vec![2.0, 4.0, 8.0],
        };
        assert_eq!((scene.speedup(), scene.ceiling(), scene.efficiency()), (1.75, 2.0, 0.875));
    }
}
