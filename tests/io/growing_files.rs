//! Tables and trajectories that a resumed run goes on with.

use crate::{frame, text};
use std::fs;
use std::path::PathBuf;
use stripmine::io::extxyz::Trajectory;
use stripmine::io::table_file::{TableFile, TableFileError};
use tempfile::TempDir;

const COLUMNS: [&str; 2] = ["time", "energy"];

fn folder_and(name: &str) -> (TempDir, PathBuf) {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join(name);
    (folder, path)
}

fn table(path: &PathBuf, steps: impl Iterator<Item = u64>) {
    let mut table = TableFile::create(path, &COLUMNS).unwrap();
    steps.for_each(|step| table.append(step, &[0.1 * step as f64, -1.0 / 3.0]).unwrap());
    table.sync().unwrap();
}

/// A run that is interrupted and resumed leaves the same bytes as one that is not.
#[test]
fn a_resumed_table_is_the_table_of_one_run() {
    let (_folder, path) = folder_and("thermo.csv");
    table(&path, [0, 10, 20, 30, 40].into_iter());
    let whole = fs::read_to_string(&path).unwrap();
    assert!(whole.starts_with("step,time,energy\n0,0.0,-0.3333333333333333\n10,1.0,"));

    for (resumed, torn) in [(20, ""), (25, "50,5."), (20, "torn")] {
        table(&path, [0, 10, 20, 30].into_iter());
        fs::write(&path, fs::read_to_string(&path).unwrap() + torn).unwrap();
        let mut table = TableFile::resume(&path, &COLUMNS, resumed).unwrap();
        for step in [30, 40] {
            table.append(step, &[0.1 * step as f64, -1.0 / 3.0]).unwrap();
        }
        table.sync().unwrap();
        assert_eq!(fs::read_to_string(&path).unwrap(), whole);
    }
}

#[test]
fn a_torn_row_is_cut_off() {
    let (_folder, path) = folder_and("thermo.csv");
    table(&path, [0, 10].into_iter());
    let whole = fs::read_to_string(&path).unwrap();
    for cut in 1..20 {
        fs::write(&path, &whole[..whole.len() - cut]).unwrap();
        TableFile::resume(&path, &COLUMNS, 10).unwrap();
        assert_eq!(fs::read_to_string(&path).unwrap(), "step,time,energy\n0,0.0,-0.3333333333333333\n");
    }
}

#[test]
fn a_table_of_something_else_is_refused_and_stays() {
    let (_folder, path) = folder_and("thermo.csv");
    for (text, words) in [
        ("", "thermo.csv:1: the columns are ``; this run writes `step,time,energy`"),
        (
            "step,time,heat\n",
            "thermo.csv:1: the columns are `step,time,heat`; this run writes `step,time,energy`",
        ),
        (
            "step,time,energy\n0,1,2\nx,1,2\n",
            "thermo.csv:3: expected a row of 3 that begins with a step, found `x,1,2`",
        ),
        ("step,time,energy\n0,1\n", "thermo.csv:2: expected a row of 3 that begins with a step, found `0,1`"),
    ] {
        fs::write(&path, text).unwrap();
        let error = TableFile::resume(&path, &COLUMNS, 10).unwrap_err().to_string();
        assert!(error.ends_with(words), "{error}");
        assert_eq!(fs::read_to_string(&path).unwrap(), text);
    }
    fs::remove_file(&path).unwrap();
    let missing = TableFile::resume(&path, &COLUMNS, 10).unwrap_err();
    assert!(matches!(missing, TableFileError::File(_)), "{missing}");
}

#[test]
fn a_row_of_another_width_is_refused() {
    let (_folder, path) = folder_and("thermo.csv");
    let mut table = TableFile::create(&path, &COLUMNS).unwrap();
    let error = table.append(0, &[1.0]).unwrap_err();
    assert!(matches!(error, TableFileError::Width { found: 1, expected: 2, .. }), "{error}");
}

#[test]
fn a_resumed_trajectory_is_the_trajectory_of_one_run() {
    let (_folder, path) = folder_and("trajectory.xyz");
    let all = [0, 5, 10, 15].map(frame);
    let whole: String = all.iter().map(text).collect();
    // Whole, or torn anywhere in the last frame.
    for cut in 0..text(&all[3]).len() {
        fs::write(&path, &whole[..whole.len() - cut]).unwrap();
        let mut trajectory = Trajectory::resume(&path, 7).unwrap();
        all[2..].iter().for_each(|frame| trajectory.append(frame).unwrap());
        trajectory.sync().unwrap();
        assert_eq!(fs::read_to_string(&path).unwrap(), whole);
    }
    fs::write(&path, &whole[..whole.len() - 1]).unwrap();
    drop(Trajectory::resume(&path, 15).unwrap());
    assert_eq!(fs::read_to_string(&path).unwrap(), all[..3].iter().map(text).collect::<String>());
}

#[test]
fn a_trajectory_begins_empty_and_is_not_resumed_from_other_text() {
    let (_folder, path) = folder_and("trajectory.xyz");
    fs::write(&path, "step,time\n").unwrap();
    let error = Trajectory::resume(&path, 7).unwrap_err().to_string();
    assert!(error.ends_with(
        "trajectory.xyz:1: expected the number of discs, which begins a frame, found `step,time`"
    ));
    let mut trajectory = Trajectory::create(&path).unwrap();
    trajectory.append(&frame(0)).unwrap();
    trajectory.sync().unwrap();
    assert_eq!(fs::read_to_string(&path).unwrap(), text(&frame(0)));
}
