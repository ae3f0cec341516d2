//! `stripmine reproduce`: the main job.

use super::items_of;
use crate::console::{Common, Failure, SHARES, bar, clear_progress, print_json, say};
use crate::provenance::Provenance;
use crate::report::Chapter;
use crate::results::{Effort, Folder, Item};
use clap::Args;
use serde::Serialize;
use std::path::PathBuf;
use std::time::Instant;
use stripmine_physics::method::Methods;
use stripmine_physics::number::counted;
use stripmine_physics::quoted;
use stripmine_physics::signals;

/// Every table, figure and claim of the sources, with data and a page that says what came out. Interrupted, the same command goes on
/// with the item where it was
#[derive(Args)]
pub(super) struct Reproduce {
    /// Also what the sources do not ask, and the speed of this host: takes several times as long
    #[arg(long)]
    all: bool,
    /// Take less time: of everything what can be made in a minute, measured less
    #[arg(long, conflicts_with = "all")]
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
        let mut all: Vec<&'static Item> = items_of(methods).collect();
        all.sort_by_key(|item| item.chapter);
        let on_page: Vec<&str> = all.iter().map(|item| item.name).collect();
        let (asked, others): (Vec<_>, Vec<_>) = all.into_iter().partition(|item| self.asks(item));
        let names: Vec<&str> = asked.iter().map(|item| item.name).collect();
        let folder = Folder::open(&self.out, &names, true)?;
        let items = self.left(common, &folder, asked)?;
        let expected: f64 = items.iter().map(|item| item.seconds(effort)).sum();
        let bar = bar(common, ticks(expected), SHARES);
        if !common.quiet && items.len() > 1 {
            say(format_args!(
                "{} will take about {}.",
                counted(items.len(), "item", "items"),
                lasting(expected)
            ));
            if effort == Effort::Full && self.only.is_empty() && !self.all {
                let more = others.iter().map(|item| item.seconds(effort)).sum();
                say(format_args!(
                    "{} beyond the sources and of this host, about {} more: --all",
                    counted(others.len(), "item", "items"),
                    lasting(more)
                ));
            }
        }
        let mut outcomes = Vec::new();
        let mut before = 0.0;
        for item in items {
            let share = item.seconds(effort);
            bar.set_message(format!("{}, about {}", item.name, lasting(share)));
            let start = Instant::now();
            let made = item.make(effort, &|part| bar.set_position(ticks(before + part * share)))?;
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
                say(format_args!("{:<20} {word:<18} {seconds:>6.1} s  {}", item.name, quoted::path(&path)));
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

    fn asks(&self, item: &Item) -> bool {
        match self.only.as_slice() {
            [] if self.quick => item.is_quick(),
            [] => self.all || item.chapter == Chapter::Sources,
            only => only.iter().any(|name| name == item.name),
        }
    }

    /// The items that are still to be made: if the same command of the same program made some of them here, but not all, it was
    /// interrupted, and goes on.
    fn left(
        &self,
        common: &Common,
        folder: &Folder,
        asked: Vec<&'static Item>,
    ) -> Result<Vec<&'static Item>, Failure> {
        if !self.only.is_empty() {
            return Ok(asked);
        }
        let here = Provenance::here(common.command.clone(), 0.0);
        let mut made = vec![];
        for item in &asked {
            let there = folder.provenance(item.name)?;
            made.push(there.is_some_and(|there| there.is_of_the_command(&here)));
        }
        let number = asked.len();
        let left = unfinished(asked, &made);
        if left.len() < number && !common.quiet {
            say(format_args!(
                "{} of {number} items made before by this command are kept; to make them again, remove {}",
                number - left.len(),
                quoted::path(&self.out)
            ));
        }
        Ok(left)
    }
}

/// What is left of a job that made some of its items; all of one that made none, or that came to its end.
fn unfinished<T>(items: Vec<T>, made: &[bool]) -> Vec<T> {
    if made.iter().all(|made| *made) {
        return items;
    }
    items.into_iter().zip(made).filter(|(_, made)| !**made).map(|(item, _)| item).collect()
}

/// A time for a reader.
fn lasting(seconds: f64) -> String {
    match seconds {
        ..1.5 => "a second".to_owned(),
        ..100.0 => format!("{seconds:.0} s"),
        _ => format!("{:.0} min", (seconds / 60.0).ceil()),
    }
}

/// Progress is counted in thousandths of an expected second.
fn ticks(seconds: f64) -> u64 {
    (1000.0 * seconds) as u64
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_was_interrupted_goes_on_and_what_was_finished_begins_again() {
        assert_eq!(unfinished(vec!["a", "b", "c"], &[true, false, true]), ["b"]);
        for all in [true, false] {
            assert_eq!(unfinished(vec!["a", "b"], &[all; 2]), ["a", "b"]);
        }
    }

    #[test]
    fn times_are_for_readers() {
        assert_eq!([0.1, 42.4, 99.0, 121.0].map(lasting), ["a second", "42 s", "99 s", "3 min"]);
    }
}
