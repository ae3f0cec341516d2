//! A file of frames that grows with a run, no frame twice.

use crate::io::FileError;
use crate::io::extxyz::Frame;
use crate::io::growing_file::{GrowingFile, GrowingFileError, Mark};
use std::io;
use std::path::PathBuf;

/// The file, and how a frame is written into it.
#[derive(Debug)]
pub(super) struct Frames {
    file: GrowingFile,
    write: fn(&Frame, &mut GrowingFile) -> io::Result<()>,
    /// Step of the last frame.
    last: Option<u64>,
}

impl Frames {
    /// Begins an empty file where nothing is.
    ///
    /// # Errors
    /// If something is there, or the system does not let it be written.
    pub(super) fn create(
        path: PathBuf,
        write: fn(&Frame, &mut GrowingFile) -> io::Result<()>,
    ) -> Result<Frames, FileError> {
        Ok(Frames { file: GrowingFile::create(path)?, write, last: None })
    }

    /// Goes on at a mark, where the last frame was that of step `last`.
    ///
    /// # Errors
    /// If what was there at the mark is not there any more.
    pub(super) fn resume(
        path: PathBuf,
        write: fn(&Frame, &mut GrowingFile) -> io::Result<()>,
        mark: Mark,
        last: Option<u64>,
    ) -> Result<Frames, GrowingFileError> {
        Ok(Frames { file: GrowingFile::resume(path, mark)?, write, last })
    }

    /// As [`GrowingFile::cut`].
    ///
    /// # Errors
    /// If the system does not let it be cut.
    pub(super) fn cut(&mut self) -> Result<(), FileError> {
        self.file.cut()
    }

    /// Adds a frame, unless the last one is of that step already.
    ///
    /// # Errors
    /// If the system does not let it be written.
    pub(super) fn add(&mut self, frame: &Frame) -> Result<(), FileError> {
        if self.last == Some(frame.step) {
            return Ok(());
        }
        (self.write)(frame, &mut self.file).map_err(FileError::at(self.file.path(), "writing a frame"))?;
        self.last = Some(frame.step);
        Ok(())
    }

    /// As [`GrowingFile::sync`], with the step of the last frame.
    ///
    /// # Errors
    /// If the system does not let it be written, or the file has been removed, replaced or changed meanwhile.
    pub(super) fn sync(&mut self) -> Result<(Mark, Option<u64>), FileError> {
        Ok((self.file.sync()?, self.last))
    }
}
