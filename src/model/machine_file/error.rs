//! What can be wrong with a machine file.

use super::limits::FORMAT;
use super::position::Position;
use std::io::ErrorKind;
use stripmine_kernels::isa::op::OpClass;
use stripmine_physics::number::counted;
use stripmine_physics::quoted::{message, one_line, quoted};
use stripmine_physics::reported::{Class, FilePlace, Reported};
use stripmine_physics::words::suggestion;

/// Why a machine file cannot be used.
#[derive(Debug, thiserror::Error)]
pub enum MachineFileError {
    /// Not TOML, or an entry that is missing, unknown or of the wrong type; the cause shows line and column.
    #[error("machine file `{}`: {}", quoted(file), message(&cause.to_string()))]
    Syntax {
        /// Name of the file.
        file: String,
        /// What the TOML reader says, with the place.
        cause: Box<toml::de::Error>,
    },
    /// Bytes that are no text.
    #[error("machine file `{}`, line {line}: not UTF-8 text; expected a TOML file in UTF-8", quoted(file))]
    NotText {
        /// Name of the file.
        file: String,
        /// The first line that is not.
        line: usize,
    },
    /// Entries that cannot be, the first of them, a line each.
    #[error("{}", lines(file, defects, *more))]
    Content {
        /// Name of the file.
        file: String,
        /// What is wrong, each with its place: where the file has the entry, or the table that should.
        defects: Vec<(Option<Position>, Defect)>,
        /// How many more there are.
        more: usize,
    },
}

fn lines(file: &str, defects: &[(Option<Position>, Defect)], more: usize) -> String {
    let file = quoted(file);
    let line = |(position, defect): &(Option<Position>, Defect)| {
        let at = position.map_or(String::new(), |at| format!(", {at}"));
        format!("machine file `{file}`{at}: {}", one_line(&defect.to_string()))
    };
    let mut lines: Vec<String> = defects.iter().map(line).collect();
    if more > 0 {
        lines.push(format!("machine file `{file}`: {}", counted(more, "more defect", "more defects")));
    }
    lines.join("\n")
}

/// Why there is no such machine.
#[derive(Debug, thiserror::Error)]
pub enum MachineError {
    /// No preset has the name asked for, and it does not look like that of a file.
    #[error(
        "unknown machine `{}`; known are {}, and machine files by their path, which ends in .toml{}",
        quoted(name),
        known.join(", "),
        suggestion(name, known.iter().copied())
    )]
    Unknown {
        /// The name asked for.
        name: String,
        /// All names that would have done.
        known: Vec<&'static str>,
    },
    /// A file that cannot be read.
    #[error("machine file `{}`: {cause}", quoted(file))]
    Read {
        /// Name of the file.
        file: String,
        /// What the system said.
        cause: std::io::Error,
    },
    /// A file that cannot be used.
    #[error(transparent)]
    File(#[from] MachineFileError),
}

/// What is wrong with an entry.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum Defect {
    /// A format version that this program does not know.
    #[error("format = {found}, but this program reads format {FORMAT}")]
    UnsupportedFormat {
        /// The version it states.
        found: u32,
    },
    /// A key that no table of its place has.
    #[error("unknown field `{name}`")]
    UnknownField {
        /// The entry.
        entry: String,
        /// Its key.
        name: String,
    },
    /// A key that must be there and is not.
    #[error("missing field `{name}`")]
    MissingField {
        /// The missing entry.
        entry: String,
        /// Its key.
        name: String,
    },
    /// Something of another kind than must stand there.
    #[error("`{entry}` must be {expected}")]
    WrongType {
        /// The entry.
        entry: String,
        /// What must stand there.
        expected: String,
    },
    /// A name that is no class of operations.
    #[error("`{entry}`: `{name}` names no class of operations; known are {}", class_names())]
    UnknownClass {
        /// The entry with the unknown name.
        entry: String,
        /// The name.
        name: String,
    },
    /// A number that is zero, negative or not finite.
    #[error("`{entry}` is {value}, but must be positive and finite")]
    NotPositive {
        /// The entry with the number.
        entry: String,
        /// The number.
        value: f64,
    },
    /// A number larger than any machine's.
    #[error("`{entry}` is {value:e}, but must be at most {most:e}")]
    TooLarge {
        /// The entry with the number.
        entry: String,
        /// The number.
        value: f64,
        /// The bound.
        most: f64,
    },
    /// An expansion into more operations than any machine needs.
    #[error("`{entry}` comes to {count} operations, but at most {most} are counted out")]
    LongExpansion {
        /// The entry.
        entry: String,
        /// Operations, expansions followed to their end.
        count: u64,
        /// The bound.
        most: u64,
    },
    /// A number with a fraction where things are counted.
    #[error("`{entry}` is {value}, but must be a whole number")]
    NotWhole {
        /// The entry with the number.
        entry: String,
        /// The number.
        value: f64,
    },
    /// A number that does not say where it comes from.
    #[error("the note of `{entry}` is empty; say where the number comes from")]
    EmptyNote {
        /// The entry without a note.
        entry: String,
    },
    /// A class that the machine executes, without a start-up.
    #[error("neither `{entry}` nor `start_up.default` is given")]
    MissingStartUp {
        /// The missing entry.
        entry: String,
    },
    /// A class that the machine executes, without a unit among those that are named.
    #[error("no unit of `{entry}` serves `{class}`, which the machine executes")]
    NoUnit {
        /// The table of units.
        entry: String,
        /// The class.
        class: &'static str,
    },
    /// An expansion into nothing.
    #[error("`{entry}` has no steps")]
    EmptyExpansion {
        /// The entry without steps.
        entry: String,
    },
    /// Expansions that lead back to where they started.
    #[error("`{entry}` never ends: {}", cycle.join(" -> "))]
    EndlessExpansion {
        /// The entry from which the circle is reached.
        entry: String,
        /// The classes passed through; the last one occurred before.
        cycle: Vec<&'static str>,
    },
}

impl Defect {
    /// The entry, as its file writes it.
    pub fn entry(&self) -> String {
        match self {
            Defect::UnsupportedFormat { .. } => "format".to_owned(),
            Defect::EmptyNote { entry } => format!("{entry}.note"),
            Defect::NotPositive { entry, .. }
            | Defect::NotWhole { entry, .. }
            | Defect::TooLarge { entry, .. } => format!("{entry}.value"),
            Defect::UnknownField { entry, .. }
            | Defect::MissingField { entry, .. }
            | Defect::WrongType { entry, .. }
            | Defect::UnknownClass { entry, .. }
            | Defect::MissingStartUp { entry }
            | Defect::NoUnit { entry, .. }
            | Defect::EmptyExpansion { entry }
            | Defect::LongExpansion { entry, .. }
            | Defect::EndlessExpansion { entry, .. } => entry.clone(),
        }
    }
}

fn class_names() -> String {
    OpClass::ALL.iter().map(|class| class.name()).collect::<Vec<_>>().join(", ")
}

impl Reported for MachineError {
    fn class(&self) -> Class {
        match self {
            MachineError::Unknown { .. } => Class::Usage,
            MachineError::File(_) => Class::Input,
            // Bytes that are no text.
            MachineError::Read { cause, .. } if cause.kind() == ErrorKind::InvalidData => Class::Input,
            MachineError::Read { .. } => Class::InputOutput,
        }
    }

    fn place(&self) -> Option<FilePlace> {
        let (file, position) = match self {
            MachineError::Unknown { .. } => return None,
            MachineError::File(MachineFileError::NotText { file, line }) => {
                return Some(FilePlace { file: file.clone(), line: Some(*line), column: None });
            }
            MachineError::Read { file, .. } | MachineError::File(MachineFileError::Syntax { file, .. }) => {
                (file, None)
            }
            MachineError::File(MachineFileError::Content { file, defects, .. }) => {
                (file, defects.first().and_then(|(position, _)| *position))
            }
        };
        let (line, column) = (position.map(|at| at.line), position.map(|at| at.column));
        Some(FilePlace { file: file.clone(), line, column })
    }

    fn remedy(&self) -> Option<String> {
        match self {
            MachineError::Unknown { .. } => {
                Some("take one of the known machines, or write a file".to_owned())
            }
            _ => None,
        }
    }
}
