//! What the scenes of a method may say: its keys, what they demand of each other, and scenes to start from.

use super::error::SceneError;
use super::key_set::KeySet;
use super::values::Values;

/// A scene that comes with the program.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Preset {
    /// The name.
    pub name: &'static str,
    /// The file, with comments.
    pub text: &'static str,
}

impl Preset {
    /// What it shows: the first line of its text.
    pub fn title(&self) -> &'static str {
        self.text.lines().next().unwrap_or_default().trim_start_matches(['#', ' '])
    }
}

/// A key of format 1, with what says the same in format 2.
#[derive(Clone, Copy, Debug)]
pub struct Renamed {
    /// `section.key` of format 1.
    pub old: &'static str,
    /// What to write instead.
    pub new: &'static str,
}

/// What the scenes of a method may say.
#[derive(Debug)]
pub struct Vocabulary {
    /// Its keys.
    pub keys: KeySet,
    /// What else must agree; each gives every mistake that it finds.
    pub rules: &'static [fn(&Values) -> Vec<SceneError>],
    /// Scenes to start from.
    pub presets: &'static [Preset],
    /// What scenes of format 1 said otherwise.
    pub renamed: &'static [Renamed],
}
