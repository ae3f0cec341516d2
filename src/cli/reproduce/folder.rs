//! The folder that results go to: a folder for each item, and the pages over all of them.

use super::items::{Item, Made};
use crate::cli::{Failure, to_json};
use crate::report::figure::{Figure, png, svg};
use crate::report::origin::Provenance;
use crate::report::{Section, csv, html, page};
use clap::ValueEnum;
use serde::Serialize;
use std::fs;
use std::path::{Path, PathBuf};

/// What a page needs of an item that is not its data.
const SECTION: &str = "section.json";
/// Where an item comes from; the one file of an item that differs from run to run.
const PROVENANCE: &str = "provenance.json";

/// The folder.
pub(in crate::cli) struct Folder {
    path: PathBuf,
}

impl Folder {
    pub(in crate::cli) fn new(path: &Path) -> Folder {
        Folder { path: path.to_owned() }
    }

    /// Writes an item's files: all of them, or, where that fails, none.
    pub(in crate::cli) fn write(&self, made: &Made, provenance: &Provenance) -> Result<PathBuf, Failure> {
        let Made { section, data, files } = made;
        let folder = self.path.join(section.folder());
        let part = folder.with_extension("part");
        let at = |path: &Path| Failure::writing(path.display().to_string());
        if part.exists() {
            fs::remove_dir_all(&part).map_err(at(&part))?;
        }
        fs::create_dir_all(&part).map_err(at(&part))?;
        let write = |name: &str, bytes: &[u8]| {
            let path = part.join(name);
            fs::write(&path, bytes).map_err(at(&path))
        };
        if !data.is_null() {
            write("data.json", compact(data)?.as_bytes())?;
        }
        for table in &section.tables {
            let mut bytes = Vec::new();
            csv::write(table, &mut bytes).map_err(Failure::writing("CSV"))?;
            write(&format!("{}.csv", table.name), &bytes)?;
        }
        for figure in &section.figures {
            write(&format!("{}.svg", figure.name), svg(figure)?.as_bytes())?;
            write(&format!("{}.png", figure.name), &png(figure)?)?;
        }
        for (name, text) in files {
            write(name, text.as_bytes())?;
        }
        let compact =
            serde_json::to_string(section).map_err(|cause| Failure::writing("JSON")(cause.into()))?;
        write(SECTION, (compact + "\n").as_bytes())?;
        write(PROVENANCE, (to_json(provenance)? + "\n").as_bytes())?;
        if folder.exists() {
            fs::remove_dir_all(&folder).map_err(at(&folder))?;
        }
        fs::rename(&part, &folder).map_err(at(&folder))?;
        Ok(folder)
    }

    /// Writes the pages over every item that the folder holds.
    pub(super) fn write_page(&self) -> Result<(), Failure> {
        let mut sections = Vec::new();
        for item in Item::value_variants() {
            sections.extend(self.read(item.name())?);
        }
        // A picture that is gone leaves a gap in the page, and is there again with the item's next making.
        let drawn = |section: &Section, figure: &Figure| {
            let file = self.path.join(section.folder()).join(format!("{}.svg", figure.name));
            fs::read_to_string(file).unwrap_or_default()
        };
        for (name, text) in
            [("README.md", page::render(&sections)), ("index.html", html::render(&sections, &drawn))]
        {
            let path = self.path.join(name);
            fs::write(&path, text).map_err(Failure::writing(path.display().to_string()))?;
        }
        Ok(())
    }

    /// The item's section, if the folder has it.
    fn read(&self, name: &str) -> Result<Option<Section>, Failure> {
        let Some(folder) = Section::folders(name)
            .map(|folder| self.path.join(folder))
            .into_iter()
            .find(|f| f.join(SECTION).exists())
        else {
            return Ok(None);
        };
        let parsed = |file: &str| -> Result<String, Failure> {
            let path = folder.join(file);
            fs::read_to_string(&path).map_err(Failure::writing(path.display().to_string()))
        };
        let foreign = |cause: serde_json::Error| Failure::writing(folder.display().to_string())(cause.into());
        let mut section: Section = serde_json::from_str(&parsed(SECTION)?).map_err(foreign)?;
        section.provenance = Some(serde_json::from_str(&parsed(PROVENANCE)?).map_err(foreign)?);
        Ok(Some(section))
    }
}

/// JSON without blanks: datasets are for programs.
fn compact(data: &impl Serialize) -> Result<String, Failure> {
    let text = serde_json::to_string(data).map_err(|cause| Failure::writing("JSON")(cause.into()))?;
    Ok(text + "\n")
}
