//! The folder of a verb that writes a few files: what it did not write it does not write over, and it is alone there.
//!
//! A list beside the files, written before them, says which are its own: a heading, then a name a line.

use std::collections::BTreeSet;
use std::fs;
use std::io::{ErrorKind, Write};
use std::path::{Path, PathBuf};
use stripmine_physics::io::lock::{Lock, LockError};
use stripmine_physics::io::replace::replace;
use stripmine_physics::io::{FileError, regular_file};
use stripmine_physics::quoted;
use stripmine_physics::reported::{Class, FilePlace, Reported};

/// Keeps other processes out.
const LOCK: &str = ".stripmine.lock";
/// Longer than any list (bytes).
const LONGEST: u64 = 1 << 20;

/// Why files are not written.
#[derive(Debug, thiserror::Error)]
pub(crate) enum OwnFilesError {
    /// A file of that name that is another's.
    #[error(
        "{} was not written by this command: move it away, choose another --out, or add --overwrite to lose it",
        quoted::path(.0)
    )]
    InTheWay(PathBuf),
    /// Another process writes there.
    #[error(transparent)]
    Lock(#[from] LockError),
    /// The system.
    #[error(transparent)]
    File(#[from] FileError),
}

impl Reported for OwnFilesError {
    fn class(&self) -> Class {
        match self {
            OwnFilesError::InTheWay(_) => Class::Usage,
            OwnFilesError::Lock(error) if error.is_refusal() => Class::Usage,
            OwnFilesError::Lock(_) | OwnFilesError::File(_) => Class::InputOutput,
        }
    }

    fn place(&self) -> Option<FilePlace> {
        match self {
            OwnFilesError::InTheWay(file) | OwnFilesError::File(FileError { file, .. }) => {
                Some(FilePlace::at(file))
            }
            OwnFilesError::Lock(_) => None,
        }
    }
}

/// Files of a verb in a folder, while this process writes them.
pub(crate) struct OwnFiles {
    path: PathBuf,
    _lock: Lock,
}

impl OwnFiles {
    /// Makes the folder if it is not there, keeps other processes out, and puts `names` on the list called `list`.
    ///
    /// # Errors
    /// If another's file has one of the names and is not to be written over, or another process writes there.
    pub(crate) fn claim(
        path: &Path,
        list: &'static str,
        names: &[String],
        overwrite: bool,
    ) -> Result<OwnFiles, OwnFilesError> {
        fs::create_dir_all(path).map_err(FileError::at(path, "creating the folder"))?;
        let lock = Lock::take(&path.join(LOCK))?;
        let heading = format!("stripmine {list} 1");
        let own = listed(&path.join(list), &heading)?;
        let is_foreign = |name: &&str| {
            !own.as_ref().is_some_and(|own| own.contains(*name)) && path.join(name).symlink_metadata().is_ok()
        };
        // A file of the list's name that is none is another's too.
        let names = names.iter().map(String::as_str);
        let mut in_the_way = names.clone().chain((own.is_none()).then_some(list)).filter(is_foreign);
        if let Some(name) = in_the_way.next().filter(|_| !overwrite) {
            return Err(OwnFilesError::InTheWay(path.join(name)));
        }
        let mut all = own.unwrap_or_default();
        all.extend(names.map(str::to_owned));
        replace(&path.join(list), |out| {
            writeln!(out, "{heading}")?;
            all.iter().try_for_each(|name| writeln!(out, "{name}"))
        })?;
        Ok(OwnFiles { path: path.to_owned(), _lock: lock })
    }

    /// Removes a file that was claimed, where it is there.
    ///
    /// # Errors
    /// If the system does not let it be removed.
    pub(crate) fn remove(&self, name: &str) -> Result<(), OwnFilesError> {
        let file = self.path.join(name);
        match fs::remove_file(&file) {
            Err(cause) if cause.kind() != ErrorKind::NotFound => {
                Err(FileError::at(&file, "removing")(cause).into())
            }
            _ => Ok(()),
        }
    }

    /// Puts a whole file in its place; it is one that was claimed.
    ///
    /// # Errors
    /// If the system does not let it be written.
    pub(crate) fn write(&self, name: &str, bytes: &[u8]) -> Result<PathBuf, OwnFilesError> {
        let file = self.path.join(name);
        replace(&file, |out| out.write_all(bytes))?;
        Ok(file)
    }
}

/// The names on a list; none where there is no list, or none of ours.
fn listed(list: &Path, heading: &str) -> Result<Option<BTreeSet<String>>, FileError> {
    let bytes = match regular_file::read(list, LONGEST) {
        Ok(bytes) => bytes,
        Err(cause) if matches!(cause.kind(), ErrorKind::NotFound | ErrorKind::InvalidInput) => {
            return Ok(None);
        }
        Err(cause) => return Err(FileError::at(list, "reading")(cause)),
    };
    let text = String::from_utf8_lossy(&bytes);
    let mut lines = text.lines();
    let is_ours = lines.next() == Some(heading);
    Ok(is_ours.then(|| lines.map(str::to_owned).collect()))
}
