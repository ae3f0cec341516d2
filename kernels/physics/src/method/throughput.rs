//! Throughput of a method: timed runs of moving particles.

use crate::memory;
use crate::method::observed::{UnknownName, find};
use crate::method::{Bench, PhysicsFailure, Prepared, Simulation, StartPurpose};
use crate::ranks;
use crate::reported::{ErrorClass, Reported};
use crate::scene::SceneErrors;
use serde::Serialize;
use serde_json::{Map, Value, json};
use std::collections::BTreeMap;
use std::sync::atomic::AtomicBool;
use std::time::Instant;
use stripmine_kernels::isa::ProgramError;
use stripmine_kernels::sweep::lattice::ShapeError;

/// Request for a measurement.
pub struct ThroughputRequest {
    /// Benchmark: defines a repeat and the rate.
    pub bench: &'static Bench,
    /// The scene.
    pub prepared: Prepared,
    /// Steps or events of each repeat.
    pub steps: u64,
    /// Repeats.
    pub repeats: usize,
}

/// Reason for a failed measurement.
#[derive(Debug, thiserror::Error)]
pub enum MeasurementError {
    /// The scene is invalid.
    #[error(transparent)]
    Scene(#[from] SceneErrors),
    /// The physics fails.
    #[error(transparent)]
    Physics(#[from] PhysicsFailure),
    /// The method does not observe a quantity that the benchmark reports.
    #[error(transparent)]
    Unknown(#[from] UnknownName),
    /// A vector program cannot be run.
    #[error(transparent)]
    Program(#[from] ProgramError),
    /// The lattice is impossible.
    #[error(transparent)]
    Shape(#[from] ShapeError),
    /// There is no thread to measure on.
    #[error("cannot start threads for the measurement: {0}")]
    Threads(rayon::ThreadPoolBuildError),
}

/// Result of a measurement.
#[derive(Clone, Debug)]
pub struct Throughput {
    /// Name of the benchmark.
    pub what: &'static str,
    /// Number of moving particles.
    pub particles: usize,
    /// Settings: precision, integrator and so on.
    pub settings: Map<String, Value>,
    /// Threads.
    pub threads: usize,
    /// Repeats.
    pub repeats: usize,
    /// Steps or events of each repeat.
    pub steps: u64,
    /// Wall seconds of the best repeat.
    pub seconds: f64,
    /// Processor seconds of the best repeat, over all threads.
    pub(crate) cpu_seconds: f64,
    /// Peak memory of the process; none where the platform does not report it.
    pub(crate) peak_memory_bytes: Option<u64>,
    /// CRC-32 of the bits of the final state, by id.
    pub checksum: String,
    /// The name of the rate.
    pub rate_name: &'static str,
    /// Rate of the best repeat.
    pub rate: f64,
    /// Rate of the median repeat.
    pub median_rate: f64,
    /// Seconds of the best repeat in each phase.
    pub phases: BTreeMap<&'static str, f64>,
    /// Quantities at the start and at the end of the measurement, if the benchmark compares them.
    pub compared: Vec<(&'static str, [f64; 2])>,
    /// Quantities at the end.
    pub at_end: Vec<(&'static str, f64)>,
}

/// Uses the names that outside programs rely on.
impl Serialize for Throughput {
    fn serialize<S: serde::Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut data = Map::new();
        let mut say = |name: &str, value: Value| data.insert(name.to_owned(), value);
        say("what", json!(self.what));
        say("particles", json!(self.particles));
        self.settings.iter().for_each(|(name, value)| drop(say(name, value.clone())));
        say("threads", json!(self.threads));
        say("repeats", json!(self.repeats));
        say("steps", json!(self.steps));
        say("seconds", json!(self.seconds));
        say("cpu_seconds", json!(self.cpu_seconds));
        say("peak_memory_bytes", json!(self.peak_memory_bytes));
        say("checksum", json!(self.checksum));
        say(self.rate_name, json!(self.rate));
        say(&format!("{}_median", self.rate_name), json!(self.median_rate));
        say("phases", json!(self.phases));
        self.compared.iter().for_each(|(name, values)| drop(say(name, json!(values))));
        self.at_end.iter().for_each(|(name, value)| drop(say(name, json!(value))));
        data.serialize(serializer)
    }
}

/// Measures the throughput; `progress` receives the completed fraction between repeats.
///
/// # Errors
/// [`MeasurementError`] if the scene is invalid or fails while running.
pub fn throughput(
    measurement: ThroughputRequest,
    progress: impl Fn(f64),
) -> Result<Throughput, MeasurementError> {
    let ThroughputRequest { bench, prepared, steps, repeats } = measurement;
    let mut running = ThroughputRun::begin(bench, prepared, steps)?;
    for repeat in 0..repeats {
        // Preparation takes about as long as a tenth of a repeat.
        progress((0.1 + repeat as f64) / (0.1 + repeats as f64));
        running.repeat()?;
    }
    Ok(running.measured()?)
}

/// Times and work of a repeat (wall and processor seconds, seconds in each phase).
struct Repeat {
    wall: f64,
    cpu: f64,
    work: f64,
    phases: BTreeMap<&'static str, f64>,
}

/// Running scene that is timed repeatedly.
pub struct ThroughputRun {
    bench: &'static Bench,
    particles: usize,
    settings: Map<String, Value>,
    simulation: Box<dyn Simulation>,
    /// Wall seconds until the first step.
    start: f64,
    steps: u64,
    before: Vec<f64>,
    /// Names and indices of quantities reported at the start and at the end, and at the end alone.
    compared: Vec<(&'static str, usize)>,
    at_end: Vec<(&'static str, usize)>,
    repeats: Vec<Repeat>,
}

impl ThroughputRun {
    /// Starts the scene and warms it up. Repeats have `steps` steps or events.
    ///
    /// # Errors
    /// [`MeasurementError`] if the scene is invalid or fails while running.
    pub fn begin(
        bench: &'static Bench,
        mut prepared: Prepared,
        steps: u64,
    ) -> Result<Self, MeasurementError> {
        prepared.memory.clone().for_crew(ranks::current_backend()).fits(bench.name)?;
        let (particles, settings) = (prepared.particles().grain_count(), prepared.settings.clone());
        let begun = Instant::now();
        let simulation = prepared.start_last(StartPurpose::Measurement)?;
        let start = begun.elapsed().as_secs_f64();
        let places = |names: &'static [&'static str]| {
            names
                .iter()
                .map(|&name| Ok((name, find(bench.quantities, name)?)))
                .collect::<Result<_, UnknownName>>()
        };
        let [compared, at_end] = [places(bench.compared)?, places(bench.at_end)?];
        let (before, repeats) = (vec![], vec![]);
        let mut running = ThroughputRun {
            bench,
            particles,
            settings,
            simulation,
            start,
            steps,
            before,
            compared,
            at_end,
            repeats,
        };
        running.advance(bench.warm_up(steps))?;
        running.before = running.simulation.row();
        running.simulation.check_ranks()?;
        Ok(running)
    }

    /// Times the steps of a repeat.
    ///
    /// # Errors
    /// [`MeasurementError::Physics`] if the scene fails.
    pub fn repeat(&mut self) -> Result<(), MeasurementError> {
        self.simulation.reset_phases();
        let done = self.simulation.work();
        let (wall, cpu) = (Instant::now(), cpu_time::ProcessTime::now());
        self.advance(self.steps)?;
        let (wall, cpu) = (wall.elapsed().as_secs_f64(), cpu.elapsed().as_secs_f64());
        let work = self.simulation.work() - done;
        self.repeats.push(Repeat { wall, cpu, work, phases: self.simulation.phases() });
        Ok(())
    }

    /// Wall seconds of work beside the steps: the start, a row of observables, a copy of all particles, and a snapshot.
    pub fn overhead_seconds(&self) -> [f64; 4] {
        let least = |work: &dyn Fn()| {
            let once = |_| {
                let begun = Instant::now();
                work();
                begun.elapsed().as_secs_f64()
            };
            (0..3).map(once).fold(f64::INFINITY, f64::min)
        };
        let simulation = &self.simulation;
        // Timed once: observations of a moment may be cached.
        let begun = Instant::now();
        drop(simulation.observe());
        let row = begun.elapsed().as_secs_f64();
        let particles = least(&|| drop(simulation.particles()));
        let snapshot = least(&|| drop(simulation.snapshot()));
        [self.start, row, particles, snapshot]
    }

    fn advance(&mut self, steps: u64) -> Result<(), PhysicsFailure> {
        let moment = (self.bench.until)(steps).after(&self.simulation.clock());
        self.simulation.advance(&[moment], &AtomicBool::new(false))
    }

    /// Result of all repeats.
    ///
    /// # Errors
    /// [`PhysicsFailure`] if a rank was lost.
    ///
    /// # Panics
    /// If there was no repeat.
    pub fn measured(mut self) -> Result<Throughput, PhysicsFailure> {
        self.repeats.sort_by(|a, b| a.wall.total_cmp(&b.wall));
        let after = self.simulation.observe();
        let ThroughputRun {
            bench,
            particles,
            settings,
            simulation,
            steps,
            before,
            compared,
            at_end,
            repeats,
            ..
        } = self;
        let [best, median] = [0, repeats.len() / 2].map(|place| &repeats[place]);
        let measured = Throughput {
            what: bench.name,
            particles,
            settings,
            threads: rayon::current_num_threads(),
            repeats: repeats.len(),
            steps,
            seconds: best.wall,
            cpu_seconds: best.cpu,
            peak_memory_bytes: memory::peak(),
            checksum: simulation.per_particle().checksum(),
            rate_name: bench.rate,
            rate: best.work / best.wall,
            median_rate: median.work / median.wall,
            phases: best.phases.clone(),
            compared: compared.into_iter().map(|(name, at)| (name, [before[at], after[at]])).collect(),
            at_end: at_end.into_iter().map(|(name, at)| (name, after[at])).collect(),
        };
        simulation.check_ranks().map(|()| measured)
    }
}

impl Reported for MeasurementError {
    fn class(&self) -> ErrorClass {
        match self {
            MeasurementError::Scene(errors) => errors.class(),
            MeasurementError::Physics(failure) => failure.class(),
            MeasurementError::Unknown(error) => error.class(),
            MeasurementError::Shape(_) => ErrorClass::Precondition,
            MeasurementError::Program(_) | MeasurementError::Threads(_) => ErrorClass::InputOutput,
        }
    }

    fn inner_error(&self) -> Option<&dyn Reported> {
        match self {
            MeasurementError::Scene(errors) => Some(errors),
            MeasurementError::Physics(failure) => Some(failure),
            MeasurementError::Unknown(error) => Some(error),
            MeasurementError::Program(_) | MeasurementError::Shape(_) | MeasurementError::Threads(_) => None,
        }
    }
}
