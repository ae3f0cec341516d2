//! How fast the program was: measurements of `bench --record`, a line each in a file that grows.

pub mod section;

use crate::provenance::{Machine, built};
use serde::{Deserialize, Serialize};
use serde_json::{Map, Value};
use std::fs::{File, OpenOptions};
use std::io::{self, ErrorKind, Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};
use stripmine_physics::io::{FileError, regular_file};
use stripmine_physics::method::throughput::Throughput;
use stripmine_physics::origin::{Origin, today};
use stripmine_physics::quoted;
use stripmine_physics::reported::{Class, FilePlace, Reported};

/// The records that come with the program: the benches of `reproduce --all` over time.
const SHIPPED: &str = include_str!("measured.jsonl");
/// Longer than any file of records (bytes).
const LONGEST: u64 = 1 << 28;

/// A measurement.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Record {
    /// The day, in universal time, as year-month-day.
    pub date: String,
    /// The program.
    pub origin: Origin,
    /// The whole command line.
    pub command: String,
    /// Where.
    pub machine: Machine,
    /// What was measured.
    pub what: String,
    /// Particles.
    pub particles: usize,
    /// How: precision, integrator and the like.
    pub settings: Map<String, Value>,
    /// Threads.
    pub threads: usize,
    /// The name of the rate.
    pub rate_name: String,
    /// The best, the median and the worst of the repeats (1/s).
    pub rates: [f64; 3],
    /// Repeats.
    pub repeats: usize,
    /// CRC-32 of the final state.
    pub checksum: String,
}

impl Record {
    /// Of a measurement that `command` has just made here.
    pub fn of(result: &Throughput, command: &str) -> Record {
        Record {
            date: today(),
            origin: built(),
            command: command.to_owned(),
            machine: Machine::here(),
            what: result.what.to_owned(),
            particles: result.particles,
            settings: result.settings.clone(),
            threads: result.threads,
            rate_name: result.rate_name.to_owned(),
            rates: [result.rate, result.median_rate, result.lowest_rate],
            repeats: result.repeats,
            checksum: result.checksum.clone(),
        }
    }

    /// What is compared over time: the bench, its size and its settings but those that say how fast the machine is.
    pub fn case(&self) -> String {
        let word = |name: &str| self.settings.get(name).and_then(Value::as_str).map(str::to_owned);
        let parts = [Some(self.what.clone()), Some(self.particles.to_string()), word("precision")];
        parts.into_iter().flatten().collect::<Vec<_>>().join(" ")
    }
}

/// Why there are no records.
#[derive(Debug, thiserror::Error)]
pub enum HistoryError {
    /// A line that `bench --record` did not write.
    #[error(
        "{}, line {line}: no measurement of `bench --record`: {cause}; remove the line, or name another file",
        quoted::path(file)
    )]
    Line {
        /// The file.
        file: PathBuf,
        /// The line, from 1 on.
        line: usize,
        /// Why.
        cause: serde_json::Error,
    },
    /// No line.
    #[error("{} holds no measurement: `stripmine bench lattice --record {}` writes one", quoted::path(.0), quoted::path(.0))]
    Empty(PathBuf),
    /// The system.
    #[error(transparent)]
    File(#[from] FileError),
}

impl Reported for HistoryError {
    fn class(&self) -> Class {
        match self {
            HistoryError::Line { .. } | HistoryError::Empty(_) => Class::Input,
            HistoryError::File(_) => Class::InputOutput,
        }
    }

    fn place(&self) -> Option<FilePlace> {
        match self {
            HistoryError::Line { file, .. } | HistoryError::Empty(file) => Some(FilePlace::at(file)),
            HistoryError::File(error) => Some(FilePlace::at(&error.file)),
        }
    }
}

/// The measurements of a file, in its order.
///
/// # Errors
/// [`HistoryError`] if it cannot be read or holds something else.
pub fn read(file: &Path) -> Result<Vec<Record>, HistoryError> {
    let bytes = regular_file::read(file, LONGEST).map_err(FileError::at(file, "reading"))?;
    let records = parsed(&String::from_utf8_lossy(&bytes), file)?;
    if records.is_empty() { Err(HistoryError::Empty(file.to_owned())) } else { Ok(records) }
}

/// The measurements that come with the program.
///
/// # Errors
/// [`HistoryError`] if one was changed by hand.
pub fn shipped() -> Result<Vec<Record>, HistoryError> {
    parsed(SHIPPED, Path::new("measured.jsonl"))
}

fn parsed(text: &str, file: &Path) -> Result<Vec<Record>, HistoryError> {
    let lines = text.lines().zip(1..).filter(|(line, _)| !line.trim().is_empty());
    let read = |(text, line): (&str, usize)| {
        serde_json::from_str(text).map_err(|cause| HistoryError::Line { file: file.to_owned(), line, cause })
    };
    lines.map(read).collect()
}

/// Whether a file can take records: it is not there, is empty, or holds records only.
///
/// # Errors
/// [`HistoryError`] if it cannot.
pub fn admits(file: &Path) -> Result<(), HistoryError> {
    match read(file) {
        Err(HistoryError::File(error)) if error.cause.kind() == ErrorKind::NotFound => Ok(()),
        Err(HistoryError::Empty(_)) | Ok(_) => Ok(()),
        Err(error) => Err(error),
    }
}

/// Adds a measurement to a file, which is made if it is not there. A last line without an end is ended first.
///
/// # Errors
/// [`HistoryError`] if the system does not let it be written.
pub fn append(file: &Path, record: &Record) -> Result<(), HistoryError> {
    let at = || FileError::at(file, "writing");
    let mut text = serde_json::to_string(record).map_err(|cause| at()(cause.into()))? + "\n";
    let mut out = OpenOptions::new().create(true).read(true).append(true).open(file).map_err(at())?;
    if !ends_a_line(&mut out).map_err(at())? {
        text.insert(0, '\n');
    }
    // In one piece: several programs may write at once.
    out.write_all(text.as_bytes()).and_then(|()| out.sync_all()).map_err(at())?;
    Ok(())
}

/// Whether a file is empty or its last line has an end.
fn ends_a_line(file: &mut File) -> io::Result<bool> {
    if file.metadata()?.len() == 0 {
        return Ok(true);
    }
    let mut last = [0];
    file.seek(SeekFrom::End(-1))?;
    file.read_exact(&mut last)?;
    Ok(last == *b"\n")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn record(rate: f64) -> Record {
        Record {
            date: "2026-11-25".into(),
            origin: built(),
            command: "stripmine bench lattice".into(),
            machine: Machine::here(),
            what: "lattice".into(),
            particles: 1000,
            settings: Map::from_iter([("precision".to_owned(), Value::from("f64"))]),
            threads: 1,
            rate_name: "particle_steps_per_second".into(),
            rates: [rate; 3],
            repeats: 1,
            checksum: "00".into(),
        }
    }

    #[test]
    fn what_is_recorded_is_read_again_and_nothing_else() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("rates.jsonl");
        assert!(admits(&file).is_ok());
        for rate in [1.5, 2.5] {
            append(&file, &record(rate)).unwrap();
        }
        assert_eq!(read(&file).unwrap(), [record(1.5), record(2.5)]);
        assert_eq!(record(1.0).case(), "lattice 1000 f64");
        // A last line without its end, as editors leave it.
        let text = std::fs::read_to_string(&file).unwrap();
        std::fs::write(&file, text.trim_end()).unwrap();
        append(&file, &record(3.5)).unwrap();
        assert_eq!(read(&file).unwrap(), [record(1.5), record(2.5), record(3.5)]);
        std::fs::write(&file, "{}\n").unwrap();
        let error = admits(&file).unwrap_err();
        assert!(matches!(error, HistoryError::Line { line: 1, .. }), "{error}");
        std::fs::write(&file, "").unwrap();
        assert!(admits(&file).is_ok());
        assert!(matches!(read(&file).unwrap_err(), HistoryError::Empty(_)));
    }

    #[test]
    fn shipped_records_are_records() {
        assert!(!shipped().unwrap().is_empty());
    }
}
