//! Journal of the finished runs of a study, one line each, from which an interrupted study resumes.
//!
//! The first line identifies the study, with a digest of its scene and of the program's version. Each further line has a checksum of
//! the digest, its key and its value. Invalid lines are dropped with a note, and their runs are measured again. A truncated last line
//! is dropped silently.

use super::journal_error::JournalError;
use super::meter::{for_each_below, run_in_parallel};
use super::team::{ProcessTeam, RunResults};
use crc32fast::Hasher;
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};
use serde_json::Value;
use std::fs::{File, OpenOptions};
use std::io::{ErrorKind, Write};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard, PoisonError, RwLock};
use stripmine_physics::io::replace::replace;
use stripmine_physics::io::{FileError, regular_file};
use stripmine_physics::quoted;

/// File name of the journal.
pub(super) const NAME: &str = "journal.jsonl";
/// Beginning of the first line.
pub(super) const MARK: &str = "{\"stripmine journal\":2,";
/// Limit of the size of a journal (bytes).
const LONGEST: u64 = 1 << 30;

/// Identity of the study that a journal belongs to.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) struct JournalIdentity {
    /// Study and scene, for reading.
    pub of: String,
    /// Digest of everything that results depend on.
    pub(crate) digest: String,
}

impl JournalIdentity {
    /// First line of its journal.
    fn heading(&self) -> Result<String, serde_json::Error> {
        Ok(format!(
            "{MARK}\"of\":{},\"digest\":{}}}\n",
            serde_json::to_string(&self.of)?,
            serde_json::to_string(&self.digest)?
        ))
    }
}

/// Line of the journal: a finished run.
#[derive(Serialize, Deserialize)]
struct JournalLine {
    key: String,
    value: Value,
}

/// Beginning of a line; its checksum in eight hexadecimal digits and [`BEHIND`] follow.
const BEFORE: &str = "{\"checksum\":\"";
/// Separator between the checksum and the text it covers.
const BEHIND: &str = "\",";

impl JournalLine {
    /// Formats the line for the journal with this digest.
    fn text(&self, digest: &str) -> Result<String, serde_json::Error> {
        let text = serde_json::to_string(self)?;
        let rest = text.trim_start_matches('{');
        Ok(format!("{BEFORE}{:08x}{BEHIND}{rest}\n", checksum(digest, rest)))
    }

    /// Parses a line of the journal with this digest; none if its checksum is wrong.
    fn read(text: &str, digest: &str) -> Option<JournalLine> {
        let (stated, rest) = text.strip_prefix(BEFORE)?.split_once(BEHIND)?;
        let is_whole = stated == format!("{:08x}", checksum(digest, rest.strip_suffix('\n')?));
        serde_json::from_str(text).ok().filter(|_| is_whole)
    }
}

/// CRC-32 of a journal's digest and the text of a line after its checksum.
fn checksum(digest: &str, text: &str) -> u32 {
    let mut sum = Hasher::new();
    sum.update(digest.as_bytes());
    sum.update(text.as_bytes());
    sum.finalize()
}

/// Finished runs of a study.
pub(crate) struct Journal {
    known: RwLock<RunResults>,
    /// Number of runs read from the file.
    before: usize,
    /// Open file; none if nothing is stored.
    file: Option<Mutex<File>>,
    path: PathBuf,
    digest: String,
    changed: Vec<usize>,
    /// Processes that make the study together, and the runs this one has made since the last exchange.
    team: Option<ProcessTeam>,
    made: Mutex<RunResults>,
}

impl Journal {
    /// Journal without a file, for studies made in one go.
    pub(crate) fn none() -> Journal {
        Journal {
            known: RwLock::default(),
            before: 0,
            file: None,
            path: PathBuf::new(),
            digest: String::new(),
            changed: vec![],
            team: None,
            made: Mutex::default(),
        }
    }

    /// Opens or creates the journal of a folder, for all processes that make the study.
    ///
    /// # Errors
    /// [`JournalError`] if it belongs to another study, or cannot be read and written.
    pub(crate) fn open(
        folder: &Path,
        identity: &JournalIdentity,
        team: Option<ProcessTeam>,
    ) -> Result<Journal, JournalError> {
        let Some(team) = team else { return Journal::read(folder, identity) };
        // The first process cleans the file before others read it, and nothing is added before all have read it.
        let first = team.is_first().then(|| Journal::read(folder, identity)).transpose()?;
        let own = RunResults::from([(identity.digest.clone(), Value::Null)]);
        if team.exchange_runs(&own)? != own {
            return Err(JournalError::Differs);
        }
        let journal = first.map_or_else(|| Journal::read(folder, identity), Ok)?;
        team.exchange_runs(&RunResults::new())?;
        Ok(Journal { team: Some(team), ..journal })
    }

    fn read(folder: &Path, identity: &JournalIdentity) -> Result<Journal, JournalError> {
        let path = folder.join(NAME);
        let at = |action| FileError::at(&path, action);
        let text = match regular_file::read(&path, LONGEST) {
            Err(cause) if cause.kind() == ErrorKind::NotFound => String::new(),
            bytes => String::from_utf8(bytes.map_err(at("reading"))?)
                .map_err(|_| JournalError::Foreign(path.clone()))?,
        };
        let heading = identity.heading().map_err(|cause| at("writing")(cause.into()))?;
        let mut lines = text.split_inclusive('\n');
        let first = lines.next().unwrap_or(&heading);
        if first != heading {
            return Err(foreign_journal_error(path, first, identity));
        }
        let (mut known, mut kept, mut changed) = (RunResults::new(), heading, vec![]);
        for (number, line) in (2..).zip(lines) {
            match JournalLine::read(line, &identity.digest) {
                Some(JournalLine { key, value }) => {
                    known.insert(key, value);
                    kept.push_str(line);
                }
                // A killed writer leaves a partial last line.
                None if line.ends_with('\n') => changed.push(number),
                None => {}
            }
        }
        if kept != text {
            replace(&path, |out| out.write_all(kept.as_bytes()))?;
        }
        let file = OpenOptions::new().append(true).open(&path).map_err(at("opening"))?;
        Ok(Journal {
            before: known.len(),
            known: RwLock::new(known),
            file: Some(Mutex::new(file)),
            path,
            digest: identity.digest.clone(),
            changed,
            ..Journal::none()
        })
    }

    /// Number of runs finished before.
    pub(crate) fn len(&self) -> usize {
        self.before
    }

    /// Returns true if no run was finished before.
    pub(crate) fn is_empty(&self) -> bool {
        self.before == 0
    }

    /// Returns true if this process writes the results and measures times.
    pub(crate) fn is_first(&self) -> bool {
        self.team.as_ref().is_none_or(ProcessTeam::is_first)
    }

    /// Results of `run` for independent inputs, computed on all threads of all processes. `run` must get its results from
    /// [`recall`](Self::recall), or derive them from such, since each process finds the results of the others there.
    ///
    /// # Errors
    /// The first failure of a run, and [`JournalError`].
    pub(crate) fn run_all<T, R, E>(
        &self,
        all: &[T],
        run: impl Fn(&T) -> Result<R, E> + Sync,
    ) -> Result<Vec<R>, E>
    where
        T: Sync,
        R: Send,
        E: From<JournalError> + Send,
    {
        if let Some(team) = &self.team {
            // A failure here occurs again below.
            let part = team.own_share(all);
            for_each_below(part.len(), &|at| _ = run(part[at]));
            let made = std::mem::take(&mut *self.made.lock().unwrap_or_else(PoisonError::into_inner));
            let runs = team.exchange_runs(&made).map_err(JournalError::from)?;
            self.known.write().unwrap_or_else(PoisonError::into_inner).extend(runs);
        }
        run_in_parallel(all, run)
    }

    /// Result of one process, broadcast to the others.
    ///
    /// # Errors
    /// As [`run_all`](Self::run_all).
    pub(crate) fn run_on_one<R: Send, E: From<JournalError> + Send>(
        &self,
        run: impl Fn() -> Result<R, E> + Sync,
    ) -> Result<R, E> {
        let mut found = self.run_all(&[()], |()| run())?;
        Ok(found.swap_remove(0))
    }

    /// Notes on damaged lines: a sentence for each of the first, and one for the rest.
    pub(crate) fn notes(&self) -> Vec<String> {
        const NAMED: usize = 5;
        let file = quoted::path(&self.path);
        let one = |line: &usize| format!("{file}:{line}: damaged line; its run is measured again");
        let mut notes: Vec<String> = self.changed.iter().take(NAMED).map(one).collect();
        if let Some(more) = self.changed.len().checked_sub(NAMED).filter(|&more| more > 0) {
            notes.push(format!("{file}: {more} more damaged lines; their runs are measured again"));
        }
        notes
    }

    /// Result of a run from the journal, if it was finished before and `fits`; otherwise runs it and stores the result.
    ///
    /// A checksum detects damage, not a line of another study: `fits` rejects values that no run of this study gives.
    ///
    /// # Errors
    /// Errors of the run, and [`JournalError`] if the result cannot be stored.
    pub(crate) fn recall<T, E>(
        &self,
        key: &str,
        fits: impl FnOnce(&T) -> bool,
        run: impl FnOnce() -> Result<T, E>,
    ) -> Result<T, E>
    where
        T: Serialize + DeserializeOwned,
        E: From<JournalError>,
    {
        if let Some(value) = self.stored_value(key)
            && let Ok(value) = serde_json::from_value(value)
            && fits(&value)
        {
            return Ok(value);
        }
        let value = run()?;
        self.store_value(key, &value).map_err(JournalError::File)?;
        Ok(value)
    }

    fn stored_value(&self, key: &str) -> Option<Value> {
        self.known.read().unwrap_or_else(PoisonError::into_inner).get(key).cloned()
    }

    fn store_value(&self, key: &str, value: &impl Serialize) -> Result<(), FileError> {
        let Some(file) = &self.file else { return Ok(()) };
        let line = serde_json::to_value(value).map(|value| JournalLine { key: key.to_owned(), value });
        if let (Some(_), Ok(JournalLine { key, value })) = (&self.team, &line) {
            let mut made = self.made.lock().unwrap_or_else(PoisonError::into_inner);
            made.insert(key.clone(), value.clone());
        }
        let text = line.and_then(|line| line.text(&self.digest)).map_err(std::io::Error::from);
        let mut file: MutexGuard<'_, File> = file.lock().unwrap_or_else(PoisonError::into_inner);
        text.and_then(|text| file.write_all(text.as_bytes())).map_err(FileError::at(&self.path, "writing"))
    }
}

/// Error for a journal whose first line differs from ours.
fn foreign_journal_error(file: PathBuf, first: &str, ours: &JournalIdentity) -> JournalError {
    let theirs = serde_json::from_str::<JournalIdentity>(first).ok().filter(|_| first.starts_with(MARK));
    let said =
        |it: &JournalIdentity| format!("{} ({})", it.of, it.digest.chars().take(8).collect::<String>());
    match theirs {
        Some(theirs) => JournalError::Other { theirs: said(&theirs), ours: said(ours), file },
        None => JournalError::Foreign(file),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::fs;
    use stripmine_physics::io::owned_folder::is_marked;
    use stripmine_physics::reported::{ErrorClass, Reported};

    fn identity(digest: &str) -> JournalIdentity {
        JournalIdentity { of: "a study of a scene".to_owned(), digest: digest.to_owned() }
    }

    fn run(journal: &Journal, key: &str, value: u64) -> u64 {
        journal.recall(key, |_| true, || Ok::<_, JournalError>(value)).unwrap()
    }

    #[test]
    fn finished_runs_are_recalled() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join(NAME);
        let first = Journal::open(folder.path(), &identity("12345678"), None).unwrap();
        assert_eq!((run(&first, "a", 1), run(&first, "b", 2)), (1, 2));
        drop(first);
        let text = fs::read_to_string(&path).unwrap();
        fs::write(&path, text.trim_end().strip_suffix('}').unwrap()).unwrap();
        let second = Journal::open(folder.path(), &identity("12345678"), None).unwrap();
        assert_eq!((run(&second, "a", 10), run(&second, "b", 20), second.len()), (1, 20, 1));
        drop(second);
        assert!(is_marked(&path, MARK).unwrap());
        let third = Journal::open(folder.path(), &identity("12345678"), None).unwrap();
        assert_eq!((run(&third, "b", 3), third.len()), (20, 2));
    }

    #[test]
    fn journals_of_other_studies_are_rejected() {
        let folder = tempfile::tempdir().unwrap();
        Journal::open(folder.path(), &identity("12345678"), None).unwrap();
        let other = Journal::open(folder.path(), &identity("87654321"), None).err().unwrap();
        assert!(matches!(other, JournalError::Other { .. }) && other.class() == ErrorClass::Usage, "{other}");
        for mine in ["mine\n", "{\"stripmine journal\":1}\n"] {
            fs::write(folder.path().join(NAME), mine).unwrap();
            let foreign = Journal::open(folder.path(), &identity("12345678"), None).err().unwrap();
            assert!(matches!(foreign, JournalError::Foreign(_)), "{foreign}");
            assert!(is_marked(&folder.path().join(NAME), MARK).is_err());
            assert_eq!(fs::read_to_string(folder.path().join(NAME)).unwrap(), mine);
        }
    }

    /// A line can have a correct checksum and an impossible value.
    #[test]
    fn impossible_values_are_measured_again() {
        let folder = tempfile::tempdir().unwrap();
        let open = || Journal::open(folder.path(), &identity("12345678"), None).unwrap();
        assert_eq!(run(&open(), "a", 20_000_001), 20_000_001);
        let fits = |value: &u64| *value < 10;
        let again = open();
        assert_eq!(again.recall("a", fits, || Ok::<_, JournalError>(3)).unwrap(), 3);
        drop(again);
        assert_eq!(open().recall("a", fits, || Ok::<_, JournalError>(4)).unwrap(), 3);
    }

    /// The checksum covers every part of a line, and lines of another journal are rejected.
    #[test]
    fn damaged_lines_are_measured_again() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join(NAME);
        let first = Journal::open(folder.path(), &identity("12345678"), None).unwrap();
        assert_eq!([run(&first, "a", 1), run(&first, "b", 2)], [1, 2]);
        drop(first);
        let text = fs::read_to_string(&path).unwrap();
        let changes = [("\"a\"", "\"c\""), (":1}", ":7}"), (":1}", ":\"x\"}")];
        for (old, new) in changes {
            let at = text.find("\"key\"").unwrap();
            assert!(text[at..].contains(old), "{text}");
            fs::write(&path, format!("{}{}", &text[..at], text[at..].replacen(old, new, 1))).unwrap();
            let second = Journal::open(folder.path(), &identity("12345678"), None).unwrap();
            let notes = second.notes();
            assert!(notes.len() == 1 && notes[0].contains("journal.jsonl:2: "), "{notes:?}");
            assert!(notes[0].contains("measured again"), "{notes:?}");
            assert_eq!((run(&second, "a", 5), run(&second, "b", 6), second.len()), (5, 2, 1));
            drop(second);
            let third = Journal::open(folder.path(), &identity("12345678"), None).unwrap();
            assert_eq!((run(&third, "a", 8), third.notes().len()), (5, 0));
        }
        let other = tempfile::tempdir().unwrap();
        drop(Journal::open(other.path(), &identity("87654321"), None).unwrap());
        let heading = fs::read_to_string(other.path().join(NAME)).unwrap();
        let line = text.lines().nth(1).unwrap();
        fs::write(other.path().join(NAME), format!("{heading}{line}\n")).unwrap();
        assert_eq!(run(&Journal::open(other.path(), &identity("87654321"), None).unwrap(), "a", 5), 5);
    }

    #[cfg(unix)]
    #[test]
    fn pipes_are_rejected_as_journals() {
        let folder = tempfile::tempdir().unwrap();
        let pipe = folder.path().join(NAME);
        assert!(std::process::Command::new("mkfifo").arg(&pipe).status().unwrap().success());
        assert!(is_marked(&pipe, MARK).is_err());
        let refused = Journal::open(folder.path(), &identity("12345678"), None).err().unwrap();
        assert!(refused.to_string().contains("it is a pipe"), "{refused}");
    }
}
