//! Reads the TOML files of machines and hosts, and reports every mistake with its line and column.

use std::cell::RefCell;
use std::io::ErrorKind;
use std::path::Path;
use stripmine_physics::io::regular_file;
use stripmine_physics::number::counted;
use stripmine_physics::quoted::{message, one_line, quoted};
use stripmine_physics::reported::{Class, FilePlace, Reported};
use stripmine_physics::words::nearest;
use toml::Spanned;
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

/// Reads a file as text; `kind` is what messages call it.
///
/// # Errors
/// [`ModelFileError`]: the system does not let it be read, or it is not UTF-8.
pub(super) fn read(kind: &'static str, path: &Path) -> Result<String, ModelFileError> {
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

/// A text in TOML, and what messages call it.
#[derive(Clone, Copy)]
pub(super) struct Source<'t> {
    pub(super) kind: &'static str,
    pub(super) file: &'t str,
    pub(super) text: &'t str,
}

impl Source<'_> {
    /// Returns what `build` makes of the document, unless a mistake is noted.
    ///
    /// # Errors
    /// [`ModelFileError`]: not TOML, or all mistakes that are noted.
    pub(super) fn read<T>(self, build: impl FnOnce(&Table<'_>) -> Option<T>) -> Result<T, ModelFileError> {
        let document = DeTable::parse(self.text).map_err(|cause| self.syntax(&cause))?;
        let (root, mistakes) = (DeValue::Table(document.into_inner()), Mistakes::default());
        let built = Entry { value: &root, at: 0, path: String::new(), mistakes: &mistakes }.table(build);
        let mut found = mistakes.take();
        match built {
            Some(built) if found.is_empty() => return Ok(built),
            _ => found.sort_by_key(|(at, _)| *at),
        }
        let lines = found.iter().take(LISTED).map(|(at, what)| {
            let [line, column] = self.place(*at);
            format!("{}, line {line}, column {column}: {}", self.name(), one_line(what))
        });
        let more = found.len().saturating_sub(LISTED);
        let more = (more > 0)
            .then(|| format!("{}: {}", self.name(), counted(more, "more mistake", "more mistakes")));
        let message = lines.chain(more).collect::<Vec<_>>().join("\n");
        let first = found.first().map_or([None; 2], |(at, _)| self.place(*at).map(Some));
        Err(self.error(Class::Input, first, message))
    }

    /// Reports what the reader of TOML found.
    pub(super) fn syntax(self, cause: &toml::de::Error) -> ModelFileError {
        let place = cause.span().map_or([None; 2], |span| self.place(span.start).map(Some));
        self.error(Class::Input, place, format!("{}: {}", self.name(), message(&cause.to_string())))
    }

    fn name(self) -> String {
        format!("{} `{}`", self.kind, quoted(self.file))
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

/// Mistakes by the byte at which they are.
type Mistakes = RefCell<Vec<(usize, String)>>;

/// A value of a file.
#[derive(Clone)]
pub(super) struct Entry<'t> {
    pub(super) value: &'t DeValue<'t>,
    at: usize,
    /// Names of the tables around it and its own, joined by dots.
    pub(super) path: String,
    mistakes: &'t Mistakes,
}

impl<'t> Entry<'t> {
    /// Notes a mistake of this entry, which then has no value.
    pub(super) fn wrong<T>(&self, what: impl Into<String>) -> Option<T> {
        self.mistakes.borrow_mut().push((self.at, what.into()));
        None
    }

    fn must_be<T>(&self, expected: &str) -> Option<T> {
        self.wrong(format!("`{}` must be {expected}", self.path))
    }

    /// Reads a table. Names that `read` does not ask for are mistakes.
    pub(super) fn table<T>(&self, read: impl FnOnce(&Table<'t>) -> Option<T>) -> Option<T> {
        let DeValue::Table(entries) = self.value else { return self.must_be("a table") };
        let table = Table { own: self.clone(), entries, known: RefCell::default() };
        let found = read(&table);
        let known = table.known.borrow();
        for (name, entry) in table.entries().filter(|(name, _)| !known.contains(name)) {
            let meant = nearest(name, known.iter().copied()).map(|near| format!(", did you mean `{near}`?"));
            let help = meant.unwrap_or_else(|| format!("; known are {}", known.join(", ")));
            _ = entry.wrong::<()>(format!("unknown field `{name}`{help}"));
        }
        found
    }

    pub(super) fn list(&self, of: &str) -> Option<Vec<Entry<'t>>> {
        let DeValue::Array(items) = self.value else { return self.must_be(&format!("a list of {of}")) };
        let item = |item: &'t Spanned<DeValue<'t>>| Entry {
            value: item.get_ref(),
            at: item.span().start,
            ..self.clone()
        };
        Some(items.iter().map(item).collect())
    }

    pub(super) fn words(&self) -> Option<String> {
        let DeValue::String(words) = self.value else { return self.must_be("words in quotes") };
        Some(words.as_ref().to_owned())
    }

    pub(super) fn truth(&self) -> Option<bool> {
        let DeValue::Boolean(truth) = self.value else { return self.must_be("`true` or `false`") };
        Some(*truth)
    }

    pub(super) fn number(&self) -> Option<f64> {
        let number = match self.value {
            DeValue::Integer(it) => i128::from_str_radix(it.as_str(), it.radix()).ok().map(|it| it as f64),
            DeValue::Float(it) => it.as_str().parse().ok(),
            _ => None,
        };
        number.or_else(|| self.must_be("a number"))
    }

    pub(super) fn whole(&self) -> Option<u64> {
        let DeValue::Integer(it) = self.value else { return self.must_be("a whole number, not negative") };
        let whole = u64::from_str_radix(it.as_str(), it.radix()).ok();
        whole.or_else(|| self.must_be("a whole number, not negative"))
    }
}

/// A table of a file.
pub(super) struct Table<'t> {
    own: Entry<'t>,
    entries: &'t DeTable<'t>,
    known: RefCell<Vec<&'t str>>,
}

impl<'t> Table<'t> {
    fn entries(&self) -> impl Iterator<Item = (&'t str, Entry<'t>)> {
        self.entries.iter().map(|(name, value)| {
            let path = format!("{}.{}", self.own.path, name.get_ref()).trim_start_matches('.').to_owned();
            // A table's own span may be that of its last header: its name says where it begins.
            let span = if value.get_ref().is_table() { name.span() } else { value.span() };
            let entry = Entry { value: value.get_ref(), at: span.start, path, ..self.own.clone() };
            (name.get_ref().as_ref(), entry)
        })
    }

    /// Reads the entry of a name if there is one: `None` is a mistake, `Some(None)` an entry that is left out.
    pub(super) fn may<T>(
        &self,
        name: &'static str,
        read: impl FnOnce(&Entry<'t>) -> Option<T>,
    ) -> Option<Option<T>> {
        self.known.borrow_mut().push(name);
        let found = self.entries().find(|(known, _)| *known == name);
        found.map_or(Some(None), |(_, entry)| read(&entry).map(Some))
    }

    /// Reads the entry of a name, which must be there.
    pub(super) fn need<T>(
        &self,
        name: &'static str,
        read: impl FnOnce(&Entry<'t>) -> Option<T>,
    ) -> Option<T> {
        self.may(name, read)?.or_else(|| self.own.wrong(format!("missing field `{name}`")))
    }

    /// Reads every entry that was not asked for before, with its name.
    pub(super) fn others<T, C: FromIterator<T>>(
        &self,
        read: impl Fn(&'t str, &Entry<'t>) -> Option<T>,
    ) -> Option<C> {
        let asked = self.known.take();
        let others = self.entries().filter(|(name, _)| !asked.contains(name));
        let all: Vec<Option<T>> = others.map(|(name, entry)| read(name, &entry)).collect();
        *self.known.borrow_mut() = self.entries().map(|(name, _)| name).collect();
        // Each was read, for each may be wrong.
        all.into_iter().collect()
    }

    /// Notes a mistake that only the whole file shows, at an entry named by its path.
    pub(super) fn wrong_at<T>(&self, path: &str, what: impl Into<String>) -> Option<T> {
        let (name, rest) = path.split_once('.').unwrap_or((path, ""));
        let Some((_, entry)) = self.entries().find(|(known, _)| *known == name) else {
            return self.own.wrong(what);
        };
        match entry.value {
            DeValue::Table(entries) if !rest.is_empty() => {
                Table { own: entry.clone(), entries, known: RefCell::default() }.wrong_at(rest, what)
            }
            _ => entry.wrong(what),
        }
    }
}
