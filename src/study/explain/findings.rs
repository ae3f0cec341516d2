//! What is measured of a scene before anything is recommended, and the scene at work.

use super::ExplainError;
use super::Target;
use super::bias::Bias;
use super::drift::Drift;
use crate::results::{Journal, JournalError};
use crate::study::trial::{Known, Sample, Span, Trial, any_number};
use crate::study::{Case, Choice, first_line};
use serde::{Deserialize, Serialize};
use std::sync::atomic::Ordering;
use stripmine_physics::method::Prepared;
use stripmine_physics::scene::Overrides;

/// How often a step that fails or is warned of is halved.
pub(super) const HALVINGS: u32 = 6;
/// Parts of the time that is given: to time the configurations, to the mean, to the bias of steps, to twins that leave something out, to another
/// start.
pub(super) const SHARES: [f64; 5] = [0.15, 0.3, 0.35, 0.12, 0.08];

/// A way to run the scene, as measured.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) struct Way {
    /// What it is called.
    pub label: String,
    /// Its settings, by axis.
    pub settings: Vec<(String, String)>,
    /// The overrides that it makes, which its settings and its skin say.
    #[serde(skip)]
    pub overrides: Overrides,
    /// Wall seconds of a unit of time at `step`; none where it was given up.
    #[serde(with = "any_number")]
    pub(crate) cost: Option<f64>,
    /// The longest step that nothing speaks against (time); none where the method takes none.
    pub step: Option<f64>,
    /// What bounds it, with its numbers.
    pub bound: Option<String>,
    /// Where it pays to change the skin of its lists: its own and the better one (length), and the cost with this over that with its own.
    pub skin: Option<[f64; 3]>,
    /// Wall seconds of a unit of time in each phase, by name, at `step`; none where it was not timed.
    pub phases: Vec<(String, f64)>,
    /// What it is off by; none where it was not compared.
    pub(crate) bias: Option<Bias>,
    /// How far what should keep its value goes, where that is asked for.
    pub(crate) drift: Option<Drift>,
    /// Why it was followed no further.
    pub(crate) dropped: Option<String>,
}

/// What was measured.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) struct Findings {
    /// Ways, the cheapest first, those that were given up last.
    pub ways: Vec<Way>,
    pub mean: Known,
    /// The label of the configuration that it was measured by.
    pub(crate) mean_way: String,
    /// Where the quantity changes all along and its mean over the whole run is asked for: the scene's own time (time).
    pub whole: Option<f64>,
    /// By how much the mean of another start differs, where that is beyond both bars: what is kept of a start does not average out.
    #[serde(with = "any_number")]
    pub(crate) starts_differ: Option<f64>,
    /// Wall seconds until the first step.
    #[serde(with = "any_number")]
    pub start: f64,
    /// Wall seconds of a row.
    #[serde(with = "any_number")]
    pub row: f64,
    /// Cost of one thread over that of all.
    #[serde(with = "any_number")]
    pub(crate) one_thread: f64,
    pub threads: usize,
    /// What the scene may be modelled without.
    pub without: Vec<Without>,
}

impl Way {
    /// The settings of all axes.
    pub(super) fn choice(&self, case: &Case) -> Choice {
        let settings: Vec<(&str, &str)> =
            self.settings.iter().map(|(axis, name)| (axis.as_str(), name.as_str())).collect();
        case.own.with(&settings)
    }
}

/// A scene at work.
pub(super) struct Work<'w> {
    pub(super) case: &'w Case,
    pub(super) target: &'w Target,
    pub(super) seconds: f64,
    /// Parts of these, as [`SHARES`].
    pub(super) shares: [f64; 5],
    /// No trial begins later, and one that has begun ends then (s of the watch).
    pub(super) end: f64,
    pub(super) trial: Trial<'w>,
    /// Finished trials: those of the same study that was interrupted are not made again.
    pub(super) journal: &'w Journal,
    /// Wall seconds of the scene as it stands, once they are known.
    pub(super) as_it_stands: Option<f64>,
    /// The scene's own time, where the quantity changes all along and its mean over the whole run is asked for (time).
    pub(super) whole: Option<f64>,
}

/// What the scene may be modelled without.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) struct Without {
    /// What is lacking.
    pub name: String,
    /// The mean less that with it, and its bar; none where it breaks or has no mean.
    #[serde(with = "any_number")]
    pub(crate) difference: Option<[f64; 2]>,
    /// Cost over that with it.
    #[serde(with = "any_number")]
    pub(crate) cost: Option<f64>,
    /// Why there is nothing to compare.
    pub(crate) failed: Option<String>,
}

/// Why a run gave nothing.
pub(super) struct NoRun(pub(super) String);

impl From<JournalError> for NoRun {
    fn from(error: JournalError) -> NoRun {
        NoRun(error.to_string())
    }
}

/// Why a trial was not made.
pub(super) const NO_TIME: &str = "the time of the trials was over: --patient has more";

impl Work<'_> {
    /// Seconds until the trials end.
    pub(super) fn left(&self) -> f64 {
        (self.end - self.trial.watch.now()).max(0.0)
    }

    pub(super) fn prepared(&self, overrides: &Overrides, step: Option<f64>) -> Result<Prepared, String> {
        let step = self.case.entry.trials.zip(step);
        let more = overrides.clone();
        let more = step.map_or(more.clone(), |(trials, step)| more.set(trials.step, step));
        self.case.prepared_with(&more).map_err(|errors| {
            let messages: Vec<&str> = errors.0.iter().map(|error| error.message.as_str()).collect();
            messages.join("; ")
        })
    }

    pub(super) fn sampled_over(&self, way: &Way, step: Option<f64>, span: Span) -> Result<Sample, String> {
        if self.left() == 0.0 {
            return Err(NO_TIME.to_owned());
        }
        let prepared = self.prepared(&way.overrides, step)?;
        let span = span.within(self.left());
        let observed = (self.case.entry.quantities, self.target.place);
        self.trial.sample(&prepared, observed, span).map_err(|failure| first_line(&failure.what()))
    }

    /// # Errors
    /// [`ExplainError::Stopped`], once the user stops the trials: those made since are shorter than they should be.
    pub(super) fn unless_stopped<T>(&self, made: T) -> Result<T, ExplainError> {
        if self.trial.stop.load(Ordering::Relaxed) { Err(ExplainError::Stopped) } else { Ok(made) }
    }

    pub(super) fn choice(&self, way: &Way) -> Choice {
        way.choice(self.case)
    }
}

/// The cheapest first, those that were given up last.
pub(super) fn sort(ways: &mut [Way]) {
    let key = |way: &Way| (way.dropped.is_some(), way.cost.unwrap_or(f64::INFINITY));
    ways.sort_by(|a, b| key(a).0.cmp(&key(b).0).then(key(a).1.total_cmp(&key(b).1)));
}
