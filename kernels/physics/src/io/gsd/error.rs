//! Mistakes in GSD files, with their locations.

use crate::io::trajectory::TrajectoryError;
use crate::quoted::{self, quoted};
use std::fmt;
use std::io;
use std::path::PathBuf;

/// Reason why a trajectory cannot be read.
#[derive(Debug, thiserror::Error)]
#[error("{}: {place}{reason}", quoted::path(file))]
pub struct GsdReadError {
    /// Path of the file.
    pub file: PathBuf,
    /// Location in the file.
    pub place: GsdLocation,
    /// Reason.
    pub reason: GsdErrorKind,
}

/// Location in a GSD file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum GsdLocation {
    /// Whole file.
    File,
    /// Byte, from 0.
    Byte(u64),
    /// Chunk of a frame.
    Chunk {
        /// Number of the frame, from 0.
        frame: u64,
        /// Name of the chunk.
        chunk: &'static str,
    },
}

impl fmt::Display for GsdLocation {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        match self {
            GsdLocation::File => Ok(()),
            GsdLocation::Byte(byte) => write!(f, "byte {byte}: "),
            GsdLocation::Chunk { frame, chunk } => write!(f, "frame {frame}, {chunk}: "),
        }
    }
}

/// Reason of an error at a location of a GSD file.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum GsdErrorKind {
    /// The system refuses to read it.
    #[error("cannot be read: {0}")]
    Io(#[from] io::Error),
    /// The bytes are not the expected ones.
    #[error("expected {0}")]
    Expected(&'static str),
    /// The file ends early.
    #[error("{what} ends at byte {end}, but the file at byte {length}")]
    Truncated {
        /// Truncated part.
        what: &'static str,
        /// Expected end.
        end: u64,
        /// End of the file.
        length: u64,
    },
    /// There is no memory for a chunk.
    #[error("it needs {length} bytes of memory, which are not available")]
    Memory {
        /// Length of the chunk (bytes).
        length: u64,
    },
    /// A chunk has no content on the disk.
    #[error(
        "it has {length} bytes, but the whole file occupies only {on_disk} on the disk: the file has holes; copy it again from its source"
    )]
    Hole {
        /// Length of the chunk (bytes).
        length: u64,
        /// Bytes of the file on the disk.
        on_disk: u64,
    },
    /// A chunk is missing.
    #[error(
        "there is no such chunk, and frame 0 has none for as many particles; expected a file written by stripmine"
    )]
    Missing,
    /// A chunk has another size or type.
    #[error("found {found}; expected {expected}")]
    Shape {
        /// Rows, columns and type.
        found: String,
        /// Expected rows, columns and type.
        expected: String,
    },
    /// A number is invalid.
    #[error("row {row} is `{}`; expected {expected}", quoted(found))]
    Number {
        /// Row, from 0.
        row: usize,
        /// Number found.
        found: String,
        /// Expected number.
        expected: &'static str,
    },
    /// An id occurs twice.
    #[error("row {row} is {id}, which is also the id of another particle")]
    RepeatedId {
        /// Row, from 0.
        row: usize,
        /// Repeated id.
        id: u32,
    },
}

impl GsdReadError {
    /// Error of the system, if the file could not be read at all.
    pub fn system(&self) -> Option<&io::Error> {
        match &self.reason {
            GsdErrorKind::Io(cause) => Some(cause),
            _ => None,
        }
    }
}

impl From<GsdReadError> for TrajectoryError {
    fn from(error: GsdReadError) -> TrajectoryError {
        TrajectoryError {
            line: None,
            is_of_system: error.system().is_some(),
            words: error.to_string(),
            file: error.file,
        }
    }
}
