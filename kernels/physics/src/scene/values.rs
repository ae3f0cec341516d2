//! The values of a scene, with their places.

use super::error::{Mistakes, Place, Spot};
use super::key_set::KeySet;
use super::keys::{Fallback, Key, Use, Value};
use super::start_file::SharedFrame;
use std::collections::{BTreeMap, BTreeSet};
use toml::de::DeValue;

pub(super) type Id = (&'static str, &'static str);

/// A value with where it comes from.
#[derive(Clone, Debug)]
pub(super) struct Entry {
    pub(super) value: Value,
    pub(super) spot: Spot,
    /// Where the items of a list stand; nothing where they come from an override.
    pub(super) items: Vec<Place>,
    pub(super) overrides: bool,
}

/// The values of a scene as they were given, with their places.
#[derive(Clone, Debug)]
pub struct Values {
    pub(super) file: String,
    pub(super) keys: &'static KeySet,
    pub(super) values: BTreeMap<Id, Entry>,
    pub(super) sections: BTreeMap<&'static str, Place>,
    /// Keys that were given, but not well.
    pub(super) faulty: BTreeSet<Id>,
    pub(super) errors: Mistakes,
    /// The frame of its start file, where other scenes share it.
    pub(super) start: Option<SharedFrame>,
}

impl Values {
    /// The same, with a start file that is read once: all clones, and scenes [with the start of this one](Self::with_start_of), take what the first of them read.
    #[must_use]
    pub fn sharing_start(self) -> Values {
        Values { start: Some(SharedFrame::default()), ..self }
    }

    /// The same, with the start file as another scene has read it.
    #[must_use]
    pub fn with_start_of(self, other: &Values) -> Values {
        Values { start: other.start.clone(), ..self }
    }

    /// Those of no text: everything is as the program that made the scene says.
    pub fn of_no_text(keys: &'static KeySet) -> Values {
        Values::none("scene", keys)
    }

    pub(super) fn none(file: &str, keys: &'static KeySet) -> Values {
        Values {
            file: file.to_owned(),
            keys,
            values: BTreeMap::new(),
            sections: BTreeMap::new(),
            faulty: BTreeSet::new(),
            errors: Mistakes::default(),
            start: None,
        }
    }

    /// The method that the scene names.
    pub fn method(&self) -> &'static str {
        self.keys.method
    }

    /// The file, the preset, or what else errors call it.
    pub fn file(&self) -> &str {
        &self.file
    }

    /// Where to look for a key: where it stands, or its section, or the file.
    pub fn spot(&self, key: &Key) -> Spot {
        match self.values.get(&key.id()) {
            Some(entry) => entry.spot.clone(),
            None => Spot { file: self.file.clone(), place: self.sections.get(key.section).copied() },
        }
    }

    /// Where an item of a list stands.
    pub fn item_spot(&self, key: &Key, item: usize) -> Spot {
        let place = self.entry(key).and_then(|entry| entry.items.get(item));
        let spot = self.spot(key);
        Spot { place: place.copied().or(spot.place), ..spot }
    }

    pub(super) fn entry(&self, key: &Key) -> Option<&Entry> {
        self.values.get(&key.id())
    }

    /// Whether a key was given, and well.
    pub fn gives(&self, key: &Key) -> bool {
        self.values.contains_key(&key.id())
    }

    /// What was given for a key, if it was given well.
    pub fn given(&self, key: &Key) -> Option<&Value> {
        self.entry(key).map(|entry| &entry.value)
    }

    /// Whether what is used with some choices of a key is used; nothing where the choice is not known.
    pub(super) fn applies(&self, used: Use) -> Option<bool> {
        match used {
            None => Some(true),
            Some((key, choices)) => self.choice(key).map(|choice| choices.contains(&choice.as_str())),
        }
    }

    /// Whether a key means anything in this scene.
    pub fn is_used(&self, key: &Key) -> bool {
        self.applies(key.used) == Some(true)
    }

    /// Whether a key was given, but not well.
    pub fn is_faulty(&self, key: &Key) -> bool {
        self.faulty.contains(&key.id())
    }

    /// The value of a key, given or by default; nothing where there is none, or a faulty one.
    pub fn value(&self, key: &Key) -> Option<Value> {
        match (self.given(key), key.fallback) {
            (Some(value), _) => Some(value.clone()),
            (None, Fallback::Is(text)) if !self.is_faulty(key) => {
                let value = DeValue::parse(text).ok()?;
                key.kind.read(&value).ok()
            }
            _ => None,
        }
    }

    /// The value of a key, given or by default, if it is a number.
    pub fn number(&self, key: &Key) -> Option<f64> {
        match self.value(key) {
            Some(Value::Number(value)) => Some(value),
            _ => None,
        }
    }

    /// The value of a key, given or by default, if it is a word; what another key implies counts as given.
    pub fn choice(&self, key: &Key) -> Option<String> {
        for other in self.implying(key) {
            if self.gives(other) {
                return other.implies.map(|(_, choice)| choice.to_owned());
            }
            if self.is_faulty(other) {
                return None;
            }
        }
        match self.value(key) {
            Some(Value::Word(word)) => Some(word),
            _ => None,
        }
    }

    /// Keys that make a choice of another one by being given.
    pub(super) fn implying(&self, key: &Key) -> impl Iterator<Item = &'static Key> {
        let id = key.id();
        self.keys.keys().filter(move |other| other.implies.is_some_and(|(of, _)| of.id() == id))
    }

    /// Whether an override made the choice of a key.
    pub(super) fn is_chosen_by_override(&self, key: &Key) -> bool {
        let own = self.entry(key).into_iter();
        own.chain(self.implying(key).filter_map(|other| self.entry(other))).any(|entry| entry.overrides)
    }
}
