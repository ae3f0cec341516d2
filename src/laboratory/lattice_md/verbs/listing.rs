//! `stripmine listing`: vector instructions of a part of the step.

use crate::console::{CommandFailure, Common, print, print_json};
use crate::emission::ListingTarget;
use crate::laboratory::lattice_md::study::efficiency_table::TableScene;
use crate::laboratory::lattice_md::study::listing::listing;
use crate::results::FinishedItem;
use clap::Args;
use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};
use stripmine_physics::method::lattice_md::Part;

/// Prints the vector instructions of a part of the step, as an assembly listing
#[derive(Args)]
pub(super) struct ListingVerb {
    #[arg(value_parser = part_parser())]
    part: Part,
    #[command(flatten)]
    scene: TableScene,
    #[command(flatten)]
    target: ListingTarget,
}

/// Parser of the existing parts; clap lists them for any other name.
fn part_parser() -> impl TypedValueParser<Value = Part> {
    let values = Part::ALL.iter().map(|part| PossibleValue::new(part.name()).help(part.meaning()));
    PossibleValuesParser::new(values).map(|name| {
        // The parser only admits names of the list.
        Part::ALL.iter().copied().find(|part| part.name() == name).unwrap_or(Part::Forces)
    })
}

impl ListingVerb {
    pub(super) fn run(&self, common: &Common) -> Result<(), CommandFailure> {
        let (instructions, text) = listing(self.part, &self.scene, self.target.size())?;
        if common.json { print_json(&FinishedItem::of([instructions]).json()) } else { print(&text) }
    }
}
