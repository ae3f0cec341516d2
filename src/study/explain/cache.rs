//! Cache of measurements, for this host and this version of the program: a repeated plan needs no trials.

use super::PlanTarget;
use super::findings::Findings;
use super::similarity::SceneFeatures;
use super::trial_runs::restore_overrides;
use crate::provenance::Provenance;
use crate::results::{Journal, JournalError, JournalIdentity};
use crate::study::StudyCase;
use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};
use std::ffi::OsStr;
use std::fs;
use std::io::{ErrorKind, Write};
use std::path::{Path, PathBuf};
use std::time::SystemTime;
use stripmine_physics::io::owned_folder::names_in;
use stripmine_physics::io::replace::{remove_if_there, replace};
use stripmine_physics::io::{FileError, regular_file};
use stripmine_physics::number::significant;
use stripmine_physics::quoted;
use stripmine_physics::reported::{ErrorClass, Reported};

/// Variables that name the user's cache folder, and the folder below.
const PLACES: [(&str, &str); 2] = [("XDG_CACHE_HOME", "stripmine"), ("HOME", ".cache/stripmine")];
/// Upper bound of the size of a cached file (bytes).
const LONGEST: u64 = 1 << 22;
/// Separator between a key and the trial time, in the folder name of a journal.
const BEGUN: &str = ".trials-";
/// Hexadecimal digits of a key.
const KEY: usize = 24;

/// Failures of the cache.
#[derive(Debug, thiserror::Error)]
pub(crate) enum PlanCacheError {
    /// A cached file cannot be parsed.
    #[error("{} is damaged: it is ignored, and rewritten after the trials", quoted::path(.0))]
    Damaged(PathBuf),
    /// The journal of interrupted trials failed.
    #[error(transparent)]
    Journal(#[from] JournalError),
    /// A file or folder cannot be read, written or removed.
    #[error(transparent)]
    File(#[from] FileError),
}

impl Reported for PlanCacheError {
    fn class(&self) -> ErrorClass {
        match self {
            PlanCacheError::Journal(error) => error.class(),
            PlanCacheError::Damaged(_) | PlanCacheError::File(_) => ErrorClass::InputOutput,
        }
    }
}

/// Folder of cached measurements; disabled where the user has no cache folder.
#[derive(Clone, Debug)]
pub(crate) struct PlanCache {
    folder: Option<PathBuf>,
    host: String,
}

/// A cached file.
#[derive(Serialize, Deserialize)]
struct CachedFindings {
    /// Key of the scene: the name of the file.
    scene: String,
    /// Processor and version of the measurement.
    host: String,
    /// Time of the measurement.
    moment: String,
    /// Trial time that was requested, and that was used (s).
    seconds: f64,
    taken: f64,
    /// Properties by which similar scenes are found.
    alike: SceneFeatures,
    findings: Findings,
}

/// Abbreviates a commit to a unique prefix.
fn abbreviated_commit(commit: &str) -> &str {
    commit.get(..10).unwrap_or(commit)
}

impl PlanCache {
    /// Opens the cache in the user's cache folder, for this processor, number of threads and version.
    pub(crate) fn here() -> PlanCache {
        PlanCache::within(
            PLACES.iter().find_map(|(variable, below)| cache_folder(&std::env::var_os(variable)?, below)),
        )
    }

    pub(crate) fn within(folder: Option<PathBuf>) -> PlanCache {
        let here = Provenance::here(String::new(), 0.0);
        let host = format!(
            "{}, {} threads, stripmine {}{}",
            here.machine.processor,
            rayon::current_num_threads(),
            here.origin.version,
            // Between versions every commit is a different program.
            if here.origin.is_committed() {
                format!(" of {}", abbreviated_commit(&here.origin.commit))
            } else {
                String::new()
            }
        );
        PlanCache { folder, host }
    }

    /// Key of a scene and a quantity. The target error matters only for conserved quantities, where it decides which runs are made.
    pub(crate) fn key(&self, case: &StudyCase, target: &PlanTarget) -> String {
        let mut sum = Sha256::new();
        let error =
            target.error.filter(|_| target.is_kept()).map_or(String::new(), |error| error.to_string());
        let window = target.window.map_or(String::new(), |window| format!("{window:?}"));
        for part in [target.quantity.name, &error, &window, &self.host, &case.prepared.scene] {
            sum.update(part.as_bytes());
            sum.update([0]);
        }
        sum.finalize().iter().take(KEY / 2).map(|byte| format!("{byte:02x}")).collect()
    }

    fn path(&self, key: &str) -> Option<PathBuf> {
        Some(self.folder.as_ref()?.join(format!("{key}.json")))
    }

    /// Returns the cached measurements of trials at least as long, with their origin. Measurements of another host are ignored.
    ///
    /// # Errors
    /// [`PlanCacheError`] if the file exists and cannot be read, or is damaged.
    pub(crate) fn recall(
        &self,
        case: &StudyCase,
        key: &str,
        seconds: f64,
    ) -> Result<Option<(Findings, String)>, PlanCacheError> {
        let Some(path) = self.path(key) else { return Ok(None) };
        let text = match regular_file::read(&path, LONGEST) {
            Ok(text) => text,
            Err(error) if error.kind() == ErrorKind::NotFound => return Ok(None),
            Err(cause) => return Err(FileError::at(&path, "reading")(cause).into()),
        };
        let mut file: CachedFindings =
            serde_json::from_slice(&text).map_err(|_| PlanCacheError::Damaged(path))?;
        if file.host != self.host || file.seconds < seconds {
            return Ok(None);
        }
        restore_overrides(&mut file.findings.configurations, case);
        let taken = significant(file.taken, 2);
        let origin = format!("cached on {} ({taken} s of trials on {})", file.moment, file.host);
        Ok(Some((file.findings, origin)))
    }

    /// Returns the cached measurements of the most similar scene, of any quantity, with their origin; none where no scene is similar.
    ///
    /// # Errors
    /// [`PlanCacheError`] if the cache cannot be read.
    pub(super) fn nearest_findings(
        &self,
        case: &StudyCase,
    ) -> Result<Option<(Findings, String)>, PlanCacheError> {
        let own = SceneFeatures::of(case);
        let near = |path: PathBuf| {
            let file: CachedFindings =
                serde_json::from_slice(&regular_file::read(&path, LONGEST).ok()?).ok()?;
            let apart = own.feature_distance(&file.alike).filter(|_| file.host == self.host)?;
            Some((apart, file))
        };
        let files = self.files()?.into_iter().filter_map(near);
        let nearest = files.min_by(|(a, _), (b, _)| a.total_cmp(b));
        Ok(nearest.map(|(_, file)| {
            let origin = format!("measured {} on {}", file.moment, file.host);
            (file.findings, origin)
        }))
    }

    /// Opens the journal of the trials of a scene, which resumes interrupted ones. Without a cache folder nothing is recorded.
    ///
    /// # Errors
    /// [`PlanCacheError`] if it cannot be read or created.
    pub(super) fn journal(
        &self,
        case: &StudyCase,
        target: &PlanTarget,
        seconds: f64,
    ) -> Result<Journal, PlanCacheError> {
        let Some(folder) = self.journal_folder(case, target, seconds) else { return Ok(Journal::none()) };
        fs::create_dir_all(&folder).map_err(FileError::at(&folder, "creating the folder"))?;
        let of = format!("trials of {}", case.arguments());
        let identity = JournalIdentity { of, digest: self.key(case, target) };
        Ok(Journal::open(&folder, &identity, None)?)
    }

    /// Removes the journal once its measurements are cached.
    ///
    /// # Errors
    /// [`PlanCacheError`] if it cannot be removed.
    pub(super) fn close(
        &self,
        case: &StudyCase,
        target: &PlanTarget,
        seconds: f64,
    ) -> Result<(), PlanCacheError> {
        let folder = self.journal_folder(case, target, seconds).filter(|folder| folder.is_dir());
        folder.map_or(Ok(()), |it| Ok(fs::remove_dir_all(&it).map_err(FileError::at(&it, "removing"))?))
    }

    /// Folder of the journal of trials of some seconds.
    fn journal_folder(&self, case: &StudyCase, target: &PlanTarget, seconds: f64) -> Option<PathBuf> {
        let name = format!("{}{BEGUN}{seconds}", self.key(case, target));
        Some(self.folder.as_ref()?.join(name))
    }

    /// Writes measurements to the cache, with the trial time that was requested and used.
    ///
    /// # Errors
    /// [`PlanCacheError`] if it cannot be written.
    pub(crate) fn store_findings(
        &self,
        case: &StudyCase,
        key: &str,
        [seconds, taken]: [f64; 2],
        findings: &Findings,
    ) -> Result<(), PlanCacheError> {
        let Some(path) = self.path(key) else { return Ok(()) };
        let file = CachedFindings {
            scene: key.to_owned(),
            host: self.host.clone(),
            moment: stripmine_physics::origin::moment(SystemTime::now()),
            seconds,
            taken,
            alike: SceneFeatures::of(case),
            findings: findings.clone(),
        };
        if let Some(folder) = path.parent() {
            fs::create_dir_all(folder).map_err(FileError::at(folder, "creating the folder"))?;
        }
        let text = serde_json::to_vec_pretty(&file);
        let text = text.map_err(|error| FileError::at(&path, "writing")(error.into()))?;
        // Replaced in one step, so that two processes do not mix their data.
        replace(&path, |out| out.write_all(&text))?;
        Ok(())
    }

    /// Describes the origin of new measurements that took some seconds.
    pub(crate) fn origin(&self, taken: f64) -> String {
        format!("{} s of trials on {}", significant(taken, 2), self.host)
    }

    /// Removes all cached files and journals, of every version, and returns their number. Other files in the folder stay.
    ///
    /// # Errors
    /// [`PlanCacheError`] if one cannot be removed.
    pub(crate) fn forget(&self) -> Result<usize, PlanCacheError> {
        let files: Vec<PathBuf> = self.files()?.into_iter().filter(|file| is_marked(file)).collect();
        files.iter().try_for_each(|file| remove_if_there(file))?;
        let journals = self.entries(|name| name.split_once(BEGUN).is_some_and(|(key, _)| is_key_of(key)))?;
        for folder in &journals {
            fs::remove_dir_all(folder).map_err(FileError::at(folder, "removing"))?;
        }
        Ok(files.len() + journals.len())
    }

    /// Lists all files named like a key, in order.
    fn files(&self) -> Result<Vec<PathBuf>, PlanCacheError> {
        self.entries(is_key)
    }

    fn entries(&self, is_ours: fn(&str) -> bool) -> Result<Vec<PathBuf>, PlanCacheError> {
        let Some(folder) = &self.folder else { return Ok(vec![]) };
        let names = names_in(folder)?.unwrap_or_default();
        Ok(names.iter().filter(|name| is_ours(name)).map(|name| folder.join(name)).collect())
    }
}

/// Returns the cache folder below the one that a variable names. None where that is empty or relative: the specification requires such values to be
/// ignored.
fn cache_folder(variable: &OsStr, below: &str) -> Option<PathBuf> {
    let folder = Path::new(variable);
    folder.is_absolute().then(|| folder.join(below).join("explain"))
}

/// True if a file is named like a cached file.
fn is_key(name: &str) -> bool {
    name.strip_suffix(".json").is_some_and(is_key_of)
}

fn is_key_of(key: &str) -> bool {
    key.len() == KEY && key.bytes().all(|byte| matches!(byte, b'0'..=b'9' | b'a'..=b'f'))
}

/// True if a file was written by this cache, of any version: it contains its own name as its key. Links are not followed.
fn is_marked(file: &Path) -> bool {
    #[derive(Deserialize)]
    struct Mark {
        scene: String,
    }
    let is_file = fs::symlink_metadata(file).is_ok_and(|it| it.is_file());
    let text = is_file.then(|| regular_file::read(file, LONGEST).ok()).flatten();
    let mark = text.and_then(|text| serde_json::from_slice::<Mark>(&text).ok());
    mark.is_some_and(|mark| file.file_stem() == Some(OsStr::new(&mark.scene)))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The specification of XDG base directories: "all paths set in these environment variables must be absolute"; relative ones are ignored.
    #[test]
    fn relative_folders_are_ignored() {
        let of = |variable: &str| cache_folder(OsStr::new(variable), "stripmine");
        assert_eq!(of("/home/me/.cache"), Some(PathBuf::from("/home/me/.cache/stripmine/explain")));
        assert_eq!([of(""), of("cache"), of("./cache"), of("~/.cache")], [const { None }; 4]);
    }

    #[test]
    fn cached_files_are_named_by_key() {
        assert!(is_key("0123456789abcdef01234567.json"));
        for other in ["mine.json", "0123456789abcdef01234567.toml", "0123456789ABCDEF01234567.json", ".json"]
        {
            assert!(!is_key(other), "{other}");
        }
    }
}
