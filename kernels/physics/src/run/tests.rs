//! Tests of runs in every format of the list; a new format is tested by its entry there.

use super::{ExistingRun, RunJob, run};
use crate::io::FORMATS;
use crate::method::{METHODS, load};
use crate::origin::Origin;
use std::collections::BTreeMap;
use std::fs;
use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};

/// Runs a short scene, with all formats or none, until a number of steps, if given; returns the files of formats with their bytes.
fn files_after(
    folder: &Path,
    is_asked: bool,
    existing: ExistingRun,
    stop: Option<u64>,
) -> BTreeMap<String, Vec<u8>> {
    let asked = FORMATS.iter().map(|format| format!("output.{}={is_asked}", format.key));
    let short = ["run.steps=60", "run.thermo_every=5", "run.snapshot_every=7", "run.checkpoint_every=10"];
    let overrides: Vec<String> = asked.chain(short.map(str::to_owned)).collect();
    let (prepared, entry) = load("two-discs", &overrides, METHODS).unwrap();
    let program = Origin {
        version: "0".to_owned(),
        commit: "unknown".to_owned(),
        dirty: false,
        target: "here".to_owned(),
    };
    let quantities = prepared.quantities(entry);
    let job = RunJob { prepared: prepared.into(), quantities, program: &program, is_open_ended: false };
    let is_stopped = AtomicBool::new(false);
    let progress = |done, _| is_stopped.store(stop == Some(done), Ordering::Relaxed);
    run(job, folder, existing, &is_stopped, progress, |_| {}).unwrap();
    let read = |name: &str| Some((name.to_owned(), fs::read(folder.join(name)).ok()?));
    FORMATS.iter().filter_map(|format| read(format.file)).collect()
}

/// Each file exists, is not empty, and is the same however often the run is stopped. A run that overwrites another removes the files that it does
/// not create.
#[test]
fn formats_are_begun_resumed_and_removed() {
    let folder = tempfile::tempdir().unwrap();
    let [whole, parts] = ["whole", "parts"].map(|name| folder.path().join(name));
    let expected = files_after(&whole, true, ExistingRun::Refuse, None);
    assert_eq!(expected.len(), FORMATS.len());
    assert!(expected.values().all(|bytes| !bytes.is_empty()));
    let go_on = ExistingRun::Resume { other_version: false };
    for stop in [Some(23), Some(24), Some(41), None] {
        let found = files_after(&parts, true, go_on, stop);
        assert!(stop.is_some() || found == expected, "other bytes than those of one piece");
    }
    let left = files_after(&parts, false, ExistingRun::Overwrite, None);
    let always = FORMATS.iter().filter(|format| format.is_default).map(|format| format.file);
    assert_eq!(left.keys().collect::<Vec<_>>(), always.collect::<Vec<_>>());
}
