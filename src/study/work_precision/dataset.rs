//! What came out.

use super::measures::{Errors, Measure};
use super::plan::Plan;
use crate::statistics::median;
use crate::study::collision::Collision;
use crate::study::encounters::Encounters;
use crate::study::growth::{COMPARABLE, Growth};
use crate::study::observables::Observables;
use crate::study::orders::Fitted;
use serde::{Deserialize, Serialize};

/// The dataset.
#[derive(Clone, Debug)]
pub struct WorkPrecision {
    /// Particles that move.
    pub particles: usize,
    /// What distances are measured in.
    pub unit: String,
    /// The unit of time.
    pub time_unit: Option<String>,
    /// Its own step (time).
    pub step: f64,
    /// How it runs itself.
    pub own: String,
    /// How long its trajectories are comparable.
    pub growth: Growth,
    /// What was run.
    pub plan: Plan,
    /// The time that is compared (time).
    pub duration: f64,
    /// What happens to a particle in the time that is compared.
    pub encounters: Encounters,
    /// Why no way is recommended: too little happens in the time that is compared; none where enough does.
    pub undecided: Option<String>,
    /// The reference.
    pub reference: Reference,
    /// Every way to run it.
    pub ways: Vec<Way>,
    /// Every run.
    pub runs: Vec<Run>,
    /// How errors fall with the step.
    pub orders: Vec<Order>,
    /// Means over time, where the scene has seeds.
    pub observables: Option<Observables>,
    /// What comes out of a collision, where the scene is one of two discs.
    pub collision: Option<Collision>,
    /// The machine of the clock periods.
    pub machine: Option<String>,
    /// Seeds of the means.
    pub seeds: Vec<u64>,
}

/// Diagrams, each with a name for its rows.
pub type Scenes = [(String, WorkPrecision)];

impl WorkPrecision {
    /// The integrator of a configuration.
    pub fn scheme(&self, label: &str) -> &str {
        self.ways.iter().find(|way| way.label == label).map_or("", |way| &way.scheme)
    }
}

/// What the runs are held against.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Reference {
    /// The way it is run, and the one of the second.
    pub ways: [String; 2],
    /// Its step (time).
    pub step: f64,
    /// By how much it differs from one with twice the step.
    pub halving: Errors,
    /// By how much it differs from the second one.
    pub second: Errors,
    /// Its own error: the larger of the two, and its own error of the balance.
    pub floor: Errors,
}

/// A way to run the scene.
#[derive(Clone, Debug)]
pub struct Way {
    /// Its settings in a line.
    pub label: String,
    /// The setting that decides the order.
    pub scheme: String,
    /// The settings that decide the digits.
    pub digits: String,
    /// The settings that decide the cost alone.
    pub cost: String,
    /// Whether it costs what the scene's own does: search and execution are the scene's own.
    pub is_primary: bool,
    /// Whether it has the scene's own scheme and digits.
    pub is_own_arithmetic: bool,
    /// Processor seconds of a step, by its first steps.
    pub each: Option<f64>,
    /// Why the scene cannot be run so.
    pub refused: Option<String>,
}

/// A run.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Run {
    /// The place of its way.
    pub way: usize,
    /// The step (time).
    pub step: f64,
    /// The step is the scene's own times two to this power.
    pub power: i32,
    /// Its errors, or why it broke.
    pub outcome: Result<Errors, String>,
    /// What speaks against it: a limit of the step by theory, a check, a warning of the run.
    pub objections: Vec<String>,
    /// Clock periods for a unit of time; none where no operations are counted.
    pub clocks: Option<f64>,
    /// Processor seconds for a unit of time in each repeat.
    pub costs: Vec<f64>,
}

impl Run {
    /// Processor seconds for a unit of time: the median.
    pub fn cost(&self) -> Option<f64> {
        (!self.costs.is_empty()).then(|| median(self.costs.iter().copied()))
    }

    /// An error.
    pub fn error(&self, measure: Measure) -> Option<f64> {
        self.outcome.as_ref().ok()?.get(&measure).copied()
    }

    /// Whether nothing speaks against it.
    pub fn is_sound(&self) -> bool {
        self.objections.is_empty()
    }

    /// Whether its trajectories have parted from the reference's.
    pub fn is_lost(&self) -> bool {
        self.error(Measure::Position).is_some_and(|error| error > COMPARABLE)
    }
}

/// How an error falls with the step.
#[derive(Clone, Debug)]
pub struct Order {
    /// The way.
    pub way: usize,
    /// The error.
    pub measure: Measure,
    /// What was fitted; none through too few points.
    pub fitted: Option<Fitted>,
    /// What theory says, with the reason.
    pub theory: Option<(f64, &'static str)>,
}
