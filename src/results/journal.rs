//! Finished runs of a study, a line each, so that a study that was interrupted goes on where it stopped.
//!
//! The first line says whose runs they are: the study, and a digest of its scene and of the program's version. A last line
//! that was cut off is dropped.

use crate::io::FileError;
use crate::reported::{Class, FilePlace, Reported};
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};
use serde_json::Value;
use std::collections::BTreeMap;
use std::fs::{self, File, OpenOptions};
use std::io::{ErrorKind, Write};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard, PoisonError};

/// The name of the file.
pub(super) const NAME: &str = "journal.jsonl";
/// How the first line begins.
const MARK: &str = "{\"stripmine journal\":1,";

/// Why there is no journal.
#[derive(Debug, thiserror::Error)]
pub enum JournalError {
    /// The folder holds the runs of something else.
    #[error(
        "{} holds the runs of {theirs}, not of {ours}: a study goes on only with the scene, the options and the version \
         of the program that it was begun with; choose another --out",
        file.display()
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
    #[error("{} is no journal of this program: move it away, or choose another --out", .0.display())]
    Foreign(PathBuf),
    /// The system.
    #[error(transparent)]
    File(#[from] FileError),
}

impl Reported for JournalError {
    fn class(&self) -> Class {
        match self {
            JournalError::Other { .. } | JournalError::Foreign(_) => Class::Usage,
            JournalError::File(_) => Class::InputOutput,
        }
    }

    fn place(&self) -> Option<FilePlace> {
        match self {
            JournalError::Other { file, .. } | JournalError::Foreign(file) => Some(FilePlace::at(file)),
            JournalError::File(error) => Some(FilePlace::at(&error.file)),
        }
    }
}

/// Whose runs a journal holds.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Identity {
    /// The study and its scene, for a reader.
    pub of: String,
    /// A digest of all that results depend on.
    pub digest: String,
}

#[derive(Serialize, Deserialize)]
struct Line {
    key: String,
    value: Value,
}

/// The runs that are finished.
#[derive(Debug)]
pub struct Journal {
    known: BTreeMap<String, Value>,
    /// None where nothing is kept.
    file: Option<Mutex<File>>,
    path: PathBuf,
}

/// Whether a folder holds a journal of this program.
pub(super) fn is_journal(folder: &Path) -> bool {
    fs::read_to_string(folder.join(NAME)).is_ok_and(|text| text.starts_with(MARK))
}

impl Journal {
    /// One that forgets: for studies that are made in one go.
    pub fn none() -> Journal {
        Journal { known: BTreeMap::new(), file: None, path: PathBuf::new() }
    }

    /// Opens the journal of a folder that is there, or begins one.
    ///
    /// # Errors
    /// [`JournalError`] if it is another's, or the system does not let it be read and written.
    pub fn open(folder: &Path, identity: &Identity) -> Result<Journal, JournalError> {
        let path = folder.join(NAME);
        let at = |action| FileError::at(&path, action);
        let (mut known, mut whole) = (BTreeMap::new(), 0);
        match fs::read_to_string(&path) {
            Err(cause) if cause.kind() == ErrorKind::NotFound => {}
            Err(cause) if cause.kind() == ErrorKind::InvalidData => return Err(JournalError::Foreign(path)),
            Err(cause) => return Err(at("reading")(cause).into()),
            Ok(text) if text.is_empty() => {}
            Ok(text) => {
                let mut lines = text.split_inclusive('\n');
                let first = lines.next().unwrap_or_default();
                if !first.starts_with(MARK) {
                    return Err(JournalError::Foreign(path));
                }
                let theirs: Identity =
                    serde_json::from_str(first).map_err(|_| JournalError::Foreign(path.clone()))?;
                if theirs != *identity {
                    let said = |it: &Identity| format!("{} ({})", it.of, &it.digest.get(..8).unwrap_or("?"));
                    return Err(JournalError::Other {
                        theirs: said(&theirs),
                        ours: said(identity),
                        file: path,
                    });
                }
                whole = first.len();
                for line in lines {
                    let read = serde_json::from_str::<Line>(line).ok().filter(|_| line.ends_with('\n'));
                    let Some(Line { key, value }) = read else { break };
                    known.insert(key, value);
                    whole += line.len();
                }
            }
        }
        let mut file = OpenOptions::new().append(true).create(true).open(&path).map_err(at("opening"))?;
        file.set_len(whole as u64).map_err(at("cutting"))?;
        if whole == 0 {
            let rest = serde_json::to_string(identity).unwrap_or_default();
            writeln!(file, "{MARK}{}", &rest[1..]).map_err(at("writing"))?;
        }
        Ok(Journal { known, file: Some(Mutex::new(file)), path })
    }

    /// How many runs were finished before.
    pub fn len(&self) -> usize {
        self.known.len()
    }

    /// Whether none was.
    pub fn is_empty(&self) -> bool {
        self.known.is_empty()
    }

    /// Whether a run was finished before.
    pub fn knows(&self, key: &str) -> bool {
        self.known.contains_key(key)
    }

    /// What a run gave, if it was finished before, and otherwise what it gives now, which is kept.
    ///
    /// # Errors
    /// Those of the run, and [`JournalError`] if it cannot be kept.
    pub fn recall<T, E>(&self, key: &str, run: impl FnOnce() -> Result<T, E>) -> Result<T, E>
    where
        T: Serialize + DeserializeOwned,
        E: From<JournalError>,
    {
        if let Some(value) = self.known.get(key)
            && let Ok(value) = serde_json::from_value(value.clone())
        {
            return Ok(value);
        }
        let value = run()?;
        self.keep(key, &value).map_err(JournalError::File)?;
        Ok(value)
    }

    fn keep(&self, key: &str, value: &impl Serialize) -> Result<(), FileError> {
        let Some(file) = &self.file else { return Ok(()) };
        let line = serde_json::to_value(value).map(|value| Line { key: key.to_owned(), value });
        let text = line.and_then(|line| serde_json::to_string(&line)).map_err(std::io::Error::from);
        let mut file: MutexGuard<'_, File> = file.lock().unwrap_or_else(PoisonError::into_inner);
        text.and_then(|text| file.write_all((text + "\n").as_bytes()))
            .map_err(FileError::at(&self.path, "writing"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn identity(digest: &str) -> Identity {
        Identity { of: "a study of a scene".to_owned(), digest: digest.to_owned() }
    }

    fn run(journal: &Journal, key: &str, value: u64) -> u64 {
        journal.recall(key, || Ok::<_, JournalError>(value)).unwrap()
    }

    #[test]
    fn finished_runs_are_not_made_again_and_a_cut_line_is_dropped() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join(NAME);
        let first = Journal::open(folder.path(), &identity("12345678")).unwrap();
        assert_eq!((run(&first, "a", 1), run(&first, "b", 2)), (1, 2));
        drop(first);
        let text = fs::read_to_string(&path).unwrap();
        fs::write(&path, text.trim_end().strip_suffix('}').unwrap()).unwrap();
        let second = Journal::open(folder.path(), &identity("12345678")).unwrap();
        assert_eq!((run(&second, "a", 10), run(&second, "b", 20), second.len()), (1, 20, 1));
        drop(second);
        assert!(is_journal(folder.path()));
        let third = Journal::open(folder.path(), &identity("12345678")).unwrap();
        assert_eq!((run(&third, "b", 3), third.len()), (20, 2));
    }

    #[test]
    fn runs_of_another_scene_and_files_of_others_are_refused() {
        let folder = tempfile::tempdir().unwrap();
        Journal::open(folder.path(), &identity("12345678")).unwrap();
        let other = Journal::open(folder.path(), &identity("87654321")).unwrap_err();
        assert!(matches!(other, JournalError::Other { .. }) && other.class() == Class::Usage, "{other}");
        for mine in ["mine\n", "{\"stripmine journal\":2}\n"] {
            fs::write(folder.path().join(NAME), mine).unwrap();
            let foreign = Journal::open(folder.path(), &identity("12345678")).unwrap_err();
            assert!(matches!(foreign, JournalError::Foreign(_)), "{foreign}");
            assert!(!is_journal(folder.path()));
            assert_eq!(fs::read_to_string(folder.path().join(NAME)).unwrap(), mine);
        }
    }
}
