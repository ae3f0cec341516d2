//! Why a folder or a file is not written to.

use super::FileError;
use crate::quoted;
use std::path::{Path, PathBuf};

/// Why a folder or a file is not written to.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum FolderError {
    /// It holds something else.
    #[error(
        "{} was not written by this command, or not by it alone: it {}holds {names}; expected a folder that is new, empty or the \
         command's own; move these files away, or choose another --out",
        quoted::path(folder),
        list.map_or_else(String::new, |list| format!("has no {list}, and "))
    )]
    NotOurs {
        /// The folder.
        folder: PathBuf,
        /// The list that it would have.
        list: Option<&'static str>,
        /// Names of files in it.
        names: String,
    },
    /// A file or folder of others has the name of one that would be written.
    #[error(
        "{} was not written by this command: move it away{}",
        quoted::path(path),
        if *is_optional { ", choose another --out, or add --overwrite to lose it" } else { ", or choose another --out" }
    )]
    InTheWay {
        /// The file or folder.
        path: PathBuf,
        /// True where it may be written over on request.
        is_optional: bool,
    },
    /// A list of own files that is not as it was written.
    #[error("{}:{line}: expected {expected}, found `{found}`", quoted::path(file))]
    List {
        /// The list.
        file: PathBuf,
        /// Line, from 1.
        line: usize,
        /// The line as it should be.
        expected: &'static str,
        /// The line as it is.
        found: String,
    },
    /// Another process writes there: which one, on which host, and since when.
    #[error("{folder} is being written by {holder}: wait until it has ended, or choose another --out", folder = quoted::path(.0), holder = .1)]
    Held(PathBuf, String),
    /// A file is there that is to stay, with what to do.
    #[error("{file} is there already: {remedy}", file = quoted::path(.0), remedy = .1)]
    Exists(PathBuf, &'static str),
    /// A folder or a device that has the name of a file to be written, and the advice. It is not replaced.
    #[error("{file} is not an ordinary file: {remedy}", file = quoted::path(.0), remedy = .1)]
    NoFile(PathBuf, &'static str),
    /// The system.
    #[error(transparent)]
    File(#[from] FileError),
}

impl FolderError {
    /// A folder with names of others in it.
    pub(super) fn not_ours(folder: &Path, list: Option<&'static str>, names: &[String]) -> FolderError {
        FolderError::NotOurs { folder: folder.to_owned(), list, names: listing(names) }
    }

    /// Something of others where only own files may be.
    pub(super) fn in_the_way(path: impl Into<PathBuf>) -> FolderError {
        FolderError::InTheWay { path: path.into(), is_optional: false }
    }
}

/// Names in a folder, for a message: the first few, without control characters.
fn listing(names: &[String]) -> String {
    const NAMED: usize = 5;
    let plain = |name: &String| name.chars().flat_map(char::escape_debug).collect::<String>();
    let said = names.iter().take(NAMED).map(plain).collect::<Vec<_>>().join(", ");
    match names.len().saturating_sub(NAMED) {
        0 => said,
        more => format!("{said} and {more} more"),
    }
}
