//! What a plan says.

use super::bias::Off;
use serde::Serialize;
use stripmine_physics::scene::Overrides;

/// A number with the least and the most that it may be.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub(crate) struct Interval {
    pub least: f64,
    pub(crate) likely: f64,
    pub most: f64,
}

impl Interval {
    /// About a likely value, within a factor.
    pub(super) fn within(likely: f64, factor: f64) -> Interval {
        Interval { least: likely / factor, likely, most: likely * factor }
    }
}

/// Something that was chosen, and what stands beside it.
#[derive(Clone, Debug, Serialize)]
pub(crate) struct Decision {
    /// What about.
    pub what: String,
    /// What is recommended.
    pub(crate) chosen: String,
    pub(crate) why: String,
    /// The others.
    pub(crate) beside: Vec<Beside>,
}

/// Something else that may be chosen.
#[derive(Clone, Debug, Serialize)]
pub(crate) struct Beside {
    pub name: String,
    /// Wall time over that of what is recommended, for the same error; none where it does not come to it.
    pub(crate) cost: Option<f64>,
    /// Why it is not recommended.
    pub(crate) why: String,
}

/// What a plan asks for and is expected to give.
#[derive(Clone, Debug, Serialize)]
pub(crate) struct Plan {
    /// The scene, as it is named on a command line.
    pub scene: String,
    pub method: &'static str,
    /// The configuration by which it is run: its settings.
    pub way: String,
    pub quantity: &'static str,
    /// Its unit, empty for a pure number.
    pub unit: &'static str,
    /// Its mean, and half the width of its interval of 95 %; none of what should keep its value.
    pub mean: Option<[f64; 2]>,
    /// The error that is asked for, in the quantity's unit.
    pub error: Option<f64>,
    /// What is recommended, one after the other.
    pub(crate) decisions: Vec<Decision>,
    /// The error that is expected, in the quantity's unit.
    pub expected: Expected,
    /// Wall seconds.
    pub seconds: Interval,
    /// Bytes of a run.
    pub memory: u64,
    /// Wall seconds of a run in each phase, by name.
    pub phases: Vec<(String, f64)>,
    /// The step (time); none where the method takes none.
    pub step: Option<f64>,
    /// Time of each run, the transient in it (time).
    pub time: f64,
    /// Rows of each run.
    pub rows: f64,
    /// Whether the mean is that over whole runs: the quantity changes all along.
    pub(crate) is_whole: bool,
    /// Time of the transient (time).
    pub(crate) transient: f64,
    /// Runs with seeds of their own.
    pub seeds: u64,
    /// By how much the mean of another start differs, where that was seen.
    pub(crate) starts_differ: Option<f64>,
    /// The overrides that make the plan of the scene.
    pub overrides: Overrides,
    /// What the scene's own values cost and reach.
    pub own: Option<Own>,
    /// What the scene may be modelled without.
    pub left_out: Vec<LeftOut>,
    /// Where the figures come from.
    pub origin: String,
}

/// What the scene's own values cost and reach.
#[derive(Clone, Debug, Serialize)]
pub(crate) struct Own {
    /// Wall seconds.
    pub seconds: f64,
    /// The error that is expected of them, in the quantity's unit.
    pub error: Expected,
}

/// What an error is made of.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub(crate) struct Expected {
    /// What the step takes the mean off by.
    pub(crate) bias: Off,
    /// Half the width of the interval of 95 % of a mean of this length.
    pub(crate) chance: f64,
    /// The most that both are together with a probability of 95 %.
    pub most: f64,
}

impl Expected {
    pub(super) fn of(bias: Off, chance: f64) -> Expected {
        Expected { bias, chance, most: bias.with(chance) }
    }
}

/// What the scene may be modelled without.
#[derive(Clone, Debug, Serialize)]
pub(crate) struct LeftOut {
    pub name: String,
    /// What it changes of the mean, and its bar; none where it was not seen.
    pub change: Option<[f64; 2]>,
    /// Cost over that with it.
    pub(crate) cost: Option<f64>,
    /// Whether the scene needs it for the error.
    pub(crate) need: Need,
    /// The same in words.
    pub says: String,
}

/// Whether a scene needs something for an error.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub(crate) enum Need {
    /// Without it the mean is off by more.
    Yes,
    /// Without it the mean is off by less.
    No,
    /// Bars are too wide to tell.
    Undecided,
    /// There is nothing to compare.
    NotCompared,
}
