//! Temporary folders for the results of runs.

use std::io;
use std::path::Path;
use std::process;
use tempfile::TempDir;

/// Temporary folder, removed with its last user in the process that made it.
pub(crate) struct Scratch {
    folder: Option<TempDir>,
    owner: u32,
}

impl Scratch {
    /// Makes one in the system's folder for temporary files.
    ///
    /// # Errors
    /// If it cannot be made.
    pub(crate) fn new() -> io::Result<Scratch> {
        let folder = tempfile::Builder::new().prefix("stripmine-").tempdir()?;
        Ok(Scratch { folder: Some(folder), owner: process::id() })
    }

    /// Path of the folder.
    pub(crate) fn path(&self) -> &Path {
        self.folder.as_ref().map_or(Path::new(""), TempDir::path)
    }
}

impl Drop for Scratch {
    /// A forked process leaves the folder to its parent.
    fn drop(&mut self) {
        if self.owner != process::id()
            && let Some(folder) = self.folder.take()
        {
            let _kept = folder.keep();
        }
    }
}
