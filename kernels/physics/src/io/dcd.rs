//! Trajectories as DCD: positions in single precision, four bytes a coordinate, as CHARMM and NAMD write and most tools read.
//!
//! The number of frames in the heading is 0, for the file grows; readers take it from the length of the file. Records have
//! their length before and behind them, as Fortran's have.

use super::growing_file::GrowingFile;
use std::io::{self, Write};

/// Where every particle is at a step, in the order of the start.
#[derive(Clone, Debug, PartialEq)]
pub struct Positions {
    /// The step.
    pub step: u64,
    /// Sides of the box (length); infinite where there is none.
    pub cell: [f64; 2],
    /// Positions (length); no numbers where a particle is lost.
    pub places: Vec<[f32; 3]>,
}

/// Adds a frame, and before the first one the heading.
///
/// # Errors
/// Those of the file.
pub fn write(frame: &Positions, file: &mut GrowingFile) -> io::Result<()> {
    let mut bytes = Vec::with_capacity(HEADING + 64 + 3 * (8 + 4 * frame.places.len()));
    if file.is_empty() {
        heading(&mut bytes, frame);
    }
    if has_box(frame) {
        // Sides and angles by turns, as CHARMM orders them: A, γ, B, β, α, C.
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
    file.write_all(&bytes)
}

/// Bytes of the heading.
const HEADING: usize = (84 + 8) + (84 + 8) + (4 + 8);

fn has_box(frame: &Positions) -> bool {
    frame.cell.iter().all(|side| side.is_finite())
}

fn heading(bytes: &mut Vec<u8>, frame: &Positions) {
    let mut numbers = [0i32; 20];
    // The first step and the distance of frames are for readers that count time; this file leaves both at one.
    [numbers[1], numbers[2]] = [1, 1];
    numbers[9] = 1f32.to_bits().cast_signed();
    numbers[10] = i32::from(has_box(frame));
    // Written as CHARMM 24 does.
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

    /// A reader of its own: the records of a file.
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
            let mut file = GrowingFile::create(&path).unwrap();
            for step in [0, 10] {
                write(&frame(step, cell), &mut file).unwrap();
            }
            file.sync().unwrap();
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
}
