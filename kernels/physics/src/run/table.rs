//! Reader of a run's table, row by row.

use crate::io::{FileError, regular_file};
use crate::method::is_sound;
use crate::quoted;
use crate::reported::{ErrorClass, FilePlace, Reported};
use std::fs::File;
use std::io::{BufRead, BufReader, Read};
use std::path::{Path, PathBuf};

/// Longest row of a run's table (bytes).
const LONGEST_ROW: u64 = 1 << 16;

/// Reason why a table cannot be read.
#[derive(Debug, thiserror::Error)]
pub enum TableError {
    /// The file is not the table of a run.
    #[error("{}:{line}: {expected}", quoted::path(file))]
    NoTable {
        /// Path of the file.
        file: PathBuf,
        /// Line, from 1.
        line: usize,
        /// Expected content.
        expected: &'static str,
    },
    /// The system refuses to read it.
    #[error(transparent)]
    File(#[from] FileError),
}

impl Reported for TableError {
    fn class(&self) -> ErrorClass {
        match self {
            TableError::NoTable { .. } => ErrorClass::Input,
            TableError::File(_) => ErrorClass::InputOutput,
        }
    }

    fn place(&self) -> Option<FilePlace> {
        match self {
            TableError::NoTable { file, line, .. } => {
                Some(FilePlace { line: Some(*line), ..FilePlace::at(file) })
            }
            TableError::File(error) => Some(FilePlace::at(&error.file)),
        }
    }
}

/// Open table: a heading with a column `time`, then finite numbers.
#[derive(Debug)]
pub struct TableReader {
    path: PathBuf,
    file: BufReader<File>,
    columns: Vec<String>,
    line: usize,
}

impl TableReader {
    /// Opens a table and reads its heading.
    ///
    /// # Errors
    /// If the system refuses to read it, or it is not the table of a run.
    pub fn open(path: &Path) -> Result<TableReader, TableError> {
        let file = regular_file::open(path).map_err(FileError::at(path, "reading"))?;
        let (path, file) = (path.to_owned(), BufReader::new(file));
        let mut table = TableReader { path, file, columns: vec![], line: 0 };
        let heading = table.next_line()?.unwrap_or_default();
        table.columns = heading.split(',').map(str::to_owned).collect();
        if !table.columns.iter().any(|column| column == "time") {
            return Err(table.wrong("expected the heading of a run's table, with a column `time`"));
        }
        Ok(table)
    }

    /// Names of the columns.
    pub fn columns(&self) -> &[String] {
        &self.columns
    }

    /// Reads the next row, a number for each column; none at the end.
    ///
    /// # Errors
    /// If the system refuses to read it, or it is not a row of numbers.
    pub fn next_row(&mut self) -> Result<Option<Vec<f64>>, TableError> {
        let Some(line) = self.next_line()? else { return Ok(None) };
        let row: Result<Vec<f64>, _> = line.split(',').map(str::parse).collect();
        let row = row.ok().filter(|row: &Vec<f64>| row.len() == self.columns.len());
        let is_whole =
            |row: &Vec<f64>| row.iter().zip(&self.columns).all(|(&value, column)| is_sound(column, value));
        let row = row.filter(is_whole);
        row.map(Some).ok_or_else(|| self.wrong("expected a finite number for each column"))
    }

    /// Error of a table without rows.
    pub fn without_rows(&self) -> TableError {
        let (file, line) = (self.path.clone(), 2);
        TableError::NoTable {
            file,
            line,
            expected: "expected a row of numbers; the run has written none yet",
        }
    }

    fn wrong(&self, expected: &'static str) -> TableError {
        TableError::NoTable { file: self.path.clone(), line: self.line.max(1), expected }
    }

    fn next_line(&mut self) -> Result<Option<String>, TableError> {
        let mut bytes = vec![];
        let read = self.file.by_ref().take(LONGEST_ROW).read_until(b'\n', &mut bytes);
        read.map_err(FileError::at(&self.path, "reading"))?;
        if bytes.is_empty() {
            return Ok(None);
        }
        self.line += 1;
        if bytes.len() as u64 == LONGEST_ROW {
            return Err(self.wrong("the line is longer than any row of a run's table"));
        }
        let text = String::from_utf8(bytes).map_err(|_| self.wrong("not UTF-8 text"))?;
        Ok(Some(text.trim_end_matches(['\n', '\r']).to_owned()))
    }
}
