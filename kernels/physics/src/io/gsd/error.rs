//! What can be wrong with a GSD file, and where.

use crate::io::trajectory::TrajectoryError;
use crate::quoted::{self, quoted};
use std::fmt;
use std::io;
use std::path::PathBuf;

/// Why a trajectory cannot be read.
#[derive(Debug, thiserror::Error)]
#[error("{}: {place}{reason}", quoted::path(file))]
pub struct ReadError {
    /// The file.
    pub file: PathBuf,
    /// Where in it.
    pub place: Place,
    /// What is wrong.
    pub reason: Reason,
}

/// A place in a GSD file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Place {
    /// The file as such.
    File,
    /// A byte, from 0.
    Byte(u64),
    /// A chunk of a frame, from 0.
    Chunk {
        /// The frame.
        frame: u64,
        /// The name.
        chunk: &'static str,
    },
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        match self {
            Place::File => Ok(()),
            Place::Byte(byte) => write!(f, "byte {byte}: "),
            Place::Chunk { frame, chunk } => write!(f, "frame {frame}, {chunk}: "),
        }
    }
}

/// What is wrong at a place of a GSD file.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Reason {
    /// The system would not let it be read.
    #[error("cannot be read: {0}")]
    Io(#[from] io::Error),
    /// Something else stands there.
    #[error("expected {0}")]
    Expected(&'static str),
    /// The file ends before.
    #[error("{what} ends at byte {end}, the file at byte {length}")]
    Truncated {
        /// What is cut off.
        what: &'static str,
        /// Where it should end.
        end: u64,
        /// Where the file ends.
        length: u64,
    },
    /// A chunk for which there is no memory.
    #[error("it takes {length} bytes, and the system has no memory for them")]
    Memory {
        /// Its length (bytes).
        length: u64,
    },
    /// A chunk without content.
    #[error(
        "it takes {length} bytes, but the whole file only {on_disk} on the disk: the file has holes; copy it again from its source"
    )]
    Hole {
        /// Its length (bytes).
        length: u64,
        /// Bytes that the file takes on the disk.
        on_disk: u64,
    },
    /// A chunk that is not there.
    #[error(
        "there is no such chunk, nor one in frame 0 for as many particles; expected what stripmine writes"
    )]
    Missing,
    /// A chunk of another size or type.
    #[error("found {found}; expected {expected}")]
    Shape {
        /// Rows, columns and type.
        found: String,
        /// What they should be.
        expected: String,
    },
    /// A number that means nothing.
    #[error("row {row} is `{}`; expected {expected}", quoted(found))]
    Number {
        /// The row, from 0.
        row: usize,
        /// The number.
        found: String,
        /// What it should be.
        expected: &'static str,
    },
    /// An id that another particle has.
    #[error("row {row} is {id}, which is the id of another particle, too")]
    RepeatedId {
        /// The row, from 0.
        row: usize,
        /// The id.
        id: u32,
    },
}

impl ReadError {
    /// What the system said, if the file could not be read at all: a matter of input and output, not of content.
    pub fn system(&self) -> Option<&io::Error> {
        match &self.reason {
            Reason::Io(cause) => Some(cause),
            _ => None,
        }
    }
}

impl From<ReadError> for TrajectoryError {
    fn from(error: ReadError) -> TrajectoryError {
        TrajectoryError {
            line: None,
            is_of_system: error.system().is_some(),
            words: error.to_string(),
            file: error.file,
        }
    }
}
