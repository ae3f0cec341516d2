//! Checkpoints: the complete state of a run in one binary file that is either valid or rejected.
//!
//! Numbers are little-endian; a text is its length in bytes (`u64`) and UTF-8.
//!
//! ```text
//! header   magic (8 bytes) · version u32 · sections u32 · length of the file u64 · checksum u32
//! section  kind (4 bytes) · length of the payload u64 · payload · checksum u32
//!   STAT   step u64 · time f64 · scene text
//!          · origin: count u64, (text, text)… · counters: count u64, (text, tag u8, 8 bytes)…
//!   COLM   name text · tag u8 · count u64 · elements
//! ```
//!
//! There is one `STAT`, then a `COLM` for each column. A checksum is the CRC-32 of all bytes before it, without other checksums. The header has the
//! same layout in every version.

mod error;
mod files;
mod reading;
mod writing;

pub use error::{CheckpointError, CheckpointFault, OlderCheckpoint};
pub use files::{LatestCheckpoint, NAME, previous, read_latest};
pub use writing::WriteError;

use std::collections::BTreeMap;

/// Format version that this program writes and reads.
pub(crate) const VERSION: u32 = 1;

const MAGIC: [u8; 8] = *b"\x93STRIPM\n";
const HEADER: u64 = 28;
/// Bytes of kind, length and checksum of a section.
const SECTION_FRAME: u64 = 16;

/// State of a run between two steps.
#[derive(Clone, Debug, PartialEq, Default)]
pub struct Checkpoint {
    /// Number of steps done.
    pub step: u64,
    /// Simulated time (time).
    pub time: f64,
    /// Scene with all its defaults in TOML.
    pub scene: String,
    /// Program that wrote it: version, commit, target and the like.
    pub origin: BTreeMap<String, String>,
    /// Counters and sums of the run.
    pub counters: BTreeMap<String, CheckpointCounter>,
    /// Values of each particle or cell, by name; lengths may differ.
    pub columns: Vec<(String, CheckpointColumn)>,
}

/// Counter or sum of a run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum CheckpointCounter {
    /// Whole number.
    Count(u64),
    /// Floating-point sum, exact to the bit.
    Sum(f64),
}

/// Values of one type, exact to the bit.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub enum CheckpointColumn {
    /// Double precision.
    F64(Vec<f64>),
    /// Single precision.
    F32(Vec<f32>),
    /// Unsigned integers of 32 bits.
    U32(Vec<u32>),
    /// Unsigned integers of 64 bits.
    U64(Vec<u64>),
}

impl Checkpoint {
    /// Column with a name.
    pub fn column(&self, name: &str) -> Option<&CheckpointColumn> {
        self.columns.iter().find(|(other, _)| other == name).map(|(_, column)| column)
    }
}

impl CheckpointColumn {
    /// Number of values.
    pub fn len(&self) -> usize {
        match self {
            CheckpointColumn::F64(values) => values.len(),
            CheckpointColumn::F32(values) => values.len(),
            CheckpointColumn::U32(values) => values.len(),
            CheckpointColumn::U64(values) => values.len(),
        }
    }

    /// True if there are no values.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Tag of the type in the file, and bytes of a value.
    fn tag_and_width(&self) -> (u8, u64) {
        match self {
            CheckpointColumn::F64(_) => (0, 8),
            CheckpointColumn::F32(_) => (1, 4),
            CheckpointColumn::U32(_) => (2, 4),
            CheckpointColumn::U64(_) => (3, 8),
        }
    }
}
