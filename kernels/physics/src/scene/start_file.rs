//! The file that discs at the start are read from.

use crate::io::extxyz::{Frame, ReadError, Which, read};
use std::path::{Path, PathBuf};
use std::sync::{Arc, OnceLock};

/// The last frame of a start file with the path that it is from, for all runs of a scene; filled by the first.
pub(super) type SharedFrame = Arc<OnceLock<(PathBuf, Frame)>>;

/// A start file, which runs that share it read once.
#[derive(Clone, Debug, Default)]
pub struct StartFile {
    path: PathBuf,
    shared: Option<SharedFrame>,
}

impl PartialEq for StartFile {
    fn eq(&self, other: &StartFile) -> bool {
        self.path == other.path
    }
}

impl StartFile {
    pub(super) fn new(path: PathBuf, shared: Option<SharedFrame>) -> StartFile {
        StartFile { path, shared }
    }

    /// Its path.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Its last frame, as it was when the first of the runs that share it read it.
    ///
    /// # Errors
    /// [`ReadError`], where it cannot be read or holds no frame.
    pub(crate) fn last_frame(&self) -> Result<Frame, ReadError> {
        let known = self.shared.as_ref().and_then(|shared| shared.get());
        if let Some((_, frame)) = known.filter(|(path, _)| *path == self.path) {
            return Ok(frame.clone());
        }
        let frame = read(&self.path, Which::Last)?;
        if let Some(shared) = &self.shared {
            #[expect(clippy::let_underscore_must_use, reason = "another thread has read the same meanwhile")]
            let _ = shared.set((self.path.clone(), frame.clone()));
        }
        Ok(frame)
    }
}
