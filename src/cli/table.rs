//! `stripmine table`: the efficiency table.

use super::scene_choice::SceneChoice;
use super::{Common, Failure, print, print_json};
use crate::model::machine;
use crate::report;
use crate::study::efficiency_table::efficiency_table;
use clap::Args;
use clap::builder::PossibleValuesParser;

/// BP93's efficiency table: NOP as printed and as counted, vector lengths, clock periods
#[derive(Args)]
pub(super) struct TableVerb {
    #[command(flatten)]
    scene: SceneChoice,
    /// Machine whose clock is asked
    #[arg(long, default_value = "paper", value_parser = PossibleValuesParser::new(machine::names()))]
    machine: String,
}

impl TableVerb {
    pub(super) fn run(&self, common: &Common) -> Result<(), Failure> {
        let data = efficiency_table(&self.scene.question(), &machine::preset(&self.machine)?)?;
        if common.json {
            return print_json(&data);
        }
        let tables = report::efficiency_table::tables(&data);
        let drawn: Vec<String> = tables.iter().map(report::terminal::render).collect();
        print(&drawn.join("\n"))
    }
}
