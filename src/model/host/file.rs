//! Host files: what `calibrate` writes, as TOML.

use super::model::HostModel;
use crate::model::machine_file::{LONGEST, Position};
use std::path::Path;
use stripmine_kernels::InstructionSet;
use stripmine_physics::io::{FileError, regular_file};
use stripmine_physics::quoted::{message, one_line, quoted};
use stripmine_physics::reported::{Class, FilePlace, Reported};

/// The version of the file format that this program reads.
pub const FORMAT: u32 = 14;

/// Why a host file cannot be used.
#[derive(Debug, thiserror::Error)]
pub enum HostFileError {
    /// Not TOML, or an entry that is missing, unknown or of the wrong type; the cause shows line and column.
    #[error("host file `{}`: {}", quoted(file), message(&cause.to_string()))]
    Syntax {
        /// Name of the file.
        file: String,
        /// What the TOML reader says, with the place.
        cause: Box<toml::de::Error>,
    },
    /// Bytes that are no text.
    #[error("host file `{}`, line {line}: not UTF-8 text; expected a TOML file in UTF-8", quoted(file))]
    NotText {
        /// Name of the file.
        file: String,
        /// The first line that is not.
        line: usize,
    },
    /// A file that cannot be read.
    #[error(transparent)]
    Read(#[from] FileError),
    /// An entry that cannot be, the first of them.
    #[error("host file `{}`{}: `{}` {}", quoted(file), at(*position), one_line(entry), one_line(what))]
    Content {
        /// Name of the file.
        file: String,
        /// Where.
        position: Option<Position>,
        /// The entry.
        entry: String,
        /// What is wrong.
        what: String,
    },
}

/// Above every number of a host file: with larger ones a sum of all that a step does might not be finite.
const MOST: f64 = 1e15;

fn at(position: Option<Position>) -> String {
    position.map_or(String::new(), |position| format!(", {position}"))
}

impl HostModel {
    /// Reads a host file.
    ///
    /// # Errors
    /// [`HostFileError`]: it cannot be read, or is bad.
    pub fn load(path: &Path) -> Result<HostModel, HostFileError> {
        let file = path.display().to_string();
        let bytes =
            regular_file::read(path, LONGEST).map_err(FileError::at(path, "reading the host file"))?;
        match String::from_utf8(bytes) {
            Ok(text) => HostModel::parse(&file, &text),
            Err(cause) => {
                let line = regular_file::line_that_is_not_text(cause.as_bytes()).unwrap_or(1);
                Err(HostFileError::NotText { file, line })
            }
        }
    }

    /// Reads a host file's text; `file` is the name that errors give it.
    ///
    /// # Errors
    /// [`HostFileError`]: the grammar's first defect, or the first entry that cannot be.
    pub fn parse(file: &str, text: &str) -> Result<HostModel, HostFileError> {
        let syntax = |cause| HostFileError::Syntax { file: file.to_owned(), cause: Box::new(cause) };
        let model: HostModel = toml::from_str(text).map_err(|cause| {
            // A file of another format has entries of other names: its format is the mistake.
            other_format(text).map_or(syntax(cause), |defect| content(file, text, defect))
        })?;
        let mut defects = model.defects();
        // A whole number beyond 2^63 fits into an entry, but into no value of a table.
        let written = text.parse::<toml::Table>().map_err(syntax)?;
        wrong_numbers(&toml::Value::Table(written), String::new(), &mut defects);
        let first = defects.into_iter().next();
        first.map_or(Ok(model), |defect| Err(content(file, text, defect)))
    }

    /// The text of its file.
    pub fn to_toml(&self) -> String {
        // A model is tables of numbers and words, which TOML can always say.
        let mut value = toml::Value::try_from(self).unwrap_or(toml::Value::Boolean(false));
        readable(&mut value);
        HEADING.to_owned() + &toml::to_string(&value).unwrap_or_default()
    }

    /// What cannot be of entries together, and why.
    fn defects(&self) -> Vec<(String, String)> {
        let mut defects = vec![];
        if self.format != FORMAT {
            defects.push(wrong_format(self.format.into()));
        }
        let sets: Vec<&str> = InstructionSet::ALL.iter().map(|set| set.name()).collect();
        if !sets.contains(&&*self.instruction_set) {
            let what = format!("is \"{}\", but must be one of {}", self.instruction_set, sets.join(", "));
            defects.push(("instruction_set".to_owned(), what));
        }
        if self.levels.is_empty() || self.lanes.is_empty() {
            defects.push(("levels".to_owned(), "with `lanes` must not be empty".to_owned()));
        }
        let footprints: Vec<f64> = self.levels.iter().map(|level| level.footprint).collect();
        let discs = self.rates.iter().map(|(name, rates)| (format!("rates.{name}.discs"), &rates.discs));
        for (entry, points) in discs.chain([("levels.footprint".to_owned(), &footprints)]) {
            if points.first().is_some_and(|&first| first <= 0.0)
                || points.windows(2).any(|two| two[0] >= two[1])
            {
                defects.push((entry, "must be positive and rise".to_owned()));
            }
        }
        defects
    }
}

/// What stands above the numbers.
const HEADING: &str = "\
# What a host takes, as `stripmine calibrate` has measured it. Times are in nanoseconds, footprints in bytes. What counts is the middle of
# the samples, under whatever else the machine was doing.
#
# run               a run of a program in addition to its passes, and of a compiled loop
# lanes.*           an operation of an element, interpreted and in a compiled loop: `add` any of them, the others in addition; the start of
#                   a pass of the interpreter; fitted to the programs of the lattice method on drill scenes
# levels            a byte, by how many bytes are gone over before it is met again, fitted to the same programs
# rates             work whose amount depends on the data: a step, disc, cell, candidate, contact, disc whose lists are rebuilt, entry of
#                   these; and how many times as long with each number of discs
";

/// Digits that a number is written with.
const DIGITS: i32 = 4;

/// Numbers with as many digits as a person reads.
fn readable(value: &mut toml::Value) {
    match value {
        toml::Value::Float(number) if number.is_finite() && *number != 0.0 => {
            let places = DIGITS - 1 - number.abs().log10().floor() as i32;
            let text = format!("{number:.*}", places.clamp(0, 12) as usize);
            *number = text.parse().unwrap_or(*number);
        }
        toml::Value::Array(items) => items.iter_mut().for_each(readable),
        toml::Value::Table(table) => table.iter_mut().for_each(|(_, value)| readable(value)),
        _ => {}
    }
}

fn content(file: &str, text: &str, (entry, what): (String, String)) -> HostFileError {
    HostFileError::Content { file: file.to_owned(), position: Position::of(text, &entry), entry, what }
}

fn wrong_format(found: i64) -> (String, String) {
    ("format".to_owned(), format!("is {found}, but this program reads {FORMAT}: calibrate again"))
}

/// The defect of a text that states another format.
fn other_format(text: &str) -> Option<(String, String)> {
    let written = text.parse::<toml::Table>().ok()?;
    let found = written.get("format")?.as_integer()?;
    (found != i64::from(FORMAT)).then(|| wrong_format(found))
}

/// Every number below an entry that cannot be.
fn wrong_numbers(value: &toml::Value, entry: String, found: &mut Vec<(String, String)>) {
    let below = |name: &str| if entry.is_empty() { name.to_owned() } else { format!("{entry}.{name}") };
    let number = match value {
        toml::Value::Float(number) => *number,
        toml::Value::Integer(number) => *number as f64,
        toml::Value::Table(table) => {
            return table.iter().for_each(|(name, value)| wrong_numbers(value, below(name), found));
        }
        toml::Value::Array(items) => {
            return items.iter().for_each(|value| wrong_numbers(value, entry.clone(), found));
        }
        _ => return,
    };
    let (range, words) = match entry.rsplit('.').next() {
        // Lanes of a register, and elements of a vector.
        Some("lanes") => (1.0..=65_536.0, "a whole number from 1 to 65536".to_owned()),
        Some("shortest" | "longest") => (1.0..=2_f64.powi(40), "a whole number from 1 to 2^40".to_owned()),
        _ => (0.0..=MOST, format!("from 0 to {MOST:e}")),
    };
    if !range.contains(&number) {
        found.push((entry, format!("is {number}, but must be {words}")));
    }
}

/// The host model that comes with the program: of the machine that it was developed on.
///
/// # Errors
/// [`HostFileError`] never, as a test of the shipped text holds.
pub fn default_model() -> Result<HostModel, HostFileError> {
    HostModel::parse("the shipped host model", include_str!("default.toml"))
}

impl Reported for HostFileError {
    fn class(&self) -> Class {
        match self {
            HostFileError::Read(_) => Class::InputOutput,
            _ => Class::Input,
        }
    }

    fn place(&self) -> Option<FilePlace> {
        Some(match self {
            HostFileError::Read(error) => FilePlace::at(&error.file),
            HostFileError::NotText { file, line } => {
                FilePlace { file: file.clone(), line: Some(*line), column: None }
            }
            HostFileError::Syntax { file, .. } => FilePlace { file: file.clone(), line: None, column: None },
            HostFileError::Content { file, position, .. } => {
                let (line, column) = (position.map(|at| at.line), position.map(|at| at.column));
                FilePlace { file: file.clone(), line, column }
            }
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_shipped_model_is_read_and_written_without_loss() {
        let model = default_model().unwrap();
        assert_eq!(HostModel::parse("again", &model.to_toml()).unwrap(), model);
    }

    #[test]
    fn bad_entries_are_named_with_their_place() {
        let text = default_model().unwrap().to_toml();
        let complaint = |old: &str, new: &str| {
            assert!(text.contains(old), "{old}");
            HostModel::parse("bad.toml", &text.replacen(old, new, 1)).unwrap_err().to_string()
        };
        for (old, new, expected) in [
            ("bind = ", "bind = -", "`bind` is -"),
            ("\"avx512\"", "\"purple\"", "`instruction_set` is \"purple\", but must be one of scalar, wide"),
            ("bind = ", "binds = ", "unknown field `binds`"),
            ("footprint = ", "footprints = ", "unknown field `footprints`"),
            ("footprint = ", "footprint = 1e12 #", "`levels.footprint` must be positive and rise"),
            ("format = 14", "format = 15", "`format` is 15"),
            ("format = 14", "format = 13\npace = 1.0", "`format` is 13, but this program reads 14"),
            ("format = 14\n", "", "missing field `format`"),
        ] {
            let said = complaint(old, new);
            assert!(said.contains(expected) && said.contains("line "), "{said}");
        }
    }
}
