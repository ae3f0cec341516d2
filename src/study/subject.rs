//! Scene of a study of the time step, with the trials of its method.

use super::observed::{StudyQuantities, WatchedQuantity};
use super::{SettingChoice, StudyCase, StudyError};
use std::ops::Deref;
use stripmine_physics::method::{AxisSetting, Every, Methods, Prepared, TheoreticalOrder, Trials, Until};
use stripmine_physics::scene::{Overrides, SceneErrors, UNITS};
use stripmine_physics::units;

/// A scene under study.
pub(crate) struct Subject {
    case: StudyCase,
    pub trials: &'static Trials,
    pub observed: StudyQuantities,
    /// Its own step (time).
    pub step: f64,
    pub steps: u64,
}

impl Deref for Subject {
    type Target = StudyCase;

    fn deref(&self) -> &StudyCase {
        &self.case
    }
}

impl Subject {
    /// Loads a scene by the name of a preset or the path of a file, with overrides.
    ///
    /// # Errors
    /// [`StudyError`] if the scene is invalid, its method has no time step, or it ends before its first output.
    pub(crate) fn load(what: &str, overrides: &[String], methods: Methods) -> Result<Subject, StudyError> {
        let case = StudyCase::load(what, overrides, methods)?;
        let nothing = StudyError::NothingToVary(case.entry.vocabulary.keys.method);
        let schedule = case.prepared.schedule;
        let (Some(trials), Until::Steps(steps), Some(step)) =
            (case.entry.trials, schedule.until, case.step())
        else {
            return Err(nothing);
        };
        let first = match schedule.rows {
            Every::Steps(steps) => steps,
            Every::Never | Every::Time(_) | Every::Seconds(_) => 1,
        };
        if steps < first.max(1) {
            return Err(StudyError::OverBeforeOutput { steps, first: first.max(1) });
        }
        let observed = StudyQuantities::of(trials, case.entry.quantities)?;
        Ok(Subject { case, trials, observed, step, steps })
    }

    /// Prepares the scene in a configuration, with a step (time) and further overrides.
    pub(crate) fn prepared_as(
        &self,
        choice: &SettingChoice,
        step: f64,
        more: &Overrides,
    ) -> Result<Prepared, SceneErrors> {
        self.prepared_with(&self.overrides(choice, step, more))
    }

    /// Prepares the scene in a configuration, even where theory forbids the step.
    pub(crate) fn prepared_at_any_step(
        &self,
        choice: &SettingChoice,
        step: f64,
        more: &Overrides,
    ) -> Result<Prepared, SceneErrors> {
        (self.trials.at_any_step)(self.values.with(&self.overrides(choice, step, more))?)
    }

    fn overrides(&self, choice: &SettingChoice, step: f64, more: &Overrides) -> Overrides {
        choice.overrides().set(self.trials.step, step).and(more)
    }

    /// Configuration of the reference, or of the second one (1).
    pub(crate) fn reference(&self, number: usize) -> SettingChoice {
        self.own.with(self.trials.references[number])
    }

    /// Duration of the scene (time).
    pub(crate) fn duration(&self) -> f64 {
        self.steps as f64 * self.step
    }

    /// Theoretical order of convergence, for a setting of the axis that decides it.
    pub(crate) fn theory(&self, setting: &AxisSetting) -> Option<TheoreticalOrder> {
        (self.trials.theory)(&self.values, &self.prepared, setting)
    }

    /// Unit of a dimension, such as `1/time`, in the units of the scene; none for a pure number.
    pub(crate) fn unit(&self, dimension: &str) -> Option<String> {
        let label = self.values.choice(&UNITS).unwrap_or_default();
        (!dimension.is_empty()).then(|| units::symbol(&label, dimension).unwrap_or(label))
    }

    /// Quantities that have a mean in a run of the scene.
    pub(crate) fn watched(&self) -> impl Iterator<Item = &WatchedQuantity> {
        let has_seeds = self.prepared.seed.is_some();
        self.observed.means.iter().filter(move |watched| has_seeds || !watched.fluctuates)
    }

    /// True for the mean of a velocity, which is compared with the speeds.
    pub(crate) fn is_velocity(&self, name: &str) -> bool {
        self.observed.means.iter().any(|watched| watched.name == name && watched.is_velocity)
    }
}
