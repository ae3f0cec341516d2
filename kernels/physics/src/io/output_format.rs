//! A format that a run writes its particles in, as the rest of the program knows it.

use super::extxyz::Frame;
use super::opened::SinkKind;
use super::trajectory::FrameReading;
use std::fs::File;
use std::io::{self, BufWriter};

/// A format that a run writes its particles in.
pub struct OutputFormat {
    /// The key of `[output]` that asks for it.
    pub key: &'static str,
    /// Help of the key.
    pub doc: &'static str,
    /// True where it is written by default. Its file is then begun in every run, for the state of a step that fails.
    pub(crate) is_default: bool,
    /// True where particles must be in a box.
    pub needs_box: bool,
    /// The name of the file.
    pub file: &'static str,
    /// Its writer.
    pub writing: FrameWriting,
    /// Its reader.
    pub reading: FrameReading,
}

impl OutputFormat {
    /// Reports whether its frames are read again.
    pub fn is_read(&self) -> bool {
        matches!(self.reading, FrameReading::Opens(_))
    }
}

/// Writer of a format.
pub enum FrameWriting {
    /// Frame by frame.
    Growing(SinkKind),
    /// The last frame, as a whole file.
    Last(fn(&Frame, &mut BufWriter<&File>) -> io::Result<()>),
}
