//! The files of a run, and the list of them that its folder has: `run.files`.

use crate::io::FORMATS;
use crate::io::checkpoint::NAME as CHECKPOINT;
use crate::io::owned_folder::{FolderKind, Holds};
use crate::structure::OBSERVABLES;

pub(super) use crate::io::owned_folder::OwnedFolder as RunFolder;

const LIST: &str = "run.files";
/// The table of observables.
pub(super) const THERMO: &str = "thermo.csv";
/// A row for each event.
pub(super) const EVENTS: &str = "events.csv";
/// The scene with every value spelled out.
pub(super) const SCENE: &str = "scene.toml";
/// What the run says of itself.
pub(super) const SUMMARY: &str = "summary.json";
/// The checkpoint before the newest.
const PREVIOUS: &str = "run.checkpoint.previous";

/// What a run writes whatever its scene, beside what grows.
pub(super) const ALWAYS: [&str; 5] = [LIST, SCENE, SUMMARY, CHECKPOINT, PREVIOUS];
/// Those that are removed first where a run begins again: without them, what is left is the beginning of a run.
pub(super) const CHECKPOINTS: [&str; 2] = [PREVIOUS, CHECKPOINT];

/// The folder of a run.
pub(super) const RUN: FolderKind = FolderKind {
    lock: "run.lock",
    list: LIST,
    holds: Holds::Files { heading: "stripmine run files 1", is_own, is_shared: false },
};

fn is_own(name: &str) -> bool {
    let formats = FORMATS.iter().map(|it| it.file);
    let mut all =
        ALWAYS.into_iter().chain([THERMO, EVENTS]).chain(formats).chain(OBSERVABLES.iter().map(|it| it.file));
    all.any(|own| own == name)
}

/// What must be there for a run to be gone on with.
pub(super) fn needed(has_checkpoint: bool) -> &'static [&'static str] {
    &[LIST, SCENE, CHECKPOINT][..if has_checkpoint { 3 } else { 2 }]
}
