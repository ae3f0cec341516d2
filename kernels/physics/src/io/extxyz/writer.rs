//! Writing of frames.

use super::{DEPTH, OF_ASE, PROPERTIES, ParticleFrame, XyzFrames};
use crate::io::growing_file::GrowingFile;
use crate::io::open_sinks::SinkKind;
use crate::io::output_format::{FrameWriting, OutputFormat};
use crate::io::run_moment::RunMoment;
use crate::io::sink::{TextFormat, TextSink};
use crate::io::species::symbol;
use crate::io::trajectory::{FrameReading, reader};
use crate::particles::{Particle, ParticleKind};
use std::io::{self, Write};
use std::ops::Range;
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
    let mut rows = RowBlock::of(particles.len());
    for disc in particles.all() {
        if rows.is_full() {
            rows.write_to(out)?;
        }
        rows.add(disc);
    }
    rows.write_to(out)
}

/// Text of some rows, written in one piece.
struct RowBlock {
    /// Text up to `end`, and space for the longest row.
    text: Vec<u8>,
    end: usize,
    /// Latest radius and mass: most discs have those of the disc before.
    repeated: [RepeatedNumber; 2],
    digits: zmij::Buffer,
}

/// Number with its text.
#[derive(Clone, Copy)]
struct RepeatedNumber {
    bits: u64,
    text: [u8; LONGEST_NUMBER],
    length: usize,
}

const RADIUS: usize = 0;
const MASS: usize = 1;

/// Space for a number with its blank and sign (bytes).
const LONGEST_NUMBER: usize = 32;
/// Space for a row (bytes), with what copies of a fixed size write beyond it.
const LONGEST_ROW: usize = 20 * LONGEST_NUMBER;
/// Most bytes written in one piece: calls of the system take little time, and the text stays in the cache.
const LONGEST_BLOCK: usize = 1 << 16;

impl RowBlock {
    /// Reserves memory for a number of rows, or for a piece of them.
    fn of(rows: usize) -> RowBlock {
        RowBlock {
            text: vec![0; LONGEST_BLOCK.min(rows.saturating_add(1).saturating_mul(LONGEST_ROW))],
            end: 0,
            repeated: [RepeatedNumber { bits: 0, text: [0; LONGEST_NUMBER], length: 0 }; 2],
            digits: zmij::Buffer::new(),
        }
    }

    fn is_full(&self) -> bool {
        self.text.len() - self.end < LONGEST_ROW
    }

    fn write_to(&mut self, out: &mut impl Write) -> io::Result<()> {
        out.write_all(&self.text[..std::mem::take(&mut self.end)])
    }

    fn add(&mut self, disc: &Particle) {
        match disc.kind {
            ParticleKind::Grain => {
                let name = symbol(disc.species);
                self.put(name, 1 + usize::from(name[1] > 0));
            }
            ParticleKind::Wall => self.put(*b"W", 1),
        }
        self.vector(disc.position);
        self.put(*b" ", 1);
        self.id(disc.id);
        let velocity = self.end;
        self.vector(disc.velocity);
        let velocity = velocity..self.end;
        self.repeated(RADIUS, disc.radius);
        self.repeated(MASS, disc.mass);
        self.put(*b" 0.0 0.0", 8);
        self.number(disc.omega);
        self.repeated(MASS, disc.mass);
        if disc.mass == 1.0 {
            self.copy::<{ 3 * LONGEST_NUMBER }>(velocity);
        } else {
            self.vector(disc.velocity.map(|v| disc.mass * v));
        }
        self.put(*b"\n", 1);
    }

    /// Appends the first bytes of an array. All are copied: a copy of a fixed size is a few instructions.
    #[inline(always)]
    fn put<const N: usize>(&mut self, bytes: [u8; N], length: usize) {
        self.text[self.end..self.end + N].copy_from_slice(&bytes);
        self.end += length;
    }

    /// Appends a part of the text, of at most `N` bytes.
    #[inline(always)]
    fn copy<const N: usize>(&mut self, part: Range<usize>) {
        let mut bytes = [0; N];
        bytes.copy_from_slice(&self.text[part.start..part.start + N]);
        self.put(bytes, part.len());
    }

    /// Appends a whole number.
    fn id(&mut self, id: u32) {
        let mut space = &mut self.text[self.end..];
        let before = space.len();
        #[expect(clippy::let_underscore_must_use, reason = "a block has space for any row")]
        let _ = write!(space, "{id}");
        self.end += before - space.len();
    }

    #[inline(always)]
    fn vector(&mut self, vector: [f64; 3]) {
        for number in vector {
            self.number(number);
        }
    }

    /// Appends a number of a column in which most are equal.
    #[inline(always)]
    fn repeated(&mut self, column: usize, number: f64) {
        let bits = number.to_bits();
        let RepeatedNumber { bits: known, text, length } = self.repeated[column];
        if known == bits && length > 0 {
            return self.put(text, length);
        }
        let from = self.end;
        self.number(number);
        let mut text = [0; LONGEST_NUMBER];
        text.copy_from_slice(&self.text[from..from + LONGEST_NUMBER]);
        self.repeated[column] = RepeatedNumber { bits, text, length: self.end - from };
    }

    /// Appends a blank and a number in the shortest form that reads back to the same bits.
    #[inline(always)]
    fn number(&mut self, number: f64) {
        if number.to_bits() == 0 {
            return self.put(*b" 0.0", 4);
        }
        self.put(*b" ", 1);
        let digits = self.digits.format(number).as_bytes();
        self.text[self.end..self.end + digits.len()].copy_from_slice(digits);
        self.end += digits.len();
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::particles::Particles;
    use proptest::prelude::*;

    /// Row as the format defines it, number by number.
    fn plain_row(disc: &Particle) -> String {
        let species = if disc.kind == ParticleKind::Wall { "W" } else { "Si" };
        let text = |numbers: &[f64]| -> String {
            numbers.iter().map(|&number| format!(" {}", zmij::Buffer::new().format(number))).collect()
        };
        let momenta = disc.velocity.map(|v| disc.mass * v);
        let Particle { id, position, velocity, radius, mass, omega, .. } = *disc;
        let shape = [radius, mass, 0.0, 0.0, omega, mass];
        format!("{species}{} {id}{}{}{}\n", text(&position), text(&velocity), text(&shape), text(&momenta))
    }

    fn number() -> impl Strategy<Value = f64> {
        let special =
            prop::sample::select(vec![0.0, -0.0, 1.0, -1.0, 0.5, 1e-7, 1e20, f64::NAN, f64::INFINITY]);
        prop_oneof![special, -1e3..1e3, any::<u64>().prop_map(f64::from_bits)]
    }

    fn disc() -> impl Strategy<Value = Particle> {
        let numbers = [(); 7].map(|()| number());
        (
            numbers,
            any::<u32>(),
            any::<bool>(),
            prop_oneof![Just(1.0), number()],
            prop_oneof![Just(0.5), number()],
        )
            .prop_map(|([x, y, z, vx, vy, vz, omega], id, is_wall, mass, radius)| Particle {
                id,
                kind: if is_wall { ParticleKind::Wall } else { ParticleKind::Grain },
                species: 0,
                position: [x, y, z],
                velocity: [vx, vy, vz],
                angle: 0.0,
                omega,
                radius,
                mass,
            })
    }

    proptest! {
        /// Rows of many blocks are those of the format, whatever was repeated before.
        #[test]
        fn rows_have_the_text_of_every_number(discs in prop::collection::vec(disc(), 0..1000)) {
            let frame = ParticleFrame {
                particles: Particles::new(discs),
                cell: [1.0; 2],
                origin: [0.0; 2],
                periodic: None,
                time: 0.0,
                step: 0,
                seed: None,
                has_raised_ids: false,
            };
            let mut written = vec![];
            write(&frame, &mut written).unwrap();
            let text = String::from_utf8(written).unwrap();
            let rows: Vec<&str> = text.split_inclusive('\n').skip(2).collect();
            let expected: Vec<String> = frame.particles.all().iter().map(plain_row).collect();
            prop_assert_eq!(rows, expected);
        }
    }
}
