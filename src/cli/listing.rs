//! `stripmine listing`: the vector instructions of a part.

use super::scene_choice::SceneChoice;
use super::{Common, Failure, print, print_json};
use crate::method::lattice_md::Part;
use crate::study::efficiency_table::{Question, step};
use clap::Args;
use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};
use serde::Serialize;

/// The vector instructions of a part of the step, as an assembly listing
#[derive(Args)]
pub(super) struct ListingVerb {
    /// The part
    #[arg(value_parser = part_parser())]
    part: Part,
    #[command(flatten)]
    scene: SceneChoice,
}

/// Accepts the parts there are; clap lists them where another is asked for.
fn part_parser() -> impl TypedValueParser<Value = Part> {
    let values = Part::ALL.iter().map(|part| PossibleValue::new(part.name()).help(part.meaning()));
    PossibleValuesParser::new(values).map(|name| {
        // The parser admits names of the list only.
        Part::ALL.iter().copied().find(|part| part.name() == name).unwrap_or(Part::Forces)
    })
}

/// One program of a part.
#[derive(Serialize)]
pub(super) struct ProgramListing {
    part: &'static str,
    length: &'static str,
    n: usize,
    lines: Vec<String>,
}

/// The programs of a part for a question.
pub(super) fn listings(part: Part, question: &Question) -> Result<Vec<ProgramListing>, Failure> {
    let (programs, lengths) = step(question)?;
    let of_part = programs.iter().filter(|step| step.part == part).map(|step| ProgramListing {
        part: part.name(),
        length: step.length.symbol(),
        n: lengths.range(step.length).len(),
        lines: step.program.listing().lines().map(str::to_owned).collect(),
    });
    Ok(of_part.collect())
}

/// Instructions of all programs: lines that are no comments.
pub(super) fn instructions(listings: &[ProgramListing]) -> usize {
    listings.iter().flat_map(|listing| &listing.lines).filter(|line| !line.starts_with(';')).count()
}

/// The listing as text.
pub(super) fn text(listings: &[ProgramListing]) -> String {
    let mut text = String::new();
    for ProgramListing { part, length, n, lines } in listings {
        text.push_str(&format!("; {part}: vectors of n = {length} = {n} elements\n"));
        for line in lines {
            text.push_str(line);
            text.push('\n');
        }
    }
    text
}

impl ListingVerb {
    pub(super) fn run(&self, common: &Common) -> Result<(), Failure> {
        let listings = listings(self.part, &self.scene.question())?;
        if common.json { print_json(&listings) } else { print(&text(&listings)) }
    }
}
