//! Refusals to write to a folder or file.

use super::FileError;
use crate::quoted;
use std::path::{Path, PathBuf};

/// Reason why a folder or a file is not written to.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum FolderError {
    /// The folder has files of others.
    #[error(
        "{} has files that this command did not write: it {}contains {names}; expected a folder that is new, empty or the command's \
         own; move them away, or choose another --out",
        quoted::path(folder),
        list.map_or_else(String::new, |list| format!("has no {list}, and "))
    )]
    NotOurs {
        /// Path of the folder.
        folder: PathBuf,
        /// Name of the list of own files that is missing.
        list: Option<&'static str>,
        /// Names of files in it.
        names: String,
    },
    /// A file or folder of others has the name of a file to be written.
    #[error(
        "{} was not written by this command: move it away{}",
        quoted::path(path),
        if *is_optional { ", choose another --out, or add --overwrite to lose it" } else { ", or choose another --out" }
    )]
    InTheWay {
        /// Path of the file or folder.
        path: PathBuf,
        /// True if it may be overwritten on request.
        is_optional: bool,
    },
    /// A list of own files has been changed.
    #[error("{}:{line}: expected {expected}, found `{found}`", quoted::path(file))]
    List {
        /// Path of the list.
        file: PathBuf,
        /// Line, from 1.
        line: usize,
        /// Expected line.
        expected: &'static str,
        /// Line found.
        found: String,
    },
    /// Another process writes there, with its description: which one, on which host, and since when.
    #[error("{folder} is being written by {holder}: wait until it has ended, or choose another --out", folder = quoted::path(.0), holder = .1)]
    Held(PathBuf, String),
    /// A file to be kept exists; with advice.
    #[error("{file} already exists: {remedy}", file = quoted::path(.0), remedy = .1)]
    Exists(PathBuf, &'static str),
    /// A folder or a device has the name of a file and is not replaced; with advice.
    #[error("{file} is not an ordinary file: {remedy}", file = quoted::path(.0), remedy = .1)]
    NoFile(PathBuf, &'static str),
    /// The system reports an error.
    #[error(transparent)]
    File(#[from] FileError),
}

impl FolderError {
    /// Error of a folder with files of others.
    pub(super) fn not_ours(folder: &Path, list: Option<&'static str>, names: &[String]) -> FolderError {
        FolderError::NotOurs { folder: folder.to_owned(), list, names: listing(names) }
    }

    /// Error of a file of others at a path reserved for own files.
    pub(super) fn in_the_way(path: impl Into<PathBuf>) -> FolderError {
        FolderError::InTheWay { path: path.into(), is_optional: false }
    }
}

/// Names in a folder for a message: the first few, without control characters.
fn listing(names: &[String]) -> String {
    const NAMED: usize = 5;
    let plain = |name: &String| name.chars().flat_map(char::escape_debug).collect::<String>();
    let said = names.iter().take(NAMED).map(plain).collect::<Vec<_>>().join(", ");
    match names.len().saturating_sub(NAMED) {
        0 => said,
        more => format!("{said} and {more} more"),
    }
}
