//! `stripmine chart density-cost`: cost against density, as data and charts.

use crate::console::{CommandFailure, Common, clear_progress, print_json, print_prose, progress};
use crate::laboratory::lattice_md::study::density_cost::density_cost;
use crate::laboratory::lattice_md::study::searches;
use crate::laboratory::write_result;
use crate::model::machines;
use crate::results::{Folder, StudyEnvironment, StudySize};
use clap::Args;
use std::path::PathBuf;
use std::time::Instant;

/// Draws BP93's figures 3 and 4 with the clock model of a machine, and measures the fastest search here; `reproduce --only searches` measures more
#[derive(Args)]
pub(super) struct DensityCostVerb {
    #[arg(long, default_value = "paper", help = super::table::machine_help())]
    machine: String,
    /// Folder for data, tables and figures
    #[arg(long, default_value = "charts")]
    out: PathBuf,
}

impl DensityCostVerb {
    pub(super) fn run(&self, common: &Common) -> Result<(), CommandFailure> {
        let machine = machines::find(&self.machine)?;
        // Checked before the long computation.
        let folder = Folder::open(&self.out, &["cost", "searches"], false)?;
        let bar = progress(common, "chart");
        let start = Instant::now();
        let cost = density_cost(&machine)?;
        let said = write_result(&folder, ("cost", &cost), start, common)?;
        let (start, show) = (Instant::now(), |share: f64| bar.set_position((1e3 * share) as u64));
        let searches = searches::reproduce(&StudyEnvironment::apart(&show), StudySize::Quick)?;
        let also_said = write_result(&folder, ("searches", &searches), start, common)?;
        clear_progress();
        match common.json {
            true => print_json(&serde_json::json!({ "cost": cost.json(), "searches": searches.json() })),
            false => print_prose(&format!("{said}\n\n{also_said}")),
        }
    }
}
