//! Scenes as simulations and runs have them: read, and held against every precondition.

use crate::particles::dimensions;
use stripmine_physics::method::{Entry, METHODS, Prepared, prepare, vocabularies};
use stripmine_physics::scene::{SceneErrors, Values};

/// The name in errors of a scene that is given as a text.
const OF_TEXT: &str = "scene";

/// The origin of a scene.
#[derive(Clone)]
pub(crate) enum Source {
    /// A preset's name, or a file's path.
    Named(String),
    /// A text.
    Text(String),
}

impl Source {
    /// Its name in errors.
    pub(crate) fn name(&self) -> &str {
        match self {
            Source::Named(name) => name,
            Source::Text(_) => OF_TEXT,
        }
    }

    pub(crate) fn values(&self, given: &[String]) -> Result<Values, SceneErrors> {
        let known = vocabularies(METHODS);
        match self {
            Source::Named(name) => Values::load(name, given, &known),
            Source::Text(text) => Values::parse(OF_TEXT, text, given, &known),
        }
    }
}

/// A scene that was read and may run.
pub(crate) struct Checked {
    /// With its particles.
    pub(crate) prepared: Prepared,
    /// Its method.
    pub(crate) entry: &'static Entry,
    /// In how many dimensions its particles move.
    pub(crate) dimensions: usize,
    /// As they were read.
    pub(crate) values: Values,
}

impl Checked {
    pub(crate) fn of(values: Values) -> Result<Checked, SceneErrors> {
        let (prepared, entry) = prepare(values.clone(), METHODS)?;
        let dimensions = dimensions(prepared.particles());
        Ok(Checked { prepared, entry, dimensions, values })
    }
}
