//! A folder for the results of a run that nobody has asked to keep.

use std::io;
use std::path::Path;
use std::process;
use tempfile::TempDir;

/// A folder that goes when the last who uses it goes, in the process that made it.
pub(crate) struct Scratch {
    folder: Option<TempDir>,
    owner: u32,
}

impl Scratch {
    /// A new one, where the system keeps such folders.
    ///
    /// # Errors
    /// If the system does not let it be made.
    pub(crate) fn new() -> io::Result<Scratch> {
        let folder = tempfile::Builder::new().prefix("stripmine-").tempdir()?;
        Ok(Scratch { folder: Some(folder), owner: process::id() })
    }

    /// Where it is.
    pub(crate) fn path(&self) -> &Path {
        self.folder.as_ref().map_or(Path::new(""), TempDir::path)
    }
}

impl Drop for Scratch {
    /// A process that was forked off leaves it to the one that made it.
    fn drop(&mut self) {
        if self.owner != process::id()
            && let Some(folder) = self.folder.take()
        {
            let _kept = folder.keep();
        }
    }
}
