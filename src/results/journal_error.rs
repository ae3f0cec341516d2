//! Errors of journals.

use std::path::PathBuf;
use stripmine_physics::io::FileError;
use stripmine_physics::quoted;
use stripmine_physics::ranks::RankError;
use stripmine_physics::reported::{ErrorClass, FilePlace, Reported};

/// Errors of opening or writing the journal of a study.
#[derive(Debug, thiserror::Error)]
pub(crate) enum JournalError {
    /// The folder holds the runs of another study.
    #[error(
        "{} holds the runs of {}, not of {ours}: a study resumes only with the scene, options and program version \
         that it was started with; choose another --out",
        quoted::path(file),
        quoted::one_line(theirs)
    )]
    Other {
        /// File of the journal.
        file: PathBuf,
        /// Study of the journal.
        theirs: String,
        /// Requested study.
        ours: String,
    },
    /// A file of the journal's name with another format.
    #[error(
        "{} is not a journal of this program version: move it away, or choose another --out",
        quoted::path(.0)
    )]
    Foreign(PathBuf),
    /// Reading or writing failed.
    #[error(transparent)]
    File(#[from] FileError),
    /// Processes of one study have different inputs.
    #[error(
        "the processes differ in scene, options or program: start all of them with the same files and the same program"
    )]
    Differs,
    /// Another process of the study is lost.
    #[error("{0}: repeat the command to resume the study with its finished runs")]
    Rank(#[from] RankError),
}

impl Reported for JournalError {
    fn class(&self) -> ErrorClass {
        match self {
            JournalError::Other { .. } | JournalError::Foreign(_) | JournalError::Differs => {
                ErrorClass::Usage
            }
            JournalError::File(_) | JournalError::Rank(_) => ErrorClass::InputOutput,
        }
    }

    fn place(&self) -> Option<FilePlace> {
        match self {
            JournalError::Other { file, .. } | JournalError::Foreign(file) => Some(FilePlace::at(file)),
            JournalError::File(error) => error.place(),
            JournalError::Differs | JournalError::Rank(_) => None,
        }
    }
}
