//! `stripmine reproduce`: the main job.

use super::items_of;
use crate::console::{Common, Failure, SHARES, bar, clear_progress, print_json, say};
use crate::provenance::Provenance;
use crate::results::Item;
use crate::results::{Effort, Folder};
use clap::Args;
use serde::Serialize;
use std::path::PathBuf;
use std::time::Instant;
use stripmine_physics::method::Methods;
use stripmine_physics::quoted;
use stripmine_physics::signals;

/// Every table and figure of the sources, with data and a page that says what came out
#[derive(Args)]
pub(super) struct Reproduce {
    /// Take less time: leaves out what needs minutes, and measures less
    #[arg(long)]
    quick: bool,
    /// Only this item; may be given several times. The page keeps what the folder holds of the others
    #[arg(long)]
    only: Vec<String>,
    /// Folder for the results
    #[arg(long, default_value = "reproduction")]
    out: PathBuf,
}

/// What was done with an item.
#[derive(Serialize)]
struct Outcome {
    item: &'static str,
    verdict: &'static str,
    seconds: f64,
    folder: PathBuf,
}

impl Reproduce {
    pub(super) fn run(&self, common: &Common, methods: Methods) -> Result<(), Failure> {
        let effort = if self.quick { Effort::Quick } else { Effort::Full };
        let asked = |item: &&Item| match self.only.as_slice() {
            [] => item.is_quick || effort == Effort::Full,
            only => only.iter().any(|name| name == item.name),
        };
        let all: Vec<&'static Item> = items_of(methods).collect();
        let on_page: Vec<&str> = all.iter().map(|item| item.name).collect();
        let items: Vec<&'static Item> = all.into_iter().filter(asked).collect();
        let names: Vec<&str> = items.iter().map(|item| item.name).collect();
        let folder = Folder::open(&self.out, &names, true)?;
        let expected: f64 = items.iter().map(|item| item.seconds(effort)).sum();
        let bar = bar(common, ticks(expected), SHARES);
        let mut outcomes = Vec::new();
        let mut before = 0.0;
        for item in items {
            bar.set_message(item.name);
            let start = Instant::now();
            let share = item.seconds(effort);
            let made = (item.make)(effort, &|part| bar.set_position(ticks(before + part * share)))?;
            before += share;
            bar.set_position(ticks(before));
            let seconds = start.elapsed().as_secs_f64();
            // Finished items are on the disk, and on the page, before the next one starts, and before a signal ends it all.
            let provenance = Provenance::here(common.command.clone(), seconds);
            let path = signals::whole(|| {
                let path = folder.write(&made, &provenance)?;
                folder.write_page(&on_page).map(|()| path)
            })?;
            if !common.quiet {
                let word = made.section.verdict.word();
                say(format_args!("{:<12} {word:<18} {seconds:>6.1} s  {}", item.name, quoted::path(&path)));
            }
            outcomes.push(Outcome {
                item: item.name,
                verdict: made.section.verdict.word(),
                seconds,
                folder: path,
            });
        }
        clear_progress();
        if common.json { print_json(&outcomes) } else { Ok(()) }
    }
}

/// Progress is counted in thousandths of an expected second.
fn ticks(seconds: f64) -> u64 {
    (1000.0 * seconds) as u64
}
