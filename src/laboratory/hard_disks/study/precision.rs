//! Speed against accuracy: the error of Z over the processor time that it took.

use crate::laboratory::running::Running;
use crate::results::Progress;
use crate::study::StudyError;
use serde::Serialize;
use stripmine_physics::method::hard_disks::keys::ENGINE;
use stripmine_physics::scene::{COUNT, Overrides, PACKING_FRACTION, SEED};

/// The packing fraction, and Z of it, measured with two independent codes to 0.1 % (the figures of the specification of ISO99).
pub const STATE: [f64; 2] = [0.50, 4.1094];
/// To what that is known.
pub const KNOWN_TO: f64 = 1e-3;
/// Collisions of a disc until the lattice of the start is forgotten.
const FORGOTTEN: f64 = 100.0;
/// Seeds, each an independent run.
const SEEDS: u64 = 8;

/// How much is measured.
#[derive(Clone, Debug)]
pub struct Effort {
    /// Numbers of discs.
    pub discs: Vec<u64>,
    /// Collisions of the longest runs.
    pub collisions: u64,
}

/// An engine with a number of discs.
#[derive(Clone, Debug, Serialize)]
pub struct Way {
    /// The engine.
    pub engine: &'static str,
    /// Discs.
    pub discs: usize,
    /// Collisions in a second of processor time.
    pub rate: f64,
    /// What is seen after growing numbers of collisions.
    pub looks: Vec<Look>,
}

/// What is known of Z after some time.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct Look {
    /// Collisions measured.
    pub collisions: u64,
    /// Processor time of a run (s).
    pub seconds: f64,
    /// Root mean square of the errors over the seeds, relative.
    pub error: f64,
    /// The mean over the seeds less what is known, relative, and the standard error of that.
    pub bias: [f64; 2],
}

/// What came out.
#[derive(Clone, Debug, Serialize)]
pub struct Precision {
    /// Ways.
    pub ways: Vec<Way>,
    /// Seeds.
    pub seeds: u64,
}

/// Follows every engine with every number of discs.
///
/// # Errors
/// [`StudyError`] if a scene breaks.
pub fn precision(effort: &Effort, progress: Progress<'_>) -> Result<Precision, StudyError> {
    let mut ways = vec![];
    let parts = (effort.discs.len() * super::rates::ENGINES.len()) as f64;
    for &discs in &effort.discs {
        for engine in super::rates::ENGINES {
            ways.push(way(engine, discs, effort.collisions)?);
            progress(ways.len() as f64 / parts);
        }
    }
    Ok(Precision { ways, seeds: SEEDS })
}

fn way(engine: &'static str, discs: u64, most: u64) -> Result<Way, StudyError> {
    let mut looks: Vec<u64> = std::iter::successors(Some(most), |it| Some(it / 4)).take(6).collect();
    looks.reverse();
    // By look: seconds, and Z of every seed.
    let mut seen: Vec<(f64, Vec<f64>)> = vec![(0.0, vec![]); looks.len()];
    let mut count = 0;
    for seed in 1..=SEEDS {
        let [packing, _] = STATE;
        let scene = Overrides::new().set(&COUNT, discs).set(&PACKING_FRACTION, packing);
        let mut fluid = Running::begin("hard-disks", &scene.set(&SEED, seed).set(&ENGINE, engine))?;
        count = fluid.simulation.particles().grain_count();
        fluid.events((0.5 * FORGOTTEN * count as f64) as u64)?;
        let names = ["time", "virial", "temperature"];
        let [begun, virial, _] = fluid.observed(names)?;
        let (before, mut done) = (cpu_time::ProcessTime::now(), 0);
        for (&collisions, (seconds, values)) in looks.iter().zip(&mut seen) {
            fluid.events(collisions - done)?;
            done = collisions;
            *seconds += before.elapsed().as_secs_f64() / SEEDS as f64;
            let [time, sum, temperature] = fluid.observed(names)?;
            values.push(1.0 + (sum - virial) / (2.0 * count as f64 * temperature * (time - begun)));
        }
    }
    let [_, known] = STATE;
    let look = |(&collisions, (seconds, values)): (&u64, (f64, Vec<f64>))| {
        let off: Vec<f64> = values.iter().map(|z| z / known - 1.0).collect();
        let spread = crate::statistics::Spread::of(&off);
        let square = off.iter().map(|it| it * it).sum::<f64>() / off.len() as f64;
        Look {
            collisions,
            seconds,
            error: square.sqrt(),
            bias: [spread.mean, spread.error.unwrap_or(f64::NAN)],
        }
    };
    let looks: Vec<Look> = looks.iter().zip(seen).map(look).collect();
    let rate = looks.last().map_or(f64::NAN, |look| look.collisions as f64 / look.seconds);
    Ok(Way { engine, discs: count, rate, looks })
}
