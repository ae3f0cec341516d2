//! Start files of scenes.

use crate::io::extxyz::{FrameChoice, ParticleFrame, XyzReadError, read};
use std::path::{Path, PathBuf};
use std::sync::{Arc, OnceLock};

/// Path and last frame of a start file, shared by all runs of a scene and filled by the first.
pub(super) type SharedFrame = Arc<OnceLock<(PathBuf, ParticleFrame)>>;

/// Start file, read once by the runs that share it.
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

    /// Path of the file.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Returns the last frame, as the first of the runs that share it has read it.
    ///
    /// # Errors
    /// [`XyzReadError`] if the file cannot be read or has no frame.
    pub(crate) fn last_frame(&self) -> Result<ParticleFrame, XyzReadError> {
        let known = self.shared.as_ref().and_then(|shared| shared.get());
        if let Some((_, frame)) = known.filter(|(path, _)| *path == self.path) {
            return Ok(frame.clone());
        }
        let frame = read(&self.path, FrameChoice::Last)?;
        if let Some(shared) = &self.shared {
            #[expect(clippy::let_underscore_must_use, reason = "another thread has read the same meanwhile")]
            let _ = shared.set((self.path.clone(), frame.clone()));
        }
        Ok(frame)
    }
}
