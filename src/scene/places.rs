//! A scene with the places of its values.

use super::check::{self, Checked};
use super::document::{self, Entries};
use super::error::{Reason, SceneErrors, Spot};
use super::keys::Key;
use super::{Scene, assemble, presets, rules};
use crate::io::regular_file;
use std::path::Path;

/// Longest scene file (bytes); a list of positions may be long.
const LONGEST: u64 = 64 << 20;

/// A scene with the text it comes from, so that what the check finds has a place.
#[derive(Clone, Debug)]
pub struct Document {
    /// The scene.
    pub scene: Scene,
    entries: Option<Entries>,
}

impl Document {
    /// Reads a scene from its text, with overrides `section.key=value`; `file` is the name that errors give it.
    ///
    /// # Errors
    /// [`SceneErrors`]: every mistake of text and overrides.
    pub fn parse(file: &str, text: &str, overrides: &[String]) -> Result<Document, SceneErrors> {
        let mut entries = document::read(file, text, overrides)?;
        rules::apply(&mut entries);
        std::mem::take(&mut entries.errors).none_of(file)?;
        let scene = assemble::read(&entries)?;
        Ok(Document { scene, entries: Some(entries) })
    }

    /// Reads the scene that is a preset's name or a file's path, with overrides.
    ///
    /// # Errors
    /// [`SceneErrors`]: neither preset nor readable file, or every mistake of the text.
    pub fn load(what: &str, overrides: &[String]) -> Result<Document, SceneErrors> {
        if let Some(preset) = presets::preset(what) {
            return Document::parse(what, preset.text, overrides);
        }
        let nowhere = Spot { file: what.to_owned(), place: None };
        let names: Vec<&str> = presets::PRESETS.iter().map(|preset| preset.name).collect();
        let bytes = regular_file::read(Path::new(what), LONGEST).map_err(|cause| {
            let message = match cause.kind() {
                std::io::ErrorKind::NotFound => "there is no such preset and no such file".to_owned(),
                _ => format!("cannot be read: {cause}"),
            };
            let error = nowhere.error(Reason::Unreadable, message);
            let error = error.expecting(format!("a file, or one of {}", names.join(", ")));
            match super::keys::nearest(what, names.iter().copied()) {
                Some(name) => error.advising(format!("did you mean {name}?")),
                None => error,
            }
        })?;
        let text = String::from_utf8(bytes).map_err(|cause| {
            let line = regular_file::line_that_is_not_text(cause.as_bytes()).unwrap_or(1);
            let spot =
                Spot { file: what.to_owned(), place: Some(super::Place { line: line as u32, column: 1 }) };
            spot.error(Reason::Syntax, "this line is not UTF-8 text").expecting("a TOML file in UTF-8")
        })?;
        Document::parse(what, &text, overrides)
    }

    /// A scene that comes from no text.
    pub(super) fn of(scene: Scene) -> Document {
        Document { scene, entries: None }
    }

    /// Makes the discs and holds the scene against what the method demands.
    ///
    /// # Errors
    /// [`SceneErrors`]: every precondition that does not hold.
    pub fn check(self) -> Result<Checked, SceneErrors> {
        check::check(self)
    }

    /// Where a key stands.
    pub(super) fn spot(&self, key: &Key) -> Spot {
        match &self.entries {
            Some(entries) => entries.spot(key),
            None => Spot { file: "scene".to_owned(), place: None },
        }
    }

    /// Whether the text gives a key.
    pub(super) fn gives(&self, key: &Key) -> bool {
        self.entries.as_ref().is_some_and(|entries| entries.given(key).is_some())
    }

    /// Where an item of a list stands.
    pub(super) fn item_spot(&self, key: &Key, item: usize) -> Spot {
        let entry = self.entries.as_ref().and_then(|entries| entries.given(key));
        let place = entry.and_then(|entry| entry.items.get(item));
        let spot = self.spot(key);
        Spot { place: place.copied().or(spot.place), ..spot }
    }
}

/// A start file's path: as it is, or beside the scene file.
pub(super) fn beside(scene_file: &str, path: &str) -> std::path::PathBuf {
    let folder = Path::new(scene_file).parent().unwrap_or(Path::new(""));
    let path = folder.join(path);
    std::path::absolute(&path).unwrap_or(path)
}
