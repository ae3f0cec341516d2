//! Intact checkpoints: every bit is read back, and replacing one is all or nothing.

use std::fs;
use std::path::Path;
use stripmine_physics::io::checkpoint::{
    Checkpoint, CheckpointColumn, CheckpointCounter, LatestCheckpoint, NAME, OlderCheckpoint, WriteError,
    previous, read_latest,
};

/// A small checkpoint with every kind of content.
pub fn checkpoint(step: u64) -> Checkpoint {
    let texts = |pairs: &[(&str, &str)]| {
        pairs.iter().map(|(name, text)| ((*name).to_owned(), (*text).to_owned())).collect()
    };
    let counters =
        [("contacts", CheckpointCounter::Count(u64::MAX)), ("energy", CheckpointCounter::Sum(-0.1))];
    let columns = [
        ("x", CheckpointColumn::F64(vec![0.1, -0.0, f64::MAX])),
        ("x_cell", CheckpointColumn::F32(vec![1e-45, f32::NEG_INFINITY])),
        ("id", CheckpointColumn::U32(vec![1, u32::MAX])),
        ("collisions", CheckpointColumn::U64(vec![7])),
        ("none", CheckpointColumn::F64(vec![])),
    ];
    Checkpoint {
        step,
        time: 0.1,
        scene: "[domain]\nlength = \"ä\"\n".to_owned(),
        origin: texts(&[("commit", "abc"), ("version", "0.1.0")]),
        counters: counters.map(|(name, counter)| (name.to_owned(), counter)).into(),
        columns: columns.map(|(name, column)| (name.to_owned(), column)).to_vec(),
    }
}

pub fn bytes(checkpoint: &Checkpoint) -> Vec<u8> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join(NAME);
    checkpoint.write_atomically(&path).unwrap();
    fs::read(path).unwrap()
}

fn names(folder: &Path) -> Vec<String> {
    let mut names: Vec<String> = fs::read_dir(folder)
        .unwrap()
        .map(|entry| entry.unwrap().file_name().into_string().unwrap())
        .collect();
    names.sort();
    names
}

#[test]
fn checkpoint_contents_are_read_back() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("any.name");
    for checkpoint in [Checkpoint::default(), checkpoint(3)] {
        checkpoint.write_atomically(&path).unwrap();
        assert_eq!(Checkpoint::read(&path).unwrap(), checkpoint);
    }
    let read = Checkpoint::read(&path).unwrap();
    assert_eq!(read.column("id"), Some(&CheckpointColumn::U32(vec![1, u32::MAX])));
    assert!(read.column("y").is_none());
}

/// Signalling and other NaNs, negative zero, denormals: bits, not values, are kept.
#[test]
fn float_bits_are_read_back() {
    let wide = [0x7ff0_0000_0000_0001, 0xfff8_dead_beef_cafe, 1 << 63, 1, u64::MAX, 0x7ff0_0000_0000_0000];
    let narrow = [0x7f80_0001, 0xffc0_beef, 1 << 31, 1, u32::MAX];
    let many: Vec<f64> = (0..20_000).map(|i| f64::from(i).sqrt()).collect();
    let written = Checkpoint {
        time: f64::from_bits(wide[0]),
        counters: [("sum".to_owned(), CheckpointCounter::Sum(f64::from_bits(wide[1])))].into(),
        columns: vec![
            ("wide".to_owned(), CheckpointColumn::F64(wide.map(f64::from_bits).to_vec())),
            ("narrow".to_owned(), CheckpointColumn::F32(narrow.map(f32::from_bits).to_vec())),
            ("many".to_owned(), CheckpointColumn::F64(many.clone())),
        ],
        ..checkpoint(0)
    };
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join(NAME);
    written.write_atomically(&path).unwrap();
    let read = Checkpoint::read(&path).unwrap();
    assert_eq!(read.time.to_bits(), wide[0]);
    assert!(matches!(read.counters["sum"], CheckpointCounter::Sum(sum) if sum.to_bits() == wide[1]));
    let Some(CheckpointColumn::F64(values)) = read.column("wide") else { panic!("wide") };
    assert_eq!(values.iter().map(|value| value.to_bits()).collect::<Vec<_>>(), wide);
    let Some(CheckpointColumn::F32(values)) = read.column("narrow") else { panic!("narrow") };
    assert_eq!(values.iter().map(|value| value.to_bits()).collect::<Vec<_>>(), narrow);
    assert_eq!(read.column("many"), Some(&CheckpointColumn::F64(many)));
}

#[test]
fn replacing_keeps_only_the_previous_checkpoint() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join(NAME);
    let older = format!("{NAME}.previous");
    checkpoint(0).write_atomically(&path).unwrap();
    assert_eq!(names(folder.path()), [NAME]);
    for step in 1..4 {
        checkpoint(step).write_atomically(&path).unwrap();
        assert_eq!(names(folder.path()), [NAME, &older]);
        assert_eq!(Checkpoint::read(&path).unwrap().step, step);
        assert_eq!(Checkpoint::read(previous(&path)).unwrap().step, step - 1);
    }
}

/// A kill after the newest checkpoint got its second name and before the new one replaced it.
#[test]
fn kill_between_both_renames_loses_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join(NAME);
    checkpoint(1).write_atomically(&path).unwrap();
    fs::hard_link(&path, previous(&path)).unwrap();
    assert_eq!(read_latest(folder.path()).unwrap().unwrap().checkpoint.step, 1);
    checkpoint(2).write_atomically(&path).unwrap();
    assert_eq!(names(folder.path()), [NAME.to_owned(), format!("{NAME}.previous")]);
    assert_eq!(Checkpoint::read(previous(&path)).unwrap().step, 1);
}

/// Foreign files at predictable names are neither followed nor overwritten.
#[cfg(unix)]
#[test]
fn no_link_is_followed() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join(NAME);
    let thesis = folder.path().join("thesis.tex");
    fs::write(&thesis, "whole").unwrap();
    for name in [NAME.to_owned(), format!("{NAME}.previous"), format!("{NAME}.new"), format!("{NAME}.link")] {
        std::os::unix::fs::symlink(&thesis, folder.path().join(name)).unwrap();
    }
    checkpoint(1).write_atomically(&path).unwrap();
    checkpoint(2).write_atomically(&path).unwrap();
    assert_eq!(fs::read_to_string(&thesis).unwrap(), "whole");
    assert_eq!(Checkpoint::read(&path).unwrap().step, 2);
    assert_eq!(Checkpoint::read(previous(&path)).unwrap().step, 1);
}

#[test]
fn failed_write_keeps_the_old_checkpoint() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join(NAME);
    checkpoint(1).write_atomically(&path).unwrap();
    // A folder at the name of the older one.
    fs::create_dir(previous(&path)).unwrap();
    let error = checkpoint(2).write_atomically(&path).unwrap_err();
    assert!(error.to_string().contains("run.checkpoint: keeping the checkpoint"), "{error}");
    assert_eq!(Checkpoint::read(&path).unwrap().step, 1);
    assert_eq!(names(folder.path()), [NAME.to_owned(), format!("{NAME}.previous")]);

    let mut twice = checkpoint(2);
    twice.columns.push(twice.columns[0].clone());
    let error = twice.write_atomically(&path).unwrap_err();
    assert!(matches!(error, WriteError::RepeatedColumn(ref name) if name == "x"), "{error}");
}

#[test]
fn newest_existing_checkpoint_is_read() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join(NAME);
    assert_eq!(read_latest(folder.path()).unwrap(), None);
    checkpoint(1).write_atomically(&path).unwrap();
    checkpoint(2).write_atomically(&path).unwrap();
    let latest = LatestCheckpoint { file: path.clone(), checkpoint: checkpoint(2) };
    assert_eq!(read_latest(folder.path()).unwrap(), Some(latest));
    fs::remove_file(&path).unwrap();
    let latest = LatestCheckpoint { file: previous(&path), checkpoint: checkpoint(1) };
    assert_eq!(read_latest(folder.path()).unwrap(), Some(latest));
}

#[test]
fn corrupt_checkpoint_error_offers_the_previous_one() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join(NAME);
    let (newest, older) = (path.display(), previous(&path));
    checkpoint(1).write_atomically(&path).unwrap();
    checkpoint(2).write_atomically(&path).unwrap();
    let whole = fs::read(&path).unwrap();
    let mut flipped = whole.clone();
    *flipped.last_mut().unwrap() ^= 1;
    fs::write(&path, flipped).unwrap();

    let error = read_latest(folder.path()).unwrap_err();
    assert!(error.is_corrupt() && error.kept == OlderCheckpoint::Whole { file: older.clone(), step: 1 });
    let expected = format!(
        "checkpoint {newest}: is corrupt: the checksum of column 5 of 5 is wrong (at byte {})
  kept: the older checkpoint, {}, of step 1, is valid
  help: to resume from it, rename it to {newest}",
        error.offset.unwrap(),
        older.display(),
    );
    assert_eq!(error.to_string(), expected);

    fs::write(&older, "no checkpoint").unwrap();
    let error = read_latest(folder.path()).unwrap_err();
    assert_eq!(error.kept, OlderCheckpoint::Unusable { file: older.clone() });
    assert!(error.to_string().ends_with("but it cannot be used either\n  help: start the run again"));
    fs::remove_file(&older).unwrap();
    let error = read_latest(folder.path()).unwrap_err();
    assert_eq!(error.kept, OlderCheckpoint::Nothing);
    assert!(error.to_string().ends_with("no older checkpoint is kept beside it; start the run again"));
    let error = Checkpoint::read(folder.path().join("missing")).unwrap_err();
    assert!(!error.is_corrupt(), "{error}");
}
