//! Folder of results: a folder for each item, and pages over all of them.
//!
//! Only files that this program wrote are overwritten. An item's folder is ours if its `provenance.json` lists every file in
//! it; a page, if it carries our mark; the whole folder, if it is empty or holds one of these, or one of our journals.

use super::FinishedItem;
use super::item_files::{self, LONGEST, read_file_bytes, section_and_files};
use super::journal::{self, NAME as JOURNAL};
use crate::claims;
use crate::console::{CommandFailure, to_json};
use crate::frame::ExpressionScope;
use crate::pages::Page;
use crate::provenance::{Provenance, built};
use crate::report::figure::Figure;
use crate::report::tally::Tally;
use crate::report::{Section, html, page};
use serde::Serialize;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::Command;
use stripmine_physics::io::owned_folder::{FolderContent, FolderKind, LOCK, OwnedFolder};
use stripmine_physics::io::regular_file;
use stripmine_physics::origin::Origin;
use stripmine_physics::quoted;
use stripmine_physics::reported::{ErrorClass, Reported};

/// File with an item's provenance and file list; the only file of an item that differs from run to run.
const PROVENANCE: &str = "provenance.json";
/// Pages over all items, with the mark that identifies each.
const PAGES: [(&str, &str); 2] = [("README.md", page::MARK), ("index.html", html::MARK)];
/// Kind of a folder of results; items that depend on the host are stored below `host`.
const RESULTS: FolderKind = FolderKind {
    lock: LOCK,
    list: PROVENANCE,
    holds: FolderContent::Folders {
        marked: &[PAGES[0], PAGES[1], (JOURNAL, journal::MARK)],
        below: &["host"],
    },
};

/// Error for committed results that a build with uncommitted changes would overwrite.
#[derive(Debug, thiserror::Error)]
#[error(
    "the results in {} are committed, but this program was built with uncommitted changes\n  help: \
     commit the changes and build again, or choose another --out",
    quoted::path(.0)
)]
struct UncommittedBuild(PathBuf);

impl Reported for UncommittedBuild {
    fn class(&self) -> ErrorClass {
        ErrorClass::Usage
    }
}

/// Contents of `provenance.json`: the provenance of an item, and the names of its files.
#[derive(Serialize)]
struct ProvenanceFile<'a> {
    #[serde(flatten)]
    provenance: &'a Provenance,
    files: Vec<&'a str>,
}

/// Folder of results, locked while this process writes to it.
pub struct Folder(OwnedFolder);

impl Folder {
    /// Creates the folder if needed, and locks it for writing `items` and optionally the pages.
    ///
    /// # Errors
    /// If its content is not ours, is committed while the source of this program is not, or another process writes to it.
    pub(crate) fn open(path: &Path, items: &[&str], pages: bool) -> Result<Folder, CommandFailure> {
        check_traceable(path, &built())?;
        let pages = PAGES.iter().filter(|_| pages).map(|(name, _)| (*name).to_owned());
        let wanted: Vec<String> = items.iter().flat_map(|name| Section::folders(name)).chain(pages).collect();
        Ok(Folder(OwnedFolder::open(path, RESULTS, &wanted)?))
    }

    /// Folder that another process has opened, into which this one may write items.
    pub fn opened_elsewhere(path: &Path) -> Folder {
        Folder(OwnedFolder::of_another(path, RESULTS))
    }

    /// Writes all files of an item, or none on failure. Returns their folder and the section for the page.
    ///
    /// # Errors
    /// If the existing files are not ours, or writing fails.
    pub(crate) fn write(
        &self,
        name: &str,
        made: &FinishedItem,
        provenance: &Provenance,
    ) -> Result<(PathBuf, Section), CommandFailure> {
        let mut provenance = provenance.clone();
        provenance.processes = made.processes.unwrap_or(provenance.processes);
        if !made.repeated.is_empty() {
            provenance.repeated.clone_from(&made.repeated);
        }
        let (section, files) = section_and_files(name, made, &provenance)?;
        let mut listed = vec![PROVENANCE];
        listed.extend(files.iter().map(|(name, _)| name.as_str()));
        let list = to_json(&ProvenanceFile { provenance: &provenance, files: listed })? + "\n";
        let all = std::iter::once((PROVENANCE, list.as_bytes()))
            .chain(files.iter().map(|(name, bytes)| (name.as_str(), bytes.as_slice())));
        let folder = self.0.write_folder(&section.folder(), all)?;
        Ok((folder, section))
    }

    /// Writes the pages over all items in the folder.
    ///
    /// # Errors
    /// As [`write`](Self::write).
    pub(crate) fn write_page(&self, items: &[&str]) -> Result<(), CommandFailure> {
        let (mut sections, mut left_out) = (Vec::new(), Vec::new());
        for item in items {
            match self.read(item, true)? {
                ItemState::There(section) => sections.push(*section),
                ItemState::OfAnotherVersion => left_out.push((*item).to_owned()),
                ItemState::Absent => {}
            }
        }
        // The sort is stable: within a chapter, items keep the order of the list.
        sections.sort_by_key(|section| section.chapter);
        // A missing picture leaves a gap in the page until the item is made again.
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

    /// Reads the item's section, if the folder has it. With `renews`, files that the current template changes are written again.
    fn read(&self, name: &str, renews: bool) -> Result<ItemState, CommandFailure> {
        let Some(folder) = self.item(name) else { return Ok(ItemState::Absent) };
        let Some(provenance) = self.provenance(name)? else { return Ok(ItemState::OfAnotherVersion) };
        let made = match Page::of(name)? {
            Some(page) => item_files::read(&folder, &page)?,
            None => None,
        };
        let section = |made: FinishedItem| self.current_section(name, (&folder, renews), &made, &provenance);
        let section = match made.map(section).transpose() {
            // The template of this version needs other tables.
            Err(_) if provenance.origin.version != built().version => None,
            section => section?,
        };
        let there = |section| ItemState::There(Box::new(Section { provenance: Some(provenance), ..section }));
        Ok(section.map_or(ItemState::OfAnotherVersion, there))
    }

    /// Section of an item from its stored data and the current template. With `renews`, files that the template changes are written
    /// again; the provenance of the data stays.
    fn current_section(
        &self,
        name: &str,
        (folder, renews): (&Path, bool),
        made: &FinishedItem,
        provenance: &Provenance,
    ) -> Result<Section, CommandFailure> {
        let (section, files) = section_and_files(name, made, provenance)?;
        let is_there = |(name, bytes): &(String, Vec<u8>)| {
            regular_file::read(&folder.join(name), LONGEST).is_ok_and(|there| there == *bytes)
        };
        if renews && !files.iter().all(is_there) {
            self.write(name, made, provenance)?;
        }
        Ok(section)
    }

    /// Provenance of an item; none if the folder has no such item that this version can read.
    ///
    /// # Errors
    /// If it cannot be read.
    pub fn provenance(&self, name: &str) -> Result<Option<Provenance>, CommandFailure> {
        let Some(folder) = self.item(name) else { return Ok(None) };
        Ok(serde_json::from_slice(&read_file_bytes(&folder.join(PROVENANCE))?).ok())
    }

    /// Tables of an item, for expressions; none if the folder does not have it, or another version wrote it.
    ///
    /// # Errors
    /// If they cannot be read.
    pub fn scope(&self, name: &str) -> Result<Option<ExpressionScope>, CommandFailure> {
        self.item(name).map_or(Ok(None), |folder| item_files::scope(&folder))
    }

    /// Section of an item as the page shows it; none if the folder does not have it, or another version wrote it.
    ///
    /// # Errors
    /// If it cannot be read, or its template or a claim names missing data.
    pub fn section(&self, name: &str) -> Result<Option<Section>, CommandFailure> {
        match self.read(name, false)? {
            ItemState::There(section) => Ok(Some(*section)),
            ItemState::OfAnotherVersion | ItemState::Absent => Ok(None),
        }
    }

    /// Folder of an existing item.
    fn item(&self, name: &str) -> Option<PathBuf> {
        let folders = Section::folders(name).map(|folder| self.0.file(&folder));
        folders.into_iter().find(|folder| folder.join(PROVENANCE).exists())
    }
}

/// State of an item in the folder.
enum ItemState {
    There(Box<Section>),
    /// Another version of the program wrote the files.
    OfAnotherVersion,
    Absent,
}

/// Refuses to overwrite committed results with results that no commit can reproduce.
fn check_traceable(path: &Path, origin: &Origin) -> Result<(), UncommittedBuild> {
    match !origin.is_committed() && is_committed(path) {
        true => Err(UncommittedBuild(path.to_owned())),
        false => Ok(()),
    }
}

/// Returns true if git tracks files of a folder, even removed ones; false without git or outside a checkout.
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

    /// A picture that the current template would draw in another way.
    #[test]
    fn reading_a_section_writes_nothing() {
        let folder = tempfile::tempdir().unwrap();
        let item = folder.path().join("corrector");
        fs::create_dir(&item).unwrap();
        let committed = Path::new(env!("CARGO_MANIFEST_DIR")).join("reports/corrector");
        for entry in fs::read_dir(committed).unwrap().map(|entry| entry.unwrap()) {
            fs::copy(entry.path(), item.join(entry.file_name())).unwrap();
        }
        let picture = item.join("energy-error.svg");
        fs::write(&picture, "<svg/>").unwrap();
        assert!(Folder::opened_elsewhere(folder.path()).section("corrector").unwrap().is_some());
        assert_eq!(fs::read_to_string(picture).unwrap(), "<svg/>");
    }

    #[test]
    fn uncommitted_builds_cannot_overwrite_committed_results() {
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
        let refused = check_traceable(&kept, &of(true)).unwrap_err();
        assert_eq!(refused.0, kept);
        assert!(refused.to_string().contains("another --out"), "{refused}");
        assert_eq!(CommandFailure::from(refused).exit_code(), 2);
        assert!(check_traceable(&kept, &of(false)).is_ok());
        fs::remove_dir_all(&kept).unwrap();
        assert!(check_traceable(&kept, &of(true)).is_err());
        // Any build may write to untracked and to new folders.
        assert!(check_traceable(&scratch, &of(true)).is_ok());
        assert!(check_traceable(&checkout.path().join("new"), &of(true)).is_ok());
    }
}
