//! Verbs of lattice MD: cost of its programs by count, by clock model and by measurement.

mod calibrate;
mod density_cost;
mod listing;
mod table;
mod validate_model;

use crate::console::{CommandFailure, Common, Verb, print, print_json};
use crate::frame::FormattedTable;
use crate::report::terminal;
use crate::results::FinishedItem;
use calibrate::CalibrateVerb;
use clap::{Args, FromArgMatches};
use density_cost::DensityCostVerb;
use listing::ListingVerb;
use table::TableVerb;
use validate_model::ValidateModelVerb;

macro_rules! verbs {
    ($($name:literal $arguments:ident,)*) => {
        &[$(Verb {
            name: $name,
            command: |command| $arguments::augment_args(command),
            run: |matches, common| run_verb::<$arguments>(matches, common, $arguments::run),
        }),*]
    };
}

/// Every verb, in the order of the help.
pub(super) const VERBS: &[Verb] = verbs! {
    "table" TableVerb,
    "listing" ListingVerb,
    "calibrate" CalibrateVerb,
    "validate-model" ValidateModelVerb,
};

/// Every study below `chart`, in the order of the help.
pub(super) const CHARTS: &[Verb] = verbs! {
    "density-cost" DensityCostVerb,
};

fn run_verb<A: Args + FromArgMatches>(
    matches: &clap::ArgMatches,
    common: &Common,
    run: fn(&A, &Common) -> Result<(), CommandFailure>,
) -> Result<(), CommandFailure> {
    run(&A::from_arg_matches(matches).map_err(CommandFailure::Arguments)?, common)
}

/// Prints a result: every frame as a table, or all of them as JSON.
fn print_result(made: &FinishedItem, common: &Common) -> Result<(), CommandFailure> {
    let tables = made.frames.iter().map(|frame| terminal::render(&FormattedTable::from(frame)));
    if common.json { print_json(&made.json()) } else { print(&tables.collect::<Vec<_>>().join("\n")) }
}
