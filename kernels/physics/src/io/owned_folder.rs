//! Folders that this program writes into: nothing of others is lost there, and one process at a time writes.
//!
//! A file is own if the list beside it names it, or if it bears a mark of this program. A list is written before the files that it
//! names, so that a process that is killed leaves nothing that is not known as its own. Temporary files (`.stripmine-….part`)
//! are on no list: their names are random.

use super::lock::{Lock, is_lock};
use super::replace::{is_temporary, remove_if_there, replace, temporary};
use super::{FileError, FolderError, regular_file};
use serde::Deserialize;
use std::collections::BTreeSet;
use std::fs::{self, File};
use std::io::{self, BufWriter, ErrorKind, Read, Write};
use std::path::{Path, PathBuf};
use tempfile::TempDir;

/// The lock of folders that have no other.
pub const LOCK: &str = ".stripmine.lock";
/// Longer than any list (bytes).
const LONGEST: u64 = 1 << 24;
/// Where in a file its mark is looked for (bytes from the beginning).
const START: u64 = 1000;
/// A folder that is being replaced, in a temporary one.
const ASIDE: &str = "item";

/// Kind of a folder: its own files, and other files that it may hold.
#[derive(Clone, Copy, Debug)]
pub struct FolderKind {
    /// File that keeps other processes out.
    pub lock: &'static str,
    /// File with the names of own files beside it.
    pub list: &'static str,
    /// Content of the folder.
    pub holds: Holds,
}

/// Content of an owned folder.
#[derive(Clone, Copy, Debug)]
pub enum Holds {
    /// Own files by a list, a name a line, and beside them those of others.
    Files {
        /// The first line of the list.
        heading: &'static str,
        /// Reports whether an own file may be called so.
        is_own: fn(&str) -> bool,
        /// True where others' files may be there before the list is.
        is_shared: bool,
    },
    /// Folders of own files alone, each with its list (`files` of a JSON object), and marked files; beside them others' files.
    Folders {
        /// Files, each with the mark that it bears among its first bytes.
        marked: &'static [(&'static str, &'static str)],
        /// Subfolders that have such folders, too.
        below: &'static [&'static str],
    },
}

/// Names of all entries of a folder, sorted; none if it is not there.
///
/// # Errors
/// If the system does not let it be read.
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

/// Reports whether a file is there; if so, it bears the mark.
///
/// # Errors
/// [`FolderError::InTheWay`] if it bears none, or the system does not let it be read.
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

/// Names on a list of JSON.
#[derive(Deserialize)]
struct Names {
    #[serde(default)]
    files: BTreeSet<String>,
}

impl FolderKind {
    /// Names on the list of a folder; none where it holds nothing of ours, or is not there.
    ///
    /// # Errors
    /// [`FolderError`] if it holds something, but nothing of ours, or its list is damaged.
    pub(crate) fn listed(&self, folder: &Path) -> Result<Option<BTreeSet<String>>, FolderError> {
        let Some(mut names) = names_in(folder)? else { return Ok(None) };
        let (listed, list, below) = match self.holds {
            Holds::Files { is_shared: true, .. } => return self.read_if_ours(folder),
            Holds::Files { .. } => (self.read(folder)?, Some(self.list), [].as_slice()),
            Holds::Folders { below, .. } => (None, None, below),
        };
        let is_empty = |path: &Path| is_folder(path) && names_in(path).is_ok_and(|it| it == Some(vec![]));
        // A process that was killed may have left these.
        names.retain(|name| {
            let (path, name) = (folder.join(name), name.as_str());
            !(is_temporary(name)
                || name == self.lock && is_lock(&path)
                || below.contains(&name) && is_empty(&path))
        });
        // A place that cannot be listed shows nothing of ours: the folder is then refused.
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

    /// Reports whether a marked file or a folder of own files is there; a file with its name is ours.
    fn owns(&self, folder: &Path, name: &str) -> Result<bool, FolderError> {
        let Holds::Folders { marked, .. } = self.holds else { return Ok(false) };
        let path = folder.join(name);
        match marked.iter().find(|(own, _)| *own == name) {
            Some((_, mark)) => is_marked(&path, mark),
            None => Ok(self.alone_in(&path)?.is_some_and(|names| !names.is_empty())),
        }
    }

    /// Names of all files of a folder that has nothing but own files; none if it is not there.
    fn alone_in(&self, folder: &Path) -> Result<Option<Vec<String>>, FolderError> {
        if folder.symlink_metadata().is_ok_and(|there| !there.is_dir()) {
            return Err(FolderError::in_the_way(folder));
        }
        let Some(names) = names_in(folder)? else { return Ok(None) };
        let listed = self.read_if_ours(folder)?.unwrap_or_default();
        let is_own = |name: &&String| listed.contains(*name) && is_file(&folder.join(name));
        let foreign: Vec<String> = names.iter().filter(|name| !is_own(name)).cloned().collect();
        if foreign.is_empty() { Ok(Some(names)) } else { Err(FolderError::not_ours(folder, None, &foreign)) }
    }

    /// Names on the list of a folder; none where there is no list. A name that leads out of the folder is none of a list.
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
        let Holds::Files { heading, is_own, .. } = self.holds else {
            let names: Result<Names, _> = serde_json::from_str(&text);
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

    /// As [`read`](Self::read); none, too, where the list is damaged or another's.
    fn read_if_ours(&self, folder: &Path) -> Result<Option<BTreeSet<String>>, FolderError> {
        match self.read(folder) {
            Err(FolderError::List { .. } | FolderError::InTheWay { .. }) => Ok(None),
            read => read,
        }
    }

    /// Removes a folder of own files, the list last.
    fn remove(&self, folder: &Path, names: &[String]) -> Result<(), FileError> {
        let (list, rest): (Vec<&String>, Vec<&String>) = names.iter().partition(|&name| name == self.list);
        rest.into_iter().chain(list).try_for_each(|name| remove_if_there(&folder.join(name)))?;
        fs::remove_dir(folder).map_err(FileError::at(folder, "removing"))
    }
}

/// A folder, while this process writes into it.
#[derive(Debug)]
pub struct OwnedFolder {
    path: PathBuf,
    kind: FolderKind,
    listed: Option<BTreeSet<String>>,
    /// None where another process holds it for this one.
    lock: Option<Lock>,
}

impl OwnedFolder {
    /// Makes the folder if it is not there, keeps other processes out, and removes what killed ones left of their temporary files.
    /// In a folder of folders, those of the names `wanted` will be written, and marked files of these names.
    ///
    /// # Errors
    /// [`FolderError`] if what is there is not ours, or another process writes there.
    pub fn open(path: &Path, kind: FolderKind, wanted: &[String]) -> Result<OwnedFolder, FolderError> {
        let listed = || {
            let listed = kind.listed(path)?;
            wanted.iter().try_for_each(|name| kind.owns(path, name).map(drop))?;
            Ok::<_, FolderError>(listed)
        };
        listed()?;
        fs::create_dir_all(path).map_err(FileError::at(path, "creating the folder"))?;
        let lock = Some(Lock::take(&path.join(kind.lock))?);
        // Again, now that it stays so.
        let folder = OwnedFolder { path: path.to_owned(), kind, listed: listed()?, lock };
        folder.remove_leftovers()?;
        Ok(folder)
    }

    /// One that another process has opened, which lets this one write there.
    pub fn of_another(path: &Path, kind: FolderKind) -> OwnedFolder {
        OwnedFolder { path: path.to_owned(), kind, listed: None, lock: None }
    }

    /// The folder.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Where a file of the folder is.
    pub fn file(&self, name: &str) -> PathBuf {
        self.path.join(name)
    }

    /// Reports whether there are names on its list.
    pub(crate) fn has_own(&self) -> bool {
        self.listed.as_ref().is_some_and(|listed| !listed.is_empty())
    }

    /// True where the file system keeps others out.
    pub(crate) fn is_locked(&self) -> bool {
        self.lock.as_ref().is_some_and(Lock::is_held)
    }

    fn is_listed(&self, name: &str) -> bool {
        self.listed.as_ref().is_some_and(|listed| listed.contains(name))
    }

    /// Puts names on the list, which is on the disk when this returns. Others' files of these names are lost with `overwrite`.
    ///
    /// # Errors
    /// [`FolderError::InTheWay`] if there are such files and they are to stay, or the system does not let the list be written.
    pub fn claim<'n>(
        &mut self,
        names: impl IntoIterator<Item = &'n str>,
        overwrite: bool,
    ) -> Result<(), FolderError> {
        let Holds::Files { heading, is_shared, .. } = self.kind.holds else { return Ok(()) };
        // A list that lacks its own name is still the list.
        let is_new =
            |name: &&str| !self.is_listed(name) && (*name != self.kind.list || self.listed.is_none());
        let new: Vec<&str> = names.into_iter().filter(is_new).collect();
        // Without a list, a file of its name is another's, too.
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

    /// Puts a whole file in its place: one that was claimed, or a marked one.
    ///
    /// # Errors
    /// [`FolderError`] if a file without the mark is there, or the system does not let it be written.
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

    /// Removes own files but the list, those of the names `first` before the others; what others wrote stays.
    ///
    /// # Errors
    /// If the system does not let one be removed.
    pub fn clear(&self, first: &[&str]) -> Result<(), FolderError> {
        let listed = self.listed.iter().flatten().map(String::as_str);
        let rest = listed.filter(|name| *name != self.kind.list && !first.contains(name));
        first.iter().copied().chain(rest).try_for_each(|name| self.remove_own(name))
    }

    /// Removes a file, if it is there and own.
    ///
    /// # Errors
    /// If the system does not let it be removed.
    pub fn remove_own(&self, name: &str) -> Result<(), FolderError> {
        if self.is_listed(name) { Ok(remove_if_there(&self.file(name))?) } else { Ok(()) }
    }

    /// That files are still there, and the lock.
    ///
    /// # Errors
    /// If something else has removed one meanwhile.
    pub(crate) fn still_has(&self, names: &[&str]) -> Result<(), FolderError> {
        let lock = self.lock.iter().find(|lock| !lock.is_there()).map(|_| self.kind.lock);
        let gone = names.iter().copied().find(|name| !is_file(&self.file(name))).or(lock);
        gone.map_or(Ok(()), |name| {
            let cause = "it was removed or replaced while the run was under way";
            let cause = io::Error::new(ErrorKind::NotFound, cause);
            Err(FileError::at(&self.file(name), "looking for it")(cause).into())
        })
    }

    /// Puts a folder of own files in the place of the one of this name: all of them or, where that fails, none. The list comes
    /// first: whatever becomes of this process, what is there is known as own.
    ///
    /// # Errors
    /// [`FolderError`] if what is there is not ours, or the system does not let the files be written.
    pub fn write_folder<'f>(
        &self,
        name: &str,
        files: impl IntoIterator<Item = (&'f str, &'f [u8])>,
    ) -> Result<PathBuf, FolderError> {
        let folder = self.file(name);
        let own = self.kind.alone_in(&folder)?;
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

    /// Removes what processes that were killed left of their temporary files and folders, as far as it is ours. Among files of
    /// others, they may be those of a process that is under way.
    fn remove_leftovers(&self) -> Result<(), FolderError> {
        if matches!(self.kind.holds, Holds::Files { is_shared: true, .. }) {
            return Ok(());
        }
        let names = names_in(&self.path)?.unwrap_or_default();
        for left in names.iter().filter(|name| is_temporary(name)).map(|name| self.file(name)) {
            if !is_folder(&left) {
                remove_if_there(&left)?;
                continue;
            }
            for folder in [left.join(ASIDE), left].iter().filter(|folder| is_folder(folder)) {
                if let Ok(Some(own)) = self.kind.alone_in(folder) {
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

    /// A list is damaged where a name leads out of the folder, though its end is that of an own file; nothing is written by it.
    #[test]
    fn names_that_lead_out_of_the_folder_are_on_no_list() {
        let holds = |is_shared| Holds::Files {
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
            let damaged = alone.listed(folder.path()).unwrap_err();
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
