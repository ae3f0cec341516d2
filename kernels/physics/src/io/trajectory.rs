//! The frames of a run, whichever of its files has them.

use super::FORMATS;
use super::extxyz::Frame;
use std::fs;
use std::path::{Path, PathBuf};

/// Reader of a format.
pub enum FrameReading {
    /// Opens a file.
    Opens(fn(&Path) -> Result<FrameReader, TrajectoryError>),
    /// Frames are not read: they lack something.
    Lacks(&'static str),
    /// Frames are not read.
    Never,
}

/// Frames one after the other; ends after the first that is wrong.
pub(crate) type FrameReader = Box<dyn Iterator<Item = Result<Frame, TrajectoryError>> + Send>;

/// Returns frames of a format as those of a run.
pub(crate) fn reader<E: Into<TrajectoryError>>(
    frames: impl Iterator<Item = Result<Frame, E>> + Send + 'static,
) -> FrameReader {
    Box::new(frames.map(|frame| frame.map_err(Into::into)))
}

/// Error in the frames of a run.
#[derive(Debug, thiserror::Error)]
#[error("{words}")]
pub struct TrajectoryError {
    /// The file.
    pub file: PathBuf,
    /// The line of the first mistake, from 1, where the file has lines.
    pub line: Option<usize>,
    /// True where the system did not let the file be read.
    pub is_of_system: bool,
    /// The message, with file and place.
    pub words: String,
}

/// The frames of a run, one after the other; ends after the first that is wrong.
pub struct Trajectory {
    path: PathBuf,
    frames: FrameReader,
}

impl Trajectory {
    /// Opens the frames of the run in a folder: the first file of a format that is read again and that has any.
    ///
    /// # Errors
    /// If the system does not let them be read, or the file is none of its kind.
    pub fn open(folder: &Path) -> Result<Trajectory, TrajectoryError> {
        let opener = |reading: &FrameReading| match reading {
            FrameReading::Opens(open) => Some(*open),
            FrameReading::Lacks(_) | FrameReading::Never => None,
        };
        let files = FORMATS.iter().filter_map(|it| Some((folder.join(it.file), opener(&it.reading)?)));
        let files: Vec<_> = files.collect();
        let has_any = |path: &Path| fs::metadata(path).is_ok_and(|file| file.len() > 0);
        // Every run has the first of them.
        let found = files.iter().find(|(path, _)| has_any(path)).unwrap_or(&files[0]);
        Ok(Trajectory { frames: found.1(&found.0)?, path: found.0.clone() })
    }

    /// The file that has them.
    pub fn path(&self) -> &Path {
        &self.path
    }
}

impl Iterator for Trajectory {
    type Item = Result<Frame, TrajectoryError>;

    fn next(&mut self) -> Option<Self::Item> {
        self.frames.next()
    }
}
