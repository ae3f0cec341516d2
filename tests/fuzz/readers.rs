//! One fuzz test for each reader.

use crate::{cases, corpus, fuzz};
use crc32fast::Hasher;
use std::io::Cursor;
use stripmine::model::host::{HostModel, default_model};
use stripmine::model::machine::MachineModel;
use stripmine::model::machines::names;
use stripmine_physics::io::checkpoint::{Checkpoint, CheckpointColumn, CheckpointCounter};
use stripmine_physics::io::extxyz::{self, XyzFrames};
use stripmine_physics::io::gsd;
use stripmine_physics::io::run_moment::RunHeader;
use stripmine_physics::io::sink::Sink;
use stripmine_physics::method::lattice_md::{ENTRY, GranularDocument};

const MEGABYTE: u64 = 1 << 20;

pub(crate) fn scenes() -> Vec<Vec<u8>> {
    let presets = ENTRY.vocabulary.presets.iter().map(|preset| preset.text.as_bytes().to_vec());
    presets.chain(corpus("scene")).collect()
}

fn read_scene(bytes: &[u8]) {
    let text = String::from_utf8_lossy(bytes);
    if let Ok(document) = GranularDocument::parse("scene.toml", &text, &[]) {
        let written = document.scene.to_toml();
        let again = GranularDocument::parse("scene.toml", &written, &[]).unwrap();
        assert_eq!(again.scene, document.scene, "{written}");
    }
}

#[test]
fn scenes_are_read_or_refused() {
    fuzz(&scenes(), cases(3000), 64 * MEGABYTE, read_scene);
}

/// Overrides: every key with mutated values.
#[test]
fn overrides_are_read_or_refused() {
    let seeds: Vec<Vec<u8>> =
        ENTRY.vocabulary.keys.keys().map(|key| format!("{}=[1.0, 2.0]", key.path()).into_bytes()).collect();
    fuzz(&seeds, cases(3000), 16 * MEGABYTE, |bytes| {
        let set = String::from_utf8_lossy(bytes).into_owned();
        if let Ok(document) = GranularDocument::load("two-discs", &[set]) {
            document.scene.to_toml();
        }
    });
}

fn frames() -> Vec<Vec<u8>> {
    let start = include_bytes!("../scenes/bad/two.xyz").to_vec();
    let twice = start.repeat(2);
    [start, twice].into_iter().chain(corpus("xyz")).collect()
}

#[test]
fn frames_are_read_or_refused() {
    fuzz(&frames(), cases(5000), 64 * MEGABYTE, |bytes| {
        for frame in XyzFrames::new(Cursor::new(bytes), "fuzz.xyz").flatten() {
            let mut written = Vec::new();
            extxyz::write(&frame, &mut written).unwrap();
            let again = XyzFrames::new(Cursor::new(written), "again.xyz").next().unwrap().unwrap();
            // Raised ids are written as they are now.
            assert_eq!(again, extxyz::ParticleFrame { has_raised_ids: false, ..frame });
        }
    });
}

/// A trajectory with an index: damage to its header, index and chunks.
#[test]
fn trajectories_are_read_or_refused() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("seed.gsd");
    let start = XyzFrames::new(Cursor::new(frames().swap_remove(0)), "two.xyz").next().unwrap().unwrap();
    let header = RunHeader { columns: vec!["energy"], logged: vec![0], ..RunHeader::default() };
    let mut file = gsd::GsdWriter::begin(path.clone(), &header).unwrap();
    for step in 0..3 {
        let frame = extxyz::ParticleFrame { step, ..start.clone() };
        file.write(gsd::LoggedFrame { frame: frame.into(), images: vec![], values: vec![0.5] }).unwrap();
    }
    let seed = std::fs::read(&path).unwrap();
    let damaged = folder.path().join("fuzz.gsd");
    fuzz(&[seed], cases(2000), 4 * MEGABYTE, |bytes| {
        std::fs::write(&damaged, bytes).unwrap();
        match gsd::GsdFrames::open(&damaged) {
            Ok(frames) => assert!(frames.flatten().all(|frame| frame.time.is_finite())),
            Err(error) => assert!(error.to_string().contains("fuzz.gsd: ")),
        }
    });
}

#[test]
fn machine_files_are_read_or_refused() {
    let folder = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("src/model/machines");
    let presets = names().map(|name| std::fs::read(folder.join(format!("{name}.toml"))).unwrap());
    let seeds: Vec<Vec<u8>> = presets.chain(corpus("machine")).collect();
    fuzz(&seeds, cases(1000), 256 * MEGABYTE, |bytes| {
        match MachineModel::parse("fuzz.toml", &String::from_utf8_lossy(bytes)) {
            Ok(machine) => {
                let mut counts = stripmine_kernels::isa::op::OpCounts::default();
                stripmine_kernels::isa::op::Op::ALL.iter().for_each(|&op| counts.record(op));
                assert!(machine.expand(&counts).values().all(|&count| count > 0));
            }
            Err(error) => assert!(error.to_string().len() < 100_000),
        }
    });
}

/// A host model with few entries, so that mutations hit every kind of entry.
fn small_host() -> Vec<u8> {
    let mut model = default_model().unwrap();
    model.rates.retain(|name, _| name == "fast");
    model.to_toml().unwrap().into_bytes()
}

#[test]
fn host_files_are_read_or_refused() {
    let seeds: Vec<Vec<u8>> = std::iter::once(small_host()).chain(corpus("host")).collect();
    fuzz(&seeds, cases(500), 256 * MEGABYTE, |bytes| {
        match HostModel::parse("fuzz.toml", &String::from_utf8_lossy(bytes)) {
            Ok(model) => {
                // Numbers are written with limited precision: the second round trip is exact.
                let written = HostModel::parse("again.toml", &model.to_toml().unwrap()).unwrap();
                assert_eq!(HostModel::parse("again.toml", &written.to_toml().unwrap()).unwrap(), written);
            }
            Err(error) => assert!(error.to_string().len() < 100_000),
        }
    });
}

fn checkpoint() -> Vec<u8> {
    let checkpoint = Checkpoint {
        step: 12,
        time: 0.5,
        scene: "format = 1\n".to_owned(),
        origin: [("version".to_owned(), "0.1.0".to_owned())].into(),
        counters: [
            ("a".to_owned(), CheckpointCounter::Count(3)),
            ("b".to_owned(), CheckpointCounter::Sum(0.25)),
        ]
        .into(),
        columns: vec![
            ("x".to_owned(), CheckpointColumn::F64(vec![1.0, 2.0])),
            ("y".to_owned(), CheckpointColumn::F32(vec![1.0])),
            ("z".to_owned(), CheckpointColumn::U32(vec![7, 8, 9])),
            ("w".to_owned(), CheckpointColumn::U64(vec![])),
        ],
    };
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("run.checkpoint");
    checkpoint.write_atomically(&path).unwrap();
    std::fs::read(path).unwrap()
}

/// Corrects length and checksums where present, so that mutations reach the checks behind the checksums.
fn sealed(bytes: &[u8]) -> Vec<u8> {
    let mut bytes = bytes.to_vec();
    if bytes.len() < 28 {
        return bytes;
    }
    let length = bytes.len() as u64;
    bytes[16..24].copy_from_slice(&length.to_le_bytes());
    let mut checksum = Hasher::new();
    checksum.update(&bytes[..24]);
    let seal = |bytes: &mut Vec<u8>, at: usize, checksum: &Hasher| {
        bytes[at..at + 4].copy_from_slice(&checksum.clone().finalize().to_le_bytes());
    };
    seal(&mut bytes, 24, &checksum);
    let mut at = 28;
    while at + 16 <= bytes.len() {
        let mut claimed = [0; 8];
        claimed.copy_from_slice(&bytes[at + 4..at + 12]);
        let Some(end) = usize::try_from(u64::from_le_bytes(claimed))
            .ok()
            .and_then(|claimed| claimed.checked_add(at + 12))
        else {
            break;
        };
        if end.checked_add(4).is_none_or(|end| end > bytes.len()) {
            break;
        }
        checksum.update(&bytes[at..end]);
        seal(&mut bytes, end, &checksum);
        at = end + 4;
    }
    bytes
}

#[test]
fn checkpoints_are_read_or_refused() {
    let seeds: Vec<Vec<u8>> = std::iter::once(checkpoint()).chain(corpus("checkpoint")).collect();
    assert!(Checkpoint::decode(&sealed(&seeds[0])).is_ok());
    fuzz(&seeds, cases(5000), MEGABYTE, |bytes| {
        let _ = Checkpoint::decode(bytes);
        let _ = Checkpoint::decode(&sealed(bytes));
    });
}
