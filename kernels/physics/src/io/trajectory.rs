//! The frames of a run, whichever of its files has them.

use super::{extxyz, gsd};
use std::fs::{self, File};
use std::io::{self, BufReader};
use std::path::{Path, PathBuf};

/// The file of frames that every run has, empty where they are not asked for.
pub const TEXT: &str = "trajectory.xyz";
/// The one with an index, on request.
pub const INDEXED: &str = "trajectory.gsd";

/// The frames of a run, one after the other; ends after the first that is wrong.
pub struct Trajectory {
    path: PathBuf,
    frames: Frames,
}

enum Frames {
    Text(extxyz::Frames<BufReader<File>>),
    Indexed(gsd::Frames),
}

/// Why frames of a run cannot be read.
#[derive(Debug, thiserror::Error)]
pub enum TrajectoryError {
    /// Extended XYZ.
    #[error(transparent)]
    Text(#[from] extxyz::ReadError),
    /// GSD.
    #[error(transparent)]
    Indexed(#[from] gsd::ReadError),
}

impl TrajectoryError {
    /// What the system said, if the file could not be read at all: a matter of input and output, not of content.
    pub fn system(&self) -> Option<&io::Error> {
        match self {
            TrajectoryError::Text(error) => error.system(),
            TrajectoryError::Indexed(error) => error.system(),
        }
    }

    /// The file.
    pub fn file(&self) -> &Path {
        match self {
            TrajectoryError::Text(error) => error.file.as_ref(),
            TrajectoryError::Indexed(error) => &error.file,
        }
    }

    /// The line of the first mistake, from 1, where the file has lines.
    pub fn line(&self) -> Option<usize> {
        match self {
            TrajectoryError::Text(error) => error.mistakes.first()?.line,
            TrajectoryError::Indexed(_) => None,
        }
    }
}

impl Trajectory {
    /// Opens the frames of the run in a folder: those of its text or, where that has none, those of GSD.
    ///
    /// # Errors
    /// If the system does not let them be read, or the file is none of its kind.
    pub fn open(folder: &Path) -> Result<Trajectory, TrajectoryError> {
        let [text, indexed] = [TEXT, INDEXED].map(|name| folder.join(name));
        let has_text = fs::metadata(&text).is_ok_and(|text| text.len() > 0);
        Ok(match !has_text && indexed.exists() {
            true => Trajectory { frames: Frames::Indexed(gsd::Frames::open(&indexed)?), path: indexed },
            false => Trajectory { frames: Frames::Text(extxyz::Frames::open(&text)?.in_space()), path: text },
        })
    }

    /// The file that has them.
    pub fn path(&self) -> &Path {
        &self.path
    }
}

impl Iterator for Trajectory {
    type Item = Result<extxyz::Frame, TrajectoryError>;

    fn next(&mut self) -> Option<Self::Item> {
        Some(match &mut self.frames {
            Frames::Text(frames) => frames.next()?.map_err(TrajectoryError::Text),
            Frames::Indexed(frames) => frames.next()?.map_err(TrajectoryError::Indexed),
        })
    }
}
