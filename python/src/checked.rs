//! Scenes that were read and checked against every precondition.

use crate::overrides::GivenOverrides;
use crate::particles::dimensions;
use stripmine_physics::method::{METHODS, MethodEntry, ObservedQuantity, Prepared, prepare, vocabularies};
use stripmine_physics::scene::{SceneErrors, SceneValues};

/// Name in errors of a scene given as text.
const OF_TEXT: &str = "scene";

/// Source of a scene.
#[derive(Clone)]
pub(crate) enum SceneSource {
    /// Preset name or file path.
    Named(String),
    /// Text in TOML.
    Text(String),
}

impl SceneSource {
    /// Name in errors.
    pub(crate) fn name(&self) -> &str {
        match self {
            SceneSource::Named(name) => name,
            SceneSource::Text(_) => OF_TEXT,
        }
    }

    pub(crate) fn values(&self, given: &GivenOverrides) -> Result<SceneValues, SceneErrors> {
        let known = vocabularies(METHODS);
        let given = (given.texts.as_slice(), given.arrays.as_slice());
        match self {
            SceneSource::Named(name) => {
                SceneValues::parse_with_arrays(name, &SceneValues::text(name, &known)?, given, &known)
            }
            SceneSource::Text(text) => SceneValues::parse_with_arrays(OF_TEXT, text, given, &known),
        }
    }
}

/// Scene that was read, passed all checks, and has its particles.
pub(crate) struct CheckedScene {
    pub(crate) prepared: Prepared,
    /// Method of the scene.
    pub(crate) entry: &'static MethodEntry,
    /// Dimensions in which the particles move.
    pub(crate) dimensions: usize,
    /// Values as read, before choices are made.
    pub(crate) values: SceneValues,
}

impl CheckedScene {
    pub(crate) fn of(values: SceneValues) -> Result<CheckedScene, SceneErrors> {
        let (prepared, entry) = prepare(values.clone(), METHODS)?;
        let dimensions = dimensions(prepared.particles());
        Ok(CheckedScene { prepared, entry, dimensions, values })
    }

    /// Observed quantities of the scene.
    pub(crate) fn quantities(&self) -> &'static [ObservedQuantity] {
        self.prepared.quantities(self.entry)
    }
}
