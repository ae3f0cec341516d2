//! Binding of a section's fields to its keys, one function for reading and writing.

use super::key_set::{KeySet, SECTIONS};
use super::keys::{Fallback, Key, KeyValue, KeyValueKind, TableRow};
use super::shared_frame::SharedFrame;
use super::target::MeanTarget;
use super::values::SceneValues;
use super::{SceneError, SceneErrors};
use crate::input::MistakeKind;
use crate::words::Words;

/// Visitor of the fields of a section: reads them from a text, or writes them.
pub trait Binding {
    /// Binds a field with this value to a key, and returns the new value of the field, if it changes.
    fn meet(&mut self, key: &'static Key, value: Option<KeyValue>) -> Option<KeyValue>;

    /// True if fields take their values from a text.
    fn reads(&self) -> bool {
        false
    }

    /// Path of the scene file, which relative paths start from; empty if none is read.
    fn file(&self) -> &str {
        ""
    }

    /// Frame of the start file shared by runs of this scene; none if each run reads it.
    fn shared_start(&self) -> Option<SharedFrame> {
        None
    }
}

macro_rules! define_bindings {
    ($($method:ident, $optional:ident, $variant:ident, $ty:ty;)*) => {
        impl dyn Binding + '_ {
            $(
                /// Binds a field that always has a value.
                pub fn $method(&mut self, key: &'static Key, field: &mut $ty) {
                    if let Some(KeyValue::$variant(value)) = self.meet(key, Some(KeyValue::$variant(field.clone()))) {
                        *field = value;
                    }
                }

                /// Binds an optional field.
                pub fn $optional(&mut self, key: &'static Key, field: &mut Option<$ty>) {
                    match self.meet(key, field.clone().map(KeyValue::$variant)) {
                        Some(KeyValue::$variant(value)) => *field = Some(value),
                        _ => {}
                    }
                }
            )*
        }
    };
}

define_bindings! {
    number, number_if_any, Number, f64;
    whole, whole_if_any, Whole, u64;
    switch, switch_if_any, Switch, bool;
    word, word_if_any, Word, String;
    pair, pair_if_any, Pair, [f64; 2];
    switches, switches_if_any, Switches, [bool; 2];
    pairs, pairs_if_any, Pairs, Vec<[f64; 2]>;
    numbers, numbers_if_any, Numbers, Vec<f64>;
    rows, rows_if_any, Rows, Vec<Vec<f64>>;
    target, target_if_any, Target, MeanTarget;
    words, words_if_any, Words, Vec<String>;
    tables, tables_if_any, Tables, Vec<TableRow>;
}

impl dyn Binding + '_ {
    /// Binds a field that is one of some words.
    pub fn choice<W: Words>(&mut self, key: &'static Key, field: &mut W) {
        let mut word = field.word().to_owned();
        self.word(key, &mut word);
        if let Some(value) = W::parse(&word) {
            *field = value;
        }
    }

    /// Binds a count of things in memory.
    pub fn count(&mut self, key: &'static Key, field: &mut usize) {
        let mut count = *field as u64;
        self.whole(key, &mut count);
        *field = count as usize;
    }
}

/// Binding that reads fields from values.
pub struct ReadBinding<'v> {
    values: &'v SceneValues,
    missing: Vec<SceneError>,
}

impl<'v> ReadBinding<'v> {
    /// Reads from values that have passed their rules.
    pub fn new(values: &'v SceneValues) -> Self {
        ReadBinding { values, missing: Vec::new() }
    }

    /// Checks that every field had its value.
    ///
    /// # Errors
    /// Keys that have neither a value nor a default.
    pub fn finish_reading(self) -> Result<(), SceneErrors> {
        SceneErrors::ok_if_empty(self.missing)
    }
}

impl Binding for ReadBinding<'_> {
    fn meet(&mut self, key: &'static Key, _: Option<KeyValue>) -> Option<KeyValue> {
        let implied = self.values.implying(key).any(|other| self.values.is_given(other));
        if implied {
            return self.values.choice(key).map(KeyValue::Word);
        }
        let value = self.values.value(key);
        if value.is_none()
            && key.fallback == Fallback::Required
            && self.values.applies(key.used) != Some(false)
        {
            let error =
                self.values.spot(key).error(MistakeKind::Missing, format!("`{}` is missing", key.path()));
            self.missing.push(error.expecting(key.expected()));
        }
        value
    }

    fn reads(&self) -> bool {
        true
    }

    fn file(&self) -> &str {
        self.values.file()
    }

    fn shared_start(&self) -> Option<SharedFrame> {
        self.values.start.clone()
    }
}

/// Binding that writes fields as values.
#[derive(Default)]
pub struct Write(Vec<(&'static Key, KeyValue)>);

impl Binding for Write {
    fn meet(&mut self, key: &'static Key, value: Option<KeyValue>) -> Option<KeyValue> {
        // A choice implied by another key is not written: that key implies it again.
        let is_said = !matches!((&value, key.kind), (Some(KeyValue::Word(word)), kind) if !kind.admits(word));
        self.0.extend(value.filter(|_| is_said).map(|value| (key, value)));
        None
    }
}

impl Write {
    /// Text in TOML: every key with its value and unit, in the order of the keys.
    pub fn to_toml(&self, keys: &KeySet) -> String {
        let mut text = String::new();
        let sections = std::iter::once("").chain(SECTIONS.iter().map(|(name, _)| *name));
        for section in sections {
            let mut lines = String::new();
            for key in keys.section(section).filter(|key| !matches!(key.kind, KeyValueKind::Tables(_))) {
                let Some((_, value)) = self.0.iter().find(|(written, _)| written.id() == key.id()) else {
                    continue;
                };
                let unit = if key.unit.is_empty() { String::new() } else { format!(" # {}", key.unit) };
                lines.push_str(&format!("{} = {}{unit}\n", key.name, value.to_toml()));
            }
            if !lines.is_empty() {
                if !section.is_empty() {
                    text.push_str(&format!("\n[{section}]\n"));
                }
                text.push_str(&lines);
            }
        }
        // Tables of a list end the text: whatever follows them belongs to the last one.
        for (key, value) in &self.0 {
            let (KeyValueKind::Tables(fields), KeyValue::Tables(rows)) = (key.kind, value) else { continue };
            for row in rows {
                text.push_str(&format!("\n[[{}]]\n", key.name));
                for (name, value) in row {
                    let unit = fields.iter().find(|field| field.name == *name).map_or("", |field| field.unit);
                    let unit = if unit.is_empty() { String::new() } else { format!(" # {unit}") };
                    text.push_str(&format!("{name} = {}{unit}\n", value.to_toml()));
                }
            }
        }
        text
    }
}
