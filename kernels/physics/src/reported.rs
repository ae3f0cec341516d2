//! Errors as shown to a user: class, location and remedy.

use crate::input::{InputErrors, Reason};
use crate::io::{FileError, FolderError};
use std::path::Path;

/// Classes of errors; each has its own exit code.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Class {
    /// Invalid or refused request.
    Usage,
    /// Mistake in a scene or another input file.
    Input,
    /// Violated precondition of the physics, or a prediction outside the calibrated range.
    Precondition,
    /// Failure to read or write.
    InputOutput,
    /// Damaged file of an earlier run.
    Checkpoint,
}

impl Class {
    /// All classes.
    const ALL: [Class; 5] =
        [Class::Usage, Class::Input, Class::Precondition, Class::InputOutput, Class::Checkpoint];

    /// Class of an exit code; none if a signal ended the program.
    pub fn of_exit_code(code: u8) -> Option<Class> {
        Class::ALL.into_iter().find(|class| class.exit_code() == code)
    }

    /// Name in JSON.
    pub fn name(self) -> &'static str {
        match self {
            Class::Usage => "usage",
            Class::Input => "input",
            Class::Precondition => "precondition",
            Class::InputOutput => "input-output",
            Class::Checkpoint => "checkpoint",
        }
    }

    /// Exit code of the class.
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

/// Location in a file, as far as it is known.
#[derive(Clone, Debug, PartialEq, Eq, serde::Serialize)]
pub struct FilePlace {
    /// Name of the file.
    pub file: String,
    /// Line, from 1.
    pub line: Option<usize>,
    /// Column, from 1.
    pub column: Option<usize>,
}

impl FilePlace {
    /// Location of a whole file.
    pub fn at(file: &Path) -> FilePlace {
        FilePlace { file: file.display().to_string(), line: None, column: None }
    }
}

/// Error that is shown to a user.
pub trait Reported: std::error::Error + Send + Sync {
    /// Class of the error.
    fn class(&self) -> Class;

    /// Inner error that supplies the mistakes, location, remedy and details not given here.
    fn passed_on(&self) -> Option<&dyn Reported> {
        None
    }

    /// Mistakes of an input file, if it is about one.
    fn mistakes(&self) -> Option<&InputErrors> {
        self.passed_on()?.mistakes()
    }

    /// Location, if known.
    fn place(&self) -> Option<FilePlace> {
        self.passed_on()?.place()
    }

    /// Remedy, unless the message has a paragraph on it.
    fn remedy(&self) -> Option<String> {
        self.passed_on()?.remedy()
    }

    /// Further facts as data.
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
