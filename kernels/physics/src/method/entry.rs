//! What a method states of itself: its entry in the list of methods, and what its scenes become.

use super::clock::{Schedule, Until};
use super::failure::Failure;
use super::simulation::Simulation;
use super::trials::{Axis, Trials, Twin};
use crate::domain::Domain;
use crate::memory::Foreseen;
use crate::particles::Particles;
use crate::scene::{Output, SceneErrors, Target, Values, Vocabulary, Warning};
use crate::structure::PairForces;
use serde::Serialize;
use serde_json::{Map, Value};
use std::path::PathBuf;
use stripmine_kernels::Runnable;

/// A method, as everything else knows it.
#[derive(Debug)]
pub struct Entry {
    /// Name, keys and presets of its scenes.
    pub vocabulary: &'static Vocabulary,
    /// Where it comes from.
    pub source: &'static str,
    /// What it simulates, in a line.
    pub doc: &'static str,
    /// What it observes: the columns of thermo.csv after the step.
    pub quantities: &'static [Quantity],
    /// Holds a scene against every precondition and makes its particles; every mistake at once.
    pub prepare: fn(Values) -> Result<Prepared, SceneErrors>,
    /// Measurements of its throughput.
    pub benches: &'static [Bench],
    /// What may be chosen without changing what is simulated; every combination that its check accepts is a way to run a scene.
    pub axes: &'static [Axis],
    /// What a scene may be modelled without.
    pub twins: &'static [Twin],
    /// How its scenes may be tried; none where nothing of them may be varied.
    pub trials: Option<&'static Trials>,
}

/// Something observed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Quantity {
    /// The name of its column.
    pub name: &'static str,
    /// The unit, empty for pure numbers.
    pub unit: &'static str,
    /// What of it is averaged over a run.
    pub kind: Kind,
    /// What it is.
    pub doc: &'static str,
}

/// Whether a value of a quantity is one of a run that has not broken: a finite number, or none of a temperature, which does not exist
/// without a degree of freedom.
pub(crate) fn is_sound(quantity: &str, value: f64) -> bool {
    value.is_finite() || value.is_nan() && quantity == "temperature"
}

/// What kind of number a quantity is, which decides what of it is averaged.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Kind {
    /// The time of the row.
    Time,
    /// A value of the moment: values are averaged.
    Instant,
    /// A count or a sum since the start: it has a rate.
    Counter,
    /// A mean over the time since the row before, of sums that every event adds to: values are averaged, but for the first, of no time.
    Interval,
    /// What the equations keep or balance, but for what acts from outside: it shows errors, and is not averaged.
    Kept,
}

impl Kind {
    /// Whether it sums up since the start.
    pub fn grows(self) -> bool {
        self == Kind::Counter
    }
}

/// A quantity, and how it is read off what a method has seen of a moment.
#[derive(Clone, Copy)]
pub struct Observable<S: 'static> {
    /// Name, unit and meaning.
    pub quantity: Quantity,
    /// Its value.
    pub of: fn(&S) -> f64,
}

/// What is observed, without the values: the columns of a table of them.
pub(crate) const fn quantities<S: 'static, const COUNT: usize>(
    observables: &[Observable<S>; COUNT],
) -> [Quantity; COUNT] {
    let mut quantities = [observables[0].quantity; COUNT];
    let mut place = 1;
    while place < COUNT {
        quantities[place] = observables[place].quantity;
        place += 1;
    }
    quantities
}

/// A measurement of throughput.
#[derive(Debug)]
pub struct Bench {
    /// Its name.
    pub name: &'static str,
    /// What is measured.
    pub doc: &'static str,
    /// The scene.
    pub preset: &'static str,
    /// The name of the rate, such as `particle_steps_per_second`.
    pub rate: &'static str,
    /// Moments of a repeat, of a number of steps or events.
    pub until: fn(u64) -> Until,
    /// How many steps or events make about a second, for a number of particles.
    pub amount: fn(u64) -> u64,
    /// Values of options that are not given.
    pub defaults: &'static [(&'static str, &'static str)],
    /// What may be chosen of its scene by a short name, each with the overrides that a value makes.
    pub options: &'static [BenchOption],
    /// Overrides that make the bench.
    pub overrides: &'static [&'static str],
    /// What the method observes.
    pub quantities: &'static [Quantity],
    /// Quantities that are said as they were at the start and at the end of the measurement.
    pub compared: &'static [&'static str],
    /// Quantities that are said as they were at the end.
    pub at_end: &'static [&'static str],
}

/// Something of the scene of a bench that has a short name.
#[derive(Debug)]
pub struct BenchOption {
    /// The name.
    pub name: &'static str,
    /// The values that it may have; none where the scene judges them.
    pub values: &'static [&'static str],
    /// The overrides that a value makes.
    pub overrides: fn(&str) -> Vec<String>,
}

/// The options of a bench: name, values where they are named here, and the overrides that a value makes.
macro_rules! bench_options {
    ($($name:literal $values:expr, $overrides:expr;)*) => {
        &[$($crate::method::BenchOption { name: $name, values: &$values, overrides: $overrides }),*]
    };
}
pub(super) use bench_options;

/// Something to be said of a scene.
#[derive(Clone, Debug, PartialEq)]
pub struct Fact {
    /// Name and value, as data.
    pub data: Option<(&'static str, Value)>,
    /// Label and value in words, where a person is to read it.
    pub words: Option<(&'static str, String)>,
}

impl Fact {
    /// For programs only.
    pub fn data(name: &'static str, value: impl Into<Value>) -> Fact {
        Fact { data: Some((name, value.into())), words: None }
    }

    /// For people only.
    pub fn words(label: &'static str, words: impl Into<String>) -> Fact {
        Fact { data: None, words: Some((label, words.into())) }
    }

    /// For programs and, in words, for people.
    pub fn new(
        name: &'static str,
        value: impl Into<Value>,
        label: &'static str,
        words: impl Into<String>,
    ) -> Fact {
        Fact { data: Some((name, value.into())), words: Some((label, words.into())) }
    }
}

/// A step that theory says not to pass.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct StepLimit {
    /// What it is called.
    pub name: &'static str,
    /// The step (time).
    pub step: f64,
    /// The scene's own step in parts of it.
    pub share: f64,
    /// The share beyond which the user is warned; infinite where the limit is for information.
    pub(crate) warned_beyond: f64,
    /// What becomes of longer ones.
    pub beyond: Beyond,
    /// Where it comes from, with its numbers.
    pub why: String,
}

impl StepLimit {
    /// Whether the step is so far beyond the limit that the user is warned.
    pub fn is_passed(&self) -> bool {
        self.share > self.warned_beyond
    }
}

/// What becomes of a step beyond a limit.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Beyond {
    /// Errors grow from step to step.
    Unstable,
    /// Motion is followed badly.
    Inaccurate,
    /// Particles pass each other unseen.
    Unseen,
}

/// What a simulation is started for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Purpose {
    /// A run, which is observed: whatever observation needs is followed.
    Run,
    /// A measurement of speed: nothing is followed that the motion does not need.
    Measurement,
}

/// What a scene has no need of, each with the reason: those that are so.
pub(super) fn left_out(reasons: &[(bool, &str)]) -> Vec<String> {
    reasons.iter().filter(|(is_so, _)| *is_so).map(|(_, reason)| (*reason).to_owned()).collect()
}

/// A program of whole-array operations, as often as a step executes it.
pub struct VectorProgram {
    /// The part of the step.
    pub part: &'static str,
    /// What its vectors are as long as, in a symbol.
    pub length: &'static str,
    /// The number that stands for.
    pub n: usize,
    /// How often a step executes it.
    pub times: u64,
    /// The program.
    pub program: Box<dyn Runnable>,
}

/// A scene that may run: its particles are made, and every precondition holds.
pub struct Prepared {
    /// The scene as TOML, every value spelled out and every choice made.
    pub scene: String,
    /// How long it runs, and how often something is written.
    pub schedule: Schedule,
    /// The mean that ends it before, when it is known well enough.
    pub target: Option<Target>,
    /// Which files are written.
    pub output: Output,
    /// The box.
    pub domain: Domain,
    /// Seed of the random numbers that made the start; none where it was read or listed.
    pub seed: Option<u64>,
    /// The file that the start was read from.
    pub start_file: Option<PathBuf>,
    /// What there is to be said of the scene.
    pub facts: Vec<Fact>,
    /// What seldom ends well.
    pub warnings: Vec<Warning>,
    /// What the scene left open and has been chosen, with the reason.
    pub choices: Vec<String>,
    /// What the scene has no need of, with the reason.
    pub left_out: Vec<String>,
    /// What bounds the step, by theory; none where there is no step, or theory says nothing.
    pub step_limits: Vec<StepLimit>,
    /// How wrong a run is expected to be, and by what measure; none where nothing is known of it.
    pub expected_error: Option<Fact>,
    /// The memory that a run takes.
    pub memory: Foreseen,
    /// How it is run: precision, integrator and the like, by name.
    pub settings: Map<String, Value>,
    /// The names of the columns of `events.csv`, where the scene asks for a row for each event.
    pub event_columns: Option<&'static str>,
    /// What simulations of it are made from.
    pub model: Box<dyn Startable>,
}

impl Prepared {
    /// The particles at the start.
    pub fn particles(&self) -> &Particles {
        self.model.particles()
    }

    /// Begins.
    ///
    /// # Errors
    /// [`Failure`] if the start breaks a precondition, or the processor lacks what is asked for.
    pub fn start(&self, purpose: Purpose) -> Result<Box<dyn Simulation>, Failure> {
        self.model.start(purpose)
    }
}

/// A method's checked scene, with its particles: what simulations are made from.
pub trait Startable: Send + Sync {
    /// The particles at the start.
    fn particles(&self) -> &Particles;

    /// The vector programs that a step of the scene, or its forces, consists of: what is counted, listed and charged by clocks; none
    /// where a method has no such.
    fn programs(&self) -> Vec<VectorProgram> {
        vec![]
    }

    /// What there is to be said of the vector programs beside their counts: that the scene itself is run otherwise.
    fn programs_note(&self) -> Option<String> {
        None
    }

    /// What a disc takes in a step, or in a unit of time where there are no steps: nanoseconds by a count of its pairs or events at
    /// the start, on no machine in particular. How often the structure is looked at goes by it: at every row and snapshot where it is 0.
    fn work(&self) -> f64 {
        0.0
    }

    /// What two particles do to each other at any moment; none where there are no forces between pairs of discs.
    fn pair_forces(&self) -> Option<PairForces> {
        None
    }

    /// Whether discs may be above the upper end of the second side of the box: nothing bounds their height.
    fn has_open_top(&self) -> bool {
        false
    }

    /// Reports whether a run counts the periods that each disc crosses (`Simulation::images`) where the scene asks for displacements.
    fn follows_crossings(&self) -> bool {
        false
    }

    /// Begins.
    ///
    /// # Errors
    /// [`Failure`] if the start breaks a precondition, or the processor lacks what is asked for.
    fn start(&self, purpose: Purpose) -> Result<Box<dyn Simulation>, Failure>;

    /// The same scene with other positions and velocities at the start: of the same particles in the same order.
    fn started_from(&self, particles: Particles) -> Prepared;

    /// The same scene whose noise has a seed, and in each step is made of that of `parts` shorter steps: a run with steps of h and p parts
    /// follows the Brownian path of one with steps of h/p and one part. The method's scheme decides how increments of the path add up. No
    /// checkpoint and no scene holds the parts. None where there is no noise.
    fn with_noise(&self, _seed: u64, _parts: u32) -> Option<Prepared> {
        None
    }

    /// Period of the forces that depend on time (time): of walls or a floor that move. None where no force does.
    fn period(&self) -> Option<f64> {
        None
    }
}
