//! Plain XYZ, for viewers that read nothing else: the number of particles, a line of comment, and an element and three coordinates
//! for each.

use super::extxyz::Frame;
use super::growing_file::GrowingFile;
use super::opened::SinkKind;
use super::output_format::{FrameWriting, OutputFormat};
use super::run_moment::RunMoment;
use super::sink::{TextFormat, TextSink};
use super::trajectory::FrameReading;
use crate::particles::Kind;
use std::io::{self, Write};
use std::sync::Arc;

/// The format.
pub(crate) const FORMAT: OutputFormat = OutputFormat {
    key: "plain_xyz",
    doc: "Snapshots as plain XYZ: H for grains, He for discs of walls.",
    is_default: false,
    needs_box: false,
    file: "plain.xyz",
    writing: FrameWriting::Growing(SinkKind::of::<TextSink<PlainFrames>>()),
    reading: FrameReading::Never,
};

struct PlainFrames;

impl TextFormat for PlainFrames {
    type Entry = Arc<Frame>;

    fn entry(moment: &RunMoment<'_>) -> Option<Arc<Frame>> {
        Some(moment.frame().clone())
    }

    fn write(frame: Arc<Frame>, out: &mut GrowingFile) -> io::Result<()> {
        let all = frame.particles.all();
        writeln!(out, "{}\ntime {:?}", all.len(), frame.time)?;
        all.iter().try_for_each(|it| {
            let element = if it.kind == Kind::Grain { "H" } else { "He" };
            let [x, y, z] = it.position;
            writeln!(out, "{element} {x:?} {y:?} {z:?}")
        })
    }
}
