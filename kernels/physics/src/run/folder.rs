//! The folder of a run: a run writes only where nothing was or where it has written before, keeps a list of its files, and
//! is alone there.
//!
//! The list, `run.files`, is a heading and then a name a line, written before the files themselves, so that a run that is
//! killed leaves nothing that is not known as its own. Temporary files (`.stripmine-….part`) are on no list: their names
//! are random.

use crate::io::checkpoint::NAME as CHECKPOINT;
use crate::io::lock::{Lock, LockError, is_lock};
use crate::io::replace::{is_temporary, listing, remove_if_there, replace};
use crate::io::{FileError, trajectory};
use crate::quoted;
use crate::reported::Class;
use crate::structure::OBSERVABLES;
use std::collections::BTreeSet;
use std::fs::{self, File};
use std::io::{self, BufWriter, ErrorKind, Read, Write};
use std::path::{Path, PathBuf};

const LIST: &str = "run.files";
const LOCK: &str = "run.lock";
/// The first line of the list.
const HEADING: &str = "stripmine run files 1";
/// More than a list holds (bytes).
const LONGEST: u64 = 10_000;

/// The table of observables.
pub(super) const THERMO: &str = "thermo.csv";
/// The frames.
pub(super) const TRAJECTORY: &str = trajectory::TEXT;
/// The frames' positions, as DCD.
pub(super) const DCD: &str = "trajectory.dcd";
/// The frames as GSD.
pub(super) const GSD: &str = trajectory::INDEXED;
/// The frames for LAMMPS.
pub(super) const DUMP: &str = "dump.lammpstrj";
/// The last state for LAMMPS.
pub(super) const DATA: &str = "final.data";
/// A row for each event.
pub(super) const EVENTS: &str = "events.csv";
/// The scene with every value spelled out.
pub(super) const SCENE: &str = "scene.toml";
/// What the run says of itself.
pub(super) const SUMMARY: &str = "summary.json";

/// The checkpoint before the newest.
const PREVIOUS: &str = "run.checkpoint.previous";

/// Everything that a run may have written, but for the structure.
const FILES: [&str; 12] =
    [LIST, SCENE, THERMO, TRAJECTORY, DCD, GSD, EVENTS, DUMP, DATA, SUMMARY, CHECKPOINT, PREVIOUS];

/// What a run writes whatever its scene.
const ALWAYS: [&str; 7] = [LIST, SCENE, THERMO, TRAJECTORY, SUMMARY, CHECKPOINT, PREVIOUS];

/// Why a run does not write into a folder.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum FolderError {
    /// Something else stands in it.
    #[error(
        "{} is no folder of a run (it has no {LIST}), and not empty: it holds {names}; a run writes only into a folder \
         that is new, empty or its own: choose another --out (a run of an earlier version, which left no {LIST}, goes on \
         only with that version)",
        quoted::path(folder)
    )]
    NotOurs {
        /// The folder.
        folder: PathBuf,
        /// What stands in it.
        names: String,
    },
    /// It holds the run, but also a file that the run did not write and now would.
    #[error("{} was not written by this run: move it away, or choose another --out", quoted::path(.0))]
    InTheWay(PathBuf),
    /// The list of the run's files says what it cannot say.
    #[error("{}:{line}: expected {expected}, found `{found}`", quoted::path(file))]
    List {
        /// The list.
        file: PathBuf,
        /// Line, from 1.
        line: usize,
        /// What should stand there.
        expected: &'static str,
        /// What stands there.
        found: String,
    },
    /// Another process writes there, or it cannot be made sure that none does.
    #[error(transparent)]
    Lock(#[from] LockError),
    /// The system.
    #[error(transparent)]
    File(#[from] FileError),
}

impl FolderError {
    /// Whether the folder is another's, another process writes there, its list is damaged, or the system refuses.
    pub(super) fn class(&self) -> Class {
        match self {
            FolderError::NotOurs { .. } | FolderError::InTheWay(_) => Class::Usage,
            FolderError::Lock(error) if error.is_refusal() => Class::Usage,
            FolderError::List { .. } => Class::Checkpoint,
            FolderError::Lock(_) | FolderError::File(_) => Class::InputOutput,
        }
    }
}

/// A run's folder, while the run writes into it.
#[derive(Debug)]
pub(super) struct RunFolder {
    path: PathBuf,
    listed: BTreeSet<&'static str>,
    lock: Lock,
}

/// The files of the run that a folder holds, by its list; none where it holds nothing or does not exist.
///
/// # Errors
/// If it holds anything else.
pub(super) fn listed(folder: &Path) -> Result<Option<BTreeSet<&'static str>>, FolderError> {
    let entries = match fs::read_dir(folder) {
        Ok(entries) => entries,
        Err(cause) if cause.kind() == ErrorKind::NotFound => return Ok(None),
        Err(cause) => return Err(FileError::at(folder, "reading the folder")(cause).into()),
    };
    let mut names = Vec::new();
    for entry in entries {
        let name = entry.map_err(FileError::at(folder, "reading the folder"))?.file_name();
        names.push(name.to_string_lossy().into_owned());
    }
    if names.iter().any(|name| name == LIST) {
        return Ok(Some(read_list(&folder.join(LIST))?));
    }
    names.retain(|name| !(is_temporary(name) || name == LOCK && is_lock(&folder.join(LOCK))));
    if names.is_empty() {
        return Ok(None);
    }
    names.sort();
    let said = listing(&names);
    Err(FolderError::NotOurs { folder: folder.to_owned(), names: said })
}

/// Refuses a folder of a run in which another process writes.
///
/// # Errors
/// Who that is.
pub(super) fn is_free(folder: &Path) -> Result<(), FolderError> {
    Ok(Lock::take(&folder.join(LOCK)).map(drop)?)
}

fn read_list(path: &Path) -> Result<BTreeSet<&'static str>, FolderError> {
    let at = || FileError::at(path, "reading");
    if !fs::symlink_metadata(path).map_err(at())?.is_file() {
        return Err(FolderError::InTheWay(path.to_owned()));
    }
    let mut bytes = Vec::new();
    File::open(path).and_then(|file| file.take(LONGEST).read_to_end(&mut bytes)).map_err(at())?;
    let text = String::from_utf8_lossy(&bytes);
    let wrong = |line: usize, expected, found: &str| {
        let found = found.chars().take(60).flat_map(char::escape_debug).collect();
        FolderError::List { file: path.to_owned(), line, expected, found }
    };
    let heading = text.lines().next().unwrap_or_default();
    if heading != HEADING {
        return Err(wrong(1, "the heading of a list of a run's files of this version", heading));
    }
    let known = |(i, line): (usize, &str)| {
        let structure = OBSERVABLES.iter().map(|observable| observable.file);
        let name = FILES.into_iter().chain(structure).find(|&name| name == line);
        name.ok_or_else(|| wrong(i + 1, "the name of a file of a run", line))
    };
    text.lines().enumerate().skip(1).map(known).collect()
}

impl RunFolder {
    /// Makes the folder if it is not there, and keeps everyone else out of it.
    ///
    /// # Errors
    /// If it holds anything but a run, or another process writes there.
    pub(super) fn open(path: &Path) -> Result<RunFolder, FolderError> {
        listed(path)?;
        fs::create_dir_all(path).map_err(FileError::at(path, "creating the folder"))?;
        let lock = Lock::take(&path.join(LOCK))?;
        // Once more, now that it stays so.
        let listed = listed(path)?;
        let folder = RunFolder { path: path.to_owned(), listed: listed.unwrap_or_default(), lock };
        folder.remove_leftovers()?;
        Ok(folder)
    }

    /// Whether it holds a run, or the beginnings of one.
    pub(super) fn is_run(&self) -> bool {
        !self.listed.is_empty()
    }

    /// Whether the file system keeps others out.
    pub(super) fn is_locked(&self) -> bool {
        self.lock.is_held()
    }

    /// Where a file of the folder is.
    pub(super) fn file(&self, name: &str) -> PathBuf {
        self.path.join(name)
    }

    /// The folder.
    pub(super) fn path(&self) -> &Path {
        &self.path
    }

    /// Removes the files of the run that was there; what it did not write stays. The checkpoints go first: without one,
    /// what is left is the beginning of a run.
    ///
    /// # Errors
    /// If the system does not let one be removed.
    pub(super) fn clear(&self) -> Result<(), FolderError> {
        let checkpoints = [PREVIOUS, CHECKPOINT];
        let (first, rest): (Vec<&str>, Vec<&str>) =
            self.listed.iter().filter(|&&name| name != LIST).partition(|name| checkpoints.contains(name));
        first.into_iter().rev().chain(rest).try_for_each(|name| self.remove_own(name))
    }

    /// Removes a file, if it is there and the run wrote it.
    ///
    /// # Errors
    /// If the system does not let it be removed.
    pub(super) fn remove_own(&self, name: &str) -> Result<(), FolderError> {
        match self.listed.contains(name) {
            true => Ok(remove_if_there(&self.file(name))?),
            false => Ok(()),
        }
    }

    /// Puts what every run writes and `more` on the list, which is on the disk when this returns.
    ///
    /// # Errors
    /// If a name not yet on the list is taken, or the system does not let the list be written.
    pub(super) fn claim(&mut self, more: &[&'static str]) -> Result<(), FolderError> {
        let wanted: Vec<&'static str> = ALWAYS.iter().chain(more).copied().collect();
        let new: Vec<&'static str> = wanted.into_iter().filter(|name| !self.listed.contains(name)).collect();
        for name in new.iter().filter(|&&name| name != LIST) {
            if fs::symlink_metadata(self.file(name)).is_ok() {
                return Err(FolderError::InTheWay(self.file(name)));
            }
        }
        if new.is_empty() {
            return Ok(());
        }
        self.listed.extend(new);
        let names = &self.listed;
        Ok(replace(&self.file(LIST), |out| {
            writeln!(out, "{HEADING}")?;
            names.iter().try_for_each(|name| writeln!(out, "{name}"))
        })?)
    }

    /// Puts a whole file of the run in its place.
    ///
    /// # Errors
    /// If the system does not let it be written.
    pub(super) fn write(
        &self,
        name: &str,
        write: impl FnOnce(&mut BufWriter<&File>) -> io::Result<()>,
    ) -> Result<(), FolderError> {
        Ok(replace(&self.file(name), write)?)
    }

    /// That what lets a run be gone on with is still there, the checkpoint where there should be one.
    ///
    /// # Errors
    /// If something else has removed a file meanwhile.
    pub(super) fn check(&self, has_checkpoint: bool) -> Result<(), FolderError> {
        let there = |name: &&str| fs::symlink_metadata(self.file(name)).is_ok_and(|there| there.is_file());
        let names = &[LIST, SCENE, CHECKPOINT][..if has_checkpoint { 3 } else { 2 }];
        let gone = names.iter().copied().find(|name| !there(name));
        let gone = gone.or_else(|| (!self.lock.is_there()).then_some(LOCK));
        match gone {
            None => Ok(()),
            Some(name) => {
                let cause = "it was removed or replaced while the run was under way";
                let cause = io::Error::new(ErrorKind::NotFound, cause);
                Err(FileError::at(&self.file(name), "looking for it")(cause).into())
            }
        }
    }

    /// What sessions that were killed left of their temporary files.
    fn remove_leftovers(&self) -> Result<(), FolderError> {
        let at = || FileError::at(&self.path, "reading the folder");
        for entry in fs::read_dir(&self.path).map_err(at())? {
            let entry = entry.map_err(at())?;
            let is_folder = entry.file_type().is_ok_and(|kind| kind.is_dir());
            if !is_folder && entry.file_name().to_str().is_some_and(is_temporary) {
                remove_if_there(&entry.path())?;
            }
        }
        Ok(())
    }
}
