//! `stripmine chart`: studies as data and charts.

use super::reproduce::{Folder, Made};
use super::{Common, Failure, print, print_json};
use crate::model::machine;
use crate::report;
use crate::report::origin::Provenance;
use crate::study::density_cost::density_cost;
use clap::{Args, ValueEnum};
use std::path::PathBuf;
use std::time::Instant;

/// Studies as data and charts
#[derive(Args)]
pub(super) struct ChartVerb {
    /// What to chart
    #[arg(value_enum)]
    what: What,
    #[arg(long, default_value = "paper", help = super::table::machine_help())]
    machine: String,
    /// Folder for data, tables and figures
    #[arg(long, default_value = "charts")]
    out: PathBuf,
}

/// What can be charted so far.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum What {
    /// BP93, figures 3 and 4: cost over particles and density, by the paper's clock of a machine
    DensityCost,
}

impl ChartVerb {
    pub(super) fn run(&self, common: &Common) -> Result<(), Failure> {
        let What::DensityCost = self.what;
        let start = Instant::now();
        let data = density_cost(&machine::find(&self.machine)?)?;
        let section = report::density_cost::section(&data);
        let came_out = section.came_out.clone();
        let command = format!("stripmine chart density-cost --machine {}", self.machine);
        let provenance = Provenance::here(command, start.elapsed().as_secs_f64());
        let folder = Folder::new(&self.out).write(&Made::new(section, &data)?, &provenance)?;
        if !common.quiet {
            eprintln!("written: {}", folder.display());
        }
        if common.json { print_json(&data) } else { print(&(came_out + "\n")) }
    }
}
