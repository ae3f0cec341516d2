//! What the scenes of a method may say (its keys, what they demand of each other, scenes to start from), and the values of a scene, with their places.

use super::SceneError;
use super::key_set::KeySet;
use super::keys::{Fallback, Key, Use, Value};
use super::start_file::SharedFrame;
use crate::input::{Mistakes, Place, Spot};
use std::collections::{BTreeMap, BTreeSet};
use toml::de::DeValue;

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
    pub(super) vocabulary: &'static Vocabulary,
    /// The methods that the scene could have named, for help with unknown keys.
    pub(super) methods: Vec<&'static Vocabulary>,
    pub(super) values: BTreeMap<Id, Entry>,
    /// Values of the text that overrides have made meaningless; further overrides may give them their meaning back.
    pub(super) set_aside: BTreeMap<Id, Entry>,
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
    pub(crate) fn of_no_text(vocabulary: &'static Vocabulary) -> Values {
        Values::none("scene", vocabulary, &[])
    }

    pub(super) fn none(
        file: &str,
        vocabulary: &'static Vocabulary,
        methods: &[&'static Vocabulary],
    ) -> Values {
        Values {
            file: file.to_owned(),
            vocabulary,
            methods: methods.to_vec(),
            values: BTreeMap::new(),
            set_aside: BTreeMap::new(),
            sections: BTreeMap::new(),
            faulty: BTreeSet::new(),
            errors: Mistakes::default(),
            start: None,
        }
    }

    /// The method that the scene names.
    pub fn method(&self) -> &'static str {
        self.vocabulary.keys.method
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
    pub(crate) fn item_spot(&self, key: &Key, item: usize) -> Spot {
        let place = self.entry(key).and_then(|entry| entry.items.get(item));
        let spot = self.spot(key);
        Spot { place: place.copied().or(spot.place), ..spot }
    }

    /// Puts the value of a key aside, as overrides have made it meaningless.
    pub(super) fn set_aside(&mut self, key: &Key) {
        self.set_aside.extend(self.values.remove_entry(&key.id()));
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
    pub(crate) fn is_faulty(&self, key: &Key) -> bool {
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
        self.vocabulary.keys.keys().filter(move |other| other.implies.is_some_and(|(of, _)| of.id() == id))
    }

    /// Whether an override made the choice of a key.
    pub(super) fn is_chosen_by_override(&self, key: &Key) -> bool {
        let own = self.entry(key).into_iter();
        own.chain(self.implying(key).filter_map(|other| self.entry(other))).any(|entry| entry.overrides)
    }
}
