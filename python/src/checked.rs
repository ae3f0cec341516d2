//! Scenes that were read and checked against every precondition.

use crate::particles::dimensions;
use stripmine_physics::method::{Entry, METHODS, Prepared, prepare, vocabularies};
use stripmine_physics::scene::{SceneErrors, Values};

/// Name in errors of a scene given as text.
const OF_TEXT: &str = "scene";

/// Source of a scene.
#[derive(Clone)]
pub(crate) enum Source {
    /// Preset name or file path.
    Named(String),
    /// Text in TOML.
    Text(String),
}

impl Source {
    /// Name in errors.
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

/// Scene that was read, passed all checks, and has its particles.
pub(crate) struct Checked {
    pub(crate) prepared: Prepared,
    /// Method of the scene.
    pub(crate) entry: &'static Entry,
    /// Dimensions in which the particles move.
    pub(crate) dimensions: usize,
    /// Values as read, before choices are made.
    pub(crate) values: Values,
}

impl Checked {
    pub(crate) fn of(values: Values) -> Result<Checked, SceneErrors> {
        let (prepared, entry) = prepare(values.clone(), METHODS)?;
        let dimensions = dimensions(prepared.particles());
        Ok(Checked { prepared, entry, dimensions, values })
    }
}
