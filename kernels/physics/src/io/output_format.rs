//! Descriptions of the formats for particles.

use super::extxyz::ParticleFrame;
use super::open_sinks::SinkKind;
use super::trajectory::FrameReading;
use std::fs::File;
use std::io::{self, BufWriter};

/// Format for particles.
pub struct OutputFormat {
    /// Key of `[output]` that requests it.
    pub key: &'static str,
    /// Help text of the key.
    pub doc: &'static str,
    /// True if it is written by default. Every run then creates its file, for the state of a failing step.
    pub(crate) is_default: bool,
    /// True if particles must be in a box.
    pub needs_box: bool,
    /// Name of the file.
    pub file: &'static str,
    /// Writer of the format.
    pub writing: FrameWriting,
    /// Reader of the format.
    pub reading: FrameReading,
}

impl OutputFormat {
    /// Returns true if its frames can be read back.
    pub fn is_read(&self) -> bool {
        matches!(self.reading, FrameReading::Opens(_))
    }
}

/// Writer of a format.
pub enum FrameWriting {
    /// Writes frame by frame.
    Growing(SinkKind),
    /// Writes the last frame as a whole file.
    Last(fn(&ParticleFrame, &mut BufWriter<&File>) -> io::Result<()>),
}
