//! Damaged checkpoints: each is refused, and the error names the fault and its byte.

use crate::Random;
use crate::checkpoint::{bytes, checkpoint};
use std::fs;
use stripmine_physics::io::checkpoint::{Checkpoint, CheckpointError, CheckpointFault};

/// Reads bytes as a checkpoint file.
struct Reader(tempfile::TempDir);

impl Reader {
    fn new() -> Self {
        Reader(tempfile::tempdir().unwrap())
    }

    fn error(&self, bytes: &[u8]) -> CheckpointError {
        let path = self.0.path().join("corrupt");
        fs::write(&path, bytes).unwrap();
        let error = Checkpoint::read(&path).expect_err("a corrupt checkpoint was read");
        assert!(error.is_corrupt() && error.file == path, "{error}");
        assert!(error.offset.is_some_and(|offset| offset <= bytes.len() as u64), "{error}");
        error
    }
}

const HEADER: usize = 28;

/// Offsets of the sections.
fn sections(bytes: &[u8]) -> Vec<usize> {
    let mut starts = vec![HEADER];
    while let Some(&start) = starts.last().filter(|&&start| start < bytes.len()) {
        let length = u64::from_le_bytes(bytes[start + 4..start + 12].try_into().unwrap());
        starts.push(start + 16 + length as usize);
    }
    starts.pop();
    starts
}

/// Recomputes all checksums, as a faulty program would write them.
fn with_right_checksums(mut bytes: Vec<u8>, starts: &[usize]) -> Vec<u8> {
    let mut hasher = crc32fast::Hasher::new();
    let mut from = 0;
    for end in [starts, &[bytes.len()]].concat() {
        hasher.update(&bytes[from..end - 4]);
        bytes[end - 4..end].copy_from_slice(&hasher.clone().finalize().to_le_bytes());
        from = end;
    }
    bytes
}

/// Overwrites bytes and recomputes the checksums.
fn forged(at: usize, new: &[u8]) -> Vec<u8> {
    let mut bytes = bytes(&checkpoint(3));
    let starts = sections(&bytes);
    bytes[at..at + new.len()].copy_from_slice(new);
    with_right_checksums(bytes, &starts)
}

#[test]
fn every_flipped_bit_is_refused() {
    let (whole, reader) = (bytes(&checkpoint(3)), Reader::new());
    assert!(whole.len() > 300);
    for bit in 0..8 * whole.len() {
        let mut flipped = whole.clone();
        flipped[bit / 8] ^= 1 << (bit % 8);
        let error = reader.error(&flipped);
        match bit / 8 {
            0..8 => assert!(matches!(error.fault, CheckpointFault::Magic), "bit {bit}: {error}"),
            8..28 => {
                let part = "the header".to_owned();
                assert!(
                    matches!(error.fault, CheckpointFault::Checksum { part: ref p } if *p == part),
                    "bit {bit}: {error}"
                );
            }
            _ => assert!(
                matches!(error.fault, CheckpointFault::Checksum { .. } | CheckpointFault::Length { .. }),
                "bit {bit}: {error}"
            ),
        }
    }
}

#[test]
fn every_truncation_is_refused() {
    let (whole, reader) = (bytes(&checkpoint(3)), Reader::new());
    for length in 0..whole.len() {
        let error = reader.error(&whole[..length]);
        let full = (length >= HEADER).then_some(whole.len() as u64);
        let right = matches!(error.fault, CheckpointFault::Truncated { found, promised }
            if found == length as u64 && promised == full);
        assert!(right && error.offset == Some(length as u64), "{length}: {error}");
    }
}

#[test]
fn bytes_after_the_end_are_refused() {
    let (mut bytes, reader) = (bytes(&checkpoint(3)), Reader::new());
    let length = bytes.len() as u64;
    for extra in 1..20 {
        bytes.push(0);
        let error = reader.error(&bytes);
        assert!(
            matches!(error.fault, CheckpointFault::Trailing { extra: found } if found == extra),
            "{error}"
        );
        assert_eq!(error.offset, Some(length));
    }
}

#[test]
fn foreign_files_and_other_versions_are_distinguished() {
    let reader = Reader::new();
    for other in [&b"step,time\n"[..], &[0; 100], b"\x93NUMPY\x01\x00 and so on, long enough for a header"] {
        assert!(matches!(reader.error(other).fault, CheckpointFault::Magic));
    }
    let error = reader.error(&forged(8, &2u32.to_le_bytes()));
    assert!(matches!(error.fault, CheckpointFault::Version { found: 2 }));
    assert_eq!(error.offset, Some(8));
    assert!(error.to_string().contains("has format version 2, but this program reads version 1 (at byte 8)"));
}

/// Impossible lengths with valid checksums are refused before memory is allocated.
#[test]
fn absurd_lengths_are_refused() {
    let (whole, reader) = (bytes(&checkpoint(3)), Reader::new());
    let starts = sections(&whole);
    for absurd in [u64::MAX - 1, 1 << 62, 1 << 40, whole.len() as u64] {
        let new = absurd.to_le_bytes();
        // Lengths of the state, of its scene, number of entries of its origin; of a column's name, number of its values.
        let (state, column) = (starts[0], starts[1]);
        let origin = state + 12 + 16 + 8 + checkpoint(3).scene.len();
        for at in [state + 4, state + 12 + 16, origin, column + 12, column + 12 + 8 + 1 + 1] {
            let error = reader.error(&forged(at, &new));
            assert!(matches!(error.fault, CheckpointFault::Length { .. }), "{at}: {error}");
        }
        // Length of the file.
        let error = reader.error(&forged(16, &(absurd + 1).to_le_bytes()));
        assert!(
            matches!(error.fault, CheckpointFault::Truncated { promised, .. } if promised == Some(absurd + 1))
        );
    }
}

#[test]
fn meaningless_contents_are_refused() {
    let (whole, reader) = (bytes(&checkpoint(3)), Reader::new());
    let starts = sections(&whole);
    let (state, column, second) = (starts[0], starts[1], starts[2]);
    let cases: [(usize, &[u8], &str); 6] = [
        (state, b"COLM", "another kind of section"),
        (column, b"STAT", "another kind of section"),
        (column + 12 + 9, &[9], "a column has an unknown type"),
        (state + 12 + 24, &[0xff], "a text is not UTF-8"),
        (12, &0u32.to_le_bytes(), "bytes after its end"),
        (12, &9u32.to_le_bytes(), "a section has a length of 16, but 0 bytes are left"),
    ];
    for (at, new, words) in cases {
        let error = reader.error(&forged(at, new)).to_string();
        assert!(error.contains(words), "{error}");
    }
    // Two columns with the same name.
    let mut twice = checkpoint(3);
    twice.columns[1].0 = "y".to_owned();
    let mut bytes = bytes(&twice);
    let starts = sections(&bytes);
    bytes[second + 12 + 8] = b'x';
    let error = reader.error(&with_right_checksums(bytes, &starts));
    assert!(matches!(error.fault, CheckpointFault::Repeated { ref name, .. } if name == "x"), "{error}");
}

/// Any damage, with valid checksums or not, gives an error or a checkpoint, never a panic.
#[test]
fn checkpoint_reader_never_panics() {
    let (whole, folder) = (bytes(&checkpoint(3)), tempfile::tempdir().unwrap());
    let (starts, path) = (sections(&whole), folder.path().join("any"));
    let mut random = Random(5);
    for round in 0..4000 {
        let mut bytes = whole.clone();
        for _ in 0..=random.below(4) {
            let at = random.below(bytes.len());
            bytes[at] = random.below(256) as u8;
        }
        if round % 2 == 0 {
            bytes = with_right_checksums(bytes, &starts);
        }
        fs::write(&path, &bytes).unwrap();
        if let Ok(read) = Checkpoint::read(&path) {
            assert_eq!(crate::checkpoint::bytes(&read).len(), bytes.len());
        }
    }
}
