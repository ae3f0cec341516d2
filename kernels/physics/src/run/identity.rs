//! Identity of a run: its scene, its discs, and the program as far as it determines the bits.

use super::folder::{LONGEST_SCENE, SCENE};
use super::{RunError, RunJob};
use crate::io::checkpoint::{Checkpoint, CheckpointCounter};
use crate::io::regular_file;
use crate::method::Clock;
use crate::origin::Origin;
use crate::particles::{Particle, ParticleKind, Particles};
use crate::scene::{SceneValues, Vocabulary};
use sha2::{Digest, Sha256};
use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

/// Number of the bits that this program promises. It is raised whenever the same scene gives other bits, or a column of the state or a file of a
/// run changes its meaning. Programs with the same number may resume each other's runs.
pub(super) const BITS: u64 = 4;

/// Scene, discs and program that started a run.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct RunIdentity {
    /// Scene with every value (TOML).
    pub(super) scene: String,
    /// Digest of all initial discs.
    discs: String,
    /// Path of the start file, if there is one.
    file: Option<String>,
    /// Program that runs it.
    program: Origin,
}

impl RunIdentity {
    /// Identity of a job whose run is in `folder`.
    pub(super) fn of(RunJob { prepared, program, .. }: &RunJob<'_>, folder: &Path) -> RunIdentity {
        let discs = digest(prepared.particles());
        let file = prepared.start_file.as_deref();
        let scene = with_files(&prepared.scene, |section| {
            let (file, label, digest) = match (section, &prepared.law_file) {
                ("[law]", Some((file, digest))) => (file.as_path(), ROWS, digest),
                _ => (file?, DISCS, &discs),
            };
            Some((path_seen_from_folder(folder, file), format!("{label}{digest}")))
        });
        let file = file.map(|file| file.display().to_string());
        RunIdentity { scene, discs, file, program: Origin::clone(program) }
    }

    /// Entries for a checkpoint.
    pub(super) fn origin(&self, notes: &[String]) -> BTreeMap<String, String> {
        let Origin { version, commit, dirty, target } = self.program.clone();
        let origin = [
            ("version", version),
            ("commit", commit),
            ("dirty", dirty.to_string()),
            ("target", target),
            ("discs", self.discs.clone()),
            ("notes", notes.join("\n")),
        ];
        origin.map(|(name, value)| (name.to_owned(), value)).into()
    }

    /// Compares the identity with that of the run in `folder`, and returns the notes on that run so far.
    ///
    /// # Errors
    /// If scene or discs differ, or this program does not promise the same bits and `other_version` is false.
    pub(super) fn check(
        &self,
        folder: &Path,
        checkpoint: &Checkpoint,
        moment: Clock,
        other_version: bool,
    ) -> Result<Vec<String>, RunError> {
        // Discs and tables are compared by their digests, so the files may have moved.
        let [theirs, ours] = [&checkpoint.scene, &self.scene].map(|scene| without_files(scene));
        same_scene(folder, &theirs, &ours)?;
        let rows = |scene: &String| {
            scene.lines().find(|line| line.starts_with(ROWS)).unwrap_or("nothing").to_owned()
        };
        let [theirs, ours] = [&checkpoint.scene, &self.scene].map(rows);
        if theirs != ours {
            return Err(RunError::OtherScene { folder: folder.to_owned(), theirs, ours });
        }
        let said = |name: &str| checkpoint.origin.get(name).cloned().unwrap_or_default();
        if said("discs") != self.discs {
            return Err(RunError::OtherDiscs {
                folder: folder.to_owned(),
                file: self.file.clone().unwrap_or_else(|| "as this version creates them".to_owned()),
                theirs: short(&said("discs")),
                ours: short(&self.discs),
            });
        }
        let mut notes: Vec<String> = said("notes").lines().map(str::to_owned).collect();
        let here = &self.program;
        let theirs = Origin {
            version: said("version"),
            commit: said("commit"),
            dirty: said("dirty") == "true",
            target: said("target"),
        };
        let same_bits = checkpoint.counters.get("bits") == Some(&CheckpointCounter::Count(BITS));
        if !same_bits && !other_version {
            let (theirs, ours) = (program(&theirs), program(here));
            return Err(RunError::OtherVersion { folder: folder.to_owned(), theirs, ours });
        }
        if !same_bits || theirs != *here {
            let promise = if same_bits {
                "which promises the same bits"
            } else {
                "which does not promise the same bits"
            };
            notes.push(format!(
                "resumed at {moment} with {}, {promise}; before with {}",
                program(here),
                program(&theirs)
            ));
        }
        Ok(notes)
    }
}

fn program(origin: &Origin) -> String {
    let Origin { version, commit, dirty, target } = origin;
    let changed = if *dirty { " with changes" } else { "" };
    format!("stripmine {version} of commit {commit}{changed} for {target}")
}

/// Beginning of a digest, long enough to compare two by eye.
fn short(digest: &str) -> String {
    digest.chars().take(12).collect()
}

/// SHA-256 of all bits of all discs, in hexadecimal.
fn digest(particles: &Particles) -> String {
    let mut sum = Sha256::new();
    for &Particle {
        id,
        kind,
        species: _,
        position: [x, y, z],
        velocity: [u, v, w],
        angle,
        omega,
        radius,
        mass,
    } in particles.all()
    {
        sum.update(id.to_le_bytes());
        sum.update([u8::from(kind == ParticleKind::Wall)]);
        [x, y, z, u, v, w, angle, omega, radius, mass]
            .iter()
            .for_each(|value| sum.update(value.to_bits().to_le_bytes()));
    }
    sum.finalize().iter().map(|byte| format!("{byte:02x}")).collect()
}

/// Choices of the run in `folder` that differ from those of `ours`, the resolved scene, for keys that are `auto` in the scene; as overrides, so
/// that a resumed run keeps them.
pub fn choices_of_the_run(
    values: &SceneValues,
    vocabulary: &'static Vocabulary,
    ours: &str,
    folder: &Path,
) -> Vec<String> {
    let file = folder.join(SCENE).display().to_string();
    let known = [vocabulary];
    // A scene that cannot be read is refused by the later comparison.
    let (Ok(theirs), Ok(ours)) =
        (SceneValues::load(&file, &[], &known), SceneValues::parse("scene", ours, &[], &known))
    else {
        return vec![];
    };
    let open = vocabulary.keys.keys().filter(|key| values.choice(key).as_deref() == Some("auto"));
    let otherwise = open.filter(|key| theirs.choice(key) != ours.choice(key));
    otherwise.filter_map(|key| theirs.choice(key).map(|word| format!("{}={word}", key.path()))).collect()
}

/// Checks, before anything is computed, that the run in a folder, if there is one, has a resolved scene. The contents of files are not compared.
///
/// # Errors
/// [`RunError::OtherScene`] with the first difference.
pub fn check_scene_of_folder(scene: &str, folder: &Path) -> Result<(), RunError> {
    // A scene that cannot be read is refused when the run is resumed.
    let Ok(theirs) = regular_file::read(&folder.join(SCENE), LONGEST_SCENE) else { return Ok(()) };
    let [theirs, ours] = [&String::from_utf8_lossy(&theirs), scene].map(without_files);
    same_scene(folder, &theirs, &ours)
}

/// Beginning of a line with the path of a file.
const FILE: &str = "file = ";
/// Comment in a run's scene with the digest of its start file's discs.
const DISCS: &str = "# discs of this file: SHA-256 ";

/// Comment in a run's scene with the digest of the rows of its law's table.
const ROWS: &str = "# rows of this file: SHA-256 ";

/// Scene of a run that reads files: for each section with a file its path from the run's folder, and a comment with the digest of what was read.
fn with_files(scene: &str, file_of: impl Fn(&str) -> Option<(PathBuf, String)>) -> String {
    let (mut section, mut text) = ("", String::new());
    for line in scene.lines() {
        if line.starts_with('[') {
            section = line;
        }
        match file_of(section).filter(|_| line.starts_with(FILE)) {
            Some((file, comment)) => {
                let place = toml::Value::from(file.to_string_lossy().into_owned());
                text.push_str(&format!("{FILE}{place}\n{comment}\n"));
            }
            None => text.push_str(&format!("{line}\n")),
        }
    }
    text
}

/// Path of a file relative to a folder, if a common folder is at most two levels up, so that both can be moved together; else the absolute path.
fn path_seen_from_folder(folder: &Path, file: &Path) -> PathBuf {
    const LEVELS: usize = 2;
    let place = |folder: &Path| fs::canonicalize(folder).ok();
    let (Some(from), Some(beside), Some(name)) =
        (place(folder), file.parent().and_then(place), file.file_name())
    else {
        return file.to_owned();
    };
    let common =
        (1..).zip(from.ancestors().skip(1)).take(LEVELS).filter(|(_, above)| above.parent().is_some());
    let below =
        common.into_iter().find_map(|(levels, above)| Some((levels, beside.strip_prefix(above).ok()?)));
    match below {
        Some((levels, below)) => PathBuf::from("../".repeat(levels)).join(below).join(name),
        None => file.to_owned(),
    }
}

/// Scene without the paths of its files and the digests.
fn without_files(scene: &str) -> String {
    let is_other = |line: &&str| ![FILE, DISCS, ROWS].iter().any(|start| line.starts_with(start));
    scene.lines().filter(is_other).flat_map(|line| [line, "\n"]).collect()
}

/// Refuses a scene that differs from the run's in other keys than duration, output and the paths of files.
///
/// # Errors
/// [`RunError::OtherScene`] with the first difference.
pub(super) fn same_scene(folder: &Path, theirs: &str, ours: &str) -> Result<(), RunError> {
    match first_difference(&physics(theirs), &physics(ours)) {
        None => Ok(()),
        Some([theirs, ours]) => Err(RunError::OtherScene { folder: folder.to_owned(), theirs, ours }),
    }
}

/// Lines of a resolved scene that determine the physics: without duration and output, and with the digest of a file instead of its path.
pub(super) fn physics(scene: &str) -> Vec<&str> {
    let all: Vec<&str> = scene.lines().filter(|line| !line.trim().is_empty()).collect();
    let is_digest = |line: &&str| line.starts_with(DISCS) || line.starts_with(ROWS);
    let mut lines = Vec::new();
    let mut of_run = false;
    for (at, &line) in all.iter().enumerate() {
        if line.starts_with('[') {
            of_run = matches!(line.trim(), "[run]" | "[output]");
        }
        let is_place = line.starts_with(FILE) && all.get(at + 1).is_some_and(is_digest);
        if !(of_run || is_place) {
            lines.push(line);
        }
    }
    lines
}

/// First lines that differ.
pub(super) fn first_difference(theirs: &[&str], ours: &[&str]) -> Option<[String; 2]> {
    let line = (0..theirs.len().max(ours.len())).find(|&line| theirs.get(line) != ours.get(line))?;
    Some([theirs, ours].map(|lines| lines.get(line).map_or("nothing", |line| line).to_owned()))
}
