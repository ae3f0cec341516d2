//! Contents of a plan.

use super::bias::BiasEstimate;
use crate::study::trial::any_number;
use serde::{Deserialize, Serialize};
use stripmine_physics::scene::Overrides;

/// A number with its bounds.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct LikelyRange {
    #[serde(with = "any_number")]
    pub least: f64,
    #[serde(with = "any_number")]
    pub(crate) likely: f64,
    #[serde(with = "any_number")]
    pub most: f64,
}

impl LikelyRange {
    /// Interval within a factor of a likely value.
    pub(super) fn within(likely: f64, factor: f64) -> LikelyRange {
        LikelyRange { least: likely / factor, likely, most: likely * factor }
    }

    /// Interval of a single value.
    pub(super) fn exactly(value: f64) -> LikelyRange {
        LikelyRange { least: value, likely: value, most: value }
    }
}

/// A decision with its alternatives.
#[derive(Clone, Debug, Serialize)]
pub(crate) struct Decision {
    /// Subject of the decision.
    pub what: String,
    pub(crate) chosen: String,
    pub(crate) why: String,
    pub(crate) beside: Vec<Alternative>,
}

/// An alternative that is not recommended.
#[derive(Clone, Debug, Serialize)]
pub(crate) struct Alternative {
    pub name: String,
    /// Wall time over that of the recommendation, for the same error; none where the error is not reached.
    pub(crate) cost: Option<f64>,
    /// Reason why it is not recommended.
    pub(crate) why: String,
}

/// Command, expected result and reasons of a plan.
#[derive(Clone, Debug, Serialize)]
pub(crate) struct RunPlan {
    /// The scene, as named on a command line.
    pub scene: String,
    pub method: &'static str,
    /// Label of the configuration: its settings.
    #[serde(rename = "way")]
    pub configuration: String,
    pub quantity: &'static str,
    /// Unit of the quantity, empty for a pure number.
    pub unit: &'static str,
    /// Mean, and half the width of its 95 % interval; none for a conserved quantity.
    pub mean: Option<[f64; 2]>,
    /// Requested error, in the quantity's unit.
    pub error: Option<f64>,
    pub(crate) decisions: Vec<Decision>,
    /// Expected error, in the quantity's unit.
    pub expected: ExpectedError,
    /// Largest deviation of a conserved quantity over a run (the quantity's unit): at its rows, at any step, and the bound for another start. None
    /// for a mean.
    pub deviation: Option<LikelyRange>,
    /// Wall seconds.
    pub seconds: LikelyRange,
    /// Memory of the runs (bytes).
    pub memory: u64,
    /// Wall seconds of a run in each phase, by name.
    pub phases: Vec<(String, f64)>,
    /// The step (time); none where the method takes none.
    pub step: Option<f64>,
    /// Time of each run, including the transient (time).
    pub time: f64,
    /// Rows of each run.
    pub rows: f64,
    /// True if the mean is taken over whole runs, because the quantity never becomes stationary.
    pub(crate) is_whole: bool,
    /// Length of the transient (time).
    pub(crate) transient: f64,
    /// Number of runs, each with its own seed.
    pub seeds: u64,
    /// Difference of the mean from another start, where significant.
    pub(crate) starts_differ: Option<f64>,
    /// Overrides that turn the scene into the plan.
    pub overrides: Overrides,
    /// Cost and error of the scene's own values.
    pub own: Option<OwnResult>,
    /// Simpler models of the scene.
    pub left_out: Vec<SimplerModelReport>,
    /// Origin of the measurements.
    pub origin: String,
}

/// Cost and error of the scene's own values.
#[derive(Clone, Debug, Serialize)]
pub(crate) struct OwnResult {
    /// Wall seconds.
    pub seconds: f64,
    /// Expected error, in the quantity's unit.
    pub error: ExpectedError,
    /// Reason why its run fails, or its warnings; empty where there are none or it was not run.
    #[serde(skip_serializing_if = "String::is_empty")]
    pub(crate) faults: String,
}

/// Parts of an error.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub(crate) struct ExpectedError {
    /// Bias from the step.
    pub(crate) bias: BiasEstimate,
    /// Half the width of the 95 % interval of a mean of this length.
    pub(crate) chance: f64,
    /// Upper bound of the total error, with 95 % confidence.
    pub most: f64,
}

impl ExpectedError {
    pub(super) fn of(bias: BiasEstimate, chance: f64) -> ExpectedError {
        ExpectedError { bias, chance, most: bias.with_statistical_error(chance) }
    }
}

/// A simpler model of the scene.
#[derive(Clone, Debug, Serialize)]
pub(crate) struct SimplerModelReport {
    pub name: String,
    /// Change of the mean, and its error bar; none where it was not measured.
    pub change: Option<[f64; 2]>,
    /// Cost over the cost of the scene.
    pub(crate) cost: Option<f64>,
    /// Verdict for the target error.
    pub(crate) need: NecessityVerdict,
    pub says: String,
}

/// Verdict on a simpler model.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub(crate) enum NecessityVerdict {
    /// Without the part the mean changes by more than the error.
    Yes,
    /// Without the part the mean changes by less than the error.
    No,
    /// Error bars are too wide to decide.
    Undecided,
    /// Nothing could be compared.
    NotCompared,
}
