//! `stripmine plot`: pictures and films of a run.

mod colouring;
mod film;
mod means;
mod observed;
mod particles;
mod segments;
mod structure;
mod window;

use super::display::{UnitSystem, scene_of, scene_text};
use super::run_folder;
use crate::console::{CommandFailure, Common, print, print_json, warn};
use crate::report::figure::{Figure, png, svg};
use crate::report::html::{self, RunPage};
use crate::report::terminal;
use clap::Args;
use clap::builder::PossibleValuesParser;
use colouring::{Colouring, RunColouring};
use observed::ObservableTable;
use particles::PictureError;
use serde_json::json;
use std::collections::BTreeSet;
use std::io::Write;
use std::path::PathBuf;
use stripmine_physics::io::owned_folder::{FolderContent, FolderKind, LOCK, OwnedFolder};
use stripmine_physics::method::Methods;
use stripmine_physics::quoted;

/// Plots a run: observables, structure functions and last state
///
/// Writes a page with all pictures and the film, index.html, and SVG and PNG files; prints small curves to the terminal. A long box also gets its density over time.
#[derive(Args)]
pub(super) struct PlotVerb {
    /// Folder of a run
    run: PathBuf,
    /// Columns of thermo.csv, separated by commas; default: all that change
    #[arg(long, value_delimiter = ',')]
    columns: Vec<String>,
    /// Colours the particles by this quantity; default: speed, or one colour each for up to six bodies with tracks
    #[arg(long, value_parser = PossibleValuesParser::new(Colouring::possible_values()))]
    color: Option<String>,
    /// Also writes the film alone, as large as the screen: film.html, a self-contained page for a browser
    #[arg(long)]
    film: bool,
    /// Folder for the pictures; default: RUN.plots
    #[arg(long)]
    out: Option<PathBuf>,
    /// Overwrites files of the same names even if this command did not write them
    #[arg(long)]
    overwrite: bool,
}

/// File name of the page with all pictures.
const PAGE: &str = "index.html";
/// File name of a film.
const FILM: &str = "film.html";
/// Kind of a folder of pictures.
const PICTURES: FolderKind = FolderKind {
    lock: LOCK,
    list: "plot.files",
    holds: FolderContent::Files { heading: "stripmine plot.files 1", is_own: is_picture, is_shared: true },
};
/// Longest name of a picture (characters), without extension and number.
const LONGEST_NAME: usize = 80;

impl PlotVerb {
    pub(super) fn run(&self, common: &Common, methods: Methods) -> Result<(), CommandFailure> {
        let run = run_folder(&self.run);
        let table = ObservableTable::read(&run.join("thermo.csv"), methods)?;
        let wanted = table.selected_columns(&self.columns, methods)?;
        let units = UnitSystem::of(scene_of(&run).as_ref());
        let mut figures = table.figures(&wanted, &units);
        figures.extend(structure::figures(&run, &units)?);
        let colours = RunColouring::new(self.color.as_deref(), &run, methods);
        match particles::pictures(&run, &colours) {
            Ok(pictures) => figures.extend(pictures),
            Err(PictureError::Colouring(error)) => return Err(error.into()),
            Err(why) if !common.quiet => warn(format_args!("the particles are not drawn: {why}")),
            Err(_) => {}
        }
        let out = self.out.clone().unwrap_or_else(|| {
            let stem = run.file_stem().unwrap_or_default();
            PathBuf::from(format!("{}.plots", stem.to_string_lossy()))
        });
        let film = match film::film(&run, &colours) {
            Err(error) if self.film => return Err(error.into()),
            film => film,
        };
        let (mut drawn, mut taken) = (vec![], BTreeSet::new());
        for figure in &figures {
            let Some((vector, pixels)) = draw_figure(figure, common)? else { continue };
            drawn.push((figure, vector, pixels, file_name(&figure.name, &mut taken)));
        }
        let shown = match &film {
            Ok((film, _)) if film.frames.len() > 1 => Ok(film),
            Ok(_) => Err("the trajectory has only one frame.".to_owned()),
            Err(error) => Err(error.to_string()),
        };
        let and_film = if shown.is_ok() { " and the film" } else { "" };
        let page = html::run_page(&RunPage {
            title: quoted::quoted(&run.file_stem().unwrap_or_default().to_string_lossy()),
            numbers: table.numbers_table(&wanted),
            pictures: drawn
                .iter()
                .map(|(figure, vector, _, name)| (*figure, vector.as_str(), name.as_str()))
                .collect(),
            film: shown,
            notes: film.as_ref().map_or(&[], |(_, notes)| notes),
            scene: scene_text(&run),
        });
        let mut files = vec![(PAGE.to_owned(), page.into_bytes())];
        for (_, vector, pixels, name) in drawn {
            files.extend([(format!("{name}.svg"), vector.into_bytes()), (format!("{name}.png"), pixels)]);
        }
        if let (true, Ok((film, notes))) = (self.film, &film) {
            files.push((FILM.to_owned(), html::film_page(film, notes).into_bytes()));
        }
        let mut folder = OwnedFolder::open(&out, PICTURES, &[])?;
        folder.claim(files.iter().map(|(name, _)| name.as_str()), self.overwrite)?;
        let mut written = vec![];
        for (name, bytes) in &files {
            written.push(folder.write(name, |out| out.write_all(bytes))?.display().to_string());
        }
        if common.json {
            return print_json(&json!({ "files": written }));
        }
        let mut small = table.terminal_table(&wanted);
        let at = |name: &str| quoted::path(&out.join(name));
        small = small.note(format!("all pictures{and_film} on one page: {}", at(PAGE)));
        if self.film {
            small = small.note(format!("film for a browser: {}", at(FILM)));
        }
        print(&terminal::render(&small))
    }
}

/// Returns true if the name can be that of a picture, of a film or of the page.
fn is_picture(name: &str) -> bool {
    [FILM, PAGE].contains(&name) || [".svg", ".png"].iter().any(|end| name.ends_with(end))
}

/// Draws a picture as SVG and PNG; warns and returns none if it cannot be drawn.
fn draw_figure(figure: &Figure, common: &Common) -> Result<Option<(String, Vec<u8>)>, CommandFailure> {
    match svg(figure).and_then(|vector| Ok((vector, png(figure)?))) {
        Ok(pictures) => Ok(Some(pictures)),
        Err(why) => {
            if !common.quiet {
                warn(format_args!("{} is not drawn: {why}", quoted::quoted(&figure.title)));
            }
            Ok(None)
        }
    }
}

/// Unique file name for a picture: letters, digits and hyphens. Names of pictures can come from the header of a file.
fn file_name(name: &str, taken: &mut BTreeSet<String>) -> String {
    let plain = |c: char| if c.is_ascii_alphanumeric() { c } else { '-' };
    let short: String = name.chars().map(plain).take(LONGEST_NAME).collect();
    let numbered = (2u32..).map(|number| format!("{short}-{number}"));
    let free = std::iter::once(short.clone()).chain(numbered).find(|name| !taken.contains(name));
    let free = free.unwrap_or(short);
    taken.insert(free.clone());
    free
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn file_names_are_safe_and_unique() {
        let mut taken = BTreeSet::new();
        let names = ["kinetic", "../kinetic", "kinetic", &"x".repeat(300)];
        let names = names.map(|name| file_name(name, &mut taken));
        assert_eq!(names[..3], ["kinetic", "---kinetic", "kinetic-2"]);
        assert_eq!(names[3].len(), LONGEST_NAME);
    }
}
