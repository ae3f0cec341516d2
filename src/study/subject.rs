//! The scene of a study, and what its method states of the trials that may be made of it.

use super::observed::Observed;
use super::{Choice, StudyError};
use crate::results::Identity;
use sha2::{Digest, Sha256};
use stripmine_physics::method::{Every, Methods, Prepared, Setting, Trials, Until, prepare, vocabularies};
use stripmine_physics::scene::{Overrides, SceneErrors, UNITS, Values};

/// The form in which studies keep finished runs; another one whenever these hold other things.
const JOURNALED: &str = "2";

/// A scene under study.
pub struct Subject {
    what: String,
    overrides: Vec<String>,
    methods: Methods,
    /// What its method states.
    pub trials: &'static Trials,
    /// The values of the scene as they were given.
    pub values: Values,
    /// The scene as it was given.
    pub prepared: Prepared,
    /// What is observed of it.
    pub observed: Observed,
    /// How the scene itself is run.
    pub own: Choice,
    /// Its own step (time).
    pub step: f64,
    /// Its own number of steps.
    pub steps: u64,
}

impl Subject {
    /// The scene that is a preset's name or a file's path, with overrides.
    ///
    /// # Errors
    /// [`StudyError`] if the scene is bad, its method states no trials, or it is over before anything is seen of it.
    pub fn load(what: &str, overrides: &[String], methods: Methods) -> Result<Subject, StudyError> {
        let values = Values::load(what, overrides, &vocabularies(methods))?;
        let (prepared, entry) = prepare(values.clone(), methods)?;
        let nothing = StudyError::NothingToVary(entry.vocabulary.keys.method);
        let (Some(trials), Until::Steps(steps)) = (entry.trials, prepared.schedule.until) else {
            return Err(nothing);
        };
        let Some(step) = values.number(trials.step) else { return Err(nothing) };
        let first = match prepared.schedule.rows {
            Every::Steps(steps) => steps,
            Every::Never | Every::Time(_) | Every::Seconds(_) => 1,
        };
        if steps < first.max(1) {
            return Err(StudyError::OverBeforeOutput { steps, first: first.max(1) });
        }
        prepared.memory.fits("scene").map_err(StudyError::Scene)?;
        let own = Choice::own(trials, &prepared);
        Ok(Subject {
            what: what.to_owned(),
            overrides: overrides.to_vec(),
            methods,
            trials,
            values,
            prepared,
            observed: Observed::of(trials, entry.quantities)?,
            own,
            step,
            steps,
        })
    }

    /// The name of the scene.
    pub fn name(&self) -> &str {
        &self.what
    }

    /// The arguments that name it on a command line.
    pub fn arguments(&self) -> String {
        let set = self.overrides.iter().map(|text| format!(" --set {text}"));
        std::iter::once(self.what.clone()).chain(set).collect()
    }

    /// The same scene in a way to run it, with a step (time) and further overrides.
    ///
    /// # Errors
    /// [`SceneErrors`]: why it cannot be run so.
    pub fn prepared_as(&self, choice: &Choice, step: f64, more: &[String]) -> Result<Prepared, SceneErrors> {
        Ok(prepare(self.values_as(choice, step, more)?, self.methods)?.0)
    }

    /// The same, whatever is foreseen of the step.
    ///
    /// # Errors
    /// [`SceneErrors`]: why it cannot be run so.
    pub fn prepared_at_any_step(
        &self,
        choice: &Choice,
        step: f64,
        more: &[String],
    ) -> Result<Prepared, SceneErrors> {
        (self.trials.at_any_step)(self.values_as(choice, step, more)?)
    }

    fn values_as(&self, choice: &Choice, step: f64, more: &[String]) -> Result<Values, SceneErrors> {
        let chosen: Vec<String> = choice.overrides().collect();
        let step = Overrides::new().set(self.trials.step, step);
        let overrides = [&self.overrides[..], &chosen, &step, more].concat();
        Values::load(&self.what, &overrides, &vocabularies(self.methods))
    }

    /// The setting of the axis that decides the order, of a way to run it.
    pub fn theory(&self, setting: &Setting) -> Option<stripmine_physics::method::Theory> {
        (self.trials.theory)(&self.values, &self.prepared, setting)
    }

    /// The unit of a dimension, such as `1/time`, in the units that the scene names; none of a pure number.
    pub fn unit(&self, dimension: &str) -> Option<String> {
        let label = self.values.choice(&UNITS).unwrap_or_default();
        match (dimension, label.as_str()) {
            ("", _) => None,
            (_, "SI") => Some(dimension.replace("time", "s").replace("length", "m").replace("force", "N")),
            _ => Some(label),
        }
    }

    /// What distances are measured in (length).
    pub fn length(&self) -> f64 {
        (self.trials.length.of)(self.prepared.particles())
    }

    /// Whether a mean is of a velocity: it means nothing but beside the speeds.
    pub fn is_velocity(&self, name: &str) -> bool {
        self.observed.means.iter().any(|watched| watched.name == name && watched.is_velocity)
    }

    /// What a study of it depends on: the resolved scene, the options and the version of the program.
    pub fn identity(&self, study: &str, options: &str) -> Identity {
        let mut sum = Sha256::new();
        for part in [study, JOURNALED, options, env!("CARGO_PKG_VERSION"), &self.prepared.scene] {
            sum.update(part.as_bytes());
            sum.update([0]);
        }
        sum.update(self.prepared.particles().checksum().as_bytes());
        let digest = sum.finalize().iter().map(|byte| format!("{byte:02x}")).collect();
        Identity { of: format!("{study} of {}", self.arguments()), digest }
    }
}
