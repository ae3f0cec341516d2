//! The folder that results go to: a folder for each item, and the pages over all of them.
//!
//! Only what this program wrote is written over. An item's folder is its own if `provenance.json` there lists every file in
//! it; a page, if it bears the mark of ours; the whole folder, if it is empty or holds one of these, or a journal of ours.

use super::Made;
use super::journal::{self, NAME as JOURNAL};
use super::made::{self, LONGEST, bytes_of, files_of};
use crate::claims;
use crate::console::{Failure, to_json};
use crate::frame::Scope;
use crate::pages::Page;
use crate::provenance::{Provenance, built};
use crate::report::figure::Figure;
use crate::report::tally::Tally;
use crate::report::{Section, html, page};
use serde::Serialize;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::Command;
use stripmine_physics::io::owned_folder::{FolderKind, Holds, LOCK, OwnedFolder};
use stripmine_physics::io::regular_file;
use stripmine_physics::origin::Origin;
use stripmine_physics::quoted;
use stripmine_physics::reported::{Class, Reported};

/// Where an item comes from, and its files; the one file of an item that differs from run to run.
const PROVENANCE: &str = "provenance.json";
/// The pages over all items, and the mark by which each is known.
const PAGES: [(&str, &str); 2] = [("README.md", page::MARK), ("index.html", html::MARK)];
/// A folder of results; items that depend on the host are below `host`.
const RESULTS: FolderKind = FolderKind {
    lock: LOCK,
    list: PROVENANCE,
    holds: Holds::Folders { marked: &[PAGES[0], PAGES[1], (JOURNAL, journal::MARK)], below: &["host"] },
};

/// Results that are committed would be written over by those of a source that is not.
#[derive(Debug, thiserror::Error)]
#[error(
    "the results in {} are committed, but this program was built from changes that are in no commit\n  help: \
     commit them and build again, or choose another --out",
    quoted::path(.0)
)]
struct Uncommitted(PathBuf);

impl Reported for Uncommitted {
    fn class(&self) -> Class {
        Class::Usage
    }
}

/// What `provenance.json` holds: where an item comes from, and the names of its files.
#[derive(Serialize)]
struct Listed<'a> {
    #[serde(flatten)]
    provenance: &'a Provenance,
    files: Vec<&'a str>,
}

/// The folder, while this process writes into it.
pub struct Folder(OwnedFolder);

impl Folder {
    /// Makes the folder if it is not there, and keeps other processes out. `items` and, if asked for, the pages will be
    /// written there.
    ///
    /// # Errors
    /// If what stands there is not ours, is committed while the source of this program is not, or another process writes
    /// there.
    pub(crate) fn open(path: &Path, items: &[&str], pages: bool) -> Result<Folder, Failure> {
        traceable(path, &built())?;
        let pages = PAGES.iter().filter(|_| pages).map(|(name, _)| (*name).to_owned());
        let wanted: Vec<String> = items.iter().flat_map(|name| Section::folders(name)).chain(pages).collect();
        Ok(Folder(OwnedFolder::open(path, RESULTS, &wanted)?))
    }

    /// One that another process has opened, which lets this one write items there.
    pub fn of_another(path: &Path) -> Folder {
        Folder(OwnedFolder::of_another(path, RESULTS))
    }

    /// Writes an item's files: all of them, or, where that fails, none. Returns their folder and the section that the page shows.
    ///
    /// # Errors
    /// If what is there is not ours, or the system does not let the files be written.
    pub(crate) fn write(
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
        let mut listed = vec![PROVENANCE];
        listed.extend(files.iter().map(|(name, _)| name.as_str()));
        let list = to_json(&Listed { provenance: &provenance, files: listed })? + "\n";
        let all = std::iter::once((PROVENANCE, list.as_bytes()))
            .chain(files.iter().map(|(name, bytes)| (name.as_str(), bytes.as_slice())));
        let folder = self.0.write_folder(&section.folder(), all)?;
        Ok((folder, section))
    }

    /// Writes the pages over every item that the folder holds.
    ///
    /// # Errors
    /// As [`write`](Self::write).
    pub(crate) fn write_page(&self, items: &[&str]) -> Result<(), Failure> {
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
            let file = self.0.file(&section.folder()).join(format!("{}.svg", figure.name));
            let picture =
                regular_file::read(&file, LONGEST).ok().and_then(|bytes| String::from_utf8(bytes).ok());
            picture.unwrap_or_default()
        };
        let tally = Tally::of(&sections, &claims::all()?);
        let texts =
            [page::render(&sections, &left_out, &tally), html::render(&sections, &left_out, &tally, &drawn)];
        for ((name, _), text) in PAGES.into_iter().zip(texts) {
            self.0.write(name, |out| out.write_all(text.as_bytes()))?;
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
        let folders = Section::folders(name).map(|folder| self.0.file(&folder));
        folders.into_iter().find(|folder| folder.join(PROVENANCE).exists())
    }
}

/// What a folder has of an item.
enum Known {
    There(Box<Section>),
    /// Files that another version of the program wrote.
    OfAnotherVersion,
    /// Nothing.
    Absent,
}

/// Refuses to write over committed results what no commit can make again.
fn traceable(path: &Path, origin: &Origin) -> Result<(), Uncommitted> {
    match !origin.is_committed() && is_committed(path) {
        true => Err(Uncommitted(path.to_owned())),
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

#[cfg(test)]
mod tests {
    use super::*;
    use std::fs;

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
        assert_eq!(refused.0, kept);
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
