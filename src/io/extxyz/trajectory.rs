//! A file of frames that grows with a run.

use super::error::{Mistakes, Reason};
use super::reader::RawFrames;
use super::{Frame, ReadError, write};
use crate::io::FileError;
use std::fs::{File, OpenOptions};
use std::io::{BufReader, BufWriter, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

/// A trajectory being written.
#[derive(Debug)]
pub struct Trajectory {
    path: PathBuf,
    out: BufWriter<File>,
}

/// Why a trajectory cannot be written or continued.
#[derive(Debug, thiserror::Error)]
pub enum TrajectoryError {
    /// The system would not let it be written.
    #[error(transparent)]
    File(#[from] FileError),
    /// What is there already is no trajectory.
    #[error(transparent)]
    Content(#[from] ReadError),
}

impl Trajectory {
    /// Begins an empty file; what was there is lost.
    ///
    /// # Errors
    /// If the system does not let it be written.
    pub fn create(path: impl Into<PathBuf>) -> Result<Self, FileError> {
        let path = path.into();
        let file = File::create(&path).map_err(FileError::at(&path, "creating the trajectory"))?;
        Ok(Trajectory { path, out: BufWriter::new(file) })
    }

    /// Goes on after the last frame of at most `step` steps; frames after it, and a torn one at the end, are
    /// cut off.
    ///
    /// # Errors
    /// If the file is not there, or a comment line in it cannot be understood.
    pub fn resume(path: impl Into<PathBuf>, step: u64) -> Result<Self, TrajectoryError> {
        let path = path.into();
        let file = OpenOptions::new()
            .read(true)
            .write(true)
            .open(&path)
            .map_err(FileError::at(&path, "opening the trajectory"))?;
        let end = end_of(&file, &path, step)?;
        let mut out = BufWriter::new(file);
        out.get_ref()
            .set_len(end)
            .and_then(|()| out.seek(SeekFrom::Start(end)))
            .map_err(FileError::at(&path, "cutting the trajectory"))?;
        Ok(Trajectory { path, out })
    }

    /// Adds a frame.
    ///
    /// # Errors
    /// If the system does not let it be written.
    pub fn append(&mut self, frame: &Frame) -> Result<(), FileError> {
        write(frame, &mut self.out).map_err(FileError::at(&self.path, "writing a frame"))
    }

    /// Returns when all frames are on the disk; to be called before a checkpoint.
    ///
    /// # Errors
    /// If the system does not let it be written.
    pub fn sync(&mut self) -> Result<(), FileError> {
        self.out
            .flush()
            .and_then(|()| self.out.get_ref().sync_data())
            .map_err(FileError::at(&self.path, "writing the trajectory"))
    }
}

/// The byte after the last whole frame of at most `step` steps.
fn end_of(file: &File, path: &Path, step: u64) -> Result<u64, ReadError> {
    let mut frames = RawFrames::new(BufReader::new(file));
    let mut end = 0;
    let of_file = |mistakes: Mistakes| mistakes.of_file(&path.display().to_string());
    loop {
        let frame = match frames.next_frame() {
            Ok(Some(frame)) => frame,
            Ok(None) => return Ok(end),
            Err(mistake) if matches!(mistake.reason, Reason::Truncated { .. }) => return Ok(end),
            Err(mistake) => return Err(of_file(mistake.into())),
        };
        if !frame.ended || frame.header().map_err(of_file)?.step > step {
            return Ok(end);
        }
        end = frame.end;
    }
}
