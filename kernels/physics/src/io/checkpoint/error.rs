//! Faults of checkpoints, and the older checkpoint that is left.

use super::VERSION;
use crate::quoted::{self, quoted};
use std::io;
use std::path::{Path, PathBuf};

/// Reason why a checkpoint cannot be used.
#[derive(Debug, thiserror::Error)]
#[error("checkpoint {}: {fault}{}{}", quoted::path(file), place(*.offset), advice(file, kept))]
pub struct CheckpointError {
    /// Path of the file.
    pub file: PathBuf,
    /// First wrong byte, from 0, if known.
    pub offset: Option<u64>,
    /// Fault of the file.
    pub fault: CheckpointFault,
    /// Older checkpoint beside it.
    pub kept: OlderCheckpoint,
}

impl CheckpointError {
    /// True if the content is at fault, not the system.
    pub fn is_corrupt(&self) -> bool {
        !matches!(self.fault, CheckpointFault::Io(_))
    }
}

/// Fault of a checkpoint.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum CheckpointFault {
    /// The system refuses to read it.
    #[error("cannot be read: {0}")]
    Io(#[from] io::Error),
    /// The signature of a checkpoint is missing.
    #[error("is not a checkpoint: its first bytes are not the signature of one")]
    Magic,
    /// The format version is unknown to this program.
    #[error("has format version {found}, but this program reads version {VERSION}")]
    Version {
        /// Version that it states.
        found: u32,
    },
    /// The file is shorter than it states.
    #[error("is truncated: {found} bytes of {}", length(*.promised))]
    Truncated {
        /// Bytes of the file.
        found: u64,
        /// Bytes it should have, if known.
        promised: Option<u64>,
    },
    /// The file is longer than it states.
    #[error("has {extra} bytes after its end")]
    Trailing {
        /// Number of excess bytes.
        extra: u64,
    },
    /// Bytes have changed since it was written.
    #[error("is corrupt: the checksum of {part} is wrong")]
    Checksum {
        /// Part with the wrong checksum.
        part: String,
    },
    /// A length exceeds the file.
    #[error("is corrupt: {what} has a length of {claimed}, but {left} bytes are left")]
    Length {
        /// Item with this length.
        what: &'static str,
        /// Length that it states.
        claimed: u64,
        /// Bytes left.
        left: u64,
    },
    /// Bytes have no meaning at their location.
    #[error("is corrupt: {0}")]
    Meaningless(&'static str),
    /// A name occurs twice.
    #[error("is corrupt: {what} `{}` occurs twice", quoted(name))]
    Repeated {
        /// Column, counter or entry of the origin.
        what: &'static str,
        /// Repeated name.
        name: String,
    },
}

/// Older checkpoint beside the newest.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum OlderCheckpoint {
    /// There is no older checkpoint.
    Nothing,
    /// A valid file.
    Whole {
        /// Path of the file.
        file: PathBuf,
        /// Step at which it was written.
        step: u64,
    },
    /// A file that cannot be used either.
    Unusable {
        /// Path of the file.
        file: PathBuf,
    },
}

fn place(offset: Option<u64>) -> String {
    offset.map_or_else(String::new, |offset| format!(" (at byte {offset})"))
}

fn length(bytes: Option<u64>) -> String {
    bytes.map_or_else(|| format!("at least {}", super::HEADER), |bytes| bytes.to_string())
}

fn advice(file: &Path, kept: &OlderCheckpoint) -> String {
    match kept {
        OlderCheckpoint::Nothing => {
            "\n  help: no older checkpoint is kept beside it; start the run again".to_owned()
        }
        OlderCheckpoint::Whole { file: older, step } => format!(
            "\n  kept: the older checkpoint, {},{} is valid\
             \n  help: to resume from it, rename it to {}",
            quoted::path(older),
            // A method without steps counts none.
            if *step > 0 { format!(" of step {step},") } else { String::new() },
            quoted::path(file)
        ),
        OlderCheckpoint::Unusable { file: older } => format!(
            "\n  kept: the older checkpoint, {}, but it cannot be used either\n  help: start the run again",
            quoted::path(older)
        ),
    }
}
