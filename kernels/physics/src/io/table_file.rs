//! A table in CSV that grows with a run, a row for a step.

use super::FileError;
use super::growing_file::{GrowingFile, GrowingFileError, Mark};
use crate::quoted;
use std::io::Write;
use std::path::PathBuf;

/// A table being written: the column `step`, then numbers.
#[derive(Debug)]
pub struct TableFile {
    file: GrowingFile,
    columns: usize,
}

/// Why a table cannot be written or continued.
#[derive(Debug, thiserror::Error)]
pub enum TableFileError {
    /// The system would not let it be written.
    #[error(transparent)]
    File(#[from] FileError),
    /// What is there is not what was written.
    #[error(transparent)]
    Content(#[from] GrowingFileError),
    /// What is there already has other columns.
    #[error("{}:1: the columns are `{found}`; this run writes `{expected}`", quoted::path(file))]
    Columns {
        /// The file.
        file: PathBuf,
        /// Its header.
        found: String,
        /// The header of this run.
        expected: String,
    },
    /// A row with more or fewer numbers than columns.
    #[error("{}: a row of {found} numbers for {expected} columns after `step`", quoted::path(file))]
    Width {
        /// The file.
        file: PathBuf,
        /// Numbers given.
        found: usize,
        /// Numbers wanted.
        expected: usize,
    },
}

impl TableFileError {
    /// Whether the content is at fault, not the system that should have read or written it.
    pub fn is_damage(&self) -> bool {
        match self {
            TableFileError::Content(error) => error.is_damage(),
            TableFileError::Columns { .. } => true,
            TableFileError::File(_) | TableFileError::Width { .. } => false,
        }
    }
}

impl TableFile {
    /// Begins a table with its header where nothing is. `columns` are those after `step`.
    ///
    /// # Errors
    /// If something is there already, or the system does not let it be written.
    pub fn create(path: impl Into<PathBuf>, columns: &[&str]) -> Result<Self, FileError> {
        let mut file = GrowingFile::create(path)?;
        let written = writeln!(file, "{}", header(columns));
        written.map_err(FileError::at(file.path(), "writing"))?;
        Ok(TableFile { file, columns: columns.len() })
    }

    /// Goes on at a mark; rows after it are cut off by [`cut`](Self::cut).
    ///
    /// # Errors
    /// If what was there at the mark is not there any more, or the table has other columns.
    pub fn resume(path: impl Into<PathBuf>, columns: &[&str], mark: Mark) -> Result<Self, TableFileError> {
        let mut file = GrowingFile::resume(path, mark)?;
        let (found, expected) = (file.first_line()?, header(columns));
        if found != expected {
            return Err(TableFileError::Columns { file: file.path().to_owned(), found, expected });
        }
        Ok(TableFile { file, columns: columns.len() })
    }

    /// As [`GrowingFile::cut`].
    ///
    /// # Errors
    /// If the system does not let it be cut.
    pub fn cut(&mut self) -> Result<(), FileError> {
        self.file.cut()
    }

    /// Adds a row, numbers in the shortest form that reads back to the same bits.
    ///
    /// # Errors
    /// If there are more or fewer numbers than columns, or the system does not let it be written.
    pub fn append(&mut self, step: u64, numbers: &[f64]) -> Result<(), TableFileError> {
        if numbers.len() != self.columns {
            let (file, found, expected) = (self.file.path().to_owned(), numbers.len(), self.columns);
            return Err(TableFileError::Width { file, found, expected });
        }
        let mut row = step.to_string();
        for number in numbers {
            row.push_str(&format!(",{number:?}"));
        }
        row.push('\n');
        let written = self.file.write_all(row.as_bytes());
        Ok(written.map_err(FileError::at(self.file.path(), "writing a row"))?)
    }

    /// As [`GrowingFile::sync`].
    ///
    /// # Errors
    /// If the system does not let it be written, or the file has been removed, replaced or changed meanwhile.
    pub fn sync(&mut self) -> Result<Mark, FileError> {
        self.file.sync()
    }
}

fn header(columns: &[&str]) -> String {
    std::iter::once("step").chain(columns.iter().copied()).collect::<Vec<_>>().join(",")
}
