//! `stripmine reproduce`: makes the items of the report.

use super::{items_of, processes};
use crate::console::{CommandFailure, Common, SHARES, bar, clear_progress, print_json, print_message};
use crate::provenance::{Provenance, built};
use crate::report::Chapter;
use crate::results::{Folder, Item, StudyEnvironment, StudySize};
use clap::Args;
use indicatif::ProgressBar;
use serde::{Deserialize, Serialize};
use std::cell::Cell;
use std::path::{Path, PathBuf};
use std::time::Instant;
use stripmine_physics::method::Methods;
use stripmine_physics::number::{count_with_noun, significant};
use stripmine_physics::quoted;
use stripmine_physics::ranks::{RankBackend, Ranks};
use stripmine_physics::signals;

/// Reproduces every table, figure and claim of the papers
///
/// Writes data, figures and a page with the verdicts. After an interruption the same command resumes with the unfinished items.
#[derive(Args)]
pub(super) struct Reproduce {
    /// Also makes items beyond the papers, measures this host, and extends series to 10 million discs; takes 20 times as long and 5 GB
    #[arg(long)]
    all: bool,
    /// Makes only the items that fit into a minute, with shorter measurements
    #[arg(long, conflicts_with = "all")]
    quick: bool,
    /// Makes only this item; can be repeated. The page keeps the other items of the folder
    #[arg(long)]
    only: Vec<String>,
    /// Folder for the results
    #[arg(long, default_value = "reproduction")]
    out: PathBuf,
}

/// Result of making an item.
#[derive(Serialize, Deserialize)]
struct ItemOutcome {
    item: String,
    verdict: String,
    seconds: f64,
    folder: String,
}

/// Names of the items of each process.
type ItemNames = Vec<Vec<String>>;

/// Items made by a process, or the exit code and message of its failure.
type ProcessOutcome = Result<Vec<ItemOutcome>, (u8, String)>;

/// Settings and destination of the items of one process.
struct ItemJob<'j> {
    effort: StudySize,
    common: &'j Common,
    folder: &'j Folder,
    /// Items of the page; none if another process writes it.
    on_page: Option<Vec<&'j str>>,
    bar: ProgressBar,
    /// Expected seconds of the items made so far.
    before: Cell<f64>,
}

impl Reproduce {
    /// Makes the items. Several processes share them; the first alone makes those that measure this host.
    pub(super) fn run(&self, common: &Common, methods: Methods) -> Result<(), CommandFailure> {
        let RankBackend::Processes(join) = common.crew else { return self.make(None, common, methods) };
        let ranks = join();
        let same = format!("{}\n{:?}", common.command, built());
        processes::run_jointly(join, &same, |is_first| match is_first {
            true => self.make(Some(ranks.as_ref()), common, methods),
            false => {
                self.make_assigned_items(ranks.as_ref(), common, methods);
                Ok(())
            }
        })
    }

    fn make(
        &self,
        ranks: Option<&dyn Ranks>,
        common: &Common,
        methods: Methods,
    ) -> Result<(), CommandFailure> {
        let effort = self.study_size();
        let mut all: Vec<&'static Item> = items_of(methods).collect();
        all.sort_by_key(|item| item.chapter());
        let on_page: Vec<&str> = all.iter().map(|item| item.name).collect();
        let (asked, others): (Vec<_>, Vec<_>) = all.into_iter().partition(|item| self.is_requested(item));
        let names: Vec<&str> = asked.iter().map(|item| item.name).collect();
        let folder = Folder::open(&self.out, &names, true)?;
        let items = self.remaining_items(common, &folder, asked)?;
        let expected: f64 = items.iter().map(|item| item.seconds(effort)).sum();
        let bar = bar(common, ticks(expected), SHARES);
        if !common.quiet && items.len() > 1 {
            print_message(format_args!(
                "{} will take about {}",
                count_with_noun(items.len(), "item", "items"),
                duration_text(expected)
            ));
            if effort == StudySize::Full && self.only.is_empty() {
                let more = others.iter().map(|item| item.seconds(StudySize::All)).sum::<f64>()
                    + items
                        .iter()
                        .map(|item| item.seconds(StudySize::All) - item.seconds(effort))
                        .sum::<f64>();
                print_message(format_args!(
                    "--all adds {} (beyond the papers, and of this host) and longer series: about {} more",
                    count_with_noun(others.len(), "item", "items"),
                    duration_text(more)
                ));
            }
        }
        let job =
            ItemJob { effort, common, folder: &folder, on_page: Some(on_page), bar, before: Cell::new(0.0) };
        let outcomes = match ranks {
            None => job.make(&items)?,
            Some(ranks) => {
                let (of_host, everywhere): (Vec<_>, Vec<_>) =
                    items.into_iter().partition(|item| item.chapter() == Chapter::Host);
                let dealt = distribute(everywhere, ranks.count(), |item| item.seconds(effort));
                let mut outcomes = job.make_together(ranks, &dealt)?;
                outcomes.extend(job.make(&of_host)?);
                outcomes
            }
        };
        clear_progress();
        if common.json { print_json(&outcomes) } else { Ok(()) }
    }

    /// Makes the items that the first process assigns to this one.
    fn make_assigned_items(&self, ranks: &dyn Ranks, common: &Common, methods: Methods) {
        let effort = self.study_size();
        let folder = Folder::opened_elsewhere(&self.out);
        while let Ok(Some(names)) = ranks.broadcast_message::<Option<ItemNames>>(None) {
            let own = names.get(ranks.rank()).into_iter().flatten();
            let own: Vec<&'static Item> =
                own.filter_map(|name| items_of(methods).find(|item| item.name == name)).collect();
            let bar = ProgressBar::hidden();
            let job = ItemJob { effort, common, folder: &folder, on_page: None, bar, before: Cell::new(0.0) };
            let made: ProcessOutcome =
                job.make(&own).map_err(|failure| (failure.exit_code(), failure.message_text()));
            if ranks.gather_messages(made).is_err() {
                return;
            }
        }
    }

    fn study_size(&self) -> StudySize {
        match (self.quick, self.all) {
            (true, _) => StudySize::Quick,
            (false, true) => StudySize::All,
            (false, false) => StudySize::Full,
        }
    }

    fn is_requested(&self, item: &Item) -> bool {
        match self.only.as_slice() {
            [] if self.quick => item.is_quick(),
            [] => self.all || item.is_default(),
            only => only.iter().any(|name| name == item.name),
        }
    }

    /// Returns false, with a message, if an item needs a program that this machine lacks.
    fn has_its_tools(item: &Item) -> bool {
        let missing = item.missing_tools();
        if let Some(why) = &missing {
            print_message(format_args!("{:<20} SKIPPED: {why}", item.name));
        }
        missing.is_none()
    }

    /// Items that remain to be made. If the same command of the same program made some of them here, but not all, it was
    /// interrupted and resumes.
    fn remaining_items(
        &self,
        common: &Common,
        folder: &Folder,
        asked: Vec<&'static Item>,
    ) -> Result<Vec<&'static Item>, CommandFailure> {
        if !self.only.is_empty() {
            return Ok(asked);
        }
        let here = Provenance::here(common.command.clone(), 0.0);
        let asked: Vec<&'static Item> = asked.into_iter().filter(|item| Self::has_its_tools(item)).collect();
        let mut made = vec![];
        for item in &asked {
            let there = folder.provenance(item.name)?;
            made.push(there.is_some_and(|there| there.has_same_origin(&here)));
        }
        let number = asked.len();
        let left = unfinished_items(asked, &made);
        if left.len() < number && !common.quiet {
            print_message(format_args!(
                "keeping {} of {number} items that this command made before; to make them again, remove {}",
                number - left.len(),
                quoted::path(&self.out)
            ));
        }
        Ok(left)
    }
}

impl ItemJob<'_> {
    /// Makes items, one after the other.
    fn make(&self, items: &[&'static Item]) -> Result<Vec<ItemOutcome>, CommandFailure> {
        items.iter().map(|item| self.make_one(item)).collect()
    }

    fn make_one(&self, item: &'static Item) -> Result<ItemOutcome, CommandFailure> {
        let (share, before) = (item.seconds(self.effort), self.before.get());
        self.bar.set_message(format!("{}, about {}", item.name, duration_text(share)));
        let (start, bar) = (Instant::now(), &self.bar);
        let progress = |part| bar.set_position(ticks(before + part * share));
        let lab = StudyEnvironment::apart(&progress);
        let made = item.make(&lab, self.effort)?;
        self.before.set(before + share);
        let seconds = start.elapsed().as_secs_f64();
        // A finished item is written, also to the page, before the next one starts or a signal ends the program.
        let provenance = Provenance::here(self.common.command.clone(), seconds);
        let (folder, section) = signals::run_protected(|| {
            let written = self.folder.write(item.name, &made, &provenance)?;
            self.on_page.as_ref().map_or(Ok(()), |items| self.folder.write_page(items)).map(|()| written)
        })?;
        let verdict = section.claim_summary();
        let folder = folder.to_string_lossy().into_owned();
        let outcome = ItemOutcome { item: item.name.to_owned(), verdict, seconds, folder };
        self.print_outcome(&outcome);
        Ok(outcome)
    }

    fn print_outcome(&self, ItemOutcome { item, verdict, seconds, folder }: &ItemOutcome) {
        if !self.common.quiet {
            print_message(format_args!(
                "{item:<20} {verdict:<18} {:>6} s  {}",
                significant(*seconds, 3),
                quoted::path(Path::new(folder))
            ));
        }
    }

    /// Makes items distributed over the processes, side by side.
    fn make_together(
        &self,
        ranks: &dyn Ranks,
        dealt: &[Vec<&'static Item>],
    ) -> Result<Vec<ItemOutcome>, CommandFailure> {
        let names: ItemNames =
            dealt.iter().map(|own| own.iter().map(|item| item.name.to_owned()).collect()).collect();
        ranks.broadcast_message(Some(Some(names))).map_err(processes::lost_rank_failure)?;
        let own = self.make(&dealt[0]);
        let all: Vec<ProcessOutcome> =
            ranks.gather_messages(Ok(vec![])).map_err(processes::lost_rank_failure)?;
        let mut outcomes = own?;
        for (rank, made) in all.into_iter().enumerate() {
            let made = made.map_err(|(code, words)| processes::rank_failure(rank, code, &words))?;
            made.iter().for_each(|outcome| self.print_outcome(outcome));
            outcomes.extend(made);
        }
        self.on_page.as_ref().map_or(Ok(()), |items| self.folder.write_page(items))?;
        Ok(outcomes)
    }
}

/// Distributes items evenly over `count` processes: the longest first, each to the process with the least work.
fn distribute<T>(mut all: Vec<T>, count: usize, seconds: impl Fn(&T) -> f64) -> Vec<Vec<T>> {
    all.sort_by(|a, b| seconds(b).total_cmp(&seconds(a)));
    let mut dealt: Vec<(f64, Vec<T>)> = (0..count).map(|_| (0.0, vec![])).collect();
    for one in all {
        let least = dealt.iter_mut().min_by(|a, b| a.0.total_cmp(&b.0));
        if let Some((sum, own)) = least {
            *sum += seconds(&one);
            own.push(one);
        }
    }
    dealt.into_iter().map(|(_, own)| own).collect()
}

/// Items left of an interrupted job; all items if none or all were made.
fn unfinished_items<T>(items: Vec<T>, made: &[bool]) -> Vec<T> {
    if made.iter().all(|made| *made) {
        return items;
    }
    items.into_iter().zip(made).filter(|(_, made)| !**made).map(|(item, _)| item).collect()
}

/// Duration for reading.
fn duration_text(seconds: f64) -> String {
    match seconds {
        ..1.5 => "a second".to_owned(),
        ..100.0 => format!("{seconds:.0} s"),
        _ => format!("{:.0} min", (seconds / 60.0).ceil()),
    }
}

/// Progress in thousandths of an expected second.
fn ticks(seconds: f64) -> u64 {
    (1000.0 * seconds) as u64
}

#[cfg(test)]
mod tests {
    use super::*;
    use stripmine_physics::method::METHODS;

    /// README promises five minutes and 2 GB for `reproduce` on two cores. Items run one after the other, so the largest memory counts.
    #[test]
    fn default_items_take_five_minutes() {
        let default: Vec<&Item> = items_of(METHODS).filter(|item| item.is_default()).collect();
        assert!(default.len() >= 19, "{} items", default.len());
        let seconds: f64 = default.iter().map(|item| item.seconds(StudySize::Full)).sum();
        assert!(seconds <= 300.0, "{seconds} s");
        for item in default {
            assert!(item.memory() <= 2000, "{}: {} MiB", item.name, item.memory());
        }
    }

    /// Stated costs match the times recorded in the committed report within a factor of 1.5 and one second.
    #[test]
    fn stated_costs_match_the_committed_report() {
        let folder = Folder::opened_elsewhere(&Path::new(env!("CARGO_MANIFEST_DIR")).join("reports"));
        for item in items_of(METHODS) {
            let Some(made) = folder.provenance(item.name).unwrap() else { continue };
            // Costs are stated for release builds and for current templates.
            if made.code.is_none() || !made.machine.compiler.contains("release") {
                continue;
            }
            let near = |stated: f64| made.seconds < 1.5 * stated + 1.0 && stated < 1.5 * made.seconds + 1.0;
            let stated = [StudySize::Full, StudySize::All].map(|effort| item.seconds(effort));
            assert!(
                stated.into_iter().any(near),
                "{}: {stated:?} s, and took {:.0} s",
                item.name,
                made.seconds
            );
        }
    }

    #[test]
    fn interrupted_jobs_resume_and_finished_jobs_restart() {
        assert_eq!(unfinished_items(vec!["a", "b", "c"], &[true, false, true]), ["b"]);
        for all in [true, false] {
            assert_eq!(unfinished_items(vec!["a", "b"], &[all; 2]), ["a", "b"]);
        }
    }

    #[test]
    fn items_are_distributed_by_duration() {
        let dealt = distribute(vec![1, 5, 2, 4, 3], 2, |seconds| f64::from(*seconds));
        assert_eq!(dealt, [vec![5, 2, 1], vec![4, 3]]);
    }

    #[test]
    fn durations_are_rounded_for_reading() {
        assert_eq!([0.1, 42.4, 99.0, 121.0].map(duration_text), ["a second", "42 s", "99 s", "3 min"]);
    }
}
