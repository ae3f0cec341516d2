//! Collisions a second: the fast engine and the source's, over packing fraction and number of discs, in turns.

use crate::laboratory::running::prepared;
use crate::results::Progress;
use crate::statistics::median;
use crate::study::StudyError;
use serde::Serialize;
use stripmine_kernels::InstructionSet;
use stripmine_physics::method::hard_disks::benches::BENCHES;
use stripmine_physics::method::hard_disks::keys::ENGINE;
use stripmine_physics::method::throughput::TimedRun;
use stripmine_physics::scene::{COUNT, Overrides, PACKING_FRACTION};

/// The engines, by the names that scenes give them.
pub const ENGINES: [&str; 2] = ["fast", "reference"];

/// How much is measured.
#[derive(Clone, Debug)]
pub struct Effort {
    /// Numbers of discs, at least.
    pub discs: Vec<u64>,
    /// Packing fractions.
    pub packing_fractions: Vec<f64>,
    /// Rounds: each of them runs every engine once, so that a disturbance affects them alike.
    pub rounds: usize,
    /// Collisions of a round.
    pub collisions: u64,
}

/// An engine at a packing fraction.
#[derive(Clone, Debug, Serialize)]
pub struct Rate {
    /// Discs.
    pub discs: usize,
    /// Area of the discs over that of the box.
    pub packing_fraction: f64,
    /// The engine.
    pub engine: &'static str,
    /// Its mask, if it has one.
    pub mask: Option<String>,
    /// Collisions in a second of processor time, round by round.
    pub rates: Vec<f64>,
    /// Bytes that its run takes, as `scene check` foresees them.
    pub bytes: u64,
}

impl Rate {
    /// The median round.
    pub fn median(&self) -> f64 {
        median(self.rates.iter().copied())
    }
}

/// Every rate.
#[derive(Clone, Debug, Serialize)]
pub struct Rates {
    /// The instructions of the fast engine.
    pub instruction_set: &'static str,
    /// Collisions of a round.
    pub collisions: u64,
    /// The rates, engine by engine for each scene.
    pub rates: Vec<Rate>,
}

/// Measures.
///
/// # Errors
/// [`StudyError`] if a scene breaks.
pub fn rates(effort: &Effort, progress: Progress<'_>) -> Result<Rates, StudyError> {
    let mut rates = vec![];
    let scenes = effort.discs.len() * effort.packing_fractions.len();
    for &discs in &effort.discs {
        for &packing_fraction in &effort.packing_fractions {
            rates.extend(engines(discs, packing_fraction, effort)?);
            progress(rates.len() as f64 / (ENGINES.len() * scenes) as f64);
        }
    }
    Ok(Rates { instruction_set: InstructionSet::best().name(), collisions: effort.collisions, rates })
}

fn engines(discs: u64, packing_fraction: f64, effort: &Effort) -> Result<Vec<Rate>, StudyError> {
    let mut rates = vec![];
    let mut running = vec![];
    for engine in ENGINES {
        let scene = Overrides::new().set(&COUNT, discs).set(&PACKING_FRACTION, packing_fraction);
        let scene = prepared("hard-disks", &scene.set(&ENGINE, engine))?;
        rates.push(Rate {
            discs: scene.particles().grain_count(),
            packing_fraction,
            engine,
            mask: scene.settings["mask"].as_str().map(str::to_owned),
            rates: vec![],
            bytes: scene.memory.needed,
        });
        // From the lattice of the start to moving discs: a few collisions of each, as many as take about as long as a round.
        let equilibration = (10 * discs).min(2 * effort.collisions);
        running.push((scene, equilibration));
    }
    let mut running = running
        .into_iter()
        .map(|(scene, equilibration)| TimedRun::begin(&BENCHES[0], scene, equilibration, effort.collisions))
        .collect::<Result<Vec<_>, _>>()?;
    for _ in 0..effort.rounds {
        for (rate, running) in rates.iter_mut().zip(&mut running) {
            running.repeat()?;
            rate.rates.push(running.last_rate());
        }
    }
    Ok(rates)
}
