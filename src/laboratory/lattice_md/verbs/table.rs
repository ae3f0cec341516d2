//! `stripmine table`: the efficiency table, and the ladder of clocks.

use super::print_made;
use super::scene_choice::SceneChoice;
use super::validate_model::host_model;
use crate::console::{Common, Failure, print, print_json};
use crate::laboratory::lattice_md::sections;
use crate::laboratory::lattice_md::study::efficiency_table::efficiency_table;
use crate::laboratory::lattice_md::study::host_ladder::host_ladder;
use crate::laboratory::lattice_md::study::ladder::ladder;
use crate::model::machines;
use crate::report::terminal;
use clap::Args;
use std::path::PathBuf;

/// BP93's efficiency table: NOP as printed and as counted, vector lengths, clock periods
#[derive(Args)]
pub(super) struct TableVerb {
    #[command(flatten)]
    scene: SceneChoice,
    #[arg(long, default_value = "paper", help = machine_help())]
    machine: String,
    /// Instead: the clock periods of a step by every clock, from the trivial one to chaining and memory ports
    #[arg(long)]
    ladder: bool,
    /// With --ladder: by the model of a host instead of a machine's clocks; a host file of `calibrate`, or the model that
    /// comes with the program
    #[arg(long, requires = "ladder", num_args = 0..=1)]
    host: Option<Option<PathBuf>>,
}

/// What `--machine` takes.
pub(super) fn machine_help() -> String {
    let names: Vec<_> = machines::names().collect();
    format!("Machine whose clock is asked: {}, or the path of a machine file (.toml)", names.join(", "))
}

impl TableVerb {
    pub(super) fn run(&self, common: &Common) -> Result<(), Failure> {
        if let Some(file) = &self.host {
            let (host, calibrated) = host_model(file.as_deref(), common)?;
            let data = host_ladder(&self.scene.question(), &host, calibrated)?;
            if common.json {
                return print_json(&data);
            }
            return print(&terminal::render(&sections::ladder::of_host(&data)));
        }
        let (question, machine) = (self.scene.question(), machines::find(&self.machine)?);
        let made = match self.ladder {
            true => ladder(&question, &machine)?,
            false => efficiency_table(&question, &machine)?,
        };
        print_made(&made, common)
    }
}
