//! Files that a resumed run appends to.

use crate::{frame, text};
use std::fs;
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use stripmine_physics::io::extxyz::write;
use stripmine_physics::io::growing_file::{FileMark, GrowingFile, GrowingFileError};
use stripmine_physics::io::run_moment::{RunHeader, RunMoment};
use stripmine_physics::io::sink::{Sink, TextSink};
use stripmine_physics::io::table_file::ObservedRows;
use stripmine_physics::particles::{Particles, PerParticle};
use tempfile::TempDir;

const COLUMNS: [&str; 2] = ["time", "energy"];

fn folder_and(name: &str) -> (TempDir, PathBuf) {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join(name);
    (folder, path)
}

type Table = TextSink<ObservedRows>;

fn header(columns: [&'static str; 2]) -> RunHeader {
    RunHeader { columns: columns.to_vec(), ..RunHeader::default() }
}

fn begun(path: &Path) -> Table {
    Table::begin(path.to_owned(), &header(COLUMNS)).unwrap()
}

fn resumed(path: &Path, columns: [&'static str; 2], mark: FileMark) -> Result<Table, GrowingFileError> {
    Table::resume(path.to_owned(), &header(columns), mark, &mut vec![])
}

struct Nothing;

impl PerParticle for Nothing {
    fn particles(&self) -> Particles {
        Particles::default()
    }
}

/// Appends the row of a step.
fn append(table: &mut Table, step: u64, row: &[f64]) -> io::Result<()> {
    let header = header(COLUMNS);
    let mut moment = RunMoment::new(&header, &Nothing, (step, step, 0.0));
    moment.row = Some(row);
    table.write(Table::entry(&moment).expect("there is a row"))
}

/// Writes a table of some rows; the mark is after the first `marked` of them.
fn table(path: &Path, marked: usize, steps: &[u64]) -> FileMark {
    let _ = fs::remove_file(path);
    let mut table = begun(path);
    let mut mark = FileMark::default();
    for (i, step) in steps.iter().enumerate() {
        if i == marked {
            mark = table.mark().unwrap();
        }
        append(&mut table, *step, &[0.1 * *step as f64, -1.0 / 3.0]).unwrap();
    }
    table.mark().unwrap();
    mark
}

/// A run that is interrupted and resumed leaves the same bytes as an uninterrupted one, whatever follows the mark.
#[test]
fn resumed_table_equals_an_uninterrupted_one() {
    let (_folder, path) = folder_and("thermo.csv");
    table(&path, 0, &[0, 10, 20, 30, 40]);
    let whole = fs::read_to_string(&path).unwrap();
    assert!(whole.starts_with("step,time,energy\n0,0.0,-0.3333333333333333\n10,1.0,"));
    for torn in ["", "50,5.", "torn", "\0\0\0"] {
        let mark = table(&path, 3, &[0, 10, 20, 30]);
        fs::write(&path, fs::read_to_string(&path).unwrap() + torn).unwrap();
        let mut table = resumed(&path, COLUMNS, mark).unwrap();
        table.cut().unwrap();
        for step in [30, 40] {
            append(&mut table, step, &[0.1 * step as f64, -1.0 / 3.0]).unwrap();
        }
        table.mark().unwrap();
        assert_eq!(fs::read_to_string(&path).unwrap(), whole);
    }
}

/// Bytes before the mark must still be there: missing and changed bytes are refused, and the file is not changed.
#[test]
fn table_damage_before_the_mark_is_refused() {
    let (_folder, path) = folder_and("thermo.csv");
    let mark = table(&path, 3, &[0, 10, 20, 30]);
    let whole = fs::read(&path).unwrap();
    let marked = mark.bytes as usize;
    for cut in 0..marked {
        fs::write(&path, &whole[..cut]).unwrap();
        let error = resumed(&path, COLUMNS, mark).unwrap_err();
        assert!(error.is_damage(), "{error}");
        assert!(error.to_string().contains(&format!("has {cut} bytes, but {marked} were")), "{error}");
        assert_eq!(fs::read(&path).unwrap(), whole[..cut]);
    }
    for place in 0..marked {
        let mut bytes = whole.clone();
        bytes[place] ^= 1;
        fs::write(&path, &bytes).unwrap();
        let error = resumed(&path, COLUMNS, mark).unwrap_err();
        assert!(error.is_damage() && error.to_string().contains("thermo.csv has changed"), "{error}");
        assert_eq!(fs::read(&path).unwrap(), bytes);
    }
    fs::remove_file(&path).unwrap();
    let missing = resumed(&path, COLUMNS, mark).unwrap_err();
    assert!(missing.is_damage() && missing.to_string().contains("thermo.csv is missing"), "{missing}");
}

#[test]
fn table_with_other_columns_is_refused() {
    let (_folder, path) = folder_and("thermo.csv");
    let mark = table(&path, 1, &[0, 10]);
    let error = resumed(&path, ["time", "heat"], mark).unwrap_err();
    assert!(
        error
            .to_string()
            .ends_with("thermo.csv:1: the columns are `step,time,energy`; this run writes `step,time,heat`"),
        "{error}"
    );
    assert!(error.is_damage());
}

#[test]
fn a_row_of_another_width_is_refused() {
    let (_folder, path) = folder_and("thermo.csv");
    let error = append(&mut begun(&path), 0, &[1.0]).unwrap_err();
    assert_eq!(error.to_string(), "a row of 1 numbers for 2 columns after `step`");
}

/// Frames that are torn anywhere after the mark.
#[test]
fn resumed_frames_equal_uninterrupted_ones() {
    let (_folder, path) = folder_and("trajectory.xyz");
    let all = [0, 5, 10].map(frame);
    let whole: String = all.iter().map(text).collect();
    for torn in 0..text(&all[2]).len() {
        let _ = fs::remove_file(&path);
        let mut file = GrowingFile::create(&path).unwrap();
        all[..2].iter().for_each(|frame| write(frame, &mut file).unwrap());
        let mark = file.sync().unwrap();
        file.write_all(&text(&all[2]).as_bytes()[..torn]).unwrap();
        drop(file);
        let mut file = GrowingFile::resume(&path, mark).unwrap();
        file.cut().unwrap();
        write(&all[2], &mut file).unwrap();
        let end = file.sync().unwrap();
        assert_eq!((fs::read_to_string(&path).unwrap(), end.bytes), (whole.clone(), whole.len() as u64));
    }
}

/// No existing file is overwritten, and no link is followed.
#[cfg(unix)]
#[test]
fn existing_files_and_links_are_not_overwritten() {
    let (folder, path) = folder_and("trajectory.xyz");
    let thesis = folder.path().join("thesis.tex");
    fs::write(&thesis, "whole").unwrap();
    std::os::unix::fs::symlink(&thesis, &path).unwrap();
    assert!(GrowingFile::create(&path).is_err());
    assert!(matches!(GrowingFile::resume(&path, FileMark::default()), Err(GrowingFileError::NoFile(_))));
    fs::remove_file(&path).unwrap();
    fs::rename(&thesis, &path).unwrap();
    assert!(GrowingFile::create(&path).is_err());
    assert_eq!(fs::read_to_string(&path).unwrap(), "whole");
}

/// Changes by others while the file is written are noticed when it is synced to disk.
#[cfg(unix)]
#[test]
fn files_changed_by_others_are_noticed() {
    let (folder, path) = folder_and("trajectory.xyz");
    let spoil: [&dyn Fn(&Path); 4] = [
        &|path| fs::remove_file(path).unwrap(),
        &|path| fs::rename(path, folder.path().join("elsewhere")).unwrap(),
        &|path| {
            fs::remove_file(path).unwrap();
            fs::write(path, "another").unwrap();
        },
        &|path| fs::write(path, "").unwrap(),
    ];
    for spoil in spoil {
        let _ = fs::remove_file(&path);
        let mut file = GrowingFile::create(&path).unwrap();
        file.write_all(b"some").unwrap();
        file.sync().unwrap();
        spoil(&path);
        file.write_all(b"more").unwrap();
        let error = file.sync().unwrap_err().to_string();
        assert!(error.contains("trajectory.xyz"), "{error}");
    }
}
