//! Checkpoints: everything a run needs to go on, in one binary file that is either whole or refused.
//!
//! All numbers are little-endian; a text is its length in bytes (`u64`) and UTF-8.
//!
//! ```text
//! header   magic (8 bytes) · version u32 · sections u32 · length of the file u64 · checksum u32
//! section  kind (4 bytes) · length of the payload u64 · payload · checksum u32
//!   STAT   step u64 · time f64 · scene text
//!          · origin: count u64, (text, text)… · counters: count u64, (text, tag u8, 8 bytes)…
//!   COLM   name text · tag u8 · count u64 · elements
//! ```
//!
//! There is one `STAT`, then a `COLM` for each column. A checksum is the CRC-32 of all bytes before it, other
//! checksums left out. The header keeps its shape in every version.

mod error;
mod files;
mod reading;
mod writing;

pub use error::{CheckpointError, Fault, Kept};
pub use files::{Latest, NAME, previous, read_latest};
pub use writing::WriteError;

use std::collections::BTreeMap;

/// The version of the format that this program writes and reads.
pub(crate) const VERSION: u32 = 1;

const MAGIC: [u8; 8] = *b"\x93STRIPM\n";
const HEADER: u64 = 28;
/// Kind, length and checksum of a section.
const SECTION_FRAME: u64 = 16;

/// The state of a run between two steps.
#[derive(Clone, Debug, PartialEq, Default)]
pub struct Checkpoint {
    /// Steps done.
    pub step: u64,
    /// Time reached (time).
    pub time: f64,
    /// The scene with all its defaults, TOML.
    pub scene: String,
    /// The program that wrote it: version, commit, target and the like.
    pub origin: BTreeMap<String, String>,
    /// What a run counts and sums up.
    pub counters: BTreeMap<String, Counter>,
    /// Values for each particle or cell, by name; each with a length of its own.
    pub columns: Vec<(String, Column)>,
}

/// A number that a run carries along.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Counter {
    /// How many.
    Count(u64),
    /// How much; all its bits are kept.
    Sum(f64),
}

/// Values of one type; all their bits are kept.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub enum Column {
    /// Double precision.
    F64(Vec<f64>),
    /// Single precision.
    F32(Vec<f32>),
    /// Whole numbers of 32 bits.
    U32(Vec<u32>),
    /// Whole numbers of 64 bits.
    U64(Vec<u64>),
}

impl Checkpoint {
    /// The column of that name.
    pub fn column(&self, name: &str) -> Option<&Column> {
        self.columns.iter().find(|(other, _)| other == name).map(|(_, column)| column)
    }
}

impl Column {
    /// How many values.
    pub fn len(&self) -> usize {
        match self {
            Column::F64(values) => values.len(),
            Column::F32(values) => values.len(),
            Column::U32(values) => values.len(),
            Column::U64(values) => values.len(),
        }
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The type's tag in the file, and the bytes of a value.
    fn tag_and_width(&self) -> (u8, u64) {
        match self {
            Column::F64(_) => (0, 8),
            Column::F32(_) => (1, 4),
            Column::U32(_) => (2, 4),
            Column::U64(_) => (3, 8),
        }
    }
}
