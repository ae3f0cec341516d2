//! Errors as shown to a user: class, location and remedy.

use crate::input::{InputErrors, MistakeKind};
use crate::io::{FileError, FolderError};
use std::path::Path;

/// Classes of errors; each has its own exit code.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ErrorClass {
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

impl ErrorClass {
    /// All classes.
    const ALL: [ErrorClass; 5] = [
        ErrorClass::Usage,
        ErrorClass::Input,
        ErrorClass::Precondition,
        ErrorClass::InputOutput,
        ErrorClass::Checkpoint,
    ];

    /// Class of an exit code; none if a signal ended the program.
    pub fn of_exit_code(code: u8) -> Option<ErrorClass> {
        ErrorClass::ALL.into_iter().find(|class| class.exit_code() == code)
    }

    /// Name in JSON.
    pub fn name(self) -> &'static str {
        match self {
            ErrorClass::Usage => "usage",
            ErrorClass::Input => "input",
            ErrorClass::Precondition => "precondition",
            ErrorClass::InputOutput => "input-output",
            ErrorClass::Checkpoint => "checkpoint",
        }
    }

    /// Exit code of the class.
    pub fn exit_code(self) -> u8 {
        match self {
            ErrorClass::Usage => 2,
            ErrorClass::Input => 3,
            ErrorClass::Precondition => 4,
            ErrorClass::InputOutput => 5,
            ErrorClass::Checkpoint => 6,
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
    fn class(&self) -> ErrorClass;

    /// Inner error that supplies the mistakes, location, remedy and details not given here.
    fn inner_error(&self) -> Option<&dyn Reported> {
        None
    }

    /// Mistakes of an input file, if it is about one.
    fn mistakes(&self) -> Option<&InputErrors> {
        self.inner_error()?.mistakes()
    }

    /// Location, if known.
    fn place(&self) -> Option<FilePlace> {
        self.inner_error()?.place()
    }

    /// Remedy, unless the message has a paragraph on it.
    fn remedy(&self) -> Option<String> {
        self.inner_error()?.remedy()
    }

    /// Further facts as data.
    fn details(&self) -> Option<serde_json::Value> {
        self.inner_error()?.details()
    }
}

impl Reported for InputErrors {
    fn class(&self) -> ErrorClass {
        let is_of_system = self.0.iter().any(|error| error.reason == MistakeKind::System);
        if is_of_system { ErrorClass::InputOutput } else { ErrorClass::Input }
    }

    fn mistakes(&self) -> Option<&InputErrors> {
        Some(self)
    }
}

impl Reported for FileError {
    fn class(&self) -> ErrorClass {
        ErrorClass::InputOutput
    }

    fn place(&self) -> Option<FilePlace> {
        Some(FilePlace::at(&self.file))
    }
}

impl Reported for FolderError {
    fn class(&self) -> ErrorClass {
        match self {
            FolderError::List { .. } => ErrorClass::Checkpoint,
            FolderError::File(error) => error.class(),
            _ => ErrorClass::Usage,
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
