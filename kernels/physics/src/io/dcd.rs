//! Trajectories as DCD: positions in single precision, four bytes for each coordinate, as CHARMM, NAMD and LAMMPS write and most tools read.
//!
//! The heading states the first step, the steps between frames and the time step, from which readers compute the time of every frame. Frames are
//! therefore evenly spaced: a frame that is not an integer number of spacings after the first is omitted.
//!
//! The number of frames in the heading is 0, since the file grows; readers derive it from the file size. Records have their length before and after
//! them, as in Fortran.

use super::FileError;
use super::growing_file::{FileMark, GrowingFile, GrowingFileError};
use super::open_sinks::SinkKind;
use super::output_format::{FrameWriting, OutputFormat};
use super::run_moment::{FramesEvery, RunHeader, RunMoment};
use super::sink::Sink;
use super::trajectory::FrameReading;
use std::io::{self, Write};
use std::path::PathBuf;

pub(crate) const FORMAT: OutputFormat = OutputFormat {
    key: "dcd",
    doc: "Snapshots as trajectory.dcd: positions in single precision, small and fast to write. Its frames are evenly spaced: a last frame between two snapshots is omitted.",
    is_default: false,
    needs_box: false,
    file: "trajectory.dcd",
    writing: FrameWriting::Growing(SinkKind::of::<DcdWriter>()),
    reading: FrameReading::Lacks("sizes"),
};

/// Positions of all particles at a step, in the order of the start.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Positions {
    /// Number of the step, or of the frame for methods without steps.
    pub step: u64,
    /// Sides of the box (length); infinite without a box.
    pub cell: [f64; 2],
    /// Positions (length); NaN where a particle is lost.
    pub places: Vec<[f32; 3]>,
}

/// Spacing of frames in the heading.
#[derive(Clone, Copy, Debug, PartialEq)]
struct FrameSpacing {
    /// Steps between frames.
    steps: u64,
    /// Time step (time).
    dt: f64,
}

impl FrameSpacing {
    fn of(header: &RunHeader) -> FrameSpacing {
        /// Placeholder for a time step or spacing that is not used.
        const NO_MATTER: f64 = 1.0;
        match (header.frames, header.time_step) {
            (FramesEvery::Time(dt), None) => FrameSpacing { steps: 1, dt },
            (FramesEvery::Steps(steps), dt) => FrameSpacing { steps, dt: dt.unwrap_or(NO_MATTER) },
            // No frame after the start is evenly spaced.
            (_, Some(dt)) => FrameSpacing { steps: u64::MAX, dt },
            (FramesEvery::Never, None) => FrameSpacing { steps: 1, dt: NO_MATTER },
        }
    }

    /// Values in the heading.
    fn numbers(self) -> [i32; 2] {
        [whole(self.steps), (self.dt as f32).to_bits().cast_signed()]
    }
}

/// Step of a moment, or number of its frame; none if it is not evenly spaced from the start.
fn number(header: &RunHeader, steps: u64, now: f64) -> Option<u64> {
    /// Rounding error of multiples (relative to the spacing, and to the multiple).
    const ROUNDING: [f64; 2] = [1e-9, 4.0 * f64::EPSILON];
    match (header.frames, header.time_step) {
        (FramesEvery::Time(time), None) => {
            let whole = (now / time).round();
            let is_whole = (now / time - whole).abs() <= ROUNDING[0].max(ROUNDING[1] * whole);
            is_whole.then_some(whole as u64).filter(|_| now == 0.0 || whole > 0.0)
        }
        (FramesEvery::Never, None) => (now == 0.0).then_some(0),
        _ => Some(steps),
    }
}

/// Number of steps in four bytes.
fn whole(steps: u64) -> i32 {
    i32::try_from(steps).unwrap_or(i32::MAX)
}

/// Open file of evenly spaced frames.
#[derive(Debug)]
pub(crate) struct DcdWriter {
    file: GrowingFile,
    spacing: FrameSpacing,
    /// Step of the next frame; none before the first.
    next: Option<u64>,
    /// True if the heading has this spacing; otherwise no frames are added.
    is_even: bool,
}

impl DcdWriter {
    /// Returns true if a frame is the next of the evenly spaced ones.
    fn is_next_frame(&self, step: u64) -> bool {
        self.is_even && step.is_multiple_of(self.spacing.steps) && self.next.is_none_or(|next| next == step)
    }
}

impl Sink for DcdWriter {
    type Entry = Positions;

    fn begin(path: PathBuf, header: &RunHeader) -> Result<DcdWriter, FileError> {
        let file = GrowingFile::create(path)?;
        Ok(DcdWriter { file, spacing: FrameSpacing::of(header), next: None, is_even: true })
    }

    fn resume(
        path: PathBuf,
        header: &RunHeader,
        mark: FileMark,
        notes: &mut Vec<String>,
    ) -> Result<DcdWriter, GrowingFileError> {
        let (mut file, spacing) = (GrowingFile::resume(path, mark)?, FrameSpacing::of(header));
        let heading = file.first_bytes(HEADING)?;
        let number = |at: usize| {
            let bytes = heading.get(at..).and_then(|rest| rest.first_chunk());
            bytes.map_or(0, |bytes| i32::from_le_bytes(*bytes))
        };
        let [first, steps, dt, has_box, count] = [FIRST, STEPS, DT, BOX, COUNT].map(number);
        let positive = |number: i32| u64::try_from(number).unwrap_or(0);
        let of_a_frame = u64::from(has_box != 0) * (48 + 8) + 3 * (4 * positive(count) + 8);
        let frames = mark.bytes.saturating_sub(HEADING as u64) / of_a_frame;
        let has_begun = mark.bytes > 0;
        let is_even = !has_begun || [steps, dt] == spacing.numbers();
        if !is_even {
            notes.push(format!(
                "{} gets no more frames: its frames have another spacing than run.snapshot_every now sets",
                FORMAT.file
            ));
        }
        let next = has_begun.then(|| positive(first) + frames * positive(steps));
        Ok(DcdWriter { file, spacing, next, is_even })
    }

    fn cut(&mut self) -> Result<(), FileError> {
        self.file.cut()
    }

    fn entry(moment: &RunMoment<'_>) -> Option<Positions> {
        let step = number(moment.header, moment.steps, moment.time)?;
        Some(Positions { step, cell: moment.header.cell, places: moment.per_particle.positions() })
    }

    /// Adds a frame, and the heading before the first; omits a frame that is not evenly spaced.
    fn write(&mut self, frame: Positions) -> io::Result<()> {
        if !self.is_next_frame(frame.step) {
            return Ok(());
        }
        let mut bytes = Vec::with_capacity(HEADING + 64 + 3 * (8 + 4 * frame.places.len()));
        if self.next.is_none() {
            heading(&mut bytes, &frame, self.spacing);
        }
        self.next = Some(frame.step + self.spacing.steps);
        if has_box(&frame) {
            // Sides and angles alternate in CHARMM's order: A, γ, B, β, α, C.
            let [a, b] = frame.cell;
            record(&mut bytes, &[a, 90.0, b, 90.0, 90.0, 1.0].map(f64::to_le_bytes).concat());
        }
        let length = (4 * frame.places.len() as u32).to_le_bytes();
        for axis in 0..3 {
            bytes.extend(length);
            let from = bytes.len();
            bytes.resize(from + 4 * frame.places.len(), 0);
            for (number, place) in bytes[from..].chunks_exact_mut(4).zip(&frame.places) {
                number.copy_from_slice(&place[axis].to_le_bytes());
            }
            bytes.extend(length);
        }
        self.file.write_all(&bytes)
    }

    fn mark(&mut self) -> Result<FileMark, FileError> {
        self.file.sync()
    }
}

/// Size of the heading (bytes).
const HEADING: usize = (84 + 8) + (84 + 8) + (4 + 8);
/// Byte offsets in the heading: the first step, the steps between frames, the time step, the flag for a box, and the number of particles.
const FIRST: usize = 12;
const STEPS: usize = 16;
const DT: usize = 44;
const BOX: usize = 48;
const COUNT: usize = 188;

fn has_box(frame: &Positions) -> bool {
    frame.cell.iter().all(|side| side.is_finite())
}

fn heading(bytes: &mut Vec<u8>, frame: &Positions, spacing: FrameSpacing) {
    let mut numbers = [0i32; 20];
    numbers[1] = whole(frame.step);
    [numbers[2], numbers[9]] = spacing.numbers();
    numbers[10] = i32::from(has_box(frame));
    // CHARMM 24 writes the same number.
    numbers[19] = 24;
    let of = |numbers: &[i32]| numbers.iter().flat_map(|number| number.to_le_bytes()).collect::<Vec<u8>>();
    record(bytes, &[b"CORD".to_vec(), of(&numbers)].concat());
    let mut title = b"stripmine".to_vec();
    title.resize(80, b' ');
    record(bytes, &[of(&[1]), title].concat());
    record(bytes, &of(&[i32::try_from(frame.places.len()).unwrap_or(i32::MAX)]));
}

fn record(bytes: &mut Vec<u8>, content: &[u8]) {
    let length = (content.len() as u32).to_le_bytes();
    bytes.extend(length);
    bytes.extend(content);
    bytes.extend(length);
}

#[cfg(test)]
mod tests {
    use super::*;

    fn header(FrameSpacing { steps, dt }: FrameSpacing) -> RunHeader {
        let frames = FramesEvery::Steps(steps);
        RunHeader { frames, time_step: Some(dt), ..RunHeader::default() }
    }

    #[test]
    fn moments_between_frames_have_no_number() {
        for (every, time, expected) in [
            (FramesEvery::Time(0.1), 0.0, Some(0)),
            (FramesEvery::Time(0.1), 3.0 * 0.1, Some(3)),
            (FramesEvery::Time(0.1), 0.35, None),
            (FramesEvery::Time(0.1), 1e6 + 0.1, Some(10_000_001)),
            (FramesEvery::Never, 0.0, Some(0)),
            (FramesEvery::Never, 5.0, None),
        ] {
            let header = RunHeader { frames: every, ..RunHeader::default() };
            assert_eq!(number(&header, 0, time), expected, "{time} by {every:?}");
        }
    }

    /// Independent reader: the records of a file.
    fn records(mut bytes: &[u8]) -> Vec<&[u8]> {
        let mut all = vec![];
        while !bytes.is_empty() {
            let length = u32::from_le_bytes(bytes[..4].try_into().unwrap()) as usize;
            all.push(&bytes[4..4 + length]);
            assert_eq!(bytes[..4], bytes[4 + length..8 + length], "both lengths of a record agree");
            bytes = &bytes[8 + length..];
        }
        all
    }

    #[test]
    fn frames_come_back_as_they_were() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("t.dcd");
        let frame = |step, cell| Positions {
            step,
            cell,
            places: vec![[1.5, -2.25, 0.0], [step as f32, f32::NAN, 4.0]],
        };
        for (cell, of_a_frame) in [([3.0, 4.0], 4), ([f64::INFINITY; 2], 3)] {
            let mut file =
                DcdWriter::begin(path.clone(), &header(FrameSpacing { steps: 10, dt: 0.5 })).unwrap();
            for step in [0, 10] {
                file.write(frame(step, cell)).unwrap();
            }
            file.mark().unwrap();
            let bytes = std::fs::read(&path).unwrap();
            let records = records(&bytes);
            assert_eq!(records.len(), 3 + 2 * of_a_frame);
            assert_eq!((&records[0][..4], records[0].len(), records[1].len()), (&b"CORD"[..], 84, 84));
            assert_eq!(records[2], 2i32.to_le_bytes());
            let x = records[3 + 2 * of_a_frame - 3];
            assert_eq!(x, [1.5f32.to_le_bytes(), 10f32.to_le_bytes()].concat());
            if of_a_frame == 4 {
                assert_eq!(records[3][..8], 3f64.to_le_bytes());
                assert_eq!(records[3].len(), 48);
            }
            std::fs::remove_file(&path).unwrap();
        }
    }

    /// The heading matches CHARMM, NAMD and LAMMPS (ISTART, NSAVC, DELTA), and frames are evenly spaced in one session and in two.
    #[test]
    fn frames_are_spaced_as_the_heading_states() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("t.dcd");
        let even = FrameSpacing { steps: 1000, dt: 0.005 };
        let frame = |step| Positions { step, cell: [3.0, 4.0], places: vec![[step as f32, 0.0, 0.0]] };
        let steps = || -> Vec<f32> {
            let bytes = std::fs::read(&path).unwrap();
            let records = records(&bytes);
            records[3..].chunks(4).map(|frame| f32::from_le_bytes(frame[1].try_into().unwrap())).collect()
        };
        let mut file = DcdWriter::begin(path.clone(), &header(even)).unwrap();
        for step in [0, 1000, 2000, 2050] {
            file.write(frame(step)).unwrap();
        }
        let mark = file.mark().unwrap();
        assert_eq!(steps(), [0.0, 1000.0, 2000.0]);
        let bytes = std::fs::read(&path).unwrap();
        let number =
            |place: usize| i32::from_le_bytes(records(&bytes)[0][4 + 4 * place..][..4].try_into().unwrap());
        assert_eq!((number(1), number(2), f32::from_bits(number(9) as u32)), (0, 1000, 0.005));
        // Later sessions append with the same spacing and add nothing with another.
        for (spacing, next, expected) in [
            (even, [2050, 3000, 4000], &[0.0, 1000.0, 2000.0, 3000.0, 4000.0][..]),
            (FrameSpacing { steps: 500, ..even }, [2500, 3000, 3500], &[0.0, 1000.0, 2000.0]),
            (FrameSpacing { dt: 0.01, ..even }, [3000, 4000, 5000], &[0.0, 1000.0, 2000.0]),
        ] {
            std::fs::write(&path, &bytes).unwrap();
            let mut notes = vec![];
            let mut file = DcdWriter::resume(path.clone(), &header(spacing), mark, &mut notes).unwrap();
            assert_eq!(notes.is_empty(), spacing == even);
            file.cut().unwrap();
            next.iter().for_each(|&step| file.write(frame(step)).unwrap());
            file.mark().unwrap();
            assert_eq!(steps(), expected);
        }
    }
}
