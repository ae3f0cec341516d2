//! From the text of a scene to values that are each right for themselves.

use super::error::{Mistakes, Place, Reason, SceneError, SceneErrors, Spot};
use super::key_table::{FORMAT, KEYS, SECTIONS};
use super::keys::{Fault, Key, Selector, Value, nearest};
use crate::quoted::quoted;
use std::collections::{BTreeMap, BTreeSet};
use toml::Spanned;
use toml::de::{DeTable, DeValue};

type Id = (&'static str, &'static str);

/// A value with where it comes from.
#[derive(Clone, Debug)]
pub(super) struct Entry {
    pub(super) value: Value,
    pub(super) spot: Spot,
    /// Where the items of a list stand; nothing where they come from an override.
    pub(super) items: Vec<Place>,
    pub(super) overrides: bool,
}

/// The values of a scene as they were given.
#[derive(Clone, Debug)]
pub(super) struct Entries {
    pub(super) file: String,
    pub(super) values: BTreeMap<Id, Entry>,
    sections: BTreeMap<&'static str, Place>,
    /// Keys that were given, but not well.
    pub(super) faulty: BTreeSet<Id>,
    pub(super) errors: Mistakes,
}

impl Entries {
    /// Where to look for a key: where it stands, or its section, or the file.
    pub(super) fn spot(&self, key: &Key) -> Spot {
        match self.values.get(&key.id()) {
            Some(entry) => entry.spot.clone(),
            None => Spot { file: self.file.clone(), place: self.sections.get(key.section).copied() },
        }
    }

    pub(super) fn given(&self, key: &Key) -> Option<&Entry> {
        self.values.get(&key.id())
    }

    pub(super) fn is_faulty(&self, key: &Key) -> bool {
        self.faulty.contains(&key.id())
    }
}

/// Where lines begin.
struct Lines<'t> {
    file: &'t str,
    text: &'t [u8],
    starts: Vec<usize>,
    /// Characters before every [`Lines::BLOCK`]th byte.
    before: Vec<usize>,
}

impl<'t> Lines<'t> {
    /// So far a place is counted from, however long its line.
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

/// Reads the text of a scene and then the overrides, each `section.key=value`.
pub(super) fn read(file: &str, text: &str, overrides: &[String]) -> Result<Entries, SceneErrors> {
    let lines = Lines::new(file, text);
    let (table, syntax) = DeTable::parse_recoverable(text);
    let mut entries = Entries {
        file: file.to_owned(),
        values: BTreeMap::new(),
        sections: BTreeMap::new(),
        faulty: BTreeSet::new(),
        errors: Mistakes::default(),
    };
    if !syntax.is_empty() {
        // One mistake often makes several messages; what a broken text says besides is not to be trusted.
        let mut known = BTreeSet::new();
        for error in syntax {
            let place = error.span().map(|span| lines.place(span.start));
            if known.insert(place.map(|place| place.line)) {
                let spot = Spot { file: file.to_owned(), place };
                entries.errors.push(spot.error(Reason::Syntax, format!("not TOML: {}", error.message())));
            }
        }
        entries.errors.none_of(file)?;
        return Err(Spot { file: file.to_owned(), place: None }.error(Reason::Syntax, "not TOML").into());
    }
    let source = Source { lines: Some(&lines), file };
    for (name, value) in table.get_ref() {
        source.top(&mut entries, name, value);
    }
    let version = entries.errors.named().iter().find(|error| error.reason == Reason::Format);
    if let Some(error) = version.cloned() {
        // Another version has other keys: what else seems wrong may not be.
        return Err(error.into());
    }
    for text in overrides {
        override_with(&mut entries, text);
    }
    Ok(entries)
}

/// Takes an override in.
fn override_with(entries: &mut Entries, text: &str) {
    let file = format!("--set {text}");
    let spot = Spot { file: file.clone(), place: None };
    let Some((path, value)) = text.split_once('=') else {
        let error = spot.error(Reason::Override, "an override needs a key and a value");
        return entries.errors.push(error.expecting("section.key=value"));
    };
    let (path, value) = (path.trim(), value.trim());
    let value = match DeValue::parse(value) {
        Ok(value) => Spanned::new(0..0, value.into_inner()),
        // A word needs no quotes on a command line.
        Err(_) => Spanned::new(0..0, DeValue::String(value.into())),
    };
    let source = Source { lines: None, file: &file };
    match path.split_once('.') {
        Some((section, key)) => match SECTIONS.iter().find(|(name, _)| *name == section) {
            Some((name, _)) => source.key(entries, name, &Spanned::new(0..0, key.into()), &value),
            None => source.unknown_section(entries, &Spanned::new(0..0, section.into())),
        },
        None => source.top(entries, &Spanned::new(0..0, path.into()), &value),
    }
}

/// A text that values come from: the file, or an option of the command line.
struct Source<'s> {
    lines: Option<&'s Lines<'s>>,
    file: &'s str,
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
        entries: &mut Entries,
        name: &Spanned<std::borrow::Cow<'_, str>>,
        value: &Spanned<DeValue<'_>>,
    ) {
        let Some((section, _)) = SECTIONS.iter().find(|(section, _)| *section == name.get_ref()) else {
            let is_table = value.get_ref().as_table().is_some();
            let known = KEYS.iter().any(|key| key.section.is_empty() && key.name == name.get_ref());
            return match is_table && !known {
                true => self.unknown_section(entries, name),
                false => self.key(entries, "", name, value),
            };
        };
        let place = self.spot(name.span().start).place;
        if let Some(place) = place {
            entries.sections.insert(section, place);
        }
        match value.get_ref().as_table() {
            Some(table) => {
                for (name, value) in table {
                    self.key(entries, section, name, value);
                }
            }
            None => {
                entries.faulty.extend(KEYS.iter().filter(|key| key.section == *section).map(|key| key.id()));
                let spot = Spot { file: self.file.to_owned(), place };
                let error = spot.error(Reason::Type, format!("`{section}` is no table"));
                entries.errors.push(error.expecting(format!("[{section}], and keys in the lines below it")));
            }
        }
    }

    fn unknown_section(&self, entries: &mut Entries, name: &Spanned<std::borrow::Cow<'_, str>>) {
        if !entries.errors.has_room() {
            return entries.errors.count();
        }
        let names = SECTIONS.map(|(name, _)| name);
        let mut error = self
            .spot(name.span().start)
            .error(Reason::Unknown, format!("unknown section [{}]", quoted(name.get_ref())))
            .expecting(names.map(|name| format!("[{name}]")).join(" "));
        if let Some(nearest) = nearest(name.get_ref(), names) {
            error = error.advising(format!("did you mean [{nearest}]?"));
            // What is missing is not missing, only under another name.
            entries.faulty.extend(KEYS.iter().filter(|key| key.section == nearest).map(|key| key.id()));
        }
        entries.errors.push(error);
    }

    fn key(
        &self,
        entries: &mut Entries,
        section: &'static str,
        name: &Spanned<std::borrow::Cow<'_, str>>,
        value: &Spanned<DeValue<'_>>,
    ) {
        let known = KEYS.iter().find(|key| key.section == section && key.name == name.get_ref());
        let Some(key) = known else { return self.unknown_key(entries, section, name) };
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
                entries.faulty.remove(&key.id());
                entries.values.insert(key.id(), entry);
            }
            Err(faults) => {
                entries.faulty.insert(key.id());
                entries.errors.extend(faults.iter().map(|fault| self.fault(key, fault)));
            }
        }
    }

    fn unknown_key(
        &self,
        entries: &mut Entries,
        section: &'static str,
        name: &Spanned<std::borrow::Cow<'_, str>>,
    ) {
        if !entries.errors.has_room() {
            return entries.errors.count();
        }
        let in_section = || KEYS.iter().filter(|key| key.section == section).map(|key| key.name);
        let place =
            if section.is_empty() { "at the top of the file".to_owned() } else { format!("in [{section}]") };
        let mut error = self
            .spot(name.span().start)
            .error(Reason::Unknown, format!("unknown key `{}` {place}", quoted(name.get_ref())));
        let elsewhere = KEYS.iter().find(|key| key.name == name.get_ref());
        if let Some(key) = elsewhere {
            let home = if key.section.is_empty() {
                "at the top of the file".into()
            } else {
                format!("in [{}]", key.section)
            };
            error = error.advising(format!("`{}` belongs {home}", key.name));
            entries.faulty.insert(key.id());
        } else if let Some(nearest) = nearest(name.get_ref(), in_section()) {
            error = error.advising(format!("did you mean `{nearest}`?"));
            entries.faulty.insert((section, nearest));
        } else {
            error = error.expecting(in_section().collect::<Vec<_>>().join(", "));
        }
        entries.errors.push(error);
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

impl Selector {
    /// The choice that a scene makes; nothing where it makes none.
    pub(super) fn choice(self, entries: &Entries) -> Option<String> {
        use super::key_table::{FILE, GENERATE, INTEGRATOR, METHOD, WALL_MOTION};
        let key = match self {
            Selector::Start if entries.given(&FILE).is_some() => return Some("file".to_owned()),
            Selector::Start if entries.is_faulty(&FILE) => return None,
            Selector::Start => &GENERATE,
            Selector::Method => &METHOD,
            Selector::WallMotion => &WALL_MOTION,
            Selector::Integrator => &INTEGRATOR,
        };
        if entries.is_faulty(key) {
            return None;
        }
        match (entries.given(key).map(|entry| &entry.value), key.fallback) {
            (Some(Value::Word(word)), _) => Some(word.clone()),
            (None, super::keys::Fallback::Is(text)) => Some(text.trim_matches('"').to_owned()),
            _ => None,
        }
    }

    /// Whether an override made the choice.
    pub(super) fn is_overridden(self, entries: &Entries) -> bool {
        use super::key_table::{FILE, GENERATE, INTEGRATOR, METHOD, WALL_MOTION};
        let keys: &[&Key] = match self {
            Selector::Start => &[&FILE, &GENERATE],
            Selector::Method => &[&METHOD],
            Selector::WallMotion => &[&WALL_MOTION],
            Selector::Integrator => &[&INTEGRATOR],
        };
        keys.iter().filter_map(|key| entries.given(key)).any(|entry| entry.overrides)
    }
}
