//! Keys common to all methods: format and units, duration, files.

use super::SceneError;
use super::binding::Binding;
use super::key_set::ExclusiveKeys;
use super::keys::Fallback::{Is, Otherwise, Required};
use super::keys::KeyValueKind::{self, Number, OneOf, Switch, Text, Whole};
use super::keys::NumberRange::{NonNegative, Positive};
use super::keys::{Key, Use, define_keys};
use super::target::MeanTarget;
use super::values::SceneValues;
use crate::input::MistakeKind;
use crate::io::FORMATS;
use crate::io::output_format::OutputFormat;
use crate::number::significant;
use crate::structure;

/// Version of the scene format that this program reads.
pub(crate) const FORMAT_VERSION: u64 = 2;

const ALWAYS: Use = None;
/// Largest number of steps of a run.
const MOST_STEPS: u64 = 1_000_000_000_000;

define_keys! {
    /// Head of the file, and the method's name.
    pub static HEADING;
    FORMAT = "" "format", OneOf(&[FORMAT_VERSION]), "", Required, ALWAYS,
        "Version of the scene format.";
    UNITS = "" "units", Text, "", Required, ALWAYS,
        "Unit system: \"SI\", \"reduced\", … A label; nothing is converted.";
    METHOD = "method" "kind", Text, "", Required, ALWAYS,
        "Name of the method, which determines the other keys of the scene.";
}

define_keys! {
    /// Duration and output of a method with time steps.
    pub static STEPPED_RUN;
    STEPS = "run" "steps", Whole(0, MOST_STEPS), "", Otherwise("from `time`"), ALWAYS,
        "Number of steps.";
    TIME = "run" "time", Number(NonNegative), "time", Otherwise("from `steps`"), ALWAYS,
        "Duration; rounded to a whole number of steps.";
    THERMO_EVERY = "run" "thermo_every", Whole(0, MOST_STEPS), "steps", Is("100"), ALWAYS,
        "Steps between rows of thermo.csv; 0 for none.";
    SNAPSHOT_EVERY = "run" "snapshot_every", Whole(0, MOST_STEPS), "steps", Is("1000"), ALWAYS,
        "Steps between snapshots; 0 for the first and the last only.";
    CHECKPOINT_EVERY = "run" "checkpoint_every", Whole(0, MOST_STEPS), "steps", Otherwise("by the wall clock"), ALWAYS,
        "Steps between checkpoints; 0 for one at the end only. Default: one every ten seconds of wall time. Results do not depend on it.";
}

define_keys! {
    /// End of a run at a target error of a mean.
    pub static TARGETED;
    TARGET = "run" "until", KeyValueKind::Target, "", Otherwise("no target"), ALWAYS,
        "Ends the run once the mean of a quantity reaches a target error: the half-width of its 95 % confidence interval, in percent of the mean or in its unit. `steps` or `time` is the latest end; a run that reaches it first fails.";
}

static KEYS_OF_FORMATS: [Key; FORMATS.len()] = {
    let (mut keys, mut at) = ([UNITS; FORMATS.len()], 0);
    while at < keys.len() {
        let OutputFormat { key: name, doc, is_default, .. } = FORMATS[at];
        let fallback = Is(if is_default { "true" } else { "false" });
        keys[at] = Key { section: "output", name, kind: Switch, fallback, doc, ..UNITS };
        at += 1;
    }
    keys
};

/// Output files: a key for each of [`FORMATS`], in their order.
pub static OUTPUT: &[&Key] = &KEYS_OF_FORMATS.each_ref();

define_keys! {
    /// Averages of the structure during a run, for scenes with a box.
    pub(crate) static SUMMED;
    STRUCTURE = "output" "structure", KeyValueKind::Words(&structure::NAMES), "", Is("[]"), ALWAYS,
        "Structure functions averaged over the second half of the run, each in a file of its own with its error. Samples are snapshots; for msd, msd_a and vacf they are rows of thermo.csv. Functions with a and b are by species: discs of different radius or second_radius, or types of a start file.";
    STRUCTURE_RANGE = "output" "structure_range", Number(Positive), "length", Otherwise("4 mean diameters, or less as the box allows"), ALWAYS,
        "Largest distance r of g(r), at most half of a periodic side.";
    STRUCTURE_BINS = "output" "structure_bins", Whole(1, 1000), "", Otherwise("50 in a mean diameter"), ALWAYS,
        "Number of bins of g(r) from 0 to the largest distance.";
    STRUCTURE_SHARE = "output" "structure_share", Number(Positive), "", Otherwise("0.05"), ALWAYS,
        "Largest fraction of a run's work for structure functions, by a count of operations. Where samples cost more, only every second, third, … row or snapshot is one. 1000 for all of them.";
}

define_keys! {
    /// Time step.
    pub static STEP;
    DT = "integrator" "dt", Number(Positive), "time", Required, ALWAYS,
        "Time step.";
}

/// Duration keys of a run with time steps: a number of steps or a time.
pub static DURATION: &[ExclusiveKeys] =
    &[ExclusiveKeys { keys: &[&STEPS, &TIME], used: ALWAYS, needed: true, with: None }];

/// Duration of a run and intervals of its output (steps; 0 is never).
#[derive(Clone, Debug, Default, PartialEq)]
pub struct RunKeys {
    /// Number of steps.
    pub steps: u64,
    /// Target error of a mean that ends the run early.
    pub target: Option<MeanTarget>,
    /// Steps between rows of observables.
    pub(crate) thermo_every: u64,
    /// Steps between snapshots.
    pub(crate) snapshot_every: u64,
    /// Steps between checkpoints; by wall time if none.
    pub(crate) checkpoint_every: Option<u64>,
}

impl RunKeys {
    /// Binds its keys; a time is rounded to a whole number of steps of `dt` (time).
    pub fn bind(&mut self, binding: &mut dyn Binding, dt: f64) {
        let mut time = None;
        binding.number_if_any(&TIME, &mut time);
        match time {
            Some(time) => self.steps = (time / dt).round() as u64,
            None => binding.whole(&STEPS, &mut self.steps),
        }
        binding.target_if_any(&TARGET, &mut self.target);
        binding.whole(&THERMO_EVERY, &mut self.thermo_every);
        binding.whole(&SNAPSHOT_EVERY, &mut self.snapshot_every);
        binding.whole_if_any(&CHECKPOINT_EVERY, &mut self.checkpoint_every);
    }
}

/// Checks that a duration has at most the largest number of steps.
pub fn too_many_steps(values: &SceneValues) -> Vec<SceneError> {
    let given = values.given(&TIME).and_then(|_| Some((values.number(&TIME)?, values.number(&DT)?)));
    let Some((time, dt)) = given.filter(|(time, dt)| time / dt > MOST_STEPS as f64) else { return vec![] };
    let message = format!("`run.time` = {time} takes {} steps of dt = {dt}", significant(time / dt, 4));
    let error = values.spot(&TIME).error(MistakeKind::Range, message);
    vec![error.expecting(format!("at most {} steps", significant(MOST_STEPS as f64, 1)))]
}

/// Output files of a run.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Output {
    /// Formats for particles, by their keys.
    pub(crate) formats: Vec<&'static str>,
    /// Names of the structure functions.
    pub structure: Vec<String>,
    /// Largest distance of pairs in structure functions (length).
    pub(crate) structure_range: Option<f64>,
    /// Bins of these distances.
    pub(crate) structure_bins: Option<u64>,
    /// Largest fraction of the work for structure functions.
    pub(crate) structure_share: Option<f64>,
}

impl Output {
    /// True if particles are written in a format.
    pub fn asks_for(&self, format: &OutputFormat) -> bool {
        self.formats.contains(&format.key)
    }

    /// True if a structure function needs displacements, for which discs are followed across periodic sides.
    pub(crate) fn follows_motion(&self) -> bool {
        self.structure.iter().filter_map(|name| structure::observable(name)).any(|it| it.follows_motion())
    }

    /// Binds its keys.
    pub fn bind(&mut self, binding: &mut dyn Binding) {
        let asked = FORMATS.iter().zip(OUTPUT.iter().copied()).filter(|&(format, key)| {
            let mut is_asked = self.asks_for(format);
            binding.switch(key, &mut is_asked);
            is_asked
        });
        self.formats = asked.map(|(format, _)| format.key).collect();
        binding.words(&STRUCTURE, &mut self.structure);
        binding.number_if_any(&STRUCTURE_RANGE, &mut self.structure_range);
        binding.whole_if_any(&STRUCTURE_BINS, &mut self.structure_bins);
        binding.number_if_any(&STRUCTURE_SHARE, &mut self.structure_share);
    }
}

/// Binds format, units and method at the head of a scene.
pub fn bind_heading(binding: &mut dyn Binding, units: &mut String, method: &'static str) {
    binding.whole(&FORMAT, &mut { FORMAT_VERSION });
    binding.word(&UNITS, units);
    binding.word(&METHOD, &mut method.to_owned());
}
