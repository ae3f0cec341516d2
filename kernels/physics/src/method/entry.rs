//! Descriptions of methods: their entries in the list of methods, and prepared scenes.

use super::bound::BoundPrograms;
use super::clock::{Schedule, Until};
use super::failure::PhysicsFailure;
use super::simulation::Simulation;
use super::trials::{SettingAxis, Trials, Twin};
use crate::domain::Domain;
use crate::memory::MemoryForecast;
use crate::particles::Particles;
use crate::scene::{MeanTarget, Output, SceneErrors, SceneValues, Vocabulary, Warning};
use crate::structure::{PairForces, StructureSetting};
use serde::Serialize;
use serde_json::{Map, Value};
use std::path::PathBuf;
use stripmine_kernels::Runnable;

/// Description of a method for the rest of the program.
#[derive(Debug)]
pub struct MethodEntry {
    /// Name, keys and presets of its scenes.
    pub vocabulary: &'static Vocabulary,
    /// Publication that it reproduces.
    pub source: &'static str,
    /// One-line description.
    pub doc: &'static str,
    /// Observed quantities: the columns of thermo.csv after the step.
    pub quantities: &'static [ObservedQuantity],
    /// Checks a scene against every precondition and generates its particles; reports all mistakes at once.
    pub prepare: fn(SceneValues) -> Result<Prepared, SceneErrors>,
    /// Measurements of its throughput.
    pub benches: &'static [Bench],
    /// Choices that do not change the physics; each combination that the check accepts is a configuration of the scene.
    pub axes: &'static [SettingAxis],
    /// Simpler models of its scenes.
    pub twins: &'static [Twin],
    /// Trials of its scenes; none where nothing can be varied.
    pub trials: Option<&'static Trials>,
}

/// Observed quantity: a column of thermo.csv.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ObservedQuantity {
    /// The name of its column.
    pub name: &'static str,
    /// The unit, empty for pure numbers.
    pub unit: &'static str,
    /// Kind of number, which decides how it is averaged.
    pub kind: QuantityKind,
    /// Description.
    pub doc: &'static str,
}

/// True if a quantity may have this value in an intact run: finite, or NaN for a temperature, which is undefined without a degree of freedom.
pub(crate) fn is_sound(quantity: &str, value: f64) -> bool {
    value.is_finite() || value.is_nan() && quantity == "temperature"
}

/// Kind of number that a quantity is. It decides how the quantity is averaged.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum QuantityKind {
    /// The time of the row.
    Time,
    /// Instantaneous value: averaged over rows.
    Instant,
    /// Count or sum since the start: it has a rate.
    Counter,
    /// Mean over the time since the previous row, of sums that every event adds to. Averaged without the first row, which covers no time.
    Interval,
    /// Quantity that the equations conserve or balance, except for external action. It shows errors and is not averaged.
    Kept,
}

impl QuantityKind {
    /// True if it accumulates since the start.
    pub fn grows(self) -> bool {
        self == QuantityKind::Counter
    }
}

/// Quantity with the function that evaluates it.
#[derive(Clone, Copy)]
pub struct MethodObservable<S: 'static> {
    /// Name, unit and meaning.
    pub quantity: ObservedQuantity,
    /// Its value.
    pub of: fn(&S) -> f64,
}

/// Quantities of a list of observables: the columns of their table.
pub(crate) const fn quantities<S: 'static, const COUNT: usize>(
    observables: &[MethodObservable<S>; COUNT],
) -> [ObservedQuantity; COUNT] {
    let mut quantities = [observables[0].quantity; COUNT];
    let mut place = 1;
    while place < COUNT {
        quantities[place] = observables[place].quantity;
        place += 1;
    }
    quantities
}

/// Benchmark of throughput.
#[derive(Debug)]
pub struct Bench {
    /// Its name.
    pub name: &'static str,
    /// Description of what is measured.
    pub doc: &'static str,
    /// The scene.
    pub preset: &'static str,
    /// The name of the rate, such as `particle_steps_per_second`.
    pub rate: &'static str,
    /// End of a repeat of this many steps or events.
    pub until: fn(u64) -> Until,
    /// Number of steps or events that take about a second, by number of particles.
    pub amount: fn(u64) -> u64,
    /// Fewest steps or events before the first repeat: a start on a lattice costs less than a gas. 1 if work does not depend on the state.
    pub least_warm_up: u64,
    /// Values of options that are not given.
    pub defaults: &'static [(&'static str, &'static str)],
    /// Choices with a short name, each with the overrides of a value.
    pub options: &'static [BenchOption],
    /// Overrides that make the bench.
    pub overrides: &'static [&'static str],
    /// Observed quantities.
    pub quantities: &'static [ObservedQuantity],
    /// Quantities reported at the start and at the end of the measurement.
    pub compared: &'static [&'static str],
    /// Quantities reported at the end.
    pub at_end: &'static [&'static str],
}

impl Bench {
    /// Steps or events before the first of the repeats with `amount` each: a tenth of a repeat warms up the processor.
    pub fn warm_up(&self, amount: u64) -> u64 {
        self.least_warm_up.max(amount / 10)
    }
}

/// Option of a benchmark: a short name for a part of its scene.
#[derive(Debug)]
pub struct BenchOption {
    /// The name.
    pub name: &'static str,
    /// Allowed values; none where the scene checks them.
    pub values: &'static [&'static str],
    /// Overrides of a value.
    pub overrides: fn(&str) -> Vec<String>,
}

/// Builds the options of a benchmark: name, values if they are listed here, and the overrides of a value.
macro_rules! bench_options {
    ($($name:literal $values:expr, $overrides:expr;)*) => {
        &[$($crate::method::BenchOption { name: $name, values: &$values, overrides: $overrides }),*]
    };
}
pub(super) use bench_options;

/// Reported property of a scene.
#[derive(Clone, Debug, PartialEq)]
pub struct Fact {
    /// Name and value, as data.
    pub data: Option<(&'static str, Value)>,
    /// Label and value in words, for people.
    pub words: Option<(&'static str, String)>,
}

impl Fact {
    /// Fact for programs only.
    pub fn data(name: &'static str, value: impl Into<Value>) -> Fact {
        Fact { data: Some((name, value.into())), words: None }
    }

    /// Fact for people only.
    pub fn words(label: &'static str, words: impl Into<String>) -> Fact {
        Fact { data: None, words: Some((label, words.into())) }
    }

    /// Fact for programs and, in words, for people.
    pub fn new(
        name: &'static str,
        value: impl Into<Value>,
        label: &'static str,
        words: impl Into<String>,
    ) -> Fact {
        Fact { data: Some((name, value.into())), words: Some((label, words.into())) }
    }
}

/// Theoretical limit of the step.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct StepLimit {
    /// Name.
    pub name: &'static str,
    /// The step (time).
    pub step: f64,
    /// Step of the scene divided by the limit.
    pub share: f64,
    /// Share that most runs bear; infinite where the limit is advice.
    pub(crate) warned_beyond: f64,
    /// Consequence of longer steps.
    pub beyond: LimitConsequence,
    /// Derivation, with its numbers.
    pub why: String,
}

impl StepLimit {
    /// True if the limit is advice, which runs may exceed without a warning.
    pub fn is_advice(&self) -> bool {
        self.warned_beyond.is_infinite()
    }

    /// True if the step exceeds the limit by more than most runs bear.
    pub fn is_passed(&self) -> bool {
        self.share > self.warned_beyond
    }
}

/// Consequence of a step beyond a limit.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum LimitConsequence {
    /// Errors grow from step to step.
    Unstable,
    /// Motion is inaccurate.
    Inaccurate,
    /// Particles pass through each other undetected.
    Unseen,
}

/// Purpose of a simulation.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum StartPurpose {
    /// Run with observations: everything that they need is tracked.
    Run,
    /// Measurement of speed: only what the motion needs is tracked.
    Measurement,
}

/// Returns the reasons that apply for leaving something out of a run.
pub(super) fn left_out(reasons: &[(bool, &str)]) -> Vec<String> {
    reasons.iter().filter(|(is_so, _)| *is_so).map(|(_, reason)| (*reason).to_owned()).collect()
}

/// Program of whole-array operations, with its executions per step.
pub struct VectorProgram {
    /// The part of the step.
    pub part: &'static str,
    /// Symbol of its vector length.
    pub length: &'static str,
    /// Vector length.
    pub n: usize,
    /// Executions per step.
    pub times: u64,
    /// The program.
    pub program: Box<dyn Runnable>,
}

/// Scene that is ready to run: its particles exist and every precondition holds.
pub struct Prepared {
    /// Name of the system of units.
    pub units: String,
    /// Scene as TOML, with every value and every choice written out.
    pub scene: String,
    /// Length of the run and intervals of its output.
    pub schedule: Schedule,
    /// Target error of a mean that ends the run early.
    pub target: Option<MeanTarget>,
    /// Files to write.
    pub output: Output,
    /// The box.
    pub domain: Domain,
    /// Seed of the generated start; none where it was read or listed.
    pub seed: Option<u64>,
    /// File that the start was read from.
    pub start_file: Option<PathBuf>,
    /// File that the pair law was read from, and the digest of its rows.
    pub law_file: Option<(PathBuf, String)>,
    /// Reported properties of the scene.
    pub facts: Vec<Fact>,
    /// Warnings about settings that seldom work.
    pub warnings: Vec<Warning>,
    /// Choices that the scene left open, with reasons.
    pub choices: Vec<String>,
    /// Parts that the scene does not need, with reasons.
    pub left_out: Vec<String>,
    /// Theoretical limits of the step; none where there is no step or no theory.
    pub step_limits: Vec<StepLimit>,
    /// Expected error of a run and its measure; none where nothing is known.
    pub expected_error: Option<Fact>,
    /// Memory requirement of a run.
    pub memory: MemoryForecast,
    /// Settings of the run by name: precision, integrator and so on.
    pub settings: Map<String, Value>,
    /// Column names of `events.csv`, if the scene asks for a row for each event.
    pub event_columns: Option<&'static str>,
    /// Model that simulations are started from.
    pub model: Box<dyn Startable>,
}

impl Prepared {
    /// The particles at the start.
    pub fn particles(&self) -> &Particles {
        self.model.particles()
    }

    /// Box and bins of the structure functions.
    pub(crate) fn structure_setting(&self) -> StructureSetting {
        let of =
            if self.model.has_open_top() { StructureSetting::with_open_top } else { StructureSetting::new };
        let setting = of(self.domain, self.particles());
        setting.with_bins(self.output.structure_range, self.output.structure_bins)
    }

    /// Observed quantities: those of its method, `entry`, and those of the scene.
    pub fn quantities(&self, entry: &MethodEntry) -> &'static [ObservedQuantity] {
        entry.quantities_with(&self.model.own_quantities())
    }

    /// Starts a simulation.
    ///
    /// # Errors
    /// [`PhysicsFailure`] if the start violates a precondition, or the processor lacks the requested instruction set.
    pub fn start(&self, purpose: StartPurpose) -> Result<Box<dyn Simulation>, PhysicsFailure> {
        self.model.start(purpose)
    }

    /// Starts the last simulation of the scene. Less memory is needed than with [`start`](Self::start): the particles at the start may be
    /// released, and [`particles`](Self::particles) is empty then.
    ///
    /// # Errors
    /// [`PhysicsFailure`] as of [`start`](Self::start).
    pub fn start_last(&mut self, purpose: StartPurpose) -> Result<Box<dyn Simulation>, PhysicsFailure> {
        self.model.start_last(purpose)
    }
}

/// Checked scene of a method with its particles: starts simulations.
pub trait Startable: Send + Sync {
    /// The particles at the start.
    fn particles(&self) -> &Particles;

    /// Names of quantities that the scene has beside those of its method: columns of thermo.csv after these.
    fn own_quantities(&self) -> Vec<String> {
        vec![]
    }

    /// True if plane walls inside the box keep discs from parts of it.
    fn has_segments(&self) -> bool {
        false
    }

    /// Vector programs of a step or its forces, which are counted, listed and timed by models; none where a method has no vector programs.
    fn programs(&self) -> Vec<VectorProgram> {
        vec![]
    }

    /// Calls `task` once with the programs of a step, or of its forces, and their arrays at the start; returns false where a method has none.
    fn with_bound_programs(&self, _task: &mut BoundPrograms<'_>) -> bool {
        false
    }

    /// Note on the vector programs beside their counts: the scene itself runs another engine.
    fn programs_note(&self) -> Option<String> {
        None
    }

    /// Work of one particle in a step, or in a unit of time where there are no steps: nanoseconds estimated from the count of pairs or events at the
    /// start, on no particular machine. It decides how often the structure is sampled: at every row and snapshot where it is 0.
    fn work(&self) -> f64 {
        0.0
    }

    /// Forces between a pair at any moment; none where the method has no pair forces.
    fn pair_forces(&self) -> Option<PairForces> {
        None
    }

    /// True if particles may rise above the upper end of the second side of the box: their height is unbounded.
    fn has_open_top(&self) -> bool {
        false
    }

    /// True if a run counts the periods that each particle crosses (`Simulation::images`) where the scene asks for displacements.
    fn follows_crossings(&self) -> bool {
        false
    }

    /// Starts a simulation.
    ///
    /// # Errors
    /// [`PhysicsFailure`] if the start violates a precondition, or the processor lacks the requested instruction set.
    fn start(&self, purpose: StartPurpose) -> Result<Box<dyn Simulation>, PhysicsFailure>;

    /// Starts the last simulation of the scene, for which the particles at the start may be released.
    ///
    /// # Errors
    /// [`PhysicsFailure`] as of [`start`](Self::start).
    fn start_last(&mut self, purpose: StartPurpose) -> Result<Box<dyn Simulation>, PhysicsFailure> {
        self.start(purpose)
    }

    /// Returns this scene started from other positions and velocities of the same particles in the same order.
    fn started_from(&self, particles: Particles) -> Prepared;

    /// Returns this scene with another noise seed, where each step uses the noise of `parts` shorter steps. A run with steps of h and p parts follows
    /// the Brownian path of one with steps of h/p and one part. The scheme decides how increments of the path add up. No checkpoint and no scene
    /// stores the parts. None where there is no noise.
    fn with_noise(&self, _seed: u64, _parts: u32) -> Option<Prepared> {
        None
    }

    /// Period of time-dependent forces (time), such as moving walls or a moving floor. None where no force depends on time.
    fn period(&self) -> Option<f64> {
        None
    }
}
