//! `stripmine chart density-cost`: cost over density, as data and charts.

use crate::console::{Common, Failure, clear_progress, print, print_json, progress, say};
use crate::laboratory::lattice_md::study::density_cost::density_cost;
use crate::laboratory::lattice_md::study::searches;
use crate::model::machines;
use crate::provenance::Provenance;
use crate::results::{Folder, Lab, Made, Size};
use clap::Args;
use std::path::PathBuf;
use std::time::Instant;
use stripmine_physics::signals;

/// BP93, figures 3 and 4, by the paper's clock of a machine, and the fastest search measured here; `reproduce --only searches` measures more
#[derive(Args)]
pub(super) struct DensityCostVerb {
    #[arg(long, default_value = "paper", help = super::table::machine_help())]
    machine: String,
    /// Folder for data, tables and figures
    #[arg(long, default_value = "charts")]
    out: PathBuf,
}

impl DensityCostVerb {
    pub(super) fn run(&self, common: &Common) -> Result<(), Failure> {
        let machine = machines::find(&self.machine)?;
        // Before anything takes its time.
        let folder = Folder::open(&self.out, &["cost", "searches"], false)?;
        let bar = progress(common, "chart");
        let write = |name: &str, made: &Made, start: Instant| -> Result<String, Failure> {
            let provenance = Provenance::here(common.command.clone(), start.elapsed().as_secs_f64());
            let (folder, section) = signals::whole(|| folder.write(name, made, &provenance))?;
            if !common.quiet {
                say(format_args!("written: {}", folder.display()));
            }
            Ok(section.paragraphs().collect::<Vec<_>>().join(" "))
        };
        let start = Instant::now();
        let cost = density_cost(&machine)?;
        let said = write("cost", &cost, start)?;
        let (start, show) = (Instant::now(), |share: f64| bar.set_position((1e3 * share) as u64));
        let searches = searches::made(&Lab::apart(&show), Size::Quick)?;
        let also_said = write("searches", &searches, start)?;
        clear_progress();
        match common.json {
            true => print_json(&serde_json::json!({ "cost": cost.json(), "searches": searches.json() })),
            false => print(&format!("{said}\n\n{also_said}\n")),
        }
    }
}
