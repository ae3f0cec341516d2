//! `stripmine plot`: pictures and films of a run, and pictures of the start of a scene.

mod colouring;
mod film;
mod means;
mod observed;
mod particles;
mod segments;
mod start;
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
use start::MisplacedOption;
use std::collections::BTreeSet;
use std::io::Write;
use std::path::{Path, PathBuf};
use stripmine_physics::io::owned_folder::{FolderContent, FolderKind, LOCK, OwnedFolder};
use stripmine_physics::method::{Methods, load};
use stripmine_physics::quoted;

/// Plots a run: observables, structure functions and last state; or the start of a scene
///
/// Writes a page with all pictures and the film, index.html, and SVG and PNG files; prints small curves to the terminal. A long box also gets its density over time.
///
/// Of a scene, draws the particles, sides and walls at the start as start.svg and start.png, without running it.
#[derive(Args)]
pub(super) struct PlotVerb {
    /// Folder of a run; or a scene: preset name or scene file
    #[arg(value_name = "RUN|SCENE")]
    what: PathBuf,
    /// Overrides a value of a scene; can be repeated
    #[arg(long = "set", value_name = "SECTION.KEY=VALUE")]
    overrides: Vec<String>,
    /// Columns of thermo.csv, separated by commas; default: all that change
    #[arg(long, value_delimiter = ',')]
    columns: Vec<String>,
    /// Colours the particles by this quantity; default: speed, or one colour each for up to six bodies with tracks
    #[arg(long, value_parser = PossibleValuesParser::new(Colouring::possible_values()))]
    color: Option<String>,
    /// Also writes the film alone, as large as the screen: film.html, a self-contained page for a browser
    #[arg(long)]
    film: bool,
    /// Folder for the pictures; default: RUN.plots or SCENE.plots
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
        let run = run_folder(&self.what);
        match start::scene_name(&self.what, &run, methods) {
            Some(scene) => self.draw_start(&scene, common, methods),
            None => self.draw_run(&run, common, methods),
        }
    }

    /// Draws the start of a scene.
    fn draw_start(&self, scene: &str, common: &Common, methods: Methods) -> Result<(), CommandFailure> {
        let of_runs = [("--columns", !self.columns.is_empty()), ("--film", self.film)];
        if let Some((option, _)) = of_runs.into_iter().find(|(_, is_given)| *is_given) {
            return Err(MisplacedOption::OfRuns { option, scene: scene.to_owned() }.into());
        }
        let (prepared, _) = load(scene, &self.overrides, methods)?;
        let figures = start::figures(scene, &prepared, self.color.as_deref())?;
        let files: Vec<_> = drawn(&figures, common).into_iter().flat_map(DrawnFigure::files).collect();
        let out = self.out_folder(Path::new(scene));
        let written = self.write(&out, &files)?;
        if common.json {
            return print_json(&json!({ "files": written }));
        }
        let line = |(name, _): &(String, Vec<u8>)| format!("start: {}\n", quoted::path(&out.join(name)));
        print(&files.iter().map(line).collect::<String>())
    }

    /// Draws a run.
    fn draw_run(&self, run: &Path, common: &Common, methods: Methods) -> Result<(), CommandFailure> {
        let table = ObservableTable::read(&run.join("thermo.csv"), methods)?;
        if !self.overrides.is_empty() {
            return Err(MisplacedOption::OfScenes { run: run.to_owned() }.into());
        }
        let wanted = table.selected_columns(&self.columns, methods)?;
        let units = UnitSystem::of(scene_of(run).as_ref());
        let mut figures = table.figures(&wanted, &units);
        figures.extend(structure::figures(run, &units)?);
        let colours = RunColouring::of_run(self.color.as_deref(), run, methods);
        match particles::pictures(run, &colours) {
            Ok(pictures) => figures.extend(pictures),
            Err(PictureError::Colouring(error)) => return Err(error.into()),
            Err(why) if !common.quiet => warn(format_args!("the particles are not drawn: {why}")),
            Err(_) => {}
        }
        let out = self.out_folder(run);
        let film = match film::film(run, &colours) {
            Err(error) if self.film => return Err(error.into()),
            film => film,
        };
        let drawn = drawn(&figures, common);
        let shown = match &film {
            Ok((film, _)) if film.frames.len() > 1 => Ok(film),
            Ok(_) => Err("the trajectory has only one frame.".to_owned()),
            Err(error) => Err(error.to_string()),
        };
        let and_film = if shown.is_ok() { " and the film" } else { "" };
        let page = html::run_page(&RunPage {
            title: quoted::quoted(&run.file_stem().unwrap_or_default().to_string_lossy()),
            numbers: table.numbers_table(&wanted),
            pictures: drawn.iter().map(|it| (it.figure, it.vector.as_str(), it.name.as_str())).collect(),
            film: shown,
            notes: film.as_ref().map_or(&[], |(_, notes)| notes),
            scene: scene_text(run),
        });
        let mut files = vec![(PAGE.to_owned(), page.into_bytes())];
        files.extend(drawn.into_iter().flat_map(DrawnFigure::files));
        if let (true, Ok((film, notes))) = (self.film, &film) {
            files.push((FILM.to_owned(), html::film_page(film, notes).into_bytes()));
        }
        let written = self.write(&out, &files)?;
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

    /// Folder for the pictures of a run or scene.
    fn out_folder(&self, of: &Path) -> PathBuf {
        let stem = of.file_stem().unwrap_or_default();
        self.out.clone().unwrap_or_else(|| PathBuf::from(format!("{}.plots", stem.to_string_lossy())))
    }

    /// Writes files to the folder of the pictures, and returns their paths.
    fn write(&self, out: &Path, files: &[(String, Vec<u8>)]) -> Result<Vec<String>, CommandFailure> {
        let mut folder = OwnedFolder::open(out, PICTURES, &[])?;
        folder.claim(files.iter().map(|(name, _)| name.as_str()), self.overwrite)?;
        let mut written = vec![];
        for (name, bytes) in files {
            written.push(folder.write(name, |out| out.write_all(bytes))?.display().to_string());
        }
        Ok(written)
    }
}

/// Picture as SVG and PNG.
struct DrawnFigure<'f> {
    figure: &'f Figure,
    vector: String,
    pixels: Vec<u8>,
    /// File name without extension.
    name: String,
}

impl DrawnFigure<'_> {
    /// Names and bytes of its files.
    fn files(self) -> [(String, Vec<u8>); 2] {
        let DrawnFigure { vector, pixels, name, .. } = self;
        [(format!("{name}.svg"), vector.into_bytes()), (format!("{name}.png"), pixels)]
    }
}

/// Draws pictures; leaves out, with a warning, those that cannot be drawn.
fn drawn<'f>(figures: &'f [Figure], common: &Common) -> Vec<DrawnFigure<'f>> {
    let (mut drawn, mut taken) = (vec![], BTreeSet::new());
    for figure in figures {
        match svg(figure).and_then(|vector| Ok((vector, png(figure)?))) {
            Ok((vector, pixels)) => {
                let name = file_name(&figure.name, &mut taken);
                drawn.push(DrawnFigure { figure, vector, pixels, name });
            }
            Err(why) if !common.quiet => {
                warn(format_args!("{} is not drawn: {why}", quoted::quoted(&figure.title)));
            }
            Err(_) => {}
        }
    }
    drawn
}

/// Returns true if the name can be that of a picture, of a film or of the page.
fn is_picture(name: &str) -> bool {
    [FILM, PAGE].contains(&name) || [".svg", ".png"].iter().any(|end| name.ends_with(end))
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
