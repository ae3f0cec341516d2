//! Studies of hard discs as verbs below `chart`.

use super::study::soft_hard::{SoftHardComparison, compare_soft_hard};
use crate::console::Verb;
use crate::console::{CommandFailure, Common, clear_progress, print_json, print_prose, progress};
use crate::laboratory::write_result;
use crate::results::Folder;
use clap::{Args, FromArgMatches};
use std::path::PathBuf;
use std::time::Instant;

/// Every study below `chart`.
pub(super) const CHARTS: &[Verb] = &[Verb {
    name: "soft-hard",
    command: |command| SoftHardVerb::augment_args(command),
    run: |matches, common| {
        SoftHardVerb::from_arg_matches(matches).map_err(CommandFailure::Arguments)?.run(common)
    },
}];

/// Compares one granular scene with soft discs of increasing stiffness and with hard discs: pressure, cooling, cost
#[derive(Args)]
struct SoftHardVerb {
    /// Minimum number of discs
    #[arg(long, default_value_t = 500, value_parser = clap::value_parser!(u64).range(50..=100_000))]
    particles: u64,
    /// Area of the discs over that of the box
    #[arg(long, default_value_t = 0.5, value_parser = bounded_number::<1, 80>, allow_negative_numbers = true)]
    packing_fraction: f64,
    /// Restitution of the gas that cools
    #[arg(long, default_value_t = 0.9, value_parser = bounded_number::<10, 100>, allow_negative_numbers = true)]
    restitution: f64,
    /// Folder for data, tables and figures
    #[arg(long, default_value = "charts")]
    out: PathBuf,
}

/// Parses a number between two bounds, given in hundredths.
fn bounded_number<const LOW: u32, const HIGH: u32>(text: &str) -> Result<f64, String> {
    let [low, high] = [LOW, HIGH].map(|hundredths| f64::from(hundredths) / 100.0);
    match text.parse() {
        Ok(value) if (low..=high).contains(&value) => Ok(value),
        _ => Err(format!("a number from {low} to {high} is expected")),
    }
}

impl SoftHardVerb {
    fn run(&self, common: &Common) -> Result<(), CommandFailure> {
        // Checked before the long computation.
        let folder = Folder::open(&self.out, &["soft-hard"], false)?;
        let question = SoftHardComparison {
            discs: self.particles,
            packing_fraction: self.packing_fraction,
            restitution: self.restitution,
            ..SoftHardComparison::REPORT
        };
        let (bar, start) = (progress(common, "chart"), Instant::now());
        let made = compare_soft_hard(&question, &|share| bar.set_position((1e3 * share) as u64))?;
        clear_progress();
        let words = write_result(&folder, ("soft-hard", &made), start, common)?;
        if common.json { print_json(&made.json()) } else { print_prose(&words) }
    }
}
