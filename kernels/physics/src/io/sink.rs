//! Files that grow during a run: created, appended to, marked for a checkpoint, and resumed at a mark.

use super::FileError;
use super::growing_file::{FileMark, GrowingFile, GrowingFileError};
use super::run_moment::{RunHeader, RunMoment};
use std::io::{self, Write};
use std::marker::PhantomData;
use std::path::PathBuf;

/// Occasion for adding to a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum WriteOccasion {
    /// Every pause of a run to process events.
    Events,
    /// Rows of observables.
    Row,
    /// Frames, and the end of a run.
    Frame,
}

/// File that grows during a run.
pub trait Sink: Send + Sized + 'static {
    /// Occasion for adding to it.
    const DUE: WriteOccasion = WriteOccasion::Frame;

    /// Data of a moment.
    type Entry: Send + 'static;

    /// Creates a file.
    ///
    /// # Errors
    /// If the path exists, or the system refuses to write it.
    fn begin(path: PathBuf, header: &RunHeader) -> Result<Self, FileError>;

    /// Resumes at a mark without truncating yet. Appends unusual findings to `notes`.
    ///
    /// # Errors
    /// If the bytes before the mark have changed, the file is a link, or the system refuses to read or write it.
    fn resume(
        path: PathBuf,
        header: &RunHeader,
        mark: FileMark,
        notes: &mut Vec<String>,
    ) -> Result<Self, GrowingFileError>;

    /// Truncates a resumed file at its mark; to be called once it is certain that the run resumes.
    ///
    /// # Errors
    /// If the system refuses to truncate it.
    fn cut(&mut self) -> Result<(), FileError>;

    /// Returns the data to add for a moment, if any.
    fn entry(moment: &RunMoment<'_>) -> Option<Self::Entry>;

    /// Adds an entry. A separate thread writes entries of frames while the run continues.
    ///
    /// # Errors
    /// Errors of the file; also if another program has changed its length.
    fn write(&mut self, entry: Self::Entry) -> io::Result<()>;

    /// Syncs everything added to the disk and returns the mark.
    ///
    /// # Errors
    /// If the system refuses to write it, or the file has been removed, replaced or changed meanwhile.
    fn mark(&mut self) -> Result<FileMark, FileError>;
}

/// Content of a growing text file.
pub trait TextFormat: Send + 'static {
    /// Occasion, see [`Sink`].
    const DUE: WriteOccasion = WriteOccasion::Frame;

    /// Data of a moment, see [`Sink`].
    type Entry: Send + 'static;

    /// Returns the first line, if it names columns.
    fn heading(_header: &RunHeader) -> Option<String> {
        None
    }

    /// Data of a moment, see [`Sink`].
    fn entry(moment: &RunMoment<'_>) -> Option<Self::Entry>;

    /// Writes an entry, see [`Sink`].
    ///
    /// # Errors
    /// Errors of the file.
    fn write(entry: Self::Entry, out: &mut GrowingFile) -> io::Result<()>;
}

/// Growing text file.
#[derive(Debug)]
pub struct TextSink<T>(GrowingFile, PhantomData<T>);

impl<T: TextFormat> Sink for TextSink<T> {
    const DUE: WriteOccasion = T::DUE;

    type Entry = T::Entry;

    fn begin(path: PathBuf, header: &RunHeader) -> Result<Self, FileError> {
        let mut file = GrowingFile::create(path)?;
        if let Some(heading) = T::heading(header) {
            writeln!(file, "{heading}").map_err(FileError::at(file.path(), "writing"))?;
        }
        Ok(TextSink(file, PhantomData))
    }

    fn resume(
        path: PathBuf,
        header: &RunHeader,
        mark: FileMark,
        _notes: &mut Vec<String>,
    ) -> Result<Self, GrowingFileError> {
        let mut file = GrowingFile::resume(path, mark)?;
        if let Some(expected) = T::heading(header) {
            let found = file.first_line()?;
            if found != expected {
                return Err(GrowingFileError::Columns { file: file.path().to_owned(), found, expected });
            }
        }
        Ok(TextSink(file, PhantomData))
    }

    fn cut(&mut self) -> Result<(), FileError> {
        self.0.cut()
    }

    fn entry(moment: &RunMoment<'_>) -> Option<T::Entry> {
        T::entry(moment)
    }

    fn write(&mut self, entry: T::Entry) -> io::Result<()> {
        T::write(entry, &mut self.0)
    }

    fn mark(&mut self) -> Result<FileMark, FileError> {
        self.0.sync()
    }
}
