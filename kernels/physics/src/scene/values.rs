//! Vocabulary of a method's scenes (keys, rules, presets), and the values of a scene with their locations.

use super::SceneError;
use super::key_set::KeySet;
use super::keys::{Fallback, Key, KeyValue, Use};
use super::shared_frame::SharedFrame;
use crate::input::{MistakeList, Spot, TextLocation};
use std::collections::{BTreeMap, BTreeSet};
use toml::de::DeValue;

/// Scene that is built into the program.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Preset {
    /// Name of the preset.
    pub name: &'static str,
    /// Text of the scene file, with comments.
    pub text: &'static str,
}

impl Preset {
    /// Title of the scene: the first line of its text.
    pub fn title(&self) -> &'static str {
        self.text.lines().next().unwrap_or_default().trim_start_matches(['#', ' '])
    }
}

/// Key of format 1 with its equivalent in format 2.
#[derive(Clone, Copy, Debug)]
pub struct RenamedKey {
    /// `section.key` of format 1.
    pub old: &'static str,
    /// Equivalent in format 2.
    pub new: &'static str,
}

/// Vocabulary of a method's scenes.
#[derive(Debug)]
pub struct Vocabulary {
    /// Keys of the method.
    pub keys: KeySet,
    /// Rules between keys; each returns every mistake that it finds.
    pub rules: &'static [fn(&SceneValues) -> Vec<SceneError>],
    /// Presets of the method.
    pub presets: &'static [Preset],
    /// Keys that format 1 spelt differently.
    pub renamed: &'static [RenamedKey],
}

pub(super) type Id = (&'static str, &'static str);

/// Value with its location.
#[derive(Clone, Debug)]
pub(super) struct ValueEntry {
    pub(super) value: KeyValue,
    pub(super) spot: Spot,
    /// Locations of the items of a list; empty if they come from an override.
    pub(super) items: Vec<TextLocation>,
    pub(super) overrides: bool,
}

/// Values of a scene as given, with their locations.
#[derive(Clone, Debug)]
pub struct SceneValues {
    pub(super) file: String,
    pub(super) vocabulary: &'static Vocabulary,
    /// Methods that the scene could have named, for help with unknown keys.
    pub(super) methods: Vec<&'static Vocabulary>,
    pub(super) values: BTreeMap<Id, ValueEntry>,
    /// Values of the text that overrides made obsolete; further overrides may restore them.
    pub(super) set_aside: BTreeMap<Id, ValueEntry>,
    pub(super) sections: BTreeMap<&'static str, TextLocation>,
    /// Keys that were given with an invalid value.
    pub(super) faulty: BTreeSet<Id>,
    pub(super) errors: MistakeList,
    /// Frame of the start file, if other scenes share it.
    pub(super) start: Option<SharedFrame>,
}

impl SceneValues {
    /// Makes all clones, and scenes [with the start of this one](Self::with_start_of), read the start file once.
    #[must_use]
    pub fn sharing_start(self) -> SceneValues {
        SceneValues { start: Some(SharedFrame::default()), ..self }
    }

    /// Takes the start file as another scene has read it.
    #[must_use]
    pub fn with_start_of(self, other: &SceneValues) -> SceneValues {
        SceneValues { start: other.start.clone(), ..self }
    }

    /// Values without a text: the program that made the scene supplies everything.
    pub(crate) fn without_text(vocabulary: &'static Vocabulary) -> SceneValues {
        SceneValues::empty_values("scene", vocabulary, &[])
    }

    pub(super) fn empty_values(
        file: &str,
        vocabulary: &'static Vocabulary,
        methods: &[&'static Vocabulary],
    ) -> SceneValues {
        SceneValues {
            file: file.to_owned(),
            vocabulary,
            methods: methods.to_vec(),
            values: BTreeMap::new(),
            set_aside: BTreeMap::new(),
            sections: BTreeMap::new(),
            faulty: BTreeSet::new(),
            errors: MistakeList::default(),
            start: None,
        }
    }

    /// Method that the scene names.
    pub fn method(&self) -> &'static str {
        self.vocabulary.keys.method
    }

    /// Name of the scene in errors: the file, the preset, or another.
    pub fn file(&self) -> &str {
        &self.file
    }

    /// Location of a key, or of its section if it is not given, or the file.
    pub fn spot(&self, key: &Key) -> Spot {
        match self.values.get(&key.id()) {
            Some(entry) => entry.spot.clone(),
            None => Spot { file: self.file.clone(), place: self.sections.get(key.section).copied() },
        }
    }

    /// Location of an item of a list.
    pub(crate) fn item_spot(&self, key: &Key, item: usize) -> Spot {
        let place = self.entry(key).and_then(|entry| entry.items.get(item));
        let spot = self.spot(key);
        Spot { place: place.copied().or(spot.place), ..spot }
    }

    /// Sets aside a value that overrides made obsolete.
    pub(super) fn set_aside(&mut self, key: &Key) {
        self.set_aside.extend(self.values.remove_entry(&key.id()));
    }

    pub(super) fn entry(&self, key: &Key) -> Option<&ValueEntry> {
        self.values.get(&key.id())
    }

    /// True if a key was given with a valid value.
    pub fn is_given(&self, key: &Key) -> bool {
        self.values.contains_key(&key.id())
    }

    /// Value given for a key, if valid.
    pub fn given(&self, key: &Key) -> Option<&KeyValue> {
        self.entry(key).map(|entry| &entry.value)
    }

    /// True if the condition of a key is met; none if the choice is unknown.
    pub(super) fn applies(&self, used: Use) -> Option<bool> {
        match used {
            None => Some(true),
            Some((key, choices)) => self.choice(key).map(|choice| choices.contains(&choice.as_str())),
        }
    }

    /// True if a key is used in this scene.
    pub fn is_used(&self, key: &Key) -> bool {
        self.applies(key.used) == Some(true)
    }

    /// True for the seed of a start file whose velocities no key asks to draw.
    pub fn is_idle(&self, key: &Key) -> bool {
        let is_given = |name: &str| self.values.contains_key(&("particles", name));
        let draws = ["temperature", "speed", "virial"].into_iter().any(is_given);
        key.id() == ("particles", "seed") && is_given("file") && !draws
    }

    /// True if a key was given with an invalid value.
    pub(crate) fn is_faulty(&self, key: &Key) -> bool {
        self.faulty.contains(&key.id())
    }

    /// Value of a key, given or by default; none if it has neither, or an invalid one.
    pub fn value(&self, key: &Key) -> Option<KeyValue> {
        match (self.given(key), key.fallback) {
            (Some(value), _) => Some(value.clone()),
            (None, Fallback::Is(text)) if !self.is_faulty(key) => {
                let value = DeValue::parse(text).ok()?;
                key.kind.read(&value).ok()
            }
            _ => None,
        }
    }

    /// Value of a key, given or by default, if it is a number.
    pub fn number(&self, key: &Key) -> Option<f64> {
        match self.value(key) {
            Some(KeyValue::Number(value)) => Some(value),
            _ => None,
        }
    }

    /// Value of a key, given or by default, if it is a word. A choice that another key implies counts as given.
    pub fn choice(&self, key: &Key) -> Option<String> {
        for other in self.implying(key) {
            if self.is_given(other) {
                return other.implies.map(|(_, choice)| choice.to_owned());
            }
            if self.is_faulty(other) {
                return None;
            }
        }
        match self.value(key) {
            Some(KeyValue::Word(word)) => Some(word),
            _ => None,
        }
    }

    /// Keys that imply a choice of this one when given.
    pub(super) fn implying(&self, key: &Key) -> impl Iterator<Item = &'static Key> {
        let id = key.id();
        self.vocabulary.keys.keys().filter(move |other| other.implies.is_some_and(|(of, _)| of.id() == id))
    }

    /// True if an override made the choice of a key.
    pub(super) fn is_chosen_by_override(&self, key: &Key) -> bool {
        let own = self.entry(key).into_iter();
        own.chain(self.implying(key).filter_map(|other| self.entry(other))).any(|entry| entry.overrides)
    }
}
