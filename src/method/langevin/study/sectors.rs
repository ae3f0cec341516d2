//! Wall time over the number of sectors along a side, on one thread and on two; where the time goes.

use super::{Running, prepared};
use crate::console::Failure;
use crate::io::extxyz::{self, Frame};
use crate::method::{Progress, Purpose};
use crate::statistics::median;
use serde::Serialize;
use std::collections::BTreeMap;
use std::time::Instant;

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

/// What came out.
#[derive(Clone, Debug, Serialize)]
pub struct Sectors {
    /// Particles.
    pub particles: usize,
    /// Wall times.
    pub rows: Vec<Row>,
    /// Seconds of 100 steps in each phase, on one thread and by lists, and of writing ten frames.
    pub phases: BTreeMap<String, f64>,
}

/// Seconds of a step on some threads, measured for about so long.
fn seconds_of_a_step(overrides: &[String], threads: usize, seconds: f64) -> Result<f64, Failure> {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
    let pool = pool.map_err(Failure::Threads)?;
    pool.install(|| {
        let mut running = Running::begin("langevin-report", overrides, Purpose::Measurement)?;
        running.steps(1)?;
        let (mut steps, mut in_all) = (1, 0.0);
        loop {
            let begun = Instant::now();
            running.steps(steps)?;
            in_all += begun.elapsed().as_secs_f64();
            if in_all > seconds {
                let done = running.0.clock().steps - 1;
                return Ok(in_all / done as f64);
            }
            steps = (2 * steps).min(200);
        }
    })
}

/// Measures every number of sectors, and neighbour lists.
///
/// # Errors
/// [`Failure`] if a scene is refused.
pub fn sectors(effort: &Effort, progress: Progress<'_>) -> Result<Sectors, Failure> {
    let counts = SOURCE.iter().filter(|(count, _)| *count >= effort.fewest);
    let ways: Vec<(Option<u64>, Option<[f64; 2]>)> =
        counts.map(|&(count, seconds)| (Some(count), Some(seconds))).chain([(None, None)]).collect();
    let mut rows = vec![];
    for (number, &(per_side, source)) in ways.iter().enumerate() {
        let overrides = match per_side {
            Some(count) => vec!["search.by=sectors".to_owned(), format!("search.sectors={count}")],
            None => vec!["search.by=neighbor-list".to_owned()],
        };
        let mut found = [vec![], vec![]];
        for _ in 0..effort.rounds {
            for (times, threads) in found.iter_mut().zip(THREADS) {
                times.push(STEPS * seconds_of_a_step(&overrides, threads, effort.seconds)?);
            }
        }
        rows.push(Row { per_side, seconds: found.map(|times| median(times.into_iter())), source });
        progress((number + 1) as f64 / (ways.len() + 1) as f64);
    }
    let phases = phases()?;
    progress(1.0);
    let particles = prepared("langevin-report", &[])?.particles().len();
    Ok(Sectors { particles, rows, phases })
}

/// Seconds of the source's run in each phase on one thread, and of the ten frames that it would write.
fn phases() -> Result<BTreeMap<String, f64>, Failure> {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build();
    let pool = pool.map_err(Failure::Threads)?;
    pool.install(|| {
        let scene = prepared("langevin-report", &[])?;
        let mut running = Running(scene.start(Purpose::Measurement)?);
        running.steps(50)?;
        running.0.reset_phases();
        let steps = 500;
        running.steps(steps)?;
        let share = STEPS / steps as f64;
        let named = running.0.phases().into_iter();
        let mut phases: BTreeMap<String, f64> =
            named.map(|(name, seconds)| (name.to_owned(), share * seconds)).collect();
        let begun = Instant::now();
        for step in 0..10 {
            let frame = Frame {
                particles: running.0.particles(),
                cell: scene.domain().lengths(),
                origin: scene.domain().corner(),
                periodic: Some(scene.domain().periodic()),
                time: 0.0,
                step,
                seed: None,
            };
            extxyz::write(&frame, &mut std::io::sink()).map_err(Failure::writing("a frame"))?;
        }
        phases.insert("ten frames as text".to_owned(), begun.elapsed().as_secs_f64());
        Ok(phases)
    })
}
