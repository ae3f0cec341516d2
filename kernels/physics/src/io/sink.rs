//! A file that grows with a run: begun, added to at its moments, marked for a checkpoint, resumed at a mark.

use super::FileError;
use super::growing_file::{GrowingFile, GrowingFileError, Mark};
use super::run_moment::{RunHeader, RunMoment};
use std::io::{self, Write};
use std::marker::PhantomData;
use std::path::PathBuf;

/// When something is added to a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Due {
    /// Whenever a run pauses to see what has happened.
    Events,
    /// When a row of observables is due.
    Row,
    /// When a frame is due, and at the end.
    Frame,
}

/// A file that grows with a run.
pub trait Sink: Send + Sized + 'static {
    /// When something is added.
    const DUE: Due = Due::Frame;

    /// Data of a moment, written when its turn comes.
    type Entry: Send + 'static;

    /// Begins a file where nothing is.
    ///
    /// # Errors
    /// If something is there already, or the system does not let it be written.
    fn begin(path: PathBuf, header: &RunHeader) -> Result<Self, FileError>;

    /// Goes on at a mark; nothing is cut yet. `notes` take up what is out of the ordinary.
    ///
    /// # Errors
    /// If what was there at the mark is not there any more, the file is a link, or the system does not let it be read and written.
    fn resume(
        path: PathBuf,
        header: &RunHeader,
        mark: Mark,
        notes: &mut Vec<String>,
    ) -> Result<Self, GrowingFileError>;

    /// Cuts off what a resumed file has after its mark; to be called once it is certain that the run goes on.
    ///
    /// # Errors
    /// If the system does not let it be cut.
    fn cut(&mut self) -> Result<(), FileError>;

    /// Returns what is added of a moment; none where there is nothing to add.
    fn entry(moment: &RunMoment<'_>) -> Option<Self::Entry>;

    /// Adds an entry. Those of frames are written by a thread of their own while the run goes on.
    ///
    /// # Errors
    /// Those of the file; also if something else has cut or lengthened it.
    fn write(&mut self, entry: Self::Entry) -> io::Result<()>;

    /// Returns when all that was added is on the disk, and says how far that is.
    ///
    /// # Errors
    /// If the system does not let it be written, or the file has been removed, replaced or changed meanwhile.
    fn mark(&mut self) -> Result<Mark, FileError>;
}

/// Content of a text file that grows.
pub trait TextFormat: Send + 'static {
    /// As of [`Sink`].
    const DUE: Due = Due::Frame;

    /// As of [`Sink`].
    type Entry: Send + 'static;

    /// Returns the first line, where one names the columns.
    fn heading(_header: &RunHeader) -> Option<String> {
        None
    }

    /// As of [`Sink`].
    fn entry(moment: &RunMoment<'_>) -> Option<Self::Entry>;

    /// As of [`Sink`].
    ///
    /// # Errors
    /// Those of the file.
    fn write(entry: Self::Entry, out: &mut GrowingFile) -> io::Result<()>;
}

/// A file of text.
#[derive(Debug)]
pub struct TextSink<T>(GrowingFile, PhantomData<T>);

impl<T: TextFormat> Sink for TextSink<T> {
    const DUE: Due = T::DUE;

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
        mark: Mark,
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

    fn mark(&mut self) -> Result<Mark, FileError> {
        self.0.sync()
    }
}
