//! What a user hears of an error, whatever it is of: its class, its place, and what to do.

use crate::input::{InputErrors, Reason};
use crate::io::{FileError, FolderError};
use std::path::Path;

/// The classes of errors; each has an exit code of its own.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Class {
    /// The request cannot be understood, or is refused.
    Usage,
    /// A scene or another input file is wrong.
    Input,
    /// The physics broke a precondition, or a prediction lies outside what was calibrated.
    Precondition,
    /// The system does not let something be read or written.
    InputOutput,
    /// What was written before has been damaged.
    Checkpoint,
}

impl Class {
    /// Every class.
    const ALL: [Class; 5] =
        [Class::Usage, Class::Input, Class::Precondition, Class::InputOutput, Class::Checkpoint];

    /// The class of an exit code; none where a signal ended the program.
    pub fn of_exit_code(code: u8) -> Option<Class> {
        Class::ALL.into_iter().find(|class| class.exit_code() == code)
    }

    /// The name in JSON.
    pub fn name(self) -> &'static str {
        match self {
            Class::Usage => "usage",
            Class::Input => "input",
            Class::Precondition => "precondition",
            Class::InputOutput => "input-output",
            Class::Checkpoint => "checkpoint",
        }
    }

    /// The exit code.
    pub fn exit_code(self) -> u8 {
        match self {
            Class::Usage => 2,
            Class::Input => 3,
            Class::Precondition => 4,
            Class::InputOutput => 5,
            Class::Checkpoint => 6,
        }
    }
}

/// A place in a file, as far as it is known.
#[derive(Clone, Debug, PartialEq, Eq, serde::Serialize)]
pub struct FilePlace {
    /// The file.
    pub file: String,
    /// Line, from 1.
    pub line: Option<usize>,
    /// Column, from 1.
    pub column: Option<usize>,
}

impl FilePlace {
    /// A file as a whole.
    pub fn at(file: &Path) -> FilePlace {
        FilePlace { file: file.display().to_string(), line: None, column: None }
    }
}

/// An error that a user hears of.
pub trait Reported: std::error::Error + Send + Sync {
    /// Its class.
    fn class(&self) -> Class;

    /// The error that it passes on, if it does: what is not said here of mistakes, place, remedy and details, that one says.
    fn passed_on(&self) -> Option<&dyn Reported> {
        None
    }

    /// The mistakes of an input file, where it is of one.
    fn mistakes(&self) -> Option<&InputErrors> {
        self.passed_on()?.mistakes()
    }

    /// Where, if it has a place.
    fn place(&self) -> Option<FilePlace> {
        self.passed_on()?.place()
    }

    /// What to do, where its words do not say so in a paragraph of their own.
    fn remedy(&self) -> Option<String> {
        self.passed_on()?.remedy()
    }

    /// What more is known of it, as data.
    fn details(&self) -> Option<serde_json::Value> {
        self.passed_on()?.details()
    }
}

impl Reported for InputErrors {
    fn class(&self) -> Class {
        let is_of_system = self.0.iter().any(|error| error.reason == Reason::System);
        if is_of_system { Class::InputOutput } else { Class::Input }
    }

    fn mistakes(&self) -> Option<&InputErrors> {
        Some(self)
    }
}

impl Reported for FileError {
    fn class(&self) -> Class {
        Class::InputOutput
    }

    fn place(&self) -> Option<FilePlace> {
        Some(FilePlace::at(&self.file))
    }
}

impl Reported for FolderError {
    fn class(&self) -> Class {
        match self {
            FolderError::List { .. } => Class::Checkpoint,
            FolderError::File(error) => error.class(),
            _ => Class::Usage,
        }
    }

    fn place(&self) -> Option<FilePlace> {
        match self {
            FolderError::NotOurs { folder: path, .. }
            | FolderError::InTheWay { path, .. }
            | FolderError::Held(path, _)
            | FolderError::Exists(path, _)
            | FolderError::NoFile(path, _) => Some(FilePlace::at(path)),
            FolderError::List { file, line, .. } => {
                Some(FilePlace { line: Some(*line), ..FilePlace::at(file) })
            }
            FolderError::File(error) => error.place(),
        }
    }
}
