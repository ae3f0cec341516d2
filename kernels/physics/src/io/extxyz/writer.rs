//! Writing of frames.

use super::{DEPTH, OF_ASE, PROPERTIES, ParticleFrame, XyzFrames};
use crate::io::growing_file::GrowingFile;
use crate::io::open_sinks::SinkKind;
use crate::io::output_format::{FrameWriting, OutputFormat};
use crate::io::run_moment::RunMoment;
use crate::io::sink::{TextFormat, TextSink};
use crate::io::trajectory::{FrameReading, reader};
use crate::particles::ParticleKind;
use std::io::{self, Write};
use std::sync::Arc;

pub(crate) const FORMAT: OutputFormat = OutputFormat {
    key: "trajectory",
    doc: "Snapshots as trajectory.xyz, extended XYZ.",
    is_default: true,
    needs_box: false,
    file: "trajectory.xyz",
    writing: FrameWriting::Growing(SinkKind::of::<TextSink<XyzSnapshots>>()),
    reading: FrameReading::Opens(|path| Ok(reader(XyzFrames::open(path)?.in_space()))),
};

struct XyzSnapshots;

impl TextFormat for XyzSnapshots {
    type Entry = Arc<ParticleFrame>;

    fn entry(moment: &RunMoment<'_>) -> Option<Arc<ParticleFrame>> {
        Some(moment.frame().clone())
    }

    fn write(frame: Arc<ParticleFrame>, out: &mut GrowingFile) -> io::Result<()> {
        write(&frame, out)
    }
}

/// Writes a frame; numbers have the shortest form that reads back to the same bits.
///
/// # Errors
/// Errors of the writer.
pub fn write(frame: &ParticleFrame, out: &mut impl Write) -> io::Result<()> {
    let ParticleFrame { particles, cell: [lx, ly], origin: [x, y], periodic, time, step, seed, .. } = frame;
    let [bottom, top] = DEPTH;
    writeln!(out, "{}", particles.len())?;
    // Unbounded space has no cell.
    let is_open = lx.is_infinite() || ly.is_infinite();
    if is_open {
        write!(out, "pbc=\"F F F\" ")?;
    } else {
        write!(out, "Lattice=\"{lx:?} 0.0 0.0 0.0 {ly:?} 0.0 0.0 0.0 {:?}\" ", top - bottom)?;
        write!(out, "Origin=\"{x:?} {y:?} {bottom:?}\" ")?;
    }
    if let Some([px, py]) =
        periodic.filter(|_| !is_open).map(|axes| axes.map(|yes| if yes { 'T' } else { 'F' }))
    {
        write!(out, "pbc=\"{px} {py} F\" ")?;
    }
    write!(out, "Properties={PROPERTIES}:{OF_ASE} Time={time:?} step={step}")?;
    if let Some(seed) = seed {
        write!(out, " seed={seed}")?;
    }
    writeln!(out)?;
    let mut row = RowBuffer::default();
    for disc in particles.all() {
        row.text.clear();
        row.text.push_str(match disc.kind {
            ParticleKind::Grain => "Si",
            ParticleKind::Wall => "W",
        });
        row.numbers(disc.position);
        row.word(&disc.id);
        row.numbers(disc.velocity);
        row.numbers([disc.radius, disc.mass, 0.0, 0.0, disc.omega]);
        row.numbers([disc.mass]);
        row.numbers(disc.velocity.map(|v| disc.mass * v));
        row.text.push('\n');
        out.write_all(row.text.as_bytes())?;
    }
    Ok(())
}

/// Buffer of a row. Its number formatting is three times as fast as the standard library's.
#[derive(Default)]
struct RowBuffer {
    text: String,
    digits: zmij::Buffer,
}

impl RowBuffer {
    fn word(&mut self, word: &dyn std::fmt::Display) {
        #[expect(clippy::let_underscore_must_use, reason = "writing to a string cannot fail")]
        let _ = std::fmt::Write::write_fmt(&mut self.text, format_args!(" {word}"));
    }

    /// Appends numbers in the shortest form that reads back to the same bits.
    fn numbers<const N: usize>(&mut self, numbers: [f64; N]) {
        for number in numbers {
            self.text.push(' ');
            self.text.push_str(self.digits.format(number));
        }
    }
}
