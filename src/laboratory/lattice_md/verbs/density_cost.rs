//! `stripmine chart density-cost`: cost over density, as data and charts.

use super::validate_model::host_model;
use crate::console::{Common, Failure, clear_progress, print, print_json, progress, say};
use crate::laboratory::lattice_md::sections;
use crate::laboratory::lattice_md::study::break_even::atlas;
use crate::laboratory::lattice_md::study::density_cost::density_cost;
use crate::laboratory::lattice_md::study::measured_cost::{Effort, measured_cost};
use crate::laboratory::lattice_md::study::rounds::Bound;
use crate::model::machines;
use crate::provenance::Provenance;
use crate::report::Section;
use crate::results::{Folder, Made};
use clap::Args;
use std::path::PathBuf;
use std::time::Instant;
use stripmine_physics::signals;

/// BP93, figures 3 and 4, by the paper's clock of a machine and measured here, and the break-even atlas: who wins where
#[derive(Args)]
pub(super) struct DensityCostVerb {
    #[arg(long, default_value = "paper", help = super::table::machine_help())]
    machine: String,
    /// Host file of `calibrate` for the atlas; without one, the model that comes with the program
    #[arg(long)]
    host: Option<PathBuf>,
    /// Folder for data, tables and figures
    #[arg(long, default_value = "charts")]
    out: PathBuf,
}

/// The answer of an item and what else there is to know.
fn said(section: &Section) -> String {
    section.paragraphs().collect::<Vec<_>>().join(" ")
}

impl DensityCostVerb {
    pub(super) fn run(&self, common: &Common) -> Result<(), Failure> {
        let machine = machines::find(&self.machine)?;
        // Before anything takes its time.
        let folder = Folder::open(&self.out, &["cost", "measured", "atlas"], false)?;
        let (host, calibrated) = host_model(self.host.as_deref(), common)?;
        let again = format!("stripmine chart density-cost --machine {}", self.machine);
        let bar = progress(common, "chart");
        let show = |from: f64, share: f64| bar.set_position((1e3 * (from + 0.5 * share)) as u64);
        let write = |name: &str, made: &Made, start: Instant| -> Result<Section, Failure> {
            let provenance = Provenance::here(common.command.clone(), start.elapsed().as_secs_f64());
            let (folder, section) = signals::whole(|| folder.write(name, made, &provenance))?;
            if !common.quiet {
                say(format_args!("written: {}", folder.display()));
            }
            Ok(section)
        };
        let value = |data: serde_json::Result<serde_json::Value>| {
            data.map_err(|cause| Failure::writing("JSON")(cause.into()))
        };
        let start = Instant::now();
        let cost = density_cost(&machine)?;
        let mut answers = vec![said(&write("cost", &cost, start)?)];

        let start = Instant::now();
        let measured = measured_cost(&Effort::chart(), |share| show(0.0, share))?;
        let section = sections::measured_cost::section(&measured);
        answers.push(said(&section));
        let measured_data = value(serde_json::to_value(&measured))?;
        write("measured", &Made::new(section, &measured_data)?, start)?;

        let start = Instant::now();
        let atlas = atlas(&[machine], (&host, calibrated), &[100, 1000, 10_000], Bound::of(3), |share| {
            show(0.5, share)
        })?;
        let section = sections::break_even::section(&atlas, &again);
        answers.push(said(&section));
        let atlas_data = value(serde_json::to_value(&atlas))?;
        write("atlas", &Made::new(section, &atlas_data)?, start)?;
        clear_progress();
        if common.json {
            let all =
                serde_json::json!({ "model": cost.json(), "measured": measured_data, "atlas": atlas_data });
            return print_json(&all);
        }
        print(&(answers.join("\n\n") + "\n"))
    }
}
