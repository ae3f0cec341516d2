//! Files of an item: written from the result of a study, and read back.

use super::FinishedItem;
use crate::claims;
use crate::console::CommandFailure;
use crate::frame::csv::{self, Package};
use crate::frame::{ExpressionScope, ResultFrame};
use crate::pages::{Page, Shown};
use crate::provenance::Provenance;
use crate::report::Section;
use crate::report::figure::{self, Picture, svg};
use serde::Serialize;
use std::path::Path;
use stripmine_physics::io::regular_file;
use stripmine_physics::quoted;

/// Limit of the size of a file that is read again (bytes).
pub(super) const LONGEST: u64 = 1 << 30;
/// File with columns, types, units and meanings of an item's tables.
const PACKAGE: &str = "datapackage.json";
/// File with the frames of an item's film.
const FILM: &str = "film.json";
/// Suffix of the name of a table with the data of a figure.
const OF_FIGURE: &str = ".data";

/// Name and contents of a file.
type NamedFile = (String, Vec<u8>);

/// Section of an item, and its files except `provenance.json`. Claims belong to items of the report, not to studies of other scenes.
pub(super) fn section_and_files(
    name: &str,
    made: &FinishedItem,
    provenance: &Provenance,
) -> Result<(Section, Vec<NamedFile>), CommandFailure> {
    let FinishedItem { frames, pictures, film, files, seeds, .. } = made;
    let section = match Page::of(name)? {
        Some(page) => {
            let shown = Shown { frames, pictures, film: film.as_ref(), files, seeds };
            let claims = if provenance.is_from_reproduce() { claims::all()? } else { vec![] };
            page.section(&shown, &claims, provenance.measured_on())?
        }
        None => Section::new(name, name),
    };
    let of_figures = section.figures.iter().filter_map(figure::data).map(|table| ResultFrame::from(&table));
    let frames: Vec<ResultFrame> = frames.iter().cloned().chain(of_figures).collect();
    let mut all = vec![];
    for frame in &frames {
        let mut bytes = vec![];
        csv::write(frame, &mut bytes).map_err(CommandFailure::writing("CSV"))?;
        all.push((format!("{}.csv", frame.name), bytes));
    }
    let package = Package::of(&section.name, &section.title, seeds, &frames);
    all.push((PACKAGE.to_owned(), compact_json(&package)?.into_bytes()));
    for figure in &section.figures {
        all.push((format!("{}.svg", figure.name), svg(figure)?.into_bytes()));
    }
    if let Some(film) = film {
        all.push((FILM.to_owned(), compact_json(film)?.into_bytes()));
    }
    all.extend(files.iter().map(|(name, text)| (name.clone(), text.clone().into_bytes())));
    Ok((section, all))
}

/// Reads an item from its folder, for a template; none if another version wrote it.
pub(super) fn read(folder: &Path, page: &Page) -> Result<Option<FinishedItem>, CommandFailure> {
    if !folder.join(PACKAGE).exists() {
        return Ok(None);
    }
    let text = |name: &str| {
        Ok::<_, CommandFailure>(String::from_utf8_lossy(&read_file_bytes(&folder.join(name))?).into_owned())
    };
    let Ok(package) = serde_json::from_str::<Package>(&text(PACKAGE)?) else { return Ok(None) };
    let mut made = FinishedItem { seeds: package.seeds, ..FinishedItem::default() };
    let drawn = page.drawn();
    let has_picture = |table: &str| table.strip_suffix(OF_FIGURE).is_some_and(|it| drawn.contains(&it));
    for resource in package.resources {
        let name = resource.path.trim_end_matches(".csv").to_owned();
        // The data of charts are made again from the template.
        if name.ends_with(OF_FIGURE) && !has_picture(&name) {
            continue;
        }
        let bytes = read_file_bytes(&folder.join(&resource.path))?;
        let Ok(frame) = csv::read(resource, &bytes) else { return Ok(None) };
        made.frames.push(frame);
    }
    for name in drawn {
        let file = format!("{name}.svg");
        if folder.join(&file).exists() {
            let has_data = made.frames.iter().any(|frame| frame.name == format!("{name}{OF_FIGURE}"));
            made.pictures.push((name.to_owned(), Picture::Drawn { svg: text(&file)?, has_data }));
        }
    }
    if folder.join(FILM).exists() {
        let Ok(film) = serde_json::from_str(&text(FILM)?) else { return Ok(None) };
        made.film = Some(film);
    }
    for name in page.files() {
        if folder.join(name).exists() {
            made.files.push((name.to_owned(), text(name)?));
        }
    }
    Ok(Some(made))
}

/// Reads the tables of an item's folder, for expressions; none if another version wrote it.
pub(super) fn scope(folder: &Path) -> Result<Option<ExpressionScope>, CommandFailure> {
    let mut frames = vec![];
    if folder.join(PACKAGE).exists() {
        let Ok(package) = serde_json::from_slice::<Package>(&read_file_bytes(&folder.join(PACKAGE))?) else {
            return Ok(None);
        };
        for resource in package.resources {
            let bytes = read_file_bytes(&folder.join(&resource.path))?;
            let Ok(frame) = csv::read(resource, &bytes) else { return Ok(None) };
            frames.push(frame);
        }
    }
    Ok(Some(ExpressionScope::of(frames)))
}

/// Reads a file.
pub(super) fn read_file_bytes(path: &Path) -> Result<Vec<u8>, CommandFailure> {
    let what = || format!("reading {}", quoted::path(path));
    regular_file::read(path, LONGEST).map_err(|cause| CommandFailure::InputOutput { what: what(), cause })
}

/// JSON without white space: datasets are for programs.
fn compact_json(data: &impl Serialize) -> Result<String, CommandFailure> {
    let text = serde_json::to_string(data).map_err(|cause| CommandFailure::writing("JSON")(cause.into()))?;
    Ok(text + "\n")
}
