//! A scene that may be run in several ways: what a study begins with.

use super::Choice;
use stripmine_physics::method::{Entry, Methods, Prepared, Until, prepare, vocabularies};
use stripmine_physics::scene::{SceneErrors, Values};

/// A scene with what its method states of the ways to run it.
pub struct Case {
    what: String,
    /// Its text, read once: all trials are of the same scene, whatever becomes of the file.
    text: String,
    overrides: Vec<String>,
    methods: Methods,
    /// Its method.
    pub entry: &'static Entry,
    /// The values of the scene as they were given.
    pub values: Values,
    /// The scene as it was given.
    pub prepared: Prepared,
    /// How the scene itself is run.
    pub own: Choice,
}

impl Case {
    /// The scene that is a preset's name or a file's path, with overrides.
    ///
    /// # Errors
    /// [`SceneErrors`] if the scene is bad, or takes more memory than there is.
    pub fn load(what: &str, overrides: &[String], methods: Methods) -> Result<Case, SceneErrors> {
        let text = Values::text(what, &vocabularies(methods))?;
        Case::of(what, text, overrides, methods)
    }

    /// The scene of a text; `what` is the name that errors give it.
    ///
    /// # Errors
    /// As [`load`](Self::load).
    pub fn parse(what: &str, text: String, methods: Methods) -> Result<Case, SceneErrors> {
        Case::of(what, text, &[], methods)
    }

    fn of(what: &str, text: String, overrides: &[String], methods: Methods) -> Result<Case, SceneErrors> {
        let values = Values::parse(what, &text, overrides, &vocabularies(methods))?;
        let (prepared, entry) = prepare(values.clone(), methods)?;
        prepared.memory.fits("scene")?;
        let own = Choice::own(entry.axes, &prepared);
        Ok(Case {
            what: what.to_owned(),
            text,
            overrides: overrides.to_vec(),
            methods,
            entry,
            values,
            prepared,
            own,
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

    /// The step, where the method takes steps (time).
    pub fn step(&self) -> Option<f64> {
        self.values.number(self.entry.trials?.step)
    }

    /// How long the scene runs (time); none where its end is a number of events.
    pub fn duration(&self) -> Option<f64> {
        match self.prepared.schedule.until {
            Until::Time(time) => Some(time),
            Until::Steps(steps) => Some(steps as f64 * self.step()?),
            Until::Events(_) => None,
        }
    }

    /// The same scene with further overrides.
    ///
    /// # Errors
    /// [`SceneErrors`]: why it cannot be run so.
    pub fn prepared_with(&self, more: &[String]) -> Result<Prepared, SceneErrors> {
        self.prepared_in(&Choice::own(&[], &self.prepared), more)
    }

    /// The same scene in a way to run it, with further overrides.
    ///
    /// # Errors
    /// [`SceneErrors`]: why it cannot be run so.
    pub fn prepared_in(&self, choice: &Choice, more: &[String]) -> Result<Prepared, SceneErrors> {
        Ok(prepare(self.values_in(choice, more)?, self.methods)?.0)
    }

    /// Its values in a way to run it, with further overrides.
    ///
    /// # Errors
    /// [`SceneErrors`] if an override is none of the method's.
    pub fn values_in(&self, choice: &Choice, more: &[String]) -> Result<Values, SceneErrors> {
        let chosen: Vec<String> = choice.overrides().collect();
        let overrides = [&self.overrides[..], &chosen, more].concat();
        Values::parse(&self.what, &self.text, &overrides, &vocabularies(self.methods))
    }

    /// A scene by the same methods.
    ///
    /// # Errors
    /// As [`parse`](Self::parse).
    pub fn beside(&self, text: String) -> Result<Case, SceneErrors> {
        Case::parse(&self.what, text, self.methods)
    }
}
