//! From the text of a scene to values that are each right for themselves.

use super::error::{Mistakes, Place, Reason, SceneError, SceneErrors, Spot};
use super::general::{FORMAT, METHOD};
use super::key_set::{KeySet, SECTIONS};
use super::keys::{Fault, Key, Value};
use super::overrides::{as_typed, typed};
use super::unknown::{Help, Unknown};
use super::values::{Entry, Values, Vocabulary};
use crate::quoted::quoted;
use crate::words::nearest;
use std::collections::BTreeSet;
use toml::Spanned;
use toml::de::{DeTable, DeValue};

/// Where lines begin.
struct Lines<'t> {
    file: &'t str,
    text: &'t [u8],
    starts: Vec<usize>,
    /// Characters before every [`Lines::BLOCK`]th byte.
    before: Vec<usize>,
}

impl<'t> Lines<'t> {
    /// A place is counted from this far at most, however long its line.
    const BLOCK: usize = 1024;

    fn new(file: &'t str, text: &'t str) -> Self {
        let text = text.as_bytes();
        let breaks = text.iter().enumerate().filter(|(_, byte)| **byte == b'\n').map(|(at, _)| at + 1);
        let starts = std::iter::once(0).chain(breaks).collect();
        let mut characters = 0;
        let before = text.chunks(Lines::BLOCK).map(|block| {
            let before = characters;
            characters += count_characters(block);
            before
        });
        Lines { file, text, starts, before: before.collect() }
    }

    /// Characters before a byte.
    fn characters(&self, offset: usize) -> usize {
        let block = (offset / Lines::BLOCK).min(self.before.len().saturating_sub(1));
        let rest = self.text.get(block * Lines::BLOCK..offset.min(self.text.len())).unwrap_or_default();
        self.before.get(block).copied().unwrap_or(0) + count_characters(rest)
    }

    fn place(&self, offset: usize) -> Place {
        let line = self.starts.partition_point(|start| *start <= offset);
        let start = self.starts[line.saturating_sub(1)];
        let column = 1 + self.characters(offset) - self.characters(start);
        Place { line: line as u32, column: column as u32 }
    }

    fn spot(&self, offset: usize) -> Spot {
        Spot { file: self.file.to_owned(), place: Some(self.place(offset)) }
    }
}

/// Characters, not bytes: continuation bytes of UTF-8 do not count.
fn count_characters(text: &[u8]) -> usize {
    text.iter().filter(|byte| **byte & 0xC0 != 0x80).count()
}

/// The method that a text and its overrides ask for, and where they do.
fn asked_method(
    file: &str,
    table: &DeTable<'_>,
    lines: &Lines<'_>,
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
        let spot = Spot { file: file.to_owned(), place: Some(lines.place(kind.span().start)) };
        Some((kind.get_ref().as_str()?.to_owned(), spot))
    })
}

/// Reads the text of a scene and then the overrides, each `section.key=value`.
pub(super) fn read(
    file: &str,
    text: &str,
    overrides: &[String],
    methods: &[&'static Vocabulary],
) -> Result<Values, SceneErrors> {
    let lines = Lines::new(file, text);
    let (table, syntax) = DeTable::parse_recoverable(text);
    if !syntax.is_empty() {
        // One mistake often makes several messages; what else a broken text says is not to be trusted.
        let (mut known, mut errors) = (BTreeSet::new(), Mistakes::default());
        for error in syntax {
            let place = error.span().map(|span| lines.place(span.start));
            if known.insert(place.map(|place| place.line)) {
                let spot = Spot { file: file.to_owned(), place };
                errors.push(spot.error(Reason::Syntax, format!("not TOML: {}", error.message())));
            }
        }
        errors.none_of(file)?;
        return Err(Spot { file: file.to_owned(), place: None }.error(Reason::Syntax, "not TOML").into());
    }
    super::format_1::refuse(file, table.get_ref(), |offset| lines.place(offset), methods)?;
    let asked = asked_method(file, table.get_ref(), &lines, overrides);
    let known = |name: &str| methods.iter().copied().find(|method| method.keys.method == name);
    let vocabulary = match &asked {
        Some((name, spot)) => known(name).ok_or_else(|| unknown_method(name, spot, methods))?,
        // The rest of the file is read as if it were of the first method; that its name is missing is said too.
        None => methods.first().copied().ok_or_else(|| unknown_method("", &Spot::default(), methods))?,
    };
    let mut values = Values::none(file, vocabulary, methods);
    let source = Source { lines: Some(&lines), file, keys: &vocabulary.keys, methods };
    for (name, value) in table.get_ref() {
        source.top(&mut values, name, value);
    }
    let version = values.errors.named().iter().find(|error| error.reason == Reason::Format);
    if let Some(error) = version.cloned() {
        // Another version has other keys: what else seems wrong may not be.
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
        .error(Reason::Type, format!("`{}` is the text \"{}\"", METHOD.path(), quoted(name)))
        .expecting(format!("kind = {}", names.join(" or ")));
    match nearest(name, methods.iter().map(|method| method.keys.method)) {
        Some(nearest) => error.advising(format!("did you mean \"{nearest}\"?")).into(),
        None => error.into(),
    }
}

/// Takes an override in.
fn override_with(values: &mut Values, text: &str, methods: &[&'static Vocabulary]) {
    let file = format!("--set {text}");
    let spot = Spot { file: file.clone(), place: None };
    let Some((path, value)) = text.split_once('=') else {
        let error = spot.error(Reason::Override, "an override needs a key and a value");
        return values.errors.push(error.expecting("section.key=value"));
    };
    let (path, value) = (path.trim(), as_typed(value.trim()));
    let source = Source { lines: None, file: &file, keys: &values.vocabulary.keys, methods };
    match path.split_once('.') {
        Some((section, key)) => match SECTIONS.iter().find(|(name, _)| *name == section) {
            Some((name, _)) => source.key(values, name, &Spanned::new(0..0, key.into()), &value),
            None => source.unknown_section(values, &Spanned::new(0..0, section.into())),
        },
        None => source.top(values, &Spanned::new(0..0, path.into()), &value),
    }
}

/// Takes an override of a known key in, with the checks and the words of one that is typed.
pub(super) fn set(values: &mut Values, key: &Key, value: &Value) {
    let text = typed(value);
    let file = format!("--set {}={text}", key.path());
    let methods = values.methods.clone();
    let source = Source { lines: None, file: &file, keys: &values.vocabulary.keys, methods: &methods };
    let name = Spanned::new(0..0, key.name.into());
    source.key(values, key.section, &name, &as_typed(&text));
}

/// A text that values come from: the file, or an option of the command line.
struct Source<'s> {
    lines: Option<&'s Lines<'s>>,
    file: &'s str,
    keys: &'static KeySet,
    methods: &'s [&'static Vocabulary],
}

impl Source<'_> {
    fn spot(&self, offset: usize) -> Spot {
        match self.lines {
            Some(lines) => lines.spot(offset),
            None => Spot { file: self.file.to_owned(), place: None },
        }
    }

    /// A key or section at the top of the file.
    fn top(
        &self,
        values: &mut Values,
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
                let error = spot.error(Reason::Type, format!("`{section}` is no table"));
                values.errors.push(error.expecting(format!("[{section}], and keys in the lines below it")));
            }
        }
    }

    fn unknown_section(&self, values: &mut Values, name: &Spanned<std::borrow::Cow<'_, str>>) {
        if !values.errors.has_room() {
            return values.errors.count();
        }
        let names = SECTIONS.map(|(name, _)| name);
        let mut error = self
            .spot(name.span().start)
            .error(Reason::Unknown, format!("unknown section [{}]", quoted(name.get_ref())))
            .expecting(names.map(|name| format!("[{name}]")).join(" "));
        if let Some(nearest) = nearest(name.get_ref(), names) {
            error = error.advising(format!("did you mean [{nearest}]?"));
            // What is missing is not missing, only under another name.
            values.faulty.extend(self.keys.section(nearest).map(Key::id));
        }
        values.errors.push(error);
    }

    fn key(
        &self,
        values: &mut Values,
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
                let places =
                    |lines: &Lines<'_>| elements.map(|item| lines.place(item.span().start)).collect();
                let entry = Entry {
                    value: read,
                    spot: self.spot(name.span().start),
                    items: self.lines.map(places).unwrap_or_default(),
                    overrides: self.lines.is_none(),
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
        values: &mut Values,
        section: &'static str,
        name: &Spanned<std::borrow::Cow<'_, str>>,
    ) {
        if !values.errors.has_room() {
            return values.errors.count();
        }
        let place =
            if section.is_empty() { "at the top of the file".to_owned() } else { format!("in [{section}]") };
        let place =
            if section.is_empty() && self.lines.is_none() { "without a section".to_owned() } else { place };
        let mut error = self
            .spot(name.span().start)
            .error(Reason::Unknown, format!("unknown key `{}` {place}", quoted(name.get_ref())));
        let unknown = Unknown {
            keys: self.keys,
            methods: self.methods,
            section,
            name: name.get_ref(),
            overrides: self.lines.is_none(),
        };
        error = match unknown.help() {
            Help::Advice(advice, meant) => {
                // What is missing is not missing, only under another name.
                values.faulty.extend(meant.iter().map(|key| key.id()));
                error.advising(advice)
            }
            Help::Expected(keys) => error.expecting(keys),
        };
        values.errors.push(error);
    }

    fn fault(&self, key: &Key, fault: &Fault) -> SceneError {
        let format = key.id() == FORMAT.id() && fault.reason == Reason::Range;
        let (reason, message) = match fault.reason {
            Reason::Range if format => {
                (Reason::Format, format!("this program does not read the format that {} names", fault.found))
            }
            Reason::Range => (Reason::Range, format!("`{}` cannot be {}", key.path(), fault.found)),
            other => (other, format!("`{}` is {}", key.path(), fault.found)),
        };
        let error = self.spot(fault.span.start).error(reason, message).expecting(key.expected());
        match fault.nearest {
            Some(nearest) => error.advising(format!("did you mean \"{nearest}\"?")),
            None => error,
        }
    }
}
