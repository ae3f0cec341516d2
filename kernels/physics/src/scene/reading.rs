//! Reading of scenes: from a preset's name, a file or a text to checked values.

use super::arrays::NumberArray;
use super::general::METHOD;
use super::overrides::Overrides;
use super::values::{Preset, SceneValues, Vocabulary};
use super::{SceneErrors, rules, text};
use crate::input::{MistakeKind, Spot, read_text};
use crate::words::nearest;
use std::path::Path;

/// Longest scene file (bytes); a list of positions may be long.
const LONGEST: u64 = 64 << 20;

impl SceneValues {
    /// Reads the text of a scene for one of some methods, with overrides `section.key=value`. `file` is its name in errors.
    ///
    /// # Errors
    /// [`SceneErrors`]: every mistake of text and overrides.
    pub fn parse(
        file: &str,
        text: &str,
        overrides: &[String],
        methods: &[&'static Vocabulary],
    ) -> Result<SceneValues, SceneErrors> {
        SceneValues::parse_with_arrays(file, text, (overrides, &[]), methods)
    }

    /// Reads the text of a scene with overrides and, after them, arrays as values of keys `section.key`.
    ///
    /// # Errors
    /// As for [`parse`](Self::parse), and for arrays of another shape or with numbers out of range.
    pub fn parse_with_arrays(
        file: &str,
        text: &str,
        (overrides, arrays): (&[String], &[(String, NumberArray)]),
        methods: &[&'static Vocabulary],
    ) -> Result<SceneValues, SceneErrors> {
        let mut values = text::read(file, text, overrides, methods)?;
        for (path, array) in arrays {
            text::set_array(&mut values, path, array);
        }
        values.checked()
    }

    /// Returns the values with further overrides, as if the text were read again with all of them; the last one for a key applies.
    ///
    /// # Errors
    /// [`SceneErrors`]: every mistake of the overrides, which cannot change the method.
    pub fn with(&self, overrides: &Overrides) -> Result<SceneValues, SceneErrors> {
        let mut values = self.clone();
        values.values.append(&mut values.set_aside);
        for (key, value) in overrides.iter() {
            text::set(&mut values, key, value);
        }
        if values.given(&METHOD) != self.given(&METHOD) {
            let error = values.spot(&METHOD).error(
                MistakeKind::Contradiction,
                "an override cannot change the method of a scene that is already read",
            );
            values.errors.push(error);
        }
        values.checked()
    }

    /// Applies all rules to the values.
    fn checked(mut self) -> Result<SceneValues, SceneErrors> {
        rules::apply_rules(&mut self);
        std::mem::take(&mut self.errors).ok_without_mistakes(&self.file)?;
        Ok(self)
    }

    /// Reads a scene by a preset's name or a file's path, with overrides.
    ///
    /// # Errors
    /// [`SceneErrors`]: neither preset nor readable file, or every mistake of the text.
    pub fn load(
        what: &str,
        overrides: &[String],
        methods: &[&'static Vocabulary],
    ) -> Result<SceneValues, SceneErrors> {
        SceneValues::parse(what, &SceneValues::text(what, methods)?, overrides, methods)
    }

    /// Reads the text of a scene by a preset's name or a file's path. A program that needs the scene several times should parse this text each
    /// time, since the file may change.
    ///
    /// # Errors
    /// [`SceneErrors`]: neither preset nor readable file.
    pub fn text(what: &str, methods: &[&'static Vocabulary]) -> Result<String, SceneErrors> {
        let presets = || methods.iter().flat_map(|method| method.presets);
        if let Some(Preset { text, .. }) = presets().find(|preset| preset.name == what) {
            return Ok((*text).to_owned());
        }
        let nowhere = Spot { file: what.to_owned(), place: None };
        let names: Vec<&str> = presets().map(|preset| preset.name).collect();
        read_text(Path::new(what), LONGEST, |cause| {
            let message = match cause.kind() {
                std::io::ErrorKind::NotFound => "there is no such preset and no such file".to_owned(),
                _ => format!("cannot be read: {cause}"),
            };
            let error = nowhere.error(MistakeKind::Unreadable, message);
            let error = error.expecting(format!("a file, or one of {}", names.join(", ")));
            match nearest(what, presets().map(|preset| preset.name)) {
                Some(name) => error.advising(format!("did you mean {name}?")),
                None => error,
            }
        })
    }
}
