//! The studies below `chart` that are this method's own.

use super::sections;
use super::study::soft_hard::{Question, soft_hard};
use crate::console::Verb;
use crate::console::{Common, Failure, clear_progress, print, print_json, progress, say};
use crate::provenance::Provenance;
use crate::results::{Folder, Made};
use clap::{Args, FromArgMatches};
use std::path::PathBuf;
use std::time::Instant;
use stripmine_physics::signals;

/// Every study below `chart`.
pub(super) const CHARTS: &[Verb] = &[Verb {
    name: "soft-hard",
    command: |command| SoftHardVerb::augment_args(command),
    run: |matches, common| SoftHardVerb::from_arg_matches(matches).map_err(Failure::Arguments)?.run(common),
}];

/// One granular scene by soft discs of growing stiffness and by hard ones: pressure, cooling, cost
#[derive(Args)]
struct SoftHardVerb {
    /// Number of discs, at least
    #[arg(long, default_value_t = 500, value_parser = clap::value_parser!(u64).range(50..=100_000))]
    particles: u64,
    /// Area of the discs over that of the box
    #[arg(long, default_value_t = 0.5, value_parser = between::<1, 80>, allow_negative_numbers = true)]
    packing_fraction: f64,
    /// Restitution of the gas that cools
    #[arg(long, default_value_t = 0.9, value_parser = between::<10, 100>, allow_negative_numbers = true)]
    restitution: f64,
    /// Folder for data, tables and figures
    #[arg(long, default_value = "charts")]
    out: PathBuf,
}

/// A number between two hundredths.
fn between<const LOW: u32, const HIGH: u32>(text: &str) -> Result<f64, String> {
    let [low, high] = [LOW, HIGH].map(|hundredths| f64::from(hundredths) / 100.0);
    match text.parse() {
        Ok(value) if (low..=high).contains(&value) => Ok(value),
        _ => Err(format!("a number from {low} to {high} is expected")),
    }
}

impl SoftHardVerb {
    fn run(&self, common: &Common) -> Result<(), Failure> {
        // Before anything takes its time.
        let folder = Folder::open(&self.out, &["soft-hard"], false)?;
        let question = Question {
            discs: self.particles,
            packing_fraction: self.packing_fraction,
            restitution: self.restitution,
            ..question()
        };
        let (bar, start) = (progress(common, "chart"), Instant::now());
        let data = soft_hard(&question, &|share| bar.set_position((1e3 * share) as u64))?;
        let again = format!(
            "stripmine chart soft-hard --particles {} --packing-fraction {} --restitution {}",
            self.particles, self.packing_fraction, self.restitution
        );
        let section = sections::soft_hard::section(&data, again);
        let answer = section.paragraphs().collect::<Vec<_>>().join(" ");
        let made = Made::new(section, &data)?;
        let provenance = Provenance::here(common.command.clone(), start.elapsed().as_secs_f64());
        let (folder, _) = signals::whole(|| folder.write("soft-hard", &made, &provenance))?;
        clear_progress();
        if !common.quiet {
            say(format_args!("written: {}", folder.display()));
        }
        if common.json { print_json(&data) } else { print(&(answer + "\n")) }
    }
}

/// What is asked if nothing else is.
pub(super) fn question() -> Question {
    Question {
        discs: 500,
        packing_fraction: 0.5,
        restitution: 0.9,
        stiffnesses: vec![1e3, 1e4, 1e5, 1e6, 1e7],
        seeds: 8,
        time: 20.0,
    }
}
