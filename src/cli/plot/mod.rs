//! `stripmine plot`: pictures and films of a run.

mod colouring;
mod film;
mod means;
mod observed;
mod particles;
mod segments;
mod structure;
mod window;

use super::display::{UnitSystem, scene_of};
use super::run_folder;
use crate::console::{CommandFailure, Common, print, print_json, warn};
use crate::report::figure::{Figure, png, svg};
use crate::report::{html, terminal};
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
/// Writes SVG and PNG files and prints small curves to the terminal. A long box also gets its density over time.
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
    /// Also writes a film of the trajectory: film.html, a self-contained page for a browser
    #[arg(long)]
    film: bool,
    /// Folder for the pictures; default: RUN.plots
    #[arg(long)]
    out: Option<PathBuf>,
    /// Overwrites files of the same names even if this command did not write them
    #[arg(long)]
    overwrite: bool,
}

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
        let (mut names, mut pictures, mut taken) = (vec![], vec![], BTreeSet::new());
        for figure in &figures {
            let Some((vector, pixels)) = draw_figure(figure, common)? else { continue };
            let name = file_name(&figure.name, &mut taken);
            names.extend(["svg", "png"].map(|kind| format!("{name}.{kind}")));
            pictures.extend([vector.into_bytes(), pixels]);
        }
        if self.film {
            let (film, notes) = film::film(&run, &colours)?;
            names.push(FILM.to_owned());
            pictures.push(html::film_page(&film, &notes).into_bytes());
        }
        let mut folder = OwnedFolder::open(&out, PICTURES, &[])?;
        folder.claim(names.iter().map(String::as_str), self.overwrite)?;
        let mut written = vec![];
        for (name, bytes) in names.iter().zip(&pictures) {
            written.push(folder.write(name, |out| out.write_all(bytes))?.display().to_string());
        }
        if common.json {
            return print_json(&json!({ "files": written }));
        }
        let mut small = table.terminal_table(&wanted, &out);
        if self.film {
            small = small.note(format!("film for a browser: {}", quoted::path(&out.join(FILM))));
        }
        print(&terminal::render(&small))
    }
}

/// Returns true if the name can be that of a picture or a film.
fn is_picture(name: &str) -> bool {
    name == FILM || [".svg", ".png"].iter().any(|end| name.ends_with(end))
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
