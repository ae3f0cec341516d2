//! Folders that this program writes to: no file of others is lost, and one process at a time writes.
//!
//! A file is own if the list beside it names it, or if it contains a mark of this program. A list is written before the files that it names, so
//! that a killed process leaves only files known as own. Temporary files (`.stripmine-….part`) have random names and are on no list.

use super::lock::{Lock, is_lock};
use super::replace::{is_temporary, remove_if_there, replace, temporary};
use super::{FileError, FolderError, regular_file};
use serde::Deserialize;
use std::collections::BTreeSet;
use std::fs::{self, File};
use std::io::{self, BufWriter, ErrorKind, Read, Write};
use std::path::{Path, PathBuf};
use tempfile::TempDir;

/// Lock file of folders that have no other.
pub const LOCK: &str = ".stripmine.lock";
/// Longest list (bytes).
const LONGEST: u64 = 1 << 24;
/// Length of the part of a file searched for its mark (bytes).
const START: u64 = 1000;
/// Name of a folder that is being replaced, in a temporary one.
const ASIDE: &str = "item";

/// Kind of a folder: its own files, and other files that it may contain.
#[derive(Clone, Copy, Debug)]
pub struct FolderKind {
    /// Lock file.
    pub lock: &'static str,
    /// File with the names of own files.
    pub list: &'static str,
    /// Content of the folder.
    pub holds: FolderContent,
}

/// Content of an owned folder.
#[derive(Clone, Copy, Debug)]
pub enum FolderContent {
    /// Own files named by a list, one on each line, beside files of others.
    Files {
        /// First line of the list.
        heading: &'static str,
        /// Returns true if an own file may have this name.
        is_own: fn(&str) -> bool,
        /// True if files of others may exist before the list.
        is_shared: bool,
    },
    /// Folders of own files only, each with its list (`files` of a JSON object), and marked files; beside files of others.
    Folders {
        /// Names of files, each with the mark near its start.
        marked: &'static [(&'static str, &'static str)],
        /// Subfolders that also have such folders.
        below: &'static [&'static str],
    },
}

/// Sorted names of all entries of a folder; none if it does not exist.
///
/// # Errors
/// If the system refuses to read it.
pub fn names_in(folder: &Path) -> Result<Option<Vec<String>>, FileError> {
    let at = || FileError::at(folder, "reading the folder");
    let entries = match fs::read_dir(folder) {
        Err(cause) if cause.kind() == ErrorKind::NotFound => return Ok(None),
        entries => entries.map_err(at())?,
    };
    let names = entries.map(|entry| Ok(entry?.file_name().to_string_lossy().into_owned()));
    let mut names: Vec<String> = names.collect::<io::Result<_>>().map_err(at())?;
    names.sort();
    Ok(Some(names))
}

/// Returns true if a file exists and has the mark, false if it does not exist.
///
/// # Errors
/// [`FolderError::InTheWay`] if it has no mark, or the system's error if it cannot be read.
pub fn is_marked(file: &Path, mark: &str) -> Result<bool, FolderError> {
    if file.symlink_metadata().is_err_and(|cause| cause.kind() == ErrorKind::NotFound) {
        return Ok(false);
    }
    let mut start = Vec::new();
    if is_file(file) {
        let read = File::open(file).and_then(|file| file.take(START).read_to_end(&mut start));
        read.map_err(FileError::at(file, "reading"))?;
    }
    let is_ours = String::from_utf8_lossy(&start).contains(mark);
    if is_ours { Ok(true) } else { Err(FolderError::in_the_way(file)) }
}

fn is_file(path: &Path) -> bool {
    path.symlink_metadata().is_ok_and(|there| there.is_file())
}

fn is_folder(path: &Path) -> bool {
    path.symlink_metadata().is_ok_and(|there| there.is_dir())
}

/// Names on a JSON list.
#[derive(Deserialize)]
struct JsonFileList {
    #[serde(default)]
    files: BTreeSet<String>,
}

impl FolderKind {
    /// Names on the list of a folder; none if it contains nothing of ours, or does not exist.
    ///
    /// # Errors
    /// [`FolderError`] if it contains files, but none of ours, or if its list is damaged.
    pub(crate) fn listed_names(&self, folder: &Path) -> Result<Option<BTreeSet<String>>, FolderError> {
        let Some(mut names) = names_in(folder)? else { return Ok(None) };
        let (listed, list, below) = match self.holds {
            FolderContent::Files { is_shared: true, .. } => return self.read_if_ours(folder),
            FolderContent::Files { .. } => (self.read(folder)?, Some(self.list), [].as_slice()),
            FolderContent::Folders { below, .. } => (None, None, below),
        };
        let is_empty = |path: &Path| is_folder(path) && names_in(path).is_ok_and(|it| it == Some(vec![]));
        // A killed process may have left these.
        names.retain(|name| {
            let (path, name) = (folder.join(name), name.as_str());
            !(is_temporary(name)
                || name == self.lock && is_lock(&path)
                || below.contains(&name) && is_empty(&path))
        });
        // A folder that cannot be listed counts as having nothing of ours, and is refused.
        let has_own = |place: PathBuf| {
            let names = names_in(&place).ok().flatten().unwrap_or_default();
            names.iter().any(|name| self.owns(&place, name).is_ok_and(|is_there| is_there))
        };
        let mut places = below.iter().map(|name| folder.join(name)).chain([folder.to_owned()]);
        match listed.is_some() || names.is_empty() || places.any(has_own) {
            true => Ok(listed),
            false => Err(FolderError::not_ours(folder, list, &names)),
        }
    }

    /// Returns true if a marked file or a folder of own files exists, and an error if its name belongs to a file of others.
    fn owns(&self, folder: &Path, name: &str) -> Result<bool, FolderError> {
        let FolderContent::Folders { marked, .. } = self.holds else { return Ok(false) };
        let path = folder.join(name);
        match marked.iter().find(|(own, _)| *own == name) {
            Some((_, mark)) => is_marked(&path, mark),
            None => Ok(self.own_files_in(&path)?.is_some_and(|names| !names.is_empty())),
        }
    }

    /// Names of all files in a folder of own files only; none if it does not exist.
    fn own_files_in(&self, folder: &Path) -> Result<Option<Vec<String>>, FolderError> {
        if folder.symlink_metadata().is_ok_and(|there| !there.is_dir()) {
            return Err(FolderError::in_the_way(folder));
        }
        let Some(names) = names_in(folder)? else { return Ok(None) };
        let listed = self.read_if_ours(folder)?.unwrap_or_default();
        let is_own = |name: &&String| listed.contains(*name) && is_file(&folder.join(name));
        let foreign: Vec<String> = names.iter().filter(|name| !is_own(name)).cloned().collect();
        if foreign.is_empty() { Ok(Some(names)) } else { Err(FolderError::not_ours(folder, None, &foreign)) }
    }

    /// Reads the names on the list of a folder; none without a list. A name that leads out of the folder is an error.
    fn read(&self, folder: &Path) -> Result<Option<BTreeSet<String>>, FolderError> {
        let file = folder.join(self.list);
        match file.symlink_metadata() {
            Ok(there) if there.is_file() => {}
            Err(cause) if cause.kind() == ErrorKind::NotFound => return Ok(None),
            Ok(_) => return Err(FolderError::in_the_way(file)),
            Err(cause) => return Err(FileError::at(&file, "reading")(cause).into()),
        }
        let bytes = regular_file::read(&file, LONGEST).map_err(FileError::at(&file, "reading"))?;
        let text = String::from_utf8_lossy(&bytes);
        let wrong = |line, expected, found: &str| {
            let found = found.chars().take(60).flat_map(char::escape_debug).collect();
            FolderError::List { file: file.clone(), line, expected, found }
        };
        let FolderContent::Files { heading, is_own, .. } = self.holds else {
            let names: Result<JsonFileList, _> = serde_json::from_str(&text);
            let names = names.map_err(|error| wrong(error.line(), "JSON with the names of files", ""))?;
            return Ok(Some(names.files));
        };
        let first = text.lines().next().unwrap_or_default();
        if first != heading {
            return Err(wrong(1, "the heading of a list of files of this version", first));
        }
        let is_plain = |name: &str| Path::new(name).file_name().is_some_and(|last| last == name);
        let known = |(i, name): (usize, &str)| match is_own(name) && is_plain(name) {
            true => Ok(name.to_owned()),
            false => Err(wrong(i + 1, "the name of a file that this command writes", name)),
        };
        text.lines().enumerate().skip(1).map(known).collect::<Result<_, _>>().map(Some)
    }

    /// Reads the list as [`read`](Self::read) does; none also if the list is damaged or another's.
    fn read_if_ours(&self, folder: &Path) -> Result<Option<BTreeSet<String>>, FolderError> {
        match self.read(folder) {
            Err(FolderError::List { .. } | FolderError::InTheWay { .. }) => Ok(None),
            read => read,
        }
    }

    /// Removes a folder of own files; the list is removed last.
    fn remove(&self, folder: &Path, names: &[String]) -> Result<(), FileError> {
        let (list, rest): (Vec<&String>, Vec<&String>) = names.iter().partition(|&name| name == self.list);
        rest.into_iter().chain(list).try_for_each(|name| remove_if_there(&folder.join(name)))?;
        fs::remove_dir(folder).map_err(FileError::at(folder, "removing"))
    }
}

/// Folder that this process writes to.
#[derive(Debug)]
pub struct OwnedFolder {
    path: PathBuf,
    kind: FolderKind,
    listed: Option<BTreeSet<String>>,
    /// Lock; none if another process holds it for this one.
    lock: Option<Lock>,
}

impl OwnedFolder {
    /// Creates the folder if necessary, excludes other processes, and removes temporary files of killed ones. In a folder of folders, `wanted`
    /// names the folders and marked files that will be written.
    ///
    /// # Errors
    /// [`FolderError`] if existing files are not ours, or another process writes there.
    pub fn open(path: &Path, kind: FolderKind, wanted: &[String]) -> Result<OwnedFolder, FolderError> {
        let listed = || {
            let listed = kind.listed_names(path)?;
            wanted.iter().try_for_each(|name| kind.owns(path, name).map(drop))?;
            Ok::<_, FolderError>(listed)
        };
        listed()?;
        fs::create_dir_all(path).map_err(FileError::at(path, "creating the folder"))?;
        let lock = Some(Lock::take(&path.join(kind.lock))?);
        // The list cannot change from here on.
        let folder = OwnedFolder { path: path.to_owned(), kind, listed: listed()?, lock };
        folder.remove_leftovers()?;
        Ok(folder)
    }

    /// Folder that another process has opened for this one.
    pub fn of_another(path: &Path, kind: FolderKind) -> OwnedFolder {
        OwnedFolder { path: path.to_owned(), kind, listed: None, lock: None }
    }

    /// Path of the folder.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Path of a file in the folder.
    pub fn file(&self, name: &str) -> PathBuf {
        self.path.join(name)
    }

    /// Returns true if its list has names.
    pub(crate) fn has_own(&self) -> bool {
        self.listed.as_ref().is_some_and(|listed| !listed.is_empty())
    }

    /// True if the file system excludes other writers.
    pub(crate) fn is_locked(&self) -> bool {
        self.lock.as_ref().is_some_and(Lock::is_held)
    }

    fn is_listed(&self, name: &str) -> bool {
        self.listed.as_ref().is_some_and(|listed| listed.contains(name))
    }

    /// Adds names to the list and syncs it to the disk. With `overwrite`, files of others with these names are lost.
    ///
    /// # Errors
    /// [`FolderError::InTheWay`] if such files exist and `overwrite` is false; the system's error if the list cannot be written.
    pub fn claim<'n>(
        &mut self,
        names: impl IntoIterator<Item = &'n str>,
        overwrite: bool,
    ) -> Result<(), FolderError> {
        let FolderContent::Files { heading, is_shared, .. } = self.kind.holds else { return Ok(()) };
        // A list that lacks its own name is still the list.
        let is_new =
            |name: &&str| !self.is_listed(name) && (*name != self.kind.list || self.listed.is_none());
        let new: Vec<&str> = names.into_iter().filter(is_new).collect();
        // Without a list of ours, a file of that name belongs to others.
        let list = self.listed.is_none().then_some(self.kind.list);
        let mut paths = new.iter().copied().chain(list).map(|name| self.file(name));
        match paths.find(|path| path.symlink_metadata().is_ok()) {
            Some(path) if !overwrite => return Err(FolderError::InTheWay { path, is_optional: is_shared }),
            _ if new.is_empty() && list.is_none() => return Ok(()),
            _ => {}
        }
        let listed = self.listed.get_or_insert_default();
        listed.extend(new.into_iter().map(str::to_owned));
        Ok(replace(&self.path.join(self.kind.list), |out| {
            writeln!(out, "{heading}")?;
            listed.iter().try_for_each(|name| writeln!(out, "{name}"))
        })?)
    }

    /// Writes a whole file atomically: a claimed or a marked one.
    ///
    /// # Errors
    /// [`FolderError`] if a file without the mark exists, or the system refuses to write it.
    pub fn write(
        &self,
        name: &str,
        write: impl FnOnce(&mut BufWriter<&File>) -> io::Result<()>,
    ) -> Result<PathBuf, FolderError> {
        self.kind.owns(&self.path, name)?;
        let file = self.file(name);
        replace(&file, write)?;
        Ok(file)
    }

    /// Removes own files except the list, starting with the names `first`; files of others stay.
    ///
    /// # Errors
    /// If the system refuses to remove one.
    pub fn clear(&self, first: &[&str]) -> Result<(), FolderError> {
        let listed = self.listed.iter().flatten().map(String::as_str);
        let rest = listed.filter(|name| *name != self.kind.list && !first.contains(name));
        first.iter().copied().chain(rest).try_for_each(|name| self.remove_own(name))
    }

    /// Removes a file if it exists and is own.
    ///
    /// # Errors
    /// If the system refuses to remove it.
    pub fn remove_own(&self, name: &str) -> Result<(), FolderError> {
        if self.is_listed(name) { Ok(remove_if_there(&self.file(name))?) } else { Ok(()) }
    }

    /// Checks that files and the lock still exist.
    ///
    /// # Errors
    /// If another program has removed one meanwhile.
    pub(crate) fn check_still_there(&self, names: &[&str]) -> Result<(), FolderError> {
        let lock = self.lock.iter().find(|lock| !lock.is_there()).map(|_| self.kind.lock);
        let gone = names.iter().copied().find(|name| !is_file(&self.file(name))).or(lock);
        gone.map_or(Ok(()), |name| {
            let cause = "it was removed or replaced while the run was under way";
            let cause = io::Error::new(ErrorKind::NotFound, cause);
            Err(FileError::at(&self.file(name), "looking for it")(cause).into())
        })
    }

    /// Replaces the folder of own files with this name: by all files or, on failure, none. The list is written first, so that the files are known
    /// as own even if this process is killed.
    ///
    /// # Errors
    /// [`FolderError`] if existing files are not ours, or the system refuses to write.
    pub fn write_folder<'f>(
        &self,
        name: &str,
        files: impl IntoIterator<Item = (&'f str, &'f [u8])>,
    ) -> Result<PathBuf, FolderError> {
        let folder = self.file(name);
        let own = self.kind.own_files_in(&folder)?;
        let part = self.temporary_folder()?;
        for (name, bytes) in files {
            let file = part.path().join(name);
            fs::write(&file, bytes).map_err(FileError::at(&file, "writing"))?;
        }
        let parent = folder.parent().unwrap_or(&self.path);
        fs::create_dir_all(parent).map_err(FileError::at(parent, "creating the folder"))?;
        let renamed =
            |from: &Path, to: &Path| fs::rename(from, to).map_err(FileError::at(&folder, "replacing"));
        if let Some(own) = own {
            let aside = self.temporary_folder()?.keep();
            let old = aside.join(ASIDE);
            renamed(&folder, &old)?;
            renamed(part.path(), &folder)?;
            self.kind.remove(&old, &own)?;
            fs::remove_dir(&aside).map_err(FileError::at(&aside, "removing"))?;
        } else {
            renamed(part.path(), &folder)?;
        }
        #[expect(clippy::let_underscore_must_use, reason = "it has another name now")]
        let _ = part.keep();
        Ok(folder)
    }

    fn temporary_folder(&self) -> Result<TempDir, FileError> {
        let folder = temporary(0o777).tempdir_in(&self.path);
        folder.map_err(FileError::at(&self.path, "creating a folder in it"))
    }

    /// Removes temporary files and folders of killed processes if they are ours. In shared folders they may belong to a running process and stay.
    fn remove_leftovers(&self) -> Result<(), FolderError> {
        if matches!(self.kind.holds, FolderContent::Files { is_shared: true, .. }) {
            return Ok(());
        }
        let names = names_in(&self.path)?.unwrap_or_default();
        for left in names.iter().filter(|name| is_temporary(name)).map(|name| self.file(name)) {
            if !is_folder(&left) {
                remove_if_there(&left)?;
                continue;
            }
            for folder in [left.join(ASIDE), left].iter().filter(|folder| is_folder(folder)) {
                if let Ok(Some(own)) = self.kind.own_files_in(folder) {
                    self.kind.remove(folder, &own)?;
                }
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A name that leads out of the folder makes a list invalid, even if it ends like an own file, and nothing is written according to it.
    #[test]
    fn lists_reject_names_outside_the_folder() {
        let holds = |is_shared| FolderContent::Files {
            heading: "pictures 1",
            is_own: |name| name.ends_with(".svg"),
            is_shared,
        };
        let [alone, shared] = [false, true].map(|is_shared| FolderKind {
            lock: LOCK,
            list: "a.files",
            holds: holds(is_shared),
        });
        let folder = tempfile::tempdir().unwrap();
        let list = folder.path().join("a.files");
        for name in ["../a.svg", "b/a.svg", "/a.svg", "./a.svg", "a.svg/.", "a.tex", ""] {
            fs::write(&list, format!("pictures 1\n{name}\n")).unwrap();
            let damaged = alone.listed_names(folder.path()).unwrap_err();
            assert!(matches!(damaged, FolderError::List { line: 2, .. }), "{name}: {damaged}");
            let mut owned = OwnedFolder::open(folder.path(), shared, &[]).unwrap();
            let refused = owned.claim(["a.svg"], false).unwrap_err();
            assert!(
                matches!(&refused, FolderError::InTheWay { path, is_optional: true } if *path == list),
                "{name}: {refused}"
            );
        }
        fs::write(&list, "pictures 1\na.svg\n").unwrap();
        let mut owned = OwnedFolder::open(folder.path(), shared, &[]).unwrap();
        owned.claim(["a.svg", "b.svg"], false).unwrap();
        assert_eq!(fs::read_to_string(list).unwrap(), "pictures 1\na.svg\nb.svg\n");
    }
}
