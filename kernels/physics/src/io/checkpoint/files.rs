//! Checkpoints in a folder: replaced atomically, with the previous one kept.

use super::error::{CheckpointError, CheckpointFault, OlderCheckpoint};
use super::{Checkpoint, WriteError, reading};
use crate::io::replace::{folder_of, remove_if_there, sync_folder, temporary, written_beside};
use crate::io::{FileError, regular_file};
use std::ffi::OsString;
use std::fs;
use std::io::{self, BufReader, ErrorKind};
use std::path::{Path, PathBuf};

/// Name of the newest checkpoint in a run's folder.
pub const NAME: &str = "run.checkpoint";

/// Newest checkpoint of a folder.
#[derive(Clone, Debug, PartialEq)]
pub struct LatestCheckpoint {
    /// Path of the file; the older one if the newest is missing.
    pub file: PathBuf,
    /// Content of the file.
    pub checkpoint: Checkpoint,
}

/// Path of the previous checkpoint: `NAME.previous`.
pub fn previous(path: &Path) -> PathBuf {
    let mut name = OsString::from(path);
    name.push(".previous");
    PathBuf::from(name)
}

/// Reads the newest checkpoint of a folder, if any. If the newest is missing, reads the previous one. If the newest is corrupt, returns an error:
/// the user decides.
///
/// # Errors
/// If it is corrupt or cannot be read; the error names the checkpoint that is left.
pub fn read_latest(folder: &Path) -> Result<Option<LatestCheckpoint>, CheckpointError> {
    let newest = folder.join(NAME);
    for file in [previous(&newest), newest.clone()].into_iter().rev() {
        match Checkpoint::read(&file) {
            Ok(checkpoint) => return Ok(Some(LatestCheckpoint { file, checkpoint })),
            Err(CheckpointError { fault: CheckpointFault::Io(cause), .. })
                if cause.kind() == ErrorKind::NotFound => {}
            Err(error) => return Err(error),
        }
    }
    Ok(None)
}

impl Checkpoint {
    /// Decodes the bytes of a checkpoint file.
    ///
    /// # Errors
    /// The fault, and its byte offset if known.
    pub fn decode(bytes: &[u8]) -> Result<Checkpoint, (Option<u64>, CheckpointFault)> {
        reading::decode(bytes, bytes.len() as u64)
    }

    /// Reads a checkpoint, exact to the bit.
    ///
    /// # Errors
    /// If it is truncated, changed in a single bit, longer than it states, of another version, or unreadable. The error names the checkpoint that
    /// is left.
    pub fn read(path: impl AsRef<Path>) -> Result<Checkpoint, CheckpointError> {
        let path = path.as_ref();
        read_one(path).map_err(|(offset, fault)| {
            let older = previous(path);
            let kept = match read_one(&older) {
                Ok(Checkpoint { step, .. }) => OlderCheckpoint::Whole { file: older, step },
                Err((_, CheckpointFault::Io(cause))) if cause.kind() == ErrorKind::NotFound => {
                    OlderCheckpoint::Nothing
                }
                Err(_) => OlderCheckpoint::Unusable { file: older },
            };
            CheckpointError { file: path.to_owned(), offset, fault, kept }
        })
    }

    /// Replaces the checkpoint at `path`, which is kept as [`previous`]. At every moment a valid checkpoint is on the disk, and on return it is the
    /// new one.
    ///
    /// # Errors
    /// If two columns have the same name, or the file cannot be written; then the one at `path` stays.
    pub fn write_atomically(&self, path: impl AsRef<Path>) -> Result<(), WriteError> {
        let path = path.as_ref();
        for (i, (name, _)) in self.columns.iter().enumerate() {
            if self.columns[..i].iter().any(|(other, _)| other == name) {
                return Err(WriteError::RepeatedColumn(name.clone()));
            }
        }
        let new = written_beside(path, |out| self.encode(out))
            .map_err(FileError::at(path, "writing the checkpoint"))?;
        keep(path).map_err(FileError::at(path, "keeping the checkpoint"))?;
        new.persist(path).map_err(|error| FileError::at(path, "replacing the checkpoint")(error.error))?;
        Ok(sync_folder(folder_of(path)).map_err(FileError::at(path, "replacing the checkpoint"))?)
    }
}

fn read_one(path: &Path) -> Result<Checkpoint, reading::LocatedFault> {
    let unreadable = |cause: io::Error| (None, CheckpointFault::Io(cause));
    let file = regular_file::open(path).map_err(unreadable)?;
    let length = file.metadata().map_err(unreadable)?.len();
    reading::decode(BufReader::new(file), length)
}

/// Gives the file at `path`, if any, the second name [`previous`], so that `path` always exists. Moves the file if the file system has no hard
/// links.
fn keep(path: &Path) -> io::Result<()> {
    let older = previous(path);
    match temporary(0o666).make_in(folder_of(path), |link| fs::hard_link(path, link)) {
        Ok(link) => {
            let link = link.into_temp_path();
            let name = link.to_path_buf();
            link.persist(&older).map_err(|error| error.error)?;
            // Renaming a file to another of its names does nothing.
            remove_if_there(&name).map_err(|error| error.cause)
        }
        Err(cause) if cause.kind() == ErrorKind::NotFound => Ok(()),
        Err(_) => fs::rename(path, &older),
    }
}
