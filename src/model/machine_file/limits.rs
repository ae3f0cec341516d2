//! What machine files, and host files after them, may be at most.

/// The version of the file format that this program reads.
pub const FORMAT: u32 = 1;

/// Longest machine or host file (bytes).
pub(crate) const LONGEST: u64 = 4 << 20;

/// At most this many defects are named, each with its place, which is looked for in the whole text.
pub(crate) const NAMED: usize = 20;
