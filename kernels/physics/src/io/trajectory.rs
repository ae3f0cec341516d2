//! Frames of a run, from any of its files that has them.

use super::FORMATS;
use super::extxyz::ParticleFrame;
use std::fs;
use std::path::{Path, PathBuf};

/// Reader of a format.
pub enum FrameReading {
    /// Opens a file.
    Opens(fn(&Path) -> Result<FrameReader, TrajectoryError>),
    /// Frames cannot be read: they lack this property.
    Lacks(&'static str),
    /// Frames cannot be read.
    Never,
}

/// Iterator over frames; ends after the first wrong one.
pub(crate) type FrameReader = Box<dyn Iterator<Item = Result<ParticleFrame, TrajectoryError>> + Send>;

/// Converts an iterator over frames of a format.
pub(crate) fn reader<E: Into<TrajectoryError>>(
    frames: impl Iterator<Item = Result<ParticleFrame, E>> + Send + 'static,
) -> FrameReader {
    Box::new(frames.map(|frame| frame.map_err(Into::into)))
}

/// Error in the frames of a run.
#[derive(Debug, thiserror::Error)]
#[error("{words}")]
pub struct TrajectoryError {
    /// Path of the file.
    pub file: PathBuf,
    /// Line of the first mistake, from 1, if the file has lines.
    pub line: Option<usize>,
    /// True if the system refused to read the file.
    pub is_of_system: bool,
    /// Message with file and location.
    pub words: String,
}

/// Iterator over the frames of a run; ends after the first wrong one.
pub struct Trajectory {
    path: PathBuf,
    frames: FrameReader,
}

impl Trajectory {
    /// Opens the frames of the run in a folder: the first file of a readable format that is not empty.
    ///
    /// # Errors
    /// If the system refuses to read them, or the file has another format.
    pub fn open(folder: &Path) -> Result<Trajectory, TrajectoryError> {
        let opener = |reading: &FrameReading| match reading {
            FrameReading::Opens(open) => Some(*open),
            FrameReading::Lacks(_) | FrameReading::Never => None,
        };
        let files = FORMATS.iter().filter_map(|it| Some((folder.join(it.file), opener(&it.reading)?)));
        let files: Vec<_> = files.collect();
        let has_any = |path: &Path| fs::metadata(path).is_ok_and(|file| file.len() > 0);
        // Every run has the first file.
        let found = files.iter().find(|(path, _)| has_any(path)).unwrap_or(&files[0]);
        Ok(Trajectory { frames: found.1(&found.0)?, path: found.0.clone() })
    }

    /// Path of the file with the frames.
    pub fn path(&self) -> &Path {
        &self.path
    }
}

impl Iterator for Trajectory {
    type Item = Result<ParticleFrame, TrajectoryError>;

    fn next(&mut self) -> Option<Self::Item> {
        self.frames.next()
    }
}
