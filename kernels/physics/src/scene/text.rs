//! Parsing of a scene's text into values that are valid on their own.

use super::arrays::{ArrayFault, NumberArray};
use super::general::{FORMAT, METHOD};
use super::key_set::{KeySet, SECTIONS};
use super::keys::{Key, KeyValue, KeyValueKind, ValueFault};
use super::overrides::{as_typed, typed};
use super::unknown::{KeyHelp, UnknownKey};
use super::values::{SceneValues, ValueEntry, Vocabulary};
use super::{SceneError, SceneErrors};
use crate::input::{InputText, MistakeKind, Spot};
use crate::quoted::quoted;
use crate::words::nearest;
use toml::Spanned;
use toml::de::{DeTable, DeValue};

/// Method that a text and its overrides name, and the location of its name.
fn requested_method(
    table: &DeTable<'_>,
    text: &InputText<'_>,
    overrides: &[String],
) -> Option<(String, Spot)> {
    let overriding = overrides.iter().rev().find_map(|text| {
        let (path, value) = text.split_once('=')?;
        let spot = Spot { file: format!("--set {text}"), place: None };
        (path.trim() == METHOD.path()).then(|| (value.trim().trim_matches('"').to_owned(), spot))
    });
    overriding.or_else(|| {
        let section = table.get(METHOD.section)?.get_ref().as_table()?;
        let kind = section.get(METHOD.name)?;
        Some((kind.get_ref().as_str()?.to_owned(), text.spot(kind.span().start)))
    })
}

/// Reads the text of a scene and then the overrides, each `section.key=value`.
pub(super) fn read(
    file: &str,
    text: &str,
    overrides: &[String],
    methods: &[&'static Vocabulary],
) -> Result<SceneValues, SceneErrors> {
    let text = &InputText::new(file, text);
    let table = text.table()?;
    super::format_1::reject_format_1(&table, text, methods)?;
    let asked = requested_method(&table, text, overrides);
    let known = |name: &str| methods.iter().copied().find(|method| method.keys.method == name);
    let vocabulary = match &asked {
        Some((name, spot)) => known(name).ok_or_else(|| unknown_method(name, spot, methods))?,
        // Without a method's name the file is read as if it named the first one; the missing name is reported too.
        None => methods.first().copied().ok_or_else(|| unknown_method("", &Spot::default(), methods))?,
    };
    let mut values = SceneValues::empty_values(file, vocabulary, methods);
    let source = ValueSource { text: Some(text), file, keys: &vocabulary.keys, methods };
    for (name, value) in &table {
        source.read_head_entry(&mut values, name, value);
    }
    let version = values.errors.named().iter().find(|error| error.reason == MistakeKind::Format);
    if let Some(error) = version.cloned() {
        // Another version has other keys, so further errors may be spurious.
        return Err(error.into());
    }
    for text in overrides {
        override_with(&mut values, text, methods);
    }
    Ok(values)
}

fn unknown_method(name: &str, spot: &Spot, methods: &[&'static Vocabulary]) -> SceneErrors {
    let names: Vec<String> = methods.iter().map(|method| format!("\"{}\"", method.keys.method)).collect();
    let error = spot
        .error(MistakeKind::Type, format!("`{}` is the text \"{}\"", METHOD.path(), quoted(name)))
        .expecting(format!("kind = {}", names.join(" or ")));
    match nearest(name, methods.iter().map(|method| method.keys.method)) {
        Some(nearest) => error.advising(format!("did you mean \"{nearest}\"?")).into(),
        None => error.into(),
    }
}

/// Applies an override.
fn override_with(values: &mut SceneValues, text: &str, methods: &[&'static Vocabulary]) {
    let file = format!("--set {text}");
    let spot = Spot { file: file.clone(), place: None };
    let Some((path, value)) = text.split_once('=') else {
        let error = spot.error(MistakeKind::Override, "an override needs a key and a value");
        return values.errors.push(error.expecting("section.key=value"));
    };
    let typed = value.trim();
    let (path, value) = (path.trim(), as_typed(typed));
    let source = ValueSource { text: None, file: &file, keys: &values.vocabulary.keys, methods };
    if let Some((list, text)) = item_of_list(values, path, typed) {
        return source.read_head_entry(values, &Spanned::new(0..0, list.into()), &as_typed(&text));
    }
    match path.split_once('.') {
        Some((section, key)) => match SECTIONS.iter().find(|(name, _)| *name == section) {
            Some((name, _)) => source.key(values, name, &Spanned::new(0..0, key.into()), &value),
            None => source.unknown_section(values, &Spanned::new(0..0, section.into())),
        },
        None => source.read_head_entry(values, &Spanned::new(0..0, path.into()), &value),
    }
}

/// Name and new text of a list of tables in which an override such as `walls.2.to` replaces one value; items are numbered from 1.
fn item_of_list(values: &SceneValues, path: &str, typed: &str) -> Option<(String, String)> {
    let (list, rest) = path.split_once('.')?;
    let (number, name) = rest.split_once('.')?;
    let key = values.vocabulary.keys.key("", list)?;
    let (Some(KeyValue::Tables(rows)), Ok(number)) = (values.value(key), number.parse::<usize>()) else {
        return None;
    };
    let parsed = |text: &str| format!("value = {text}").parse::<toml::Table>().ok()?.remove("value");
    let mut items = parsed(&KeyValue::Tables(rows).to_toml())?;
    let item = items.as_array_mut()?.get_mut(number.checked_sub(1)?)?.as_table_mut()?;
    item.insert(name.to_owned(), parsed(typed).unwrap_or_else(|| toml::Value::String(typed.to_owned())));
    Some((list.to_owned(), items.to_string()))
}

/// Applies an override of a known key, with the checks and messages of a typed one.
pub(super) fn set(values: &mut SceneValues, key: &Key, value: &KeyValue) {
    let text = typed(value);
    let file = format!("--set {}={text}", key.path());
    let methods = values.methods.clone();
    let source = ValueSource { text: None, file: &file, keys: &values.vocabulary.keys, methods: &methods };
    let name = Spanned::new(0..0, key.name.into());
    source.key(values, key.section, &name, &as_typed(&text));
}

/// Applies an array as the value of a key.
pub(super) fn set_array(values: &mut SceneValues, path: &str, array: &NumberArray) {
    let spot = Spot { file: format!("array {path}"), place: None };
    let key = path.split_once('.').and_then(|(section, name)| values.vocabulary.keys.key(section, name));
    let Some(key) = key else {
        // Unknown keys have the message of a text.
        let methods = values.methods.clone();
        return override_with(values, &format!("{path}=[]"), &methods);
    };
    let expected = match key.kind {
        KeyValueKind::Pairs => "(N, 2)".to_owned(),
        KeyValueKind::Rows(width) => format!("(N, {width})"),
        KeyValueKind::Pair(_) => "(2,)".to_owned(),
        _ => "(N,)".to_owned(),
    };
    let of_shape = |shape: &[usize]| {
        let comma = if shape.len() == 1 { "," } else { "" };
        format!("({}{comma})", shape.iter().map(ToString::to_string).collect::<Vec<_>>().join(", "))
    };
    let error = match array.value(key.kind) {
        Ok(value) => {
            let entry = ValueEntry { value, spot, items: vec![], overrides: true };
            values.faulty.remove(&key.id());
            values.values.insert(key.id(), entry);
            return;
        }
        Err(ArrayFault::NoList) => {
            spot.error(MistakeKind::Type, format!("`{path}` is an array")).expecting(key.expected())
        }
        Err(ArrayFault::Shape(shape)) => spot
            .error(MistakeKind::Type, format!("`{path}` has the shape {}", of_shape(&shape)))
            .expecting(format!("the shape {expected}")),
        Err(ArrayFault::Number(place, number)) => {
            let place = place.iter().map(ToString::to_string).collect::<Vec<_>>().join(", ");
            let error = spot.error(MistakeKind::Range, format!("`{path}`[{place}] is {number}"));
            error.expecting(key.expected())
        }
    };
    values.faulty.insert(key.id());
    values.errors.push(error);
}

/// Source of values: the file, or an option of the command line.
struct ValueSource<'s> {
    text: Option<&'s InputText<'s>>,
    file: &'s str,
    keys: &'static KeySet,
    methods: &'s [&'static Vocabulary],
}

impl ValueSource<'_> {
    fn spot(&self, offset: usize) -> Spot {
        match self.text {
            Some(text) => text.spot(offset),
            None => Spot { file: self.file.to_owned(), place: None },
        }
    }

    /// Reads a key or section at the head of the file.
    fn read_head_entry(
        &self,
        values: &mut SceneValues,
        name: &Spanned<std::borrow::Cow<'_, str>>,
        value: &Spanned<DeValue<'_>>,
    ) {
        let Some((section, _)) = SECTIONS.iter().find(|(section, _)| *section == name.get_ref()) else {
            let is_table = value.get_ref().as_table().is_some();
            let known = self.keys.key("", name.get_ref()).is_some();
            return match is_table && !known {
                true => self.unknown_section(values, name),
                false => self.key(values, "", name, value),
            };
        };
        let place = self.spot(name.span().start).place;
        if let Some(place) = place {
            values.sections.insert(section, place);
        }
        match value.get_ref().as_table() {
            Some(table) => {
                for (name, value) in table {
                    self.key(values, section, name, value);
                }
            }
            None => {
                values.faulty.extend(self.keys.section(section).map(Key::id));
                let spot = Spot { file: self.file.to_owned(), place };
                let error = spot.error(MistakeKind::Type, format!("`{section}` is not a table"));
                values.errors.push(error.expecting(format!("[{section}], and keys in the lines below it")));
            }
        }
    }

    fn unknown_section(&self, values: &mut SceneValues, name: &Spanned<std::borrow::Cow<'_, str>>) {
        if !values.errors.has_room() {
            return values.errors.count();
        }
        let names = SECTIONS.map(|(name, _)| name);
        let mut error = self
            .spot(name.span().start)
            .error(MistakeKind::Unknown, format!("unknown section [{}]", quoted(name.get_ref())))
            .expecting(names.map(|name| format!("[{name}]")).join(" "));
        if let Some(nearest) = nearest(name.get_ref(), names) {
            error = error.advising(format!("did you mean [{nearest}]?"));
            // Its keys are not missing: they are under a misspelt name.
            values.faulty.extend(self.keys.section(nearest).map(Key::id));
        }
        values.errors.push(error);
    }

    fn key(
        &self,
        values: &mut SceneValues,
        section: &'static str,
        name: &Spanned<std::borrow::Cow<'_, str>>,
        value: &Spanned<DeValue<'_>>,
    ) {
        let Some(key) = self.keys.key(section, name.get_ref()) else {
            return self.unknown_key(values, section, name);
        };
        match key.kind.read(value) {
            Ok(read) => {
                let elements = value.get_ref().as_array().into_iter().flatten();
                let places = |text: &InputText<'_>| {
                    elements.map(|item| text.location_of_byte(item.span().start)).collect()
                };
                let entry = ValueEntry {
                    value: read,
                    spot: self.spot(name.span().start),
                    items: self.text.map(places).unwrap_or_default(),
                    overrides: self.text.is_none(),
                };
                values.faulty.remove(&key.id());
                values.values.insert(key.id(), entry);
            }
            Err(faults) => {
                values.faulty.insert(key.id());
                values.errors.extend(faults.iter().map(|fault| self.fault(key, fault)));
            }
        }
    }

    fn unknown_key(
        &self,
        values: &mut SceneValues,
        section: &'static str,
        name: &Spanned<std::borrow::Cow<'_, str>>,
    ) {
        if !values.errors.has_room() {
            return values.errors.count();
        }
        let place =
            if section.is_empty() { "at the top of the file".to_owned() } else { format!("in [{section}]") };
        let place =
            if section.is_empty() && self.text.is_none() { "without a section".to_owned() } else { place };
        let mut error = self
            .spot(name.span().start)
            .error(MistakeKind::Unknown, format!("unknown key `{}` {place}", quoted(name.get_ref())));
        let unknown = UnknownKey {
            keys: self.keys,
            methods: self.methods,
            section,
            name: name.get_ref(),
            overrides: self.text.is_none(),
        };
        error = match unknown.help() {
            KeyHelp::Advice(advice, meant) => {
                // A misspelt key is not missing.
                values.faulty.extend(meant.iter().map(|key| key.id()));
                error.advising(advice)
            }
            KeyHelp::Expected(keys) => error.expecting(keys),
        };
        values.errors.push(error);
    }

    fn fault(&self, key: &Key, fault: &ValueFault) -> SceneError {
        let format = key.id() == FORMAT.id() && fault.reason == MistakeKind::Range;
        let (reason, message) = match fault.reason {
            MistakeKind::Range if format => {
                (MistakeKind::Format, format!("unknown scene format: {}", fault.found))
            }
            MistakeKind::Range => (MistakeKind::Range, format!("`{}` cannot be {}", key.path(), fault.found)),
            other => (other, format!("`{}` is {}", key.path(), fault.found)),
        };
        let error = self.spot(fault.span.start).error(reason, message).expecting(key.expected());
        match fault.nearest {
            Some(nearest) => error.advising(format!("did you mean \"{nearest}\"?")),
            None => error,
        }
    }
}
