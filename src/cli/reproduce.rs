//! `stripmine reproduce`: the main job.

use super::{Common, Failure, listing, print_json, to_json};
use crate::method::lattice_md::Part;
use crate::model::machine;
use crate::report::origin::Origin;
use crate::report::{self, page::Section};
use crate::study::efficiency_table::{Question, efficiency_table};
use clap::{Args, ValueEnum};
use serde::Serialize;
use std::path::{Path, PathBuf};

/// Every table and figure of the sources, with data and a page that says what came out
#[derive(Args)]
pub(super) struct Reproduce {
    /// Take less time (so far no item takes long, so this changes nothing)
    #[arg(long)]
    quick: bool,
    /// Only this item; may be given several times
    #[arg(long, value_enum)]
    only: Vec<Item>,
    /// Folder for the results
    #[arg(long, default_value = "reports")]
    out: PathBuf,
}

/// What can be reproduced.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum, Serialize)]
#[serde(rename_all = "lowercase")]
enum Item {
    /// BP93's efficiency table
    Table,
    /// The vector instructions of every part
    Listing,
}

/// What was written.
#[derive(Serialize)]
struct Outcome {
    origin: Origin,
    quick: bool,
    items: Vec<Item>,
    files: Vec<PathBuf>,
}

impl Reproduce {
    pub(super) fn run(&self, common: &Common) -> Result<(), Failure> {
        let asked = |item: &Item| self.only.is_empty() || self.only.contains(item);
        let items: Vec<Item> = Item::value_variants().iter().copied().filter(asked).collect();
        let mut folder = Folder { path: self.out.clone(), written: Vec::new() };
        let mut sections = Vec::new();
        for item in &items {
            sections.push(match item {
                Item::Table => table(&mut folder)?,
                Item::Listing => listings(&mut folder)?,
            });
        }
        let origin = Origin::here();
        folder.write("README.md", &report::page::render(&sections, &origin))?;
        let outcome = Outcome { origin, quick: self.quick, items, files: folder.written };
        if common.json {
            return print_json(&outcome);
        }
        if !common.quiet {
            for file in &outcome.files {
                eprintln!("wrote {}", file.display());
            }
        }
        Ok(())
    }
}

/// The folder that results go to.
struct Folder {
    path: PathBuf,
    written: Vec<PathBuf>,
}

impl Folder {
    fn write(&mut self, name: impl AsRef<Path>, text: &str) -> Result<(), Failure> {
        let path = self.path.join(name);
        let parent = path.parent().unwrap_or(&self.path);
        let fail = || Failure::writing(path.display().to_string());
        std::fs::create_dir_all(parent).map_err(fail())?;
        std::fs::write(&path, text).map_err(fail())?;
        self.written.push(path);
        Ok(())
    }
}

/// The efficiency table of the source's own machine.
fn table(folder: &mut Folder) -> Result<Section, Failure> {
    let question = Question::default();
    let data = efficiency_table(&question, &machine::preset("paper")?)?;
    folder.write("efficiency_table/data.json", &(to_json(&data)? + "\n"))?;
    let tables = report::efficiency_table::tables(&data);
    for table in &tables {
        let mut bytes = Vec::new();
        report::csv::write(table, &mut bytes).map_err(Failure::writing("CSV"))?;
        folder.write(format!("efficiency_table/{}.csv", table.name), &String::from_utf8_lossy(&bytes))?;
    }
    Ok(Section {
        title: "The efficiency table".to_owned(),
        says: "BP93, section 3, counts 59, 12, 1656 and 54 operations for predictor, index, forces and corrector, \
               each at NOP·(n + D) clock periods with D = 20."
            .to_owned(),
        came_out: report::efficiency_table::verdict(&data),
        again: "stripmine reproduce --only table".to_owned(),
        body: tables.iter().map(report::markdown::render).collect::<Vec<_>>().join("\n"),
        files: "efficiency_table/".to_owned(),
    })
}

/// The vector instructions of every part.
fn listings(folder: &mut Folder) -> Result<Section, Failure> {
    let mut lengths = Vec::new();
    let mut excerpt = String::new();
    for &part in Part::ALL {
        let listings = listing::listings(part, &Question::default())?;
        let text = listing::text(&listings);
        if part == Part::Forces {
            excerpt = text.lines().take(24).collect::<Vec<_>>().join("\n");
        }
        lengths.push(format!("{} {}", part.name(), listing::instructions(&listings)));
        folder.write(format!("listing/{}.txt", part.name()), &text)?;
    }
    Ok(Section {
        title: "The vector instructions".to_owned(),
        says: "BP93 gives the algorithm in vector notation and prints no code.".to_owned(),
        came_out: format!("The programs that run, recorded: vector instructions {}.", lengths.join(", ")),
        again: "stripmine reproduce --only listing, or stripmine listing PART".to_owned(),
        body: format!("The first lines of the forces:\n\n```text\n{excerpt}\n```\n"),
        files: "listing/".to_owned(),
    })
}
