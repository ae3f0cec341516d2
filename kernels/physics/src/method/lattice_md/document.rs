//! A scene of this method with the places of its values, as the check needs it.

use super::keys::{VOCABULARY, asks_for_programs};
use super::scene::{EngineChoice, Scene};
use crate::scene::{Read, SceneErrors, Values};

/// A scene with the text it comes from, so that what the check finds has a place.
#[derive(Clone, Debug)]
pub struct Document {
    /// The scene.
    pub scene: Scene,
    pub(super) values: Values,
}

impl Document {
    /// Reads a scene from its text, with overrides `section.key=value`; `file` is the name that errors give it.
    ///
    /// # Errors
    /// [`SceneErrors`]: every mistake of text and overrides.
    pub fn parse(file: &str, text: &str, overrides: &[String]) -> Result<Document, SceneErrors> {
        Document::read(Values::parse(file, text, overrides, &[&VOCABULARY])?)
    }

    /// Reads the scene that is a preset's name or a file's path, with overrides.
    ///
    /// # Errors
    /// [`SceneErrors`]: neither preset nor readable file, or every mistake of the text.
    pub fn load(what: &str, overrides: &[String]) -> Result<Document, SceneErrors> {
        Document::read(Values::load(what, overrides, &[&VOCABULARY])?)
    }

    /// The scene of values that have passed their rules.
    ///
    /// # Errors
    /// [`SceneErrors`]: what is missing.
    pub(super) fn read(values: Values) -> Result<Document, SceneErrors> {
        let (mut scene, mut read) = (Scene::default(), Read::new(&values));
        scene.bind(&mut read);
        read.done()?;
        if asks_for_programs(&values) {
            scene.machine.engine = EngineChoice::Programs;
        }
        Ok(Document { scene, values })
    }
}

impl Scene {
    /// Reads a scene from its text; `file` is the name that errors give it, and start files are looked for beside it.
    ///
    /// # Errors
    /// [`SceneErrors`]: every mistake of the text.
    pub fn parse(file: &str, text: &str) -> Result<Scene, SceneErrors> {
        Document::parse(file, text, &[]).map(|document| document.scene)
    }

    /// Reads the scene that is a preset's name or a file's path.
    ///
    /// # Errors
    /// [`SceneErrors`]: neither preset nor readable file, or every mistake of the text.
    pub fn load(what: &str) -> Result<Scene, SceneErrors> {
        Document::load(what, &[]).map(|document| document.scene)
    }

    /// The scene with some values replaced, each given as `section.key=value`. An override takes the place of keys that
    /// exclude it, and of keys that another choice leaves without meaning.
    ///
    /// # Errors
    /// [`SceneErrors`]: every mistake of the overrides.
    pub fn with_overrides(&self, overrides: &[&str]) -> Result<Scene, SceneErrors> {
        let overrides: Vec<String> = overrides.iter().map(|&text| text.to_owned()).collect();
        Document::parse("scene", &self.to_toml(), &overrides).map(|document| document.scene)
    }
}
