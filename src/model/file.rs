//! Reads the TOML files of machines and hosts, and reports mistakes with their line and column.
//!
//! serde reads the grammar of a file and stops at its first mistake; a rule for single entries then reports each value that
//! cannot be.

use serde::de::DeserializeOwned;
use std::io::ErrorKind;
use std::path::Path;
use stripmine_physics::io::regular_file;
use stripmine_physics::number::counted;
use stripmine_physics::quoted::{message, one_line, quoted};
use stripmine_physics::reported::{Class, FilePlace, Reported};
use toml::de::{DeTable, DeValue};

/// Longest file (bytes).
const LONGEST: u64 = 4 << 20;
/// Mistakes that a message lists at most.
const LISTED: usize = 20;

/// Why the file of a machine or a host cannot be used, with the place of its first mistake.
#[derive(Debug, thiserror::Error)]
#[error("{message}")]
pub struct ModelFileError {
    class: Class,
    place: FilePlace,
    message: String,
}

impl Reported for ModelFileError {
    fn class(&self) -> Class {
        self.class
    }

    fn place(&self) -> Option<FilePlace> {
        Some(self.place.clone())
    }
}

/// A kind of file.
pub(super) struct Kind {
    /// Its name in messages.
    pub(super) name: &'static str,
    /// The version that this program reads.
    pub(super) format: u32,
    /// Words after the number of another version: what to do.
    pub(super) remedy: &'static str,
}

/// A value of a file.
pub(super) struct Entry<'t> {
    /// Names of the tables around it, and its own.
    pub(super) names: Vec<&'t str>,
    pub(super) value: &'t DeValue<'t>,
    /// Bytes at which messages say that it is, and at which its value begins.
    at: [usize; 2],
}

impl Entry<'_> {
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
}

/// A value and all that is in it, which have these names and places.
fn entries<'t>(names: Vec<&'t str>, at: [usize; 2], value: &'t DeValue<'t>) -> Vec<Entry<'t>> {
    let mut all = vec![Entry { names: names.clone(), value, at }];
    match value {
        DeValue::Table(table) => all.extend(table.iter().flat_map(|(name, value)| {
            let starts = value.span().start;
            // A table's own span may be that of its last header: its name says where it begins.
            let at = if value.get_ref().is_table() { name.span().start } else { starts };
            entries([&names[..], &[name.get_ref()]].concat(), [at, starts], value.get_ref())
        })),
        DeValue::Array(items) => {
            all.extend(items.iter().flat_map(|it| entries(names.clone(), [it.span().start; 2], it.get_ref())))
        }
        _ => {}
    }
    all
}

/// A text in TOML, and its name in messages.
#[derive(Clone, Copy)]
pub(super) struct Source<'t> {
    pub(super) kind: &'static Kind,
    pub(super) file: &'t str,
    pub(super) text: &'t str,
}

impl Source<'_> {
    /// Reads the document. `wrong` says what is wrong with a single entry; `completed` completes a document whose entries are
    /// right, or returns the path of an entry that disagrees with others, and why.
    ///
    /// # Errors
    /// [`ModelFileError`]: not TOML, another version, or the grammar's first mistake with all wrong values.
    pub(super) fn read<T: DeserializeOwned>(
        self,
        wrong: impl Fn(&Entry<'_>) -> Option<String>,
        completed: impl FnOnce(T) -> Result<T, (String, String)>,
    ) -> Result<T, ModelFileError> {
        let document = DeTable::parse(self.text).map_err(|cause| {
            let place = cause.span().map_or([None; 2], |span| self.place(span.start).map(Some));
            self.error(Class::Input, place, format!("{}: {}", self.name(), message(&cause.to_string())))
        })?;
        let root = DeValue::Table(document.into_inner());
        let entries = entries(vec![], [0; 2], &root);
        let format = entries.iter().find(|it| it.names == ["format"]);
        let format = format.and_then(|it| Some((it.at[0], it.number()?)));
        // A file of another version has other entries: its version is the mistake.
        if let Some((at, found)) = format.filter(|&(_, found)| found != f64::from(self.kind.format)) {
            let Kind { format, remedy, .. } = self.kind;
            let what = format!("`format` is {found}, but this program reads {format}{remedy}");
            return Err(self.mistakes(vec![(at, what)]));
        }
        let mut mistakes: Vec<(usize, String)> =
            entries.iter().filter_map(|it| Some((it.at[0], wrong(it)?))).collect();
        match toml::from_str(self.text) {
            Ok(read) if mistakes.is_empty() => match completed(read) {
                Ok(completed) => return Ok(completed),
                Err((path, what)) => {
                    let entry = entries.iter().find(|it| it.path() == path);
                    mistakes.push((entry.map_or(0, |it| it.at[0]), what));
                }
            },
            Ok(_) => {}
            Err(cause) => {
                let at = cause.span().map_or(0, |span| span.start);
                let entry = entries.iter().find(|it| it.at[1] == at && !it.names.is_empty());
                let path = entry.map(|it| format!("`{}`: ", it.path())).unwrap_or_default();
                mistakes.push((at, path + cause.message()));
            }
        }
        Err(self.mistakes(mistakes))
    }

    /// Reports mistakes by the byte at which they are.
    fn mistakes(self, mut found: Vec<(usize, String)>) -> ModelFileError {
        found.sort_by_key(|(at, _)| *at);
        let lines = found.iter().take(LISTED).map(|(at, what)| {
            let [line, column] = self.place(*at);
            format!("{}, line {line}, column {column}: {}", self.name(), one_line(what))
        });
        let more = found.len().saturating_sub(LISTED);
        let more = (more > 0)
            .then(|| format!("{}: {}", self.name(), counted(more, "more mistake", "more mistakes")));
        let message = lines.chain(more).collect::<Vec<_>>().join("\n");
        let first = found.first().map_or([None; 2], |(at, _)| self.place(*at).map(Some));
        self.error(Class::Input, first, message)
    }

    fn name(self) -> String {
        format!("{} `{}`", self.kind.name, quoted(self.file))
    }

    fn error(self, class: Class, [line, column]: [Option<usize>; 2], message: String) -> ModelFileError {
        ModelFileError { class, place: FilePlace { file: self.file.to_owned(), line, column }, message }
    }

    /// The line and the column of a byte, from 1.
    fn place(self, at: usize) -> [usize; 2] {
        let before = self.text.get(..at).unwrap_or_default();
        let column = before.rsplit('\n').next().map_or(0, |line| line.chars().count()) + 1;
        [before.matches('\n').count() + 1, column]
    }
}

/// Reads a file as text.
///
/// # Errors
/// [`ModelFileError`]: the system does not let it be read, or it is not UTF-8.
pub(super) fn text(kind: &'static Kind, path: &Path) -> Result<String, ModelFileError> {
    let file = path.display().to_string();
    let source = Source { kind, file: &file, text: "" };
    let bytes = regular_file::read(path, LONGEST).map_err(|cause| {
        let is_input = cause.kind() == ErrorKind::InvalidData;
        let class = if is_input { Class::Input } else { Class::InputOutput };
        source.error(class, [None; 2], format!("{}: {cause}", source.name()))
    })?;
    String::from_utf8(bytes).map_err(|cause| {
        let line = regular_file::line_that_is_not_text(cause.as_bytes()).unwrap_or(1);
        let what = format!("{}, line {line}: not UTF-8 text; expected a TOML file in UTF-8", source.name());
        source.error(Class::Input, [Some(line), None], what)
    })
}
