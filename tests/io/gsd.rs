//! GSD trajectories, which have an index.

use crate::Random;
use std::fs;
use std::io::{Seek, SeekFrom, Write as _};
use std::path::{Path, PathBuf};
use stripmine_physics::io::extxyz::ParticleFrame;
use stripmine_physics::io::growing_file::{FileMark, GrowingFileError};
use stripmine_physics::io::gsd::{GsdFrames, GsdWriter, LoggedFrame};
use stripmine_physics::io::run_moment::RunHeader;
use stripmine_physics::io::sink::Sink;
use stripmine_physics::particles::{Particle, ParticleKind, Particles};
use tempfile::TempDir;

/// Header of a run that logs two quantities.
fn header() -> RunHeader {
    logging(vec!["energy", "lost"])
}

fn logging(columns: Vec<&'static str>) -> RunHeader {
    RunHeader { logged: (0..columns.len()).collect(), columns, ..RunHeader::default() }
}

fn resumed(path: &Path, header: &RunHeader, mark: FileMark) -> Result<GsdWriter, GrowingFileError> {
    GsdWriter::resume(path.to_owned(), header, mark, &mut vec![])
}

/// Number of frames that makes the index move twice.
const MANY: u64 = 200;

fn folder_and_path() -> (TempDir, PathBuf) {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("trajectory.gsd");
    (folder, path)
}

fn disc(id: u32, step: u64) -> Particle {
    let along = 0.1 * f64::from(id) + 0.01 * step as f64;
    Particle {
        id,
        kind: if id > 3 { ParticleKind::Wall } else { ParticleKind::Grain },
        species: 0,
        position: [along, 1.0 / (1.0 + along), 0.0],
        velocity: [-along, 1e-300, 0.0],
        angle: 0.0,
        omega: 0.0,
        radius: 0.05,
        mass: 0.1 * f64::from(id),
    }
}

/// Five discs; one is lost from step 30 on, one rotates from step 50 on.
fn plane(step: u64) -> LoggedFrame {
    let ids = (1..=5).filter(|id| *id != 2 || step < 30);
    let mut particles = Particles::new(ids.map(|id| disc(id, step)).collect());
    if step >= 50 {
        let turned = &mut particles.all_mut()[0];
        (turned.angle, turned.omega) = (-1.0 / 3.0, 0.25);
    }
    let frame = ParticleFrame {
        particles,
        cell: [10.0 / 3.0, 8.0],
        origin: [-0.5, 0.1],
        periodic: Some([true, false]),
        time: 0.1 * step as f64,
        step,
        seed: None,
        has_raised_ids: false,
    };
    LoggedFrame { frame: frame.into(), images: vec![], values: vec![step as f64, f64::NAN] }
}

/// Two bodies in space that move apart.
fn space(step: u64) -> LoggedFrame {
    let far = 1.5 + step as f64;
    let body = |id, z| Particle { kind: ParticleKind::Grain, position: [far, -far, z], ..disc(id, step) };
    let LoggedFrame { frame, values, .. } = plane(step);
    let particles = Particles::new(vec![body(1, far), body(2, -0.25)]);
    let open = ([f64::INFINITY; 2], [0.0; 2], Some([false; 2]));
    let frame = ParticleFrame {
        particles,
        cell: open.0,
        origin: open.1,
        periodic: open.2,
        ..ParticleFrame::clone(&frame)
    };
    LoggedFrame { frame: frame.into(), images: vec![[1, -2], [0, step as i32]], values }
}

/// Writes a file of `count` frames; returns its bytes and its mark without frames, after the first, and so on.
fn written(path: &Path, of: fn(u64) -> LoggedFrame, count: u64) -> (Vec<Vec<u8>>, Vec<FileMark>) {
    let _ = fs::remove_file(path);
    let mut file = GsdWriter::begin(path.to_owned(), &header()).unwrap();
    let mut grown = (vec![fs::read(path).unwrap()], vec![file.mark().unwrap()]);
    for step in 0..count {
        file.write(of(step)).unwrap();
        grown.1.push(file.mark().unwrap());
        grown.0.push(fs::read(path).unwrap());
    }
    grown
}

#[test]
fn frames_are_read_by_number() {
    let (_folder, path) = folder_and_path();
    for of in [plane, space] {
        written(&path, of, MANY);
        let mut frames = GsdFrames::open(&path).unwrap();
        assert_eq!(frames.frame_count(), MANY);
        let mut random = Random(1);
        for _ in 0..500 {
            let number = random.below(MANY as usize) as u64;
            assert_eq!(frames.frame(number).unwrap().unwrap(), *of(number).frame);
        }
        assert!(frames.frame(MANY).unwrap().is_none());
        assert!(frames.map(|frame| frame.unwrap().step).eq(0..MANY));
    }
}

/// Other programs require all particles inside the box: a box without a ceiling is doubled until it holds them, in that frame only.
#[test]
fn every_disc_is_inside_the_box() {
    let (_folder, path) = folder_and_path();
    let high = |step: u64| {
        let mut frame = ParticleFrame::clone(&plane(step).frame);
        frame.particles.all_mut()[0].position[1] = if step == 1 { 19.0 } else { 1.0 };
        LoggedFrame { frame: frame.into(), ..plane(step) }
    };
    let (grown, marks) = written(&path, high, 3);
    let heights = |frame: usize| {
        // The box follows the step if it differs from the first frame's.
        let at = marks[frame].bytes as usize + 8;
        f32::from_le_bytes(grown[3][at + 4..at + 8].try_into().unwrap())
    };
    // The box of 8 has its centre at 4.1.
    assert!(heights(1) == 32.0 && heights(2) != 8.0, "{} {}", heights(1), heights(2));
    assert_eq!(GsdFrames::open(&path).unwrap().frame(1).unwrap().unwrap().cell, [10.0 / 3.0, 8.0]);
}

/// Readers of the schema replace a missing chunk by that of the first frame if it has as many rows. Only chunks that differ from the
/// first frame are written.
#[test]
fn unchanged_chunks_are_written_once() {
    let (_folder, path) = folder_and_path();
    let (_, marks) = written(&path, plane, 60);
    let lengths: Vec<u64> = marks.windows(2).map(|two| two[1].bytes - two[0].bytes).collect();
    // Step, time and two quantities; for each disc six numbers in single precision and four in double.
    let moving = |discs: u64| 4 * 8 + (12 * discs).next_multiple_of(8) * 2 + 32 * discs;
    assert!(lengths[1..30].iter().all(|&it| it == moving(5)), "{lengths:?}");
    assert!(lengths[30] > moving(4) && lengths[50] == lengths[30], "{lengths:?}");
}

/// From every mark, whatever was written after it and wherever the process was killed: the bytes of a run that was never stopped.
#[test]
fn resumed_trajectory_equals_an_uninterrupted_one() {
    let (_folder, path) = folder_and_path();
    let (grown, marks) = written(&path, plane, MANY);
    let whole = &grown[MANY as usize];
    let mut random = Random(2);
    for number in (1..MANY as usize).step_by(7) {
        let mark = marks[number];
        let more = number + random.below(MANY as usize - number);
        let next = &whole[marks[more].bytes as usize..];
        let torn = [&grown[more][..], &next[..random.below(next.len().min(2000) + 1)]].concat();
        for bytes in [whole, &grown[number], &grown[more], &torn] {
            fs::write(&path, bytes).unwrap();
            let mut file = resumed(&path, &header(), mark).unwrap();
            assert!(&fs::read(&path).unwrap() == bytes, "the file must not change before it is truncated");
            file.cut().unwrap();
            assert_eq!(GsdFrames::open(&path).unwrap().frame_count(), number as u64);
            for step in number as u64..MANY {
                file.write(plane(step)).unwrap();
            }
            assert_eq!(file.mark().unwrap(), marks[MANY as usize]);
            assert!(&fs::read(&path).unwrap() == whole, "from frame {number}");
        }
    }
}

/// Killed at any byte, the file consists of whole frames: all of them, or all but the last.
#[test]
fn killed_trajectory_has_whole_frames() {
    let (_folder, path) = folder_and_path();
    // Includes the frame that makes the index move for the first time.
    let (grown, _) = written(&path, plane, MANY);
    let moved = grown.iter().position(|bytes| bytes[8..16] != grown[0][8..16]).unwrap();
    for count in [3, moved] {
        let (before, after) = (&grown[count - 1], &grown[count]);
        let index = |bytes: &[u8]| u64::from_le_bytes(bytes[8..16].try_into().unwrap()) as usize;
        // In the order of writing: the end with the new index, the header, the end, the entries.
        let moves = index(before) != index(after);
        let capacity = u64::from_le_bytes(after[16..24].try_into().unwrap()) as usize;
        let data = if moves { index(after) + 32 * capacity } else { before.len() };
        let heading = before.len()..data;
        let mut states: Vec<Vec<u8>> = heading.step_by(1009).map(|end| after[..end].to_vec()).collect();
        for state in &mut states {
            state[..24].copy_from_slice(&before[..24]);
        }
        let ends = (data..=after.len()).step_by(5).map(|end| after[..end].to_vec());
        states.extend(ends.map(|mut bytes| {
            // The entries of the last frame are not written yet.
            let used = (0..).find(|entry| {
                let at = index(after) + 32 * entry;
                after[at..at + 8] == (count as u64 - 1).to_le_bytes() && after[at + 16..at + 24] != [0; 8]
            });
            let at = index(after) + 32 * used.unwrap();
            bytes[at..index(after) + 32 * capacity].fill(0);
            bytes
        }));
        for state in states {
            fs::write(&path, &state).unwrap();
            let mut frames = GsdFrames::open(&path).unwrap();
            let whole = count as u64 - 1;
            assert_eq!(frames.frame_count(), whole, "{} bytes", state.len());
            assert_eq!(frames.frame(whole - 1).unwrap().unwrap().step, whole - 1);
        }
    }
}

/// Bytes before the mark must still be there: a change in header, names, entries or chunks is refused, and the file is not changed.
#[test]
fn damage_before_the_mark_is_rejected() {
    let (_folder, path) = folder_and_path();
    let (mut grown, marks) = written(&path, plane, 4);
    let (whole, mark) = (grown.swap_remove(4), marks[4]);
    let refused = |bytes: &[u8], words: &str| {
        fs::write(&path, bytes).unwrap();
        let error = resumed(&path, &header(), mark).unwrap_err();
        assert!(error.is_damage() && error.to_string().contains(words), "{error}");
        assert_eq!(fs::read(&path).unwrap(), bytes);
    };
    for cut in (0..whole.len()).step_by(211) {
        refused(&whole[..cut], "bytes, but");
    }
    let index = u64::from_le_bytes(whole[8..16].try_into().unwrap()) as usize;
    let unused = index + 32 * (0..).find(|entry| whole[index + 32 * entry..][..32] == [0; 32]).unwrap();
    let end = index + 32 * 1024;
    // The position of the index may have been written after the mark.
    for place in (0..8).chain(24..unused).chain(end..whole.len()) {
        let mut bytes = whole.clone();
        bytes[place] ^= 1;
        refused(&bytes, "trajectory.gsd has changed");
    }
    fs::write(&path, &whole).unwrap();
    assert!(resumed(&path, &logging(vec!["heat"]), mark).unwrap_err().is_damage());
    fs::remove_file(&path).unwrap();
    assert!(resumed(&path, &header(), mark).unwrap_err().to_string().contains("is missing"));
}

/// Damaged and foreign files are refused with the location of the mistake.
#[test]
fn damaged_files_are_refused_with_the_location() {
    let (_folder, path) = folder_and_path();
    let whole = written(&path, plane, 4).0.swap_remove(4);
    let index = u64::from_le_bytes(whole[8..16].try_into().unwrap()) as usize;
    let data = index + 32 * 1024;
    let entry = |name: &str| {
        let names = std::str::from_utf8(&whole[256..index]).unwrap();
        let name = names.split('\0').position(|it| it == name).unwrap() as u16;
        let is_it = |entry: &usize| whole[index + 32 * entry + 28..][..2] == name.to_le_bytes();
        index + 32 * (0..1024).find(is_it).unwrap()
    };
    let chunk = |name: &str| u64::from_le_bytes(whole[entry(name) + 16..][..8].try_into().unwrap()) as usize;
    let cases: [(usize, &[u8], &str); 12] = [
        (0, b"CORD", "byte 0: expected the eight bytes"),
        (40, &[0, 0, 2, 0], "byte 40: expected version 1.4 of the schema"),
        (44, &[0, 0, 1, 0], "byte 44: expected version 2.0 of the file layer"),
        (48, b"gsd.hoomd", "byte 48: expected `stripmine` as the application"),
        (112, b"other", "byte 112: expected `hoomd` as the schema"),
        (8, &[255; 8], "the index ends at byte"),
        (index + 32 + 28, &[255, 255], &format!("byte {}: expected an entry of the index for", index + 32)),
        (
            index + 32 + 30,
            &[99],
            &format!("byte {}: expected a chunk of numbers of a known type", index + 32),
        ),
        (index + 64, &[9], &format!("byte {}: expected entries of the index in the order", index + 64)),
        (index + 32 + 16, &[0, 0, 0, 0, 1], &format!("byte {}: the chunk of this entry ends at", index + 32)),
        (
            chunk("log/particles/mass") + 8,
            &[0; 8],
            "frame 0, log/particles/mass: row 1 is `0`; expected a finite number greater",
        ),
        (
            chunk("log/particles/id"),
            &[3],
            "frame 0, log/particles/id: row 2 is 3, which is also the id of another particle",
        ),
    ];
    let first = |bytes: &[u8]| {
        fs::write(&path, bytes).unwrap();
        let error = GsdFrames::open(&path).and_then(|mut frames| frames.frame(0)).unwrap_err();
        assert!(error.to_string().contains("trajectory.gsd: "), "{error}");
        error.to_string()
    };
    for (at, bytes, words) in cases {
        let mut damaged = whole.clone();
        damaged[at..at + bytes.len()].copy_from_slice(bytes);
        assert!(first(&damaged).contains(words), "{words}: {}", first(&damaged));
    }
    // A chunk with another name instead of a required one, and one with fewer rows.
    for (name, at, byte, words) in [
        ("log/time", 28, 10, "frame 0, log/time: there is no such chunk"),
        (
            "particles/typeid",
            8,
            4,
            "frame 0, particles/typeid: found 4 × 1 numbers of type 3; expected 5 × 1",
        ),
    ] {
        let mut damaged = whole.clone();
        damaged[entry(name) + at] = byte;
        assert!(first(&damaged).contains(words), "{words}: {}", first(&damaged));
    }
    for cut in [0, 100, 300, index + 40, data - 1, data + 1, whole.len() - 1] {
        fs::write(&path, &whole[..cut]).unwrap();
        let error = GsdFrames::open(&path).unwrap_err().to_string();
        assert!(error.contains(&format!("the file at byte {cut}")), "{error}");
    }
}

/// In a file whose index has moved, a change of any byte up to the end of the last entry makes resumption fail. The unused rest of the
/// index is written again.
#[test]
fn damage_of_a_moved_index_is_refused() {
    let (_folder, path) = folder_and_path();
    // With so many quantities the index moves in the third frame.
    let header = logging((0..400).map(|number| &*format!("q{number}").leak()).collect());
    let mut file = GsdWriter::begin(path.clone(), &header).unwrap();
    let frame = |step| LoggedFrame { values: vec![0.5; 400], ..plane(step) };
    (0..3).for_each(|step| file.write(frame(step)).unwrap());
    let (mark, bytes) = (file.mark().unwrap(), fs::read(&path).unwrap());
    file.write(frame(3)).unwrap();
    file.mark().unwrap();
    drop(file);
    let whole = fs::read(&path).unwrap();
    let number = |at: usize| u64::from_le_bytes(bytes[at..at + 8].try_into().unwrap()) as usize;
    let (next, room, first) = (number(8), number(16), 256 + number(32) * 64);
    assert!(room == 2048 && next > first + 32 * 1024);
    let used = (0..room).find(|entry| bytes[next + 32 * entry..][..32] == [0; 32]).unwrap();
    fs::write(&path, &bytes).unwrap();
    let open = || fs::OpenOptions::new().write(true).open(&path).unwrap();
    for place in (0..first + 32 * 1024).chain(next..next + 32 * room) {
        let is_unused = place >= next + 32 * used;
        // A sample of the bytes of unused entries is enough.
        if is_unused && place % 97 > 0 {
            continue;
        }
        let put = |byte: u8| {
            let mut file = open();
            file.seek(SeekFrom::Start(place as u64)).unwrap();
            file.write_all(&[byte]).unwrap();
        };
        put(bytes[place] ^ 1 << (place % 8));
        match resumed(&path, &header, mark) {
            Err(error) => {
                assert!(
                    error.is_damage() && error.to_string().contains("has changed"),
                    "byte {place}: {error}"
                );
                put(bytes[place]);
            }
            Ok(mut file) => {
                assert!(is_unused, "byte {place} is not refused");
                file.cut().unwrap();
                file.write(frame(3)).unwrap();
                file.mark().unwrap();
                assert!(fs::read(&path).unwrap() == whole, "a change of byte {place} is accepted");
                fs::write(&path, &bytes).unwrap();
            }
        }
    }
}

/// A file that is long only because of holes is refused before memory is allocated for them.
#[test]
fn holes_take_no_memory() {
    let (_folder, path) = folder_and_path();
    let whole = written(&path, plane, 1).0.swap_remove(1);
    let index = u64::from_le_bytes(whole[8..16].try_into().unwrap()) as usize;
    let sparse = |changes: &[(usize, &[u8])]| {
        let mut bytes = whole.clone();
        changes.iter().for_each(|&(at, new)| bytes[at..at + new.len()].copy_from_slice(new));
        fs::write(&path, bytes).unwrap();
        fs::OpenOptions::new().write(true).open(&path).unwrap().set_len(1 << 42).unwrap();
        GsdFrames::open(&path).and_then(|mut frames| frames.frame(0)).unwrap_err().to_string()
    };
    let names = (1_u64 << 34).to_le_bytes();
    assert!(sparse(&[(32, &names)]).contains("byte 32: expected a list of names of at most 4 MiB"));
    // The largest possible number of particles, whose types are in the hole.
    let entry = |name: &str| {
        let names = std::str::from_utf8(&whole[256..index]).unwrap();
        let name = names.split('\0').position(|it| it == name).unwrap() as u16;
        index
            + 32 * (0..1024)
                .find(|entry| whole[index + 32 * entry + 28..][..2] == name.to_le_bytes())
                .unwrap()
    };
    let count = u64::from_le_bytes(whole[entry("particles/N") + 16..][..8].try_into().unwrap()) as usize;
    let many = u32::MAX.to_le_bytes();
    let rows = u64::from(u32::MAX).to_le_bytes();
    let said = sparse(&[(count, &many), (entry("particles/typeid") + 8, &rows)]);
    assert!(said.contains("frame 0, particles/typeid: it has 17179869180 bytes"), "{said}");
}
