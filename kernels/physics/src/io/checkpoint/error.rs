//! What can be wrong with a checkpoint, and what is left.

use super::VERSION;
use crate::quoted::{self, quoted};
use std::io;
use std::path::{Path, PathBuf};

/// Why a checkpoint cannot be used.
#[derive(Debug, thiserror::Error)]
#[error("checkpoint {}: {fault}{}{}", quoted::path(file), place(*.offset), advice(file, kept))]
pub struct CheckpointError {
    /// The file.
    pub file: PathBuf,
    /// The byte at which it goes wrong, from 0, where known.
    pub offset: Option<u64>,
    /// What is wrong.
    pub fault: Fault,
    /// The older checkpoint beside it.
    pub kept: Kept,
}

impl CheckpointError {
    /// Whether the content is at fault, not the system that should have read it.
    pub fn is_corrupt(&self) -> bool {
        !matches!(self.fault, Fault::Io(_))
    }
}

/// What is wrong with a checkpoint.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Fault {
    /// The system would not let it be read.
    #[error("cannot be read: {0}")]
    Io(#[from] io::Error),
    /// It does not begin as a checkpoint does.
    #[error("is no checkpoint: its first bytes are not those of one")]
    Magic,
    /// Of a format that this program does not know.
    #[error("has format version {found}, but this program reads version {VERSION}")]
    Version {
        /// The version it states.
        found: u32,
    },
    /// Shorter than it says.
    #[error("is truncated: {found} bytes of {}", length(*.promised))]
    Truncated {
        /// Bytes there are.
        found: u64,
        /// Bytes there should be, where that is known.
        promised: Option<u64>,
    },
    /// Longer than it says.
    #[error("has {extra} bytes after its end")]
    Trailing {
        /// Bytes too many.
        extra: u64,
    },
    /// Bytes have changed since it was written.
    #[error("is corrupt: the checksum of {part} is wrong")]
    Checksum {
        /// The part.
        part: String,
    },
    /// A length that reaches beyond what is there.
    #[error("is corrupt: {what} has a length of {claimed}, but {left} bytes are left")]
    Length {
        /// What is to be that long.
        what: &'static str,
        /// The length it states.
        claimed: u64,
        /// Bytes left for it.
        left: u64,
    },
    /// Bytes that mean nothing at their place.
    #[error("is corrupt: {0}")]
    Meaningless(&'static str),
    /// A name given twice.
    #[error("is corrupt: {what} `{}` is there twice", quoted(name))]
    Repeated {
        /// Column, counter or entry of the origin.
        what: &'static str,
        /// Its name.
        name: String,
    },
}

/// The older checkpoint that is kept beside the newest.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Kept {
    /// There is none.
    Nothing,
    /// It is whole.
    Whole {
        /// The file.
        file: PathBuf,
        /// The step it was written at.
        step: u64,
    },
    /// It cannot be used either.
    Unusable {
        /// The file.
        file: PathBuf,
    },
}

fn place(offset: Option<u64>) -> String {
    offset.map_or_else(String::new, |offset| format!(" (at byte {offset})"))
}

fn length(bytes: Option<u64>) -> String {
    bytes.map_or_else(|| format!("at least {}", super::HEADER), |bytes| bytes.to_string())
}

fn advice(file: &Path, kept: &Kept) -> String {
    match kept {
        Kept::Nothing => "\n  help: no older checkpoint is kept beside it; start the run again".to_owned(),
        Kept::Whole { file: older, step } => format!(
            "\n  kept: the older one, {},{} is whole\
             \n  help: to go on from it, rename it to {}",
            quoted::path(older),
            // A method that takes no steps counts none.
            if *step > 0 { format!(" of step {step},") } else { String::new() },
            quoted::path(file)
        ),
        Kept::Unusable { file: older } => format!(
            "\n  kept: the older one, {}, but it cannot be used either\n  help: start the run again",
            quoted::path(older)
        ),
    }
}
