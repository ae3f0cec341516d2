//! Measurements of a scene that a plan is based on, and the state of its trials.

use super::ExplainError;
use super::PlanTarget;
use super::bias::Bias;
use super::drift::{DeviationRun, StepDeviations};
use crate::results::{Journal, JournalError};
use crate::study::trial::{MeanEstimate, SampleSpan, TrialControl, TrialSample, any_number};
use crate::study::{SettingChoice, StudyCase, first_line};
use serde::{Deserialize, Serialize};
use std::sync::atomic::Ordering;
use stripmine_physics::method::Prepared;
use stripmine_physics::scene::Overrides;

/// Most halvings of a step that fails or raises a warning.
pub(super) const HALVINGS: u32 = 6;
/// Shares of the trial time: timing of configurations, mean, bias of steps, simpler models, another start.
pub(super) const SHARES: [f64; 5] = [0.15, 0.3, 0.35, 0.12, 0.08];

/// A configuration of the scene, as measured.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) struct MeasuredConfiguration {
    pub label: String,
    /// Settings, by axis.
    pub settings: Vec<(String, String)>,
    /// Overrides of the scene, which follow from the settings and the skin.
    #[serde(skip)]
    pub overrides: Overrides,
    /// Wall seconds of a unit of time at `step`; none where the configuration was dropped before it was timed.
    #[serde(with = "any_number")]
    pub(crate) cost: Option<f64>,
    /// Longest usable step (time); none where the method has no time step.
    pub step: Option<f64>,
    /// Limit of the step, with its numbers.
    pub bound: Option<String>,
    /// Skin of the neighbour lists, where changing it pays: the scene's own and the better one (length), and the ratio of the costs.
    pub skin: Option<[f64; 3]>,
    /// Wall seconds of a unit of time in each phase, by name, at `step`; empty where it was not timed.
    pub phases: Vec<(String, f64)>,
    /// Bias of its step; none where it was not measured.
    pub(crate) bias: Option<Bias>,
    /// Deviation of a conserved quantity, where that is the target.
    pub(crate) drift: Option<StepDeviations>,
    /// Reason why it was dropped.
    pub(crate) dropped: Option<String>,
}

/// Measurements of a scene.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) struct Findings {
    /// Configurations by cost, dropped ones last.
    pub configurations: Vec<MeasuredConfiguration>,
    pub mean: MeanEstimate,
    /// Run of the scene as it stands, where a conserved quantity is the target and there was time for it.
    pub(crate) own_run: Option<DeviationRun>,
    /// Label of the configuration that measured the mean.
    pub(crate) mean_configuration: String,
    /// The scene's own run time, where the quantity never becomes stationary and its mean over the whole run is the target (time).
    pub whole: Option<f64>,
    /// Difference between the means of another start and of this one, where it exceeds both error bars: a conserved quantity of the start does not
    /// average out.
    #[serde(with = "any_number")]
    pub(crate) starts_differ: Option<f64>,
    /// Wall seconds until the first step.
    #[serde(with = "any_number")]
    pub start: f64,
    /// Wall seconds of a row.
    #[serde(with = "any_number")]
    pub row: f64,
    /// Cost with one thread over that with all threads.
    #[serde(with = "any_number")]
    pub(crate) one_thread: f64,
    pub threads: usize,
    /// Simpler models of the scene.
    pub without: Vec<SimplerModelResult>,
}

impl MeasuredConfiguration {
    pub(super) fn choice(&self, case: &StudyCase) -> SettingChoice {
        let settings: Vec<(&str, &str)> =
            self.settings.iter().map(|(axis, name)| (axis.as_str(), name.as_str())).collect();
        case.own.with(&settings)
    }
}

/// State of the trials of a scene.
pub(super) struct SceneTrials<'w> {
    pub(super) case: &'w StudyCase,
    pub(super) target: &'w PlanTarget,
    pub(super) seconds: f64,
    /// Shares of the trial time, as [`SHARES`].
    pub(super) shares: [f64; 5],
    /// Deadline: no trial begins later, and a running one ends then (s of the watch).
    pub(super) end: f64,
    pub(super) trial: TrialControl<'w>,
    /// Finished trials: an interrupted study does not repeat them.
    pub(super) journal: &'w Journal,
    /// Wall seconds of the scene as it stands, once known.
    pub(super) as_it_stands: Option<f64>,
    /// The scene's own run time, where the quantity never becomes stationary and its mean over the whole run is the target (time).
    pub(super) whole: Option<f64>,
}

/// A simpler model of a scene, as measured.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) struct SimplerModelResult {
    pub name: String,
    /// Mean of the simpler model less the mean of the scene, and its error bar; none where it fails or has no mean.
    #[serde(with = "any_number")]
    pub(crate) difference: Option<[f64; 2]>,
    /// Cost over the cost of the scene.
    #[serde(with = "any_number")]
    pub(crate) cost: Option<f64>,
    /// Reason why nothing could be compared.
    pub(crate) failed: Option<String>,
}

/// Reason why a run has no result.
pub(super) struct MissingRun(pub(super) String);

impl From<JournalError> for MissingRun {
    fn from(error: JournalError) -> MissingRun {
        MissingRun(error.to_string())
    }
}

/// Reason of trials that were not run.
pub(super) const NO_TIME: &str = "the trial time was used up (use --patient for more)";

impl SceneTrials<'_> {
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

    pub(super) fn sample_over(
        &self,
        configuration: &MeasuredConfiguration,
        step: Option<f64>,
        span: SampleSpan,
    ) -> Result<TrialSample, String> {
        if self.left() == 0.0 {
            return Err(NO_TIME.to_owned());
        }
        let prepared = self.prepared(&configuration.overrides, step)?;
        let span = span.within(self.left());
        let observed = (self.case.quantities(), self.target.place);
        self.trial.sample(&prepared, observed, span).map_err(|failure| first_line(&failure.what_and_when()))
    }

    /// Returns a result, unless the user stopped the trials.
    ///
    /// # Errors
    /// [`ExplainError::Stopped`], once the user stops the trials: those made since are too short.
    pub(super) fn unless_stopped<T>(&self, made: T) -> Result<T, ExplainError> {
        if self.trial.stop.load(Ordering::Relaxed) { Err(ExplainError::Stopped) } else { Ok(made) }
    }

    pub(super) fn choice(&self, configuration: &MeasuredConfiguration) -> SettingChoice {
        configuration.choice(self.case)
    }
}

/// Sorts configurations by cost, dropped ones last.
pub(super) fn sort_by_cost(configurations: &mut [MeasuredConfiguration]) {
    let key = |configuration: &MeasuredConfiguration| {
        (configuration.dropped.is_some(), configuration.cost.unwrap_or(f64::INFINITY))
    };
    configurations.sort_by(|a, b| key(a).0.cmp(&key(b).0).then(key(a).1.total_cmp(&key(b).1)));
}
