//! Files of a run, and their list in its folder: `run.files`.

use super::changes::CHANGES;
use crate::io::FORMATS;
use crate::io::checkpoint::NAME as CHECKPOINT;
use crate::io::owned_folder::{FolderContent, FolderKind};
use crate::structure::OBSERVABLES;

pub(super) use crate::io::owned_folder::OwnedFolder as RunFolder;

const LIST: &str = "run.files";
/// Table of observables.
pub(super) const THERMO: &str = "thermo.csv";
/// Table of events.
pub(super) const EVENTS: &str = "events.csv";
/// Scene with every value.
pub(super) const SCENE: &str = "scene.toml";
/// Longest scene (bytes).
pub(super) const LONGEST_SCENE: u64 = 64 << 20;
/// Summary of the run.
pub(super) const SUMMARY: &str = "summary.json";
/// Checkpoint before the newest.
const PREVIOUS: &str = "run.checkpoint.previous";

/// Files that every run writes, except growing ones.
pub(super) const ALWAYS: [&str; 5] = [LIST, SCENE, SUMMARY, CHECKPOINT, PREVIOUS];
/// Files removed first when a run starts again: without them, the rest is the beginning of a run.
pub(super) const CHECKPOINTS: [&str; 2] = [PREVIOUS, CHECKPOINT];

/// Folder of a run.
pub(super) const RUN: FolderKind = FolderKind {
    lock: "run.lock",
    list: LIST,
    holds: FolderContent::Files { heading: "stripmine run files 1", is_own, is_shared: false },
};

fn is_own(name: &str) -> bool {
    let formats = FORMATS.iter().map(|it| it.file);
    let mut all = ALWAYS
        .into_iter()
        .chain([THERMO, EVENTS, CHANGES])
        .chain(formats)
        .chain(OBSERVABLES.iter().map(|it| it.file));
    all.any(|own| own == name)
}

/// Files that a run needs to be resumed.
pub(super) fn files_to_resume(has_checkpoint: bool) -> &'static [&'static str] {
    &[LIST, SCENE, CHECKPOINT][..if has_checkpoint { 3 } else { 2 }]
}
