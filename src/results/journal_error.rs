//! Why there is no journal of a study.

use std::path::PathBuf;
use stripmine_physics::io::FileError;
use stripmine_physics::quoted;
use stripmine_physics::ranks::RankError;
use stripmine_physics::reported::{Class, FilePlace, Reported};

/// Why there is no journal.
#[derive(Debug, thiserror::Error)]
pub(crate) enum JournalError {
    /// The folder holds the runs of something else.
    #[error(
        "{} holds the runs of {}, not of {ours}: a study goes on only with the scene, the options and the version \
         of the program that it was begun with; choose another --out",
        quoted::path(file),
        quoted::one_line(theirs)
    )]
    Other {
        /// The journal.
        file: PathBuf,
        /// What it was begun with.
        theirs: String,
        /// What was asked for.
        ours: String,
    },
    /// A file of that name that is none of ours.
    #[error(
        "{} is no journal of this version of the program: move it away, or choose another --out",
        quoted::path(.0)
    )]
    Foreign(PathBuf),
    /// The system.
    #[error(transparent)]
    File(#[from] FileError),
    /// Processes of one study were given other things.
    #[error(
        "the processes have not the same scene, options and program: give all of them the same files and the same program"
    )]
    Differs,
    /// Another process of the study is lost.
    #[error("{0}: a study goes on with the runs that were finished when it is begun again")]
    Rank(#[from] RankError),
}

impl Reported for JournalError {
    fn class(&self) -> Class {
        match self {
            JournalError::Other { .. } | JournalError::Foreign(_) | JournalError::Differs => Class::Usage,
            JournalError::File(_) | JournalError::Rank(_) => Class::InputOutput,
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
