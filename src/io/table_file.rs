//! A table in CSV that grows with a run, a row for a step.

use super::FileError;
use std::fs::{File, OpenOptions};
use std::io::{BufRead, BufReader, BufWriter, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

/// A table being written: the column `step`, then numbers.
#[derive(Debug)]
pub struct TableFile {
    path: PathBuf,
    out: BufWriter<File>,
    columns: usize,
}

/// Why a table cannot be written or continued.
#[derive(Debug, thiserror::Error)]
pub enum TableFileError {
    /// The system would not let it be written.
    #[error(transparent)]
    File(#[from] FileError),
    /// What is there already has other columns.
    #[error("{}:1: the columns are `{found}`; this run writes `{expected}`", file.display())]
    Columns {
        /// The file.
        file: PathBuf,
        /// Its header.
        found: String,
        /// The header of this run.
        expected: String,
    },
    /// A row that does not begin with a step.
    #[error(
        "{}:{line}: expected a row of {columns} that begins with a step, found `{found}`",
        file.display()
    )]
    Row {
        /// The file.
        file: PathBuf,
        /// Line, from 1.
        line: usize,
        /// How many columns a row has.
        columns: usize,
        /// What stands there.
        found: String,
    },
    /// A row with more or fewer numbers than columns.
    #[error("{}: a row of {found} numbers for {expected} columns after `step`", file.display())]
    Width {
        /// The file.
        file: PathBuf,
        /// Numbers given.
        found: usize,
        /// Numbers wanted.
        expected: usize,
    },
}

impl TableFile {
    /// Begins a table with its header; what was there is lost. `columns` are those after `step`.
    ///
    /// # Errors
    /// If the system does not let it be written.
    pub fn create(path: impl Into<PathBuf>, columns: &[&str]) -> Result<Self, FileError> {
        let path = path.into();
        let file = File::create(&path).map_err(FileError::at(&path, "creating the table"))?;
        let mut out = BufWriter::new(file);
        writeln!(out, "{}", header(columns)).map_err(FileError::at(&path, "writing the table"))?;
        Ok(TableFile { path, out, columns: columns.len() })
    }

    /// Goes on after the last row of at most `step`; rows after it, and a torn one at the end, are cut off.
    ///
    /// # Errors
    /// If the file is not there, has other columns, or has a row that does not begin with a step.
    pub fn resume(path: impl Into<PathBuf>, columns: &[&str], step: u64) -> Result<Self, TableFileError> {
        let path = path.into();
        let file = OpenOptions::new()
            .read(true)
            .write(true)
            .open(&path)
            .map_err(FileError::at(&path, "opening the table"))?;
        let end = end_of(&file, &path, columns, step)?;
        let mut out = BufWriter::new(file);
        out.get_ref()
            .set_len(end)
            .and_then(|()| out.seek(SeekFrom::Start(end)))
            .map_err(FileError::at(&path, "cutting the table"))?;
        Ok(TableFile { path, out, columns: columns.len() })
    }

    /// Adds a row, numbers in the shortest form that reads back to the same bits.
    ///
    /// # Errors
    /// If there are more or fewer numbers than columns, or the system does not let it be written.
    pub fn append(&mut self, step: u64, numbers: &[f64]) -> Result<(), TableFileError> {
        if numbers.len() != self.columns {
            let (file, found, expected) = (self.path.clone(), numbers.len(), self.columns);
            return Err(TableFileError::Width { file, found, expected });
        }
        let mut row = step.to_string();
        for number in numbers {
            row.push_str(&format!(",{number:?}"));
        }
        row.push('\n');
        Ok(self.out.write_all(row.as_bytes()).map_err(FileError::at(&self.path, "writing a row"))?)
    }

    /// Returns when all rows are on the disk; to be called before a checkpoint.
    ///
    /// # Errors
    /// If the system does not let it be written.
    pub fn sync(&mut self) -> Result<(), FileError> {
        self.out
            .flush()
            .and_then(|()| self.out.get_ref().sync_data())
            .map_err(FileError::at(&self.path, "writing the table"))
    }
}

fn header(columns: &[&str]) -> String {
    std::iter::once("step").chain(columns.iter().copied()).collect::<Vec<_>>().join(",")
}

/// The byte after the last whole row of at most `step`.
fn end_of(file: &File, path: &Path, columns: &[&str], step: u64) -> Result<u64, TableFileError> {
    let mut reader = BufReader::new(file);
    let mut line = Vec::new();
    let mut end = 0;
    for number in 1.. {
        line.clear();
        let bytes = reader.read_until(b'\n', &mut line).map_err(FileError::at(path, "reading the table"))?;
        let whole = line.ends_with(b"\n");
        let text = String::from_utf8_lossy(&line);
        let text = text.trim_end_matches(['\n', '\r']);
        if number == 1 {
            let expected = header(columns);
            if !whole || text != expected {
                return Err(TableFileError::Columns {
                    file: path.to_owned(),
                    found: text.to_owned(),
                    expected,
                });
            }
        } else if !whole {
            // The end of the file, or a row that was being written.
            break;
        } else {
            let first = text.split(',').next().and_then(|field| field.parse::<u64>().ok());
            match first.filter(|_| text.split(',').count() == columns.len() + 1) {
                Some(found) if found <= step => {}
                Some(_) => break,
                None => {
                    let (file, found) = (path.to_owned(), text.chars().take(80).collect());
                    return Err(TableFileError::Row {
                        file,
                        line: number,
                        columns: columns.len() + 1,
                        found,
                    });
                }
            }
        }
        end += bytes as u64;
    }
    Ok(end)
}
