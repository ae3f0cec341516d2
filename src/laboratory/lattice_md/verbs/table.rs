//! `stripmine table`: efficiency table, and ladder of clock models.

use super::print_result;
use super::validate_model::host_model;
use crate::console::{CommandFailure, Common, print};
use crate::frame::FormattedTable;
use crate::laboratory::host_table::host_frame;
use crate::laboratory::lattice_md::study::efficiency_table::{TableScene, efficiency_table};
use crate::laboratory::lattice_md::study::ladder::ladder;
use crate::model::machines;
use crate::report::terminal;
use crate::results::FinishedItem;
use clap::Args;
use std::path::PathBuf;
use stripmine_physics::method::{METHODS, load};

/// Prints BP93's efficiency table: NOP as printed and as counted, vector lengths, clock periods
#[derive(Args)]
pub(super) struct TableVerb {
    #[command(flatten)]
    scene: TableScene,
    #[arg(long, default_value = "paper", help = machine_help())]
    machine: String,
    /// Preset name or scene file, whose programs are timed on this host; used with --host
    #[arg(requires = "host", conflicts_with_all = ["ladder", "particles", "occupancy", "text", "machine"])]
    timed: Option<String>,
    /// Overrides a value of the scene; can be repeated
    #[arg(long = "set", value_name = "SECTION.KEY=VALUE", requires = "timed")]
    overrides: Vec<String>,
    /// Prints the scene's operations, flops, bytes and time, predicted by a host model beside the measured one: by a host file, or the shipped model
    #[arg(long, requires = "timed", num_args = 0..=1, require_equals = true, value_name = "HOST_FILE")]
    host: Option<Option<PathBuf>>,
    /// Prints the clock periods of a step by every clock model instead, from the trivial one to chaining and memory ports
    #[arg(long)]
    ladder: bool,
    /// Prints all tables: ways of counting, sections, vector lengths, classes of operations, simpler scenes
    #[arg(long, conflicts_with_all = ["host", "ladder"])]
    all: bool,
}

/// Help of the option `--machine`.
pub(super) fn machine_help() -> String {
    let names: Vec<_> = machines::names().collect();
    format!("Machine of the clock model: {}, or the path of a machine file (.toml)", names.join(", "))
}

impl TableVerb {
    pub(super) fn run(&self, common: &Common) -> Result<(), CommandFailure> {
        if let (Some(name), Some(host)) = (&self.timed, &self.host) {
            let (prepared, _) = load(name, &self.overrides, METHODS)?;
            let (model, _) = host_model(host.as_deref(), common)?;
            return print_result(&FinishedItem::of([host_frame(name, &prepared, &model)?]), common);
        }
        let (question, machine) = (self.scene, machines::find(&self.machine)?);
        let made = match self.ladder {
            true => ladder(&question, &machine)?,
            false => efficiency_table(&question, &machine)?,
        };
        match made.frames.split_first() {
            Some((first, others)) if !(others.is_empty() || self.all || self.ladder || common.json) => {
                let titles: Vec<&str> = others.iter().map(|frame| frame.title.as_str()).collect();
                let table = FormattedTable::from(first)
                    .note(format!("Machine: {}.", machine.title()))
                    .note(format!("Further tables, printed by --all: {}.", titles.join("; ")));
                print(&terminal::render(&table))
            }
            _ => print_result(&made, common),
        }
    }
}
