//! Reader of the TOML files of machines and hosts.
//!
//! The type of a file is its grammar; a rule of the file checks single values. All mistakes are found at once: serde
//! stops at the first one, which is removed before it reads again.

use serde::de::DeserializeOwned;
use std::ops::Range;
use std::path::Path;
use stripmine_physics::input::{
    InputError, InputErrors, InputText, MistakeKind, MistakeList, Spot, read_text,
};
use stripmine_physics::quoted::one_line;
use stripmine_physics::words::nearest;
use toml::Spanned;
use toml::de::{DeTable, DeValue, Deserializer};

/// Largest size of a file (bytes).
const LONGEST: u64 = 4 << 20;
/// Range of a whole file.
const WHOLE: Range<usize> = 0..usize::MAX;

/// A kind of file, which is read into a `T`.
pub(super) struct FileKind<T> {
    /// Format version that this program reads.
    pub(super) format: u32,
    /// Advice for other versions.
    pub(super) remedy: Option<&'static str>,
    /// Describes an error of a single value, if any.
    pub(super) wrong: fn(&FileEntry<'_>) -> Option<String>,
    /// Completes the file, or returns the path of an entry that contradicts others, and why.
    pub(super) completed: fn(T) -> Result<T, (String, String)>,
}

/// A value of a file.
pub(super) struct FileEntry<'t> {
    /// Names of the tables around it, and its own.
    pub(super) names: Vec<&'t str>,
    pub(super) value: &'t DeValue<'t>,
    /// Byte ranges of its name and of its value. For a table they may be those of its last heading.
    spans: [Range<usize>; 2],
}

impl FileEntry<'_> {
    /// Its names, joined by dots.
    pub(super) fn path(&self) -> String {
        self.names.join(".")
    }

    pub(super) fn number(&self) -> Option<f64> {
        match self.value {
            DeValue::Integer(it) => i128::from_str_radix(it.as_str(), it.radix()).ok().map(|it| it as f64),
            DeValue::Float(it) => it.as_str().parse().ok(),
            _ => None,
        }
    }

    /// Byte offset for messages.
    fn at(&self) -> usize {
        self.spans[usize::from(!self.value.is_table())].start
    }
}

/// Lists a value and everything in it, with names and byte ranges.
fn entries<'t>(names: Vec<&'t str>, spans: [Range<usize>; 2], value: &'t DeValue<'t>) -> Vec<FileEntry<'t>> {
    let mut all = vec![FileEntry { names: names.clone(), value, spans }];
    match value {
        DeValue::Table(table) => all.extend(table.iter().flat_map(|(name, value)| {
            let spans = [name.span(), value.span()];
            entries([&names[..], &[name.get_ref()]].concat(), spans, value.get_ref())
        })),
        DeValue::Array(items) => all
            .extend(items.iter().flat_map(|it| entries(names.clone(), [it.span(), it.span()], it.get_ref()))),
        _ => {}
    }
    all
}

/// Removes an entry from a table; returns true if it existed.
fn remove(table: &mut DeTable<'_>, names: &[&str]) -> bool {
    match names {
        [] => false,
        [name] => table.remove(*name).is_some(),
        [name, rest @ ..] => match table.get_mut(*name).map(Spanned::get_mut) {
            Some(DeValue::Table(table)) => remove(table, rest),
            _ => false,
        },
    }
}

impl<T: DeserializeOwned> FileKind<T> {
    /// Reads a file.
    ///
    /// # Errors
    /// [`InputErrors`]: the file cannot be read, it is not UTF-8, or as for [`FileKind::read`].
    pub(super) fn load(&self, path: &Path) -> Result<T, InputErrors> {
        let file = path.display().to_string();
        let nowhere = Spot { file: file.clone(), place: None };
        let text = read_text(path, LONGEST, |cause| nowhere.error(MistakeKind::System, cause.to_string()))?;
        self.read(&file, &text)
    }

    /// Reads a file's text; `file` is its name in errors.
    ///
    /// # Errors
    /// [`InputErrors`]: not TOML, another version, all mistakes of single entries, or a contradiction between valid ones.
    pub(super) fn read(&self, file: &str, text: &str) -> Result<T, InputErrors> {
        let text = InputText::new(file, text);
        let table = text.table()?;
        let root = DeValue::Table(table.clone());
        let entries = entries(vec![], [0..0, WHOLE], &root);
        let format = entries.iter().find(|it| it.names == ["format"]);
        // A file of another version has other entries, so only its version is reported.
        if let Some((it, found)) = format.and_then(|it| Some((it, it.number()?)))
            && found != f64::from(self.format)
        {
            let what = format!("`format` is {found}, but this program reads {}", self.format);
            let error = text.spot(it.at()).error(MistakeKind::Format, what);
            return Err(self.remedy.map_or(error.clone(), |remedy| error.advising(remedy)).into());
        }
        let mut mistakes = MistakeList::default();
        let wrong = |it: &FileEntry<'_>| {
            Some(text.spot(it.at()).error(MistakeKind::Range, one_line(&(self.wrong)(it)?)))
        };
        mistakes.extend(entries.iter().filter_map(wrong));
        let read = deserialized(&text, table, &entries, &mut mistakes);
        mistakes.ok_without_mistakes(file)?;
        (self.completed)(read?).map_err(|(path, what)| {
            let entry = entries.iter().find(|it| it.path() == path);
            text.spot(entry.map_or(0, FileEntry::at)).error(MistakeKind::Contradiction, what).into()
        })
    }
}

/// Deserialises a table with these entries; adds the errors of serde to the mistakes.
fn deserialized<T: DeserializeOwned>(
    text: &InputText<'_>,
    mut table: DeTable<'_>,
    entries: &[FileEntry<'_>],
    mistakes: &mut MistakeList,
) -> Result<T, InputError> {
    // Entries missing because they were wrong or misspelt are not reported again.
    let mut gone: Vec<String> = vec![];
    loop {
        let cause = match T::deserialize(Deserializer::from(Spanned::new(WHOLE, table.clone()))) {
            Ok(read) => return Ok(read),
            Err(cause) => cause,
        };
        let span = cause.span().unwrap_or(WHOLE);
        // The innermost of several entries with the same range comes last.
        let entry = entries.iter().rev().find(|it| it.spans.contains(&span));
        let names = entry.map_or(&[][..], |it| &it.names[..]);
        let path = names.join(".");
        let is_of_value = entry.is_some_and(|it| it.spans[1] == span) && !names.is_empty();
        let prefix = if is_of_value { format!("`{path}`: ") } else { String::new() };
        let spot = text.spot(if names.is_empty() { 0 } else { span.start });
        let mut error = spot.error(MistakeKind::Type, one_line(&(prefix + cause.message())));
        let words: Vec<&str> = cause.message().split('`').collect();
        let is_known = match words[..] {
            ["missing field ", name, ..] => gone.contains(&below(&path, name)),
            ["unknown field " | "unknown variant ", name, _, ref known @ ..] => {
                if let Some(near) = nearest(name, known.iter().step_by(2).copied()) {
                    gone.extend(names.split_last().map(|(_, above)| below(&above.join("."), near)));
                    error = error.advising(format!("did you mean `{near}`?"));
                }
                false
            }
            _ => false,
        };
        if !is_known {
            mistakes.push(error.clone());
        }
        if !mistakes.has_room() || !remove(&mut table, names) {
            return Err(error);
        }
        gone.push(path);
    }
}

/// Path of an entry of a table.
fn below(path: &str, name: &str) -> String {
    if path.is_empty() { name.to_owned() } else { format!("{path}.{name}") }
}
