//! Scene of this method with the locations of its values, as input of the check.

use super::keys::{VOCABULARY, asks_for_programs};
use super::scene::{EngineChoice, GranularScene};
use crate::scene::{ReadBinding, SceneErrors, SceneValues};

/// Scene with the text it comes from, so that findings of the check have a location.
#[derive(Clone, Debug)]
pub struct GranularDocument {
    /// The scene.
    pub scene: GranularScene,
    pub(super) values: SceneValues,
}

impl GranularDocument {
    /// Reads a scene from TOML, with overrides `section.key=value`; `file` is its name in errors.
    ///
    /// # Errors
    /// [`SceneErrors`]: every mistake of the TOML and the overrides.
    pub fn parse(file: &str, text: &str, overrides: &[String]) -> Result<GranularDocument, SceneErrors> {
        GranularDocument::read(SceneValues::parse(file, text, overrides, &[&VOCABULARY])?)
    }

    /// Reads a scene, given as a preset's name or a file's path, with overrides.
    ///
    /// # Errors
    /// [`SceneErrors`]: neither preset nor readable file, or every mistake in it.
    pub fn load(what: &str, overrides: &[String]) -> Result<GranularDocument, SceneErrors> {
        GranularDocument::read(SceneValues::load(what, overrides, &[&VOCABULARY])?)
    }

    /// Builds the scene from values that satisfy their rules.
    ///
    /// # Errors
    /// [`SceneErrors`]: missing values.
    pub(super) fn read(values: SceneValues) -> Result<GranularDocument, SceneErrors> {
        let (mut scene, mut read) = (GranularScene::default(), ReadBinding::new(&values));
        scene.bind(&mut read);
        read.finish_reading()?;
        if asks_for_programs(&values) {
            scene.machine.engine = EngineChoice::Programs;
        }
        Ok(GranularDocument { scene, values })
    }
}

impl GranularScene {
    /// Reads a scene from TOML; `file` is its name in errors, and start files are searched beside it.
    ///
    /// # Errors
    /// [`SceneErrors`]: every mistake of the TOML.
    pub fn parse(file: &str, text: &str) -> Result<GranularScene, SceneErrors> {
        GranularDocument::parse(file, text, &[]).map(|document| document.scene)
    }

    /// Reads a scene, given as a preset's name or a file's path.
    ///
    /// # Errors
    /// [`SceneErrors`]: neither preset nor readable file, or every mistake in it.
    pub fn load(what: &str) -> Result<GranularScene, SceneErrors> {
        GranularDocument::load(what, &[]).map(|document| document.scene)
    }

    /// Returns the scene with some values replaced, each given as `section.key=value`. An override replaces keys that exclude it, and keys that
    /// another choice makes meaningless.
    ///
    /// # Errors
    /// [`SceneErrors`]: every mistake of the overrides.
    pub fn with_overrides(&self, overrides: &[&str]) -> Result<GranularScene, SceneErrors> {
        let overrides: Vec<String> = overrides.iter().map(|&text| text.to_owned()).collect();
        GranularDocument::parse("scene", &self.to_toml(), &overrides).map(|document| document.scene)
    }
}
