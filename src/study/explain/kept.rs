//! What was measured of scenes, kept for this host and this version of the program: the second time costs nothing.

use super::Target;
use super::alike::Alike;
use super::findings::Findings;
use crate::provenance::Provenance;
use crate::study::Case;
use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};
use std::fs;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};
use std::time::SystemTime;
use stripmine_physics::number::significant;
use stripmine_physics::quoted;
use stripmine_physics::reported::{Class, Reported};

/// The folder of the user's caches, by the variables that name it.
const PLACES: [(&str, &str); 2] = [("XDG_CACHE_HOME", "stripmine"), ("HOME", ".cache/stripmine")];

/// Why what is kept is of no use.
#[derive(Debug, thiserror::Error)]
pub enum KeptError {
    /// A file that cannot be read or written.
    #[error("{}: {source}", quoted::path(path))]
    File {
        /// The file.
        path: PathBuf,
        /// What the system says.
        source: std::io::Error,
    },
}

impl Reported for KeptError {
    fn class(&self) -> Class {
        Class::InputOutput
    }
}

/// Where measurements are kept; nowhere, where the user has no folder for it.
#[derive(Clone, Debug)]
pub struct Kept {
    folder: Option<PathBuf>,
    host: String,
}

/// A file of what was measured.
#[derive(Serialize, Deserialize)]
struct File {
    /// The scene.
    scene: String,
    /// Processor and version that it was measured with.
    host: String,
    /// When.
    moment: String,
    /// Seconds of trials that were asked for, and that they took.
    seconds: f64,
    taken: f64,
    /// What other scenes are held against.
    alike: Alike,
    findings: Findings,
}

/// As much of a commit as tells it from others.
fn short(commit: &str) -> &str {
    commit.get(..10).unwrap_or(commit)
}

impl Kept {
    /// In the user's folder of caches, for this processor, number of threads and version.
    pub fn here() -> Kept {
        let folder = PLACES.iter().find_map(|(variable, below)| {
            let place = std::env::var_os(variable).filter(|place| !place.is_empty())?;
            Some(Path::new(&place).join(below).join("explain"))
        });
        Kept::within(folder)
    }

    /// In a folder.
    pub fn within(folder: Option<PathBuf>) -> Kept {
        let here = Provenance::here(String::new(), 0.0);
        let host = format!(
            "{}, {} threads, stripmine {}{}",
            here.machine.processor,
            rayon::current_num_threads(),
            here.origin.version,
            // Between versions it is another program with every commit.
            if here.origin.is_committed() {
                format!(" of {}", short(&here.origin.commit))
            } else {
                String::new()
            }
        );
        Kept { folder, host }
    }

    /// The folder.
    pub fn folder(&self) -> Option<&Path> {
        self.folder.as_deref()
    }

    /// What a scene and a quantity are kept as: the error that is asked for does not matter.
    pub fn key(&self, case: &Case, target: &Target) -> String {
        let mut sum = Sha256::new();
        for part in [target.quantity.name, &self.host, &case.prepared.scene] {
            sum.update(part.as_bytes());
            sum.update([0]);
        }
        sum.finalize().iter().take(12).map(|byte| format!("{byte:02x}")).collect()
    }

    fn path(&self, key: &str) -> Option<PathBuf> {
        Some(self.folder.as_ref()?.join(format!("{key}.json")))
    }

    /// What is kept, where trials were at least as long, and where it comes from. A file that is none of ours, or was measured on
    /// another host, is as good as none.
    ///
    /// # Errors
    /// [`KeptError`] if it is there and cannot be read.
    pub fn recall(&self, key: &str, seconds: f64) -> Result<Option<(Findings, String)>, KeptError> {
        let Some(path) = self.path(key) else { return Ok(None) };
        let text = match fs::read(&path) {
            Ok(text) => text,
            Err(error) if error.kind() == ErrorKind::NotFound => return Ok(None),
            Err(source) => return Err(KeptError::File { path, source }),
        };
        let Ok(file) = serde_json::from_slice::<File>(&text) else { return Ok(None) };
        if file.host != self.host || file.seconds < seconds {
            return Ok(None);
        }
        let taken = significant(file.taken, 2);
        let origin = format!("kept from {} ({taken} s of trials on {})", file.moment, file.host);
        Ok(Some((file.findings, origin)))
    }

    /// What is kept of the scene that is most alike, whatever quantity it was asked for, and where it comes from; none where there is none.
    ///
    /// # Errors
    /// [`KeptError`] if what is kept cannot be read.
    pub(super) fn alike(&self, case: &Case) -> Result<Option<(Findings, String)>, KeptError> {
        let own = Alike::of(case);
        let near = |path: PathBuf| {
            let file: File = serde_json::from_slice(&fs::read(path).ok()?).ok()?;
            let apart = own.apart(&file.alike).filter(|_| file.host == self.host)?;
            Some((apart, file))
        };
        let files = self.files()?.into_iter().filter_map(near);
        let nearest = files.min_by(|(a, _), (b, _)| a.total_cmp(b));
        Ok(nearest.map(|(_, file)| {
            let origin = format!("measured {} on {}", file.moment, file.host);
            (file.findings, origin)
        }))
    }

    /// Keeps what was measured with the seconds of trials that were asked for and that they took, and says where it comes from.
    ///
    /// # Errors
    /// [`KeptError`] if it cannot be written.
    pub fn keep(
        &self,
        case: &Case,
        key: &str,
        [seconds, taken]: [f64; 2],
        findings: &Findings,
    ) -> Result<String, KeptError> {
        let origin = format!("{} s of trials on {}", significant(taken, 2), self.host);
        let Some(path) = self.path(key) else { return Ok(origin) };
        let file = File {
            scene: key.to_owned(),
            host: self.host.clone(),
            moment: stripmine_physics::origin::moment(SystemTime::now()),
            seconds,
            taken,
            alike: Alike::of(case),
            findings: findings.clone(),
        };
        let fail = |source| KeptError::File { path: path.clone(), source };
        if let Some(folder) = path.parent() {
            fs::create_dir_all(folder).map_err(fail)?;
        }
        let text = serde_json::to_vec_pretty(&file).map_err(|error| fail(error.into()))?;
        // In one step, so that two at a time do not mix.
        let beside = path.with_extension(format!("{}", std::process::id()));
        fs::write(&beside, text).map_err(fail)?;
        fs::rename(&beside, &path).map_err(fail)?;
        Ok(origin)
    }

    /// Removes all that is kept, and says how many files that were.
    ///
    /// # Errors
    /// [`KeptError`] if one cannot be removed.
    pub fn forget(&self) -> Result<usize, KeptError> {
        let files = self.files()?;
        for file in &files {
            fs::remove_file(file).map_err(|source| KeptError::File { path: file.clone(), source })?;
        }
        Ok(files.len())
    }

    /// All files, by their names.
    fn files(&self) -> Result<Vec<PathBuf>, KeptError> {
        let Some(folder) = &self.folder else { return Ok(vec![]) };
        let files = match fs::read_dir(folder) {
            Ok(files) => files,
            Err(error) if error.kind() == ErrorKind::NotFound => return Ok(vec![]),
            Err(source) => return Err(KeptError::File { path: folder.clone(), source }),
        };
        let is_ours = |file: &PathBuf| file.extension().is_some_and(|ending| ending == "json");
        let mut files: Vec<PathBuf> = files.flatten().map(|file| file.path()).filter(is_ours).collect();
        files.sort();
        Ok(files)
    }
}
