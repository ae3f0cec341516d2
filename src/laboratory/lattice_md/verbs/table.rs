//! `stripmine table`: efficiency table, and ladder of clock models.

use super::print_result;
use crate::console::{CommandFailure, Common};
use crate::laboratory::lattice_md::study::efficiency_table::{TableScene, efficiency_table};
use crate::laboratory::lattice_md::study::ladder::ladder;
use crate::model::machines;
use clap::Args;

/// Prints BP93's efficiency table: NOP as printed and as counted, vector lengths, clock periods
#[derive(Args)]
pub(super) struct TableVerb {
    #[command(flatten)]
    scene: TableScene,
    #[arg(long, default_value = "paper", help = machine_help())]
    machine: String,
    /// Prints the clock periods of a step by every clock model instead, from the trivial one to chaining and memory ports
    #[arg(long)]
    ladder: bool,
}

/// Help of the option `--machine`.
pub(super) fn machine_help() -> String {
    let names: Vec<_> = machines::names().collect();
    format!("Machine of the clock model: {}, or the path of a machine file (.toml)", names.join(", "))
}

impl TableVerb {
    pub(super) fn run(&self, common: &Common) -> Result<(), CommandFailure> {
        let (question, machine) = (self.scene, machines::find(&self.machine)?);
        let made = match self.ladder {
            true => ladder(&question, &machine)?,
            false => efficiency_table(&question, &machine)?,
        };
        print_result(&made, common)
    }
}
