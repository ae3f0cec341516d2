//! How fast is a method? Whole steps of moving particles, timed.

use crate::method::{Failure, Method, Timings};
use crate::observe::{Observation, Scenery};
use crate::run::assemble;
use crate::scene::{Checked, Document, MethodKind, Precision, SceneErrors, Scheme};
use serde::Serialize;
use std::collections::BTreeMap;
use stripmine_kernels::InstructionSet;

/// What is measured.
#[derive(Clone, Debug)]
pub struct Measurement {
    /// The scene, with the method to be measured.
    pub document: Document,
    /// Steps before the clock starts; the start on a lattice is kinder than a gas.
    pub equilibration: u64,
    /// Steps of each repeat.
    pub steps: u64,
    /// Repeats.
    pub repeats: usize,
}

/// Why there is no measurement.
#[derive(Debug, thiserror::Error)]
pub enum MeasurementError {
    /// The scene.
    #[error(transparent)]
    Scene(#[from] SceneErrors),
    /// The physics.
    #[error(transparent)]
    Physics(#[from] Failure),
    /// No thread to measure on.
    #[error("no thread to measure on: {0}")]
    Threads(rayon::ThreadPoolBuildError),
}

/// The result, with the names that outside programs rely on.
#[derive(Clone, Debug, Serialize)]
pub struct Throughput {
    /// What was measured.
    pub what: &'static str,
    /// Grains.
    pub particles: usize,
    /// Area of the discs over that of the box.
    pub packing_fraction: f64,
    /// Precision of state and forces.
    pub precision: &'static str,
    /// The integrator.
    pub integrator: String,
    /// How the step is executed, as the scene names it. Lists meet their pairs one by one in every execution of programs.
    pub execution: String,
    /// Whether there is friction, and with it rotation.
    pub friction: bool,
    /// Sides of a cell of the lattice (length); none where the method needs no lattice.
    pub cell_edge: Option<[f64; 2]>,
    /// Threads.
    pub threads: usize,
    /// Instructions.
    pub instruction_set: &'static str,
    /// Repeats.
    pub repeats: usize,
    /// Steps of each repeat.
    pub steps: u64,
    /// Wall seconds of the best repeat.
    pub seconds: f64,
    /// Processor seconds of the best repeat, over all threads.
    pub cpu_seconds: f64,
    /// Most memory the process ever held; none where the platform does not say.
    pub peak_memory_bytes: Option<u64>,
    /// Temperature at the start and at the end of the measurement.
    pub temperature: [f64; 2],
    /// CRC-32 of the bits of the final state, by id.
    pub checksum: String,
    /// Grains times steps in a second: the best repeat.
    pub particle_steps_per_second: f64,
    /// The median repeat.
    pub particle_steps_per_second_median: f64,
    /// Seconds of the best repeat in each phase.
    pub phases: BTreeMap<&'static str, f64>,
    /// Contacts at the end.
    pub contacts: u64,
}

/// Measures.
///
/// # Errors
/// [`MeasurementError`] if the scene is bad or breaks while running.
pub fn throughput(measurement: Measurement) -> Result<Throughput, MeasurementError> {
    let Measurement { document, equilibration, steps, repeats } = measurement;
    let mut running = Running::begin(document, equilibration, steps)?;
    (0..repeats).try_for_each(|_| running.repeat())?;
    Ok(running.measured())
}

/// A scene that runs, and is timed for some steps again and again.
pub struct Running {
    checked: Checked,
    method: Box<dyn Method>,
    scenery: Scenery,
    steps: u64,
    temperature: f64,
    samples: Vec<(f64, f64, Timings)>,
}

impl Running {
    /// Lets the scene run for `equilibration` steps. Repeats have `steps`.
    ///
    /// # Errors
    /// [`MeasurementError`] if the scene is bad or breaks while running.
    pub fn begin(document: Document, equilibration: u64, steps: u64) -> Result<Self, MeasurementError> {
        let checked = document.check()?;
        let method = assemble(&checked)?;
        let scenery = Scenery::of(&crate::run::model(&checked));
        let mut running = Running { checked, method, scenery, steps, temperature: 0.0, samples: vec![] };
        running.advance(equilibration)?;
        running.temperature = running.observation().temperature;
        Ok(running)
    }

    /// Times the steps of a repeat.
    ///
    /// # Errors
    /// [`MeasurementError::Physics`] if the scene breaks.
    pub fn repeat(&mut self) -> Result<(), MeasurementError> {
        self.method.reset_timings();
        let (wall, cpu) = (std::time::Instant::now(), cpu_time::ProcessTime::now());
        self.advance(self.steps)?;
        let sample = (wall.elapsed().as_secs_f64(), cpu.elapsed().as_secs_f64(), *self.method.timings());
        self.samples.push(sample);
        Ok(())
    }

    fn advance(&mut self, steps: u64) -> Result<(), Failure> {
        (0..steps).try_for_each(|_| self.method.step())
    }

    fn observation(&self) -> Observation {
        let Running { method, scenery, .. } = self;
        Observation::of(method.steps(), method.time(), &method.particles(), scenery)
    }

    /// What came out.
    ///
    /// # Panics
    /// If there was no repeat.
    pub fn measured(mut self) -> Throughput {
        self.samples.sort_by(|a, b| a.0.total_cmp(&b.0));
        let after = self.observation();
        let Running { checked, method, steps, temperature: before, samples, .. } = self;
        let scene = &checked.scene;
        let particles = checked.particles.grain_count();
        let discs: f64 =
            checked.particles.all().iter().map(|disc| std::f64::consts::PI * disc.radius.powi(2)).sum();
        let work = particles as f64 * steps as f64;
        let (seconds, cpu_seconds, timings) = samples[0];
        Throughput {
            what: match scene.method.kind {
                MethodKind::Lattice => "lattice",
                MethodKind::Sectors => "sectors",
                MethodKind::NeighborList { .. } => "neighbor-list",
            },
            particles,
            packing_fraction: discs / (checked.domain.sides[0] * checked.domain.sides[1]),
            precision: match scene.method.precision {
                Precision::F64 => "f64",
                Precision::F32 => "f32",
                Precision::Mixed => "mixed",
            },
            integrator: match scene.integrator.scheme {
                Scheme::Gear { values } => format!("gear{values}"),
                Scheme::VelocityVerlet => "velocity-verlet".to_owned(),
            },
            execution: scene.method.execution.name(),
            friction: scene.law.has_friction(),
            cell_edge: scene.method.needs_lattice().then_some(checked.geometry.frame.edge),
            threads: rayon::current_num_threads(),
            instruction_set: scene.method.instruction_set.unwrap_or_else(InstructionSet::best).name(),
            repeats: samples.len(),
            steps,
            seconds,
            cpu_seconds,
            peak_memory_bytes: peak_memory(),
            temperature: [before, after.temperature],
            checksum: super::checksum(&method.particles()),
            particle_steps_per_second: work / seconds,
            particle_steps_per_second_median: work / samples[samples.len() / 2].0,
            phases: timings.named(),
            contacts: after.contacts,
        }
    }
}

/// The peak memory of this process, where the system gives it (Linux: `VmHWM`).
fn peak_memory() -> Option<u64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find(|line| line.starts_with("VmHWM:"))?;
    Some(line.split_whitespace().nth(1)?.parse::<u64>().ok()? * 1024)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_search_is_said_to_run_in_the_execution_that_was_asked_for() {
        for (search, executions) in [
            ("lattice", ["fast", "chained", "eager", "strip:64"].as_slice()),
            ("neighbor-list", &["fast", "chained", "eager", "strip:64"]),
            ("sectors", &["fast"]),
        ] {
            for execution in executions {
                let overrides = [
                    "particles.count=60".to_owned(),
                    format!("method.kind=\"{search}\""),
                    format!("method.execution=\"{execution}\""),
                ];
                let document = Document::load("bench", &overrides).unwrap();
                let measured =
                    throughput(Measurement { document, equilibration: 1, steps: 2, repeats: 1 }).unwrap();
                assert_eq!((measured.what, measured.execution.as_str()), (search, *execution));
            }
        }
    }
}
