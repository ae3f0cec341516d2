//! The folder that results go to: a folder for each item, and the pages over all of them.
//!
//! Only what this program wrote is written over. An item's folder is its own if `provenance.json` there lists every file in
//! it; a page, if it bears the mark of ours; the whole folder, if it is empty or holds one of these, or a journal of ours.

use super::Made;
use super::journal::is_journal;
use super::made::{self, LONGEST, bytes_of, files_of};
use crate::claims;
use crate::console::{Failure, to_json};
use crate::frame::Scope;
use crate::pages::Page;
use crate::provenance::{Provenance, built};
use crate::report::figure::Figure;
use crate::report::tally::Tally;
use crate::report::{Section, html, page};
use serde::{Deserialize, Serialize};
use std::fs::{self, File};
use std::io::{ErrorKind, Read, Write};
use std::path::{Path, PathBuf};
use std::process::Command;
use stripmine_physics::io::lock::{Lock, LockError, is_lock};
use stripmine_physics::io::replace::{is_temporary, listing, remove_if_there, replace, temporary};
use stripmine_physics::io::{FileError, regular_file};
use stripmine_physics::origin::Origin;
use stripmine_physics::quoted;
use stripmine_physics::reported::{Class, Reported};
use tempfile::TempDir;

/// Where an item comes from, and its files; the one file of an item that differs from run to run.
const PROVENANCE: &str = "provenance.json";
/// Keeps other processes out.
const LOCK: &str = ".stripmine.lock";
/// Where the items lie that depend on the host.
const HOST: &str = "host";
/// The pages over all items, and the mark by which each is known.
const PAGES: [(&str, &str); 2] = [("README.md", page::MARK), ("index.html", html::MARK)];
/// Where in a page its mark is looked for (bytes from the beginning).
const START: u64 = 1000;

/// Why results are not written.
#[derive(Debug, thiserror::Error)]
pub enum FolderError {
    /// Something else stands there.
    #[error(
        "{} was not written by this command, or not by it alone: it holds {names}; move this away, or choose another --out",
        quoted::path(folder)
    )]
    NotOurs {
        /// The folder.
        folder: PathBuf,
        /// What is not ours.
        names: String,
    },
    /// A page of that name that is another's.
    #[error("{} was not written by this command: move it away, or choose another --out", quoted::path(.0))]
    InTheWay(PathBuf),
    /// Results that are committed would be written over by those of a source that is not.
    #[error(
        "the results in {} are committed, but this program was built from changes that are in no commit\n  help: \
         commit them and build again, or choose another --out",
        quoted::path(.0)
    )]
    Uncommitted(PathBuf),
    /// Another process writes there.
    #[error(transparent)]
    Lock(#[from] LockError),
    /// The system.
    #[error(transparent)]
    File(#[from] FileError),
}

impl Reported for FolderError {
    fn class(&self) -> Class {
        match self {
            FolderError::NotOurs { .. } | FolderError::InTheWay(_) | FolderError::Uncommitted(_) => {
                Class::Usage
            }
            FolderError::Lock(error) if error.is_refusal() => Class::Usage,
            FolderError::Lock(_) | FolderError::File(_) => Class::InputOutput,
        }
    }
}

/// What `provenance.json` holds: where an item comes from, and the names of its files.
#[derive(Serialize)]
struct Listed<'a> {
    #[serde(flatten)]
    provenance: &'a Provenance,
    files: Vec<&'a str>,
}

/// The names alone.
#[derive(Deserialize)]
struct Names {
    #[serde(default)]
    files: Vec<String>,
}

/// The folder, while this process writes into it.
pub struct Folder {
    path: PathBuf,
    /// None where another process holds it for this one.
    _lock: Option<Lock>,
}

impl Folder {
    /// Makes the folder if it is not there, and keeps other processes out. `items` and, if asked for, the pages will be
    /// written there.
    ///
    /// # Errors
    /// If what stands there is not ours, is committed while the source of this program is not, or another process writes
    /// there.
    pub fn open(path: &Path, items: &[&str], pages: bool) -> Result<Folder, FolderError> {
        traceable(path, &built())?;
        let admits = || {
            judge(path)?;
            for name in items {
                Section::folders(name)
                    .iter()
                    .try_for_each(|folder| own_files(&path.join(folder)).map(drop))?;
            }
            match pages {
                true => PAGES.iter().try_for_each(|&(name, mark)| own_page(&path.join(name), mark).map(drop)),
                false => Ok(()),
            }
        };
        admits()?;
        fs::create_dir_all(path).map_err(FileError::at(path, "creating the folder"))?;
        let lock = Lock::take(&path.join(LOCK))?;
        // Once more, now that it stays so.
        admits()?;
        remove_leftovers(path)?;
        Ok(Folder { path: path.to_owned(), _lock: Some(lock) })
    }

    /// One that another process has opened, which lets this one write items there.
    pub fn of_another(path: &Path) -> Folder {
        Folder { path: path.to_owned(), _lock: None }
    }

    /// Writes an item's files: all of them, or, where that fails, none. Returns their folder and the section that the page shows.
    ///
    /// # Errors
    /// If what is there is not ours, or the system does not let the files be written.
    pub fn write(
        &self,
        name: &str,
        made: &Made,
        provenance: &Provenance,
    ) -> Result<(PathBuf, Section), Failure> {
        let mut provenance = provenance.clone();
        provenance.processes = made.processes.unwrap_or(provenance.processes);
        if !made.repeated.is_empty() {
            provenance.repeated.clone_from(&made.repeated);
        }
        let (section, files) = files_of(name, made, &provenance)?;
        let folder = self.path.join(section.folder());
        let own = own_files(&folder)?;
        let mut listed = vec![PROVENANCE];
        listed.extend(files.iter().map(|(name, _)| name.as_str()));
        // The list first: whatever becomes of this process, what is here is known as ours.
        let list = to_json(&Listed { provenance: &provenance, files: listed })? + "\n";
        let part = self.temporary_folder()?;
        let all = std::iter::once((PROVENANCE, list.as_bytes()))
            .chain(files.iter().map(|(name, bytes)| (name.as_str(), bytes.as_slice())));
        for (name, bytes) in all {
            let path = part.path().join(name);
            fs::write(&path, bytes).map_err(FileError::at(&path, "writing")).map_err(FolderError::from)?;
        }
        self.exchange(&part, &folder, own.as_deref())?;
        // It has another name now.
        let _ = part.keep();
        Ok((folder, section))
    }

    /// Puts a new folder in the place of an item's, whose files are `own`.
    fn exchange(&self, part: &TempDir, folder: &Path, own: Option<&[String]>) -> Result<(), FolderError> {
        let at = || FileError::at(folder, "replacing");
        let parent = folder.parent().unwrap_or(&self.path);
        fs::create_dir_all(parent).map_err(FileError::at(parent, "creating the folder"))?;
        let Some(own) = own else { return Ok(fs::rename(part.path(), folder).map_err(at())?) };
        let aside = self.temporary_folder()?.keep();
        let old = aside.join("item");
        fs::rename(folder, &old).map_err(at())?;
        fs::rename(part.path(), folder).map_err(at())?;
        remove_own(&old, own)?;
        Ok(fs::remove_dir(&aside).map_err(FileError::at(&aside, "removing"))?)
    }

    fn temporary_folder(&self) -> Result<TempDir, FolderError> {
        #[cfg_attr(not(unix), expect(unused_mut, reason = "only there they have permissions"))]
        let mut names = temporary();
        #[cfg(unix)]
        {
            use std::os::unix::fs::PermissionsExt;
            // As for any other folder: what the user's mask leaves of it.
            names.permissions(fs::Permissions::from_mode(0o777));
        }
        Ok(names.tempdir_in(&self.path).map_err(FileError::at(&self.path, "creating a folder in it"))?)
    }

    /// Writes the pages over every item that the folder holds.
    ///
    /// # Errors
    /// As [`write`](Self::write).
    pub fn write_page(&self, items: &[&str]) -> Result<(), Failure> {
        let (mut sections, mut left_out) = (Vec::new(), Vec::new());
        for item in items {
            match self.read(item)? {
                Known::There(section) => sections.push(*section),
                Known::OfAnotherVersion => left_out.push((*item).to_owned()),
                Known::Absent => {}
            }
        }
        // Within a chapter, items stand as they are listed.
        sections.sort_by_key(|section| section.chapter);
        // A picture that is gone leaves a gap in the page, and is there again with the item's next making.
        let drawn = |section: &Section, figure: &Figure| {
            let file = self.path.join(section.folder()).join(format!("{}.svg", figure.name));
            String::from_utf8(regular_file::read(&file, LONGEST).unwrap_or_default()).unwrap_or_default()
        };
        let tally = Tally::of(&sections, &claims::all()?);
        let texts =
            [page::render(&sections, &left_out, &tally), html::render(&sections, &left_out, &tally, &drawn)];
        for ((name, mark), text) in PAGES.into_iter().zip(texts) {
            let path = self.path.join(name);
            own_page(&path, mark)?;
            replace(&path, |out| out.write_all(text.as_bytes())).map_err(FolderError::from)?;
        }
        Ok(())
    }

    /// The item's section, if the folder has it.
    fn read(&self, name: &str) -> Result<Known, Failure> {
        let Some(folder) = self.item(name) else { return Ok(Known::Absent) };
        let Some(provenance) = self.provenance(name)? else { return Ok(Known::OfAnotherVersion) };
        let made = match Page::of(name)? {
            Some(page) => made::read(&folder, &page)?,
            None => None,
        };
        let section = match made.map(|made| self.renewed(name, &folder, &made, &provenance)).transpose() {
            // Its tables are not those that the page of this version shows.
            Err(_) if provenance.origin.version != built().version => None,
            section => section?,
        };
        let there = |section| Known::There(Box::new(Section { provenance: Some(provenance), ..section }));
        Ok(section.map_or(Known::OfAnotherVersion, there))
    }

    /// The section of an item whose data are there, by its template of today. Files that the template changes are written again; the
    /// record of where the data come from stays.
    fn renewed(
        &self,
        name: &str,
        folder: &Path,
        made: &Made,
        provenance: &Provenance,
    ) -> Result<Section, Failure> {
        let (section, files) = files_of(name, made, provenance)?;
        let is_there = |(name, bytes): &(String, Vec<u8>)| {
            regular_file::read(&folder.join(name), LONGEST).is_ok_and(|there| there == *bytes)
        };
        if !files.iter().all(is_there) {
            self.write(name, made, provenance)?;
        }
        Ok(section)
    }

    /// How the folder's item of this name was made; none if it has no such item that this version of the program can read.
    ///
    /// # Errors
    /// If it cannot be read.
    pub fn provenance(&self, name: &str) -> Result<Option<Provenance>, Failure> {
        let Some(folder) = self.item(name) else { return Ok(None) };
        Ok(serde_json::from_slice(&bytes_of(&folder.join(PROVENANCE))?).ok())
    }

    /// The tables of an item, for expressions; none if the folder does not have it, or another version of the program wrote it.
    ///
    /// # Errors
    /// If they cannot be read.
    pub fn scope(&self, name: &str) -> Result<Option<Scope>, Failure> {
        self.item(name).map_or(Ok(None), |folder| made::scope(&folder))
    }

    /// An item as its page shows it; none if the folder does not have it, or another version of the program wrote it.
    ///
    /// # Errors
    /// If it cannot be read, or its page or a claim names what is not there.
    pub fn section(&self, name: &str) -> Result<Option<Section>, Failure> {
        match self.read(name)? {
            Known::There(section) => Ok(Some(*section)),
            Known::OfAnotherVersion | Known::Absent => Ok(None),
        }
    }

    /// The folder of an item that is there.
    fn item(&self, name: &str) -> Option<PathBuf> {
        let folders = Section::folders(name).map(|folder| self.path.join(folder));
        folders.into_iter().find(|folder| folder.join(PROVENANCE).exists())
    }
}

/// What a folder has of an item.
enum Known {
    /// Its section.
    There(Box<Section>),
    /// Files that another version of the program wrote.
    OfAnotherVersion,
    /// Nothing.
    Absent,
}

/// Names of all entries of a folder, sorted; none if it is not there.
fn entries(folder: &Path) -> Result<Option<Vec<String>>, FileError> {
    let at = || FileError::at(folder, "reading the folder");
    let entries = match fs::read_dir(folder) {
        Ok(entries) => entries,
        Err(cause) if cause.kind() == ErrorKind::NotFound => return Ok(None),
        Err(cause) => return Err(at()(cause)),
    };
    let mut names = Vec::new();
    for entry in entries {
        names.push(entry.map_err(at())?.file_name().to_string_lossy().into_owned());
    }
    names.sort();
    Ok(Some(names))
}

/// Refuses to write over committed results what no commit can make again.
fn traceable(path: &Path, origin: &Origin) -> Result<(), FolderError> {
    match !origin.is_committed() && is_committed(path) {
        true => Err(FolderError::Uncommitted(path.to_owned())),
        false => Ok(()),
    }
}

/// Whether git keeps files of a folder, which may have been removed; without git, or outside a checkout, it keeps none.
fn is_committed(folder: &Path) -> bool {
    let there = folder.ancestors().find(|there| there.is_dir()).unwrap_or(Path::new(""));
    // Git does not take empty paths.
    let [at, below] =
        [there, folder.strip_prefix(there).unwrap_or(folder)].map(|path| Path::new(".").join(path));
    let listed = Command::new("git").arg("-C").arg(at).args(["ls-files", "--"]).arg(below).output();
    listed.is_ok_and(|listed| listed.status.success() && !listed.stdout.is_empty())
}

fn not_ours(folder: &Path, foreign: &[String]) -> FolderError {
    FolderError::NotOurs { folder: folder.to_owned(), names: listing(foreign) }
}

fn is_folder(path: &Path) -> bool {
    fs::symlink_metadata(path).is_ok_and(|there| there.is_dir())
}

fn is_file(path: &Path) -> bool {
    fs::symlink_metadata(path).is_ok_and(|there| there.is_file())
}

/// The files in the folder of an item, all of them ours; none if there is no folder.
fn own_files(folder: &Path) -> Result<Option<Vec<String>>, FolderError> {
    if fs::symlink_metadata(folder).is_ok_and(|there| !there.is_dir()) {
        return Err(FolderError::InTheWay(folder.to_owned()));
    }
    let Some(names) = entries(folder)? else { return Ok(None) };
    let list = folder.join(PROVENANCE);
    let listed = match is_file(&list) {
        true => regular_file::read(&list, LONGEST).map_err(FileError::at(&list, "reading"))?,
        false => vec![],
    };
    let listed = serde_json::from_slice::<Names>(&listed).map_or(vec![], |names| names.files);
    let foreign: Vec<String> =
        names.iter().filter(|name| !listed.contains(name) || !is_file(&folder.join(name))).cloned().collect();
    if foreign.is_empty() { Ok(Some(names)) } else { Err(not_ours(folder, &foreign)) }
}

/// Removes files and the folder, if nothing else is in it; the list goes last.
fn remove_own(folder: &Path, own: &[String]) -> Result<(), FolderError> {
    let (list, rest): (Vec<&String>, Vec<&String>) = own.iter().partition(|&name| name == PROVENANCE);
    rest.into_iter().chain(list).try_for_each(|name| remove_if_there(&folder.join(name)))?;
    Ok(fs::remove_dir(folder).map_err(FileError::at(folder, "removing"))?)
}

/// Whether a page is there; if so, it is ours.
fn own_page(path: &Path, mark: &str) -> Result<bool, FolderError> {
    if fs::symlink_metadata(path).is_err_and(|cause| cause.kind() == ErrorKind::NotFound) {
        return Ok(false);
    }
    let mut start = Vec::new();
    if is_file(path) {
        let read = File::open(path).and_then(|file| file.take(START).read_to_end(&mut start));
        read.map_err(FileError::at(path, "reading"))?;
    }
    if String::from_utf8_lossy(&start).contains(mark) {
        Ok(true)
    } else {
        Err(FolderError::InTheWay(path.to_owned()))
    }
}

/// Refuses a folder that holds something, but nothing of ours.
fn judge(path: &Path) -> Result<(), FolderError> {
    let Some(mut names) = entries(path)? else { return Ok(()) };
    names.retain(|name| !(is_temporary(name) || name == LOCK && is_lock(&path.join(LOCK))));
    let host = path.join(HOST);
    let of_host = if is_folder(&host) { entries(&host)?.unwrap_or_default() } else { vec![] };
    if of_host.is_empty() && is_folder(&host) {
        names.retain(|name| name != HOST);
    }
    let items = names.iter().map(|name| path.join(name)).chain(of_host.iter().map(|name| host.join(name)));
    let is_item = |folder: PathBuf| is_file(&folder.join(PROVENANCE)) && own_files(&folder).is_ok();
    let (page, mark) = PAGES[0];
    let ours = names.is_empty()
        || is_journal(path)
        || own_page(&path.join(page), mark).is_ok_and(|there| there)
        || items.into_iter().any(is_item);
    if ours { Ok(()) } else { Err(not_ours(path, &names)) }
}

/// What sessions that were killed left of their temporary files and folders, as far as it is ours.
fn remove_leftovers(path: &Path) -> Result<(), FolderError> {
    for name in entries(path)?.unwrap_or_default().into_iter().filter(|name| is_temporary(name)) {
        let left = path.join(name);
        if !is_folder(&left) {
            remove_if_there(&left)?;
            continue;
        }
        let aside = left.join("item");
        for folder in [aside, left].iter().filter(|folder| is_folder(folder)) {
            if let Ok(Some(own)) = own_files(folder) {
                remove_own(folder, &own)?;
            }
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn committed_results_are_refused_to_a_source_that_is_not_committed() {
        let checkout = tempfile::tempdir().unwrap();
        let git = |arguments: &[&str]| {
            let done = Command::new("git").arg("-C").arg(checkout.path()).args(arguments).output().unwrap();
            assert!(done.status.success(), "{done:?}");
        };
        let [kept, scratch] = ["reports", "scratch"].map(|name| checkout.path().join(name));
        for folder in [&kept, &scratch] {
            fs::create_dir(folder).unwrap();
            fs::write(folder.join("README.md"), page::MARK).unwrap();
        }
        git(&["init", "--quiet"]);
        git(&["add", "reports"]);
        let of = |dirty| Origin { commit: "1234567890ab".to_owned(), dirty, ..built() };
        let refused = traceable(&kept, &of(true)).unwrap_err();
        assert!(matches!(&refused, FolderError::Uncommitted(folder) if *folder == kept));
        assert!(refused.to_string().contains("another --out"), "{refused}");
        assert_eq!(Failure::from(refused).exit_code(), 2);
        assert!(traceable(&kept, &of(false)).is_ok());
        fs::remove_dir_all(&kept).unwrap();
        assert!(traceable(&kept, &of(true)).is_err());
        // Folders that git does not keep, and that are not there yet, may be written by any program.
        assert!(traceable(&scratch, &of(true)).is_ok());
        assert!(traceable(&checkout.path().join("new"), &of(true)).is_ok());
    }
}
