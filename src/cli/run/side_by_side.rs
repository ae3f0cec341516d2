//! Several runs side by side, as many at a time as threads and memory allow.

use crate::console::{CommandFailure, Common, SHARES, bar, clear_progress, print_message, warn};
use crate::provenance::built;
use rayon::{ThreadPool, ThreadPoolBuilder};
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU64, AtomicUsize, Ordering};
use std::sync::{Mutex, PoisonError};
use std::thread;
use stripmine_physics::memory::MemoryForecast;
use stripmine_physics::method::{MethodEntry, Prepared};
use stripmine_physics::quoted;
use stripmine_physics::run::{Ending, ExistingRun, RunError, RunJob, Summary, run};
use stripmine_physics::signals;

/// Ticks of the progress bar per run.
const PARTS: u64 = 1000;

/// Folder of a run, and the overrides of its scene.
#[derive(Clone, Debug)]
pub(in crate::cli) struct PlannedRun {
    pub(in crate::cli) folder: PathBuf,
    pub(in crate::cli) overrides: Vec<String>,
}

/// Run that did not complete.
#[derive(Debug)]
pub(in crate::cli) struct FailedRun {
    pub(in crate::cli) failure: CommandFailure,
    /// True if the run has ended, but not with the error of a mean that should end it.
    pub(in crate::cli) has_means: bool,
}

impl From<CommandFailure> for FailedRun {
    fn from(failure: CommandFailure) -> FailedRun {
        FailedRun { failure, has_means: false }
    }
}

/// Prepares a scene with overrides.
pub(in crate::cli) type PrepareScene<'s> =
    &'s (dyn Fn(&[String]) -> Result<(Prepared, &'static MethodEntry), CommandFailure> + Sync);

/// Runs that share the threads of the program.
pub(in crate::cli) struct SideBySide<'s> {
    pub(in crate::cli) existing: ExistingRun,
    /// Memory of the largest run.
    pub(in crate::cli) memory: &'s MemoryForecast,
    pub(in crate::cli) common: &'s Common,
    pub(in crate::cli) prepare: PrepareScene<'s>,
    /// Folder that holds all runs, for the message of an interruption.
    pub(in crate::cli) folder: &'s Path,
}

impl SideBySide<'_> {
    /// Makes all runs, and returns the outcome of each once all have ended. After an interruption no run begins.
    ///
    /// # Errors
    /// If threads cannot be started.
    pub(in crate::cli) fn carry_out(
        &self,
        members: &[PlannedRun],
    ) -> Result<Vec<Result<Summary, FailedRun>>, CommandFailure> {
        let threads = rayon::current_num_threads();
        let memory = self.memory;
        let fit = memory.available.map_or(threads, |left| (left.bytes / memory.needed.max(1)) as usize);
        let workers = threads.min(members.len()).min(fit).max(1);
        let (next, done) = (AtomicUsize::new(0), AtomicU64::new(0));
        let bar = bar(self.common, PARTS * members.len() as u64, SHARES);
        bar.set_message(format!("{} runs", members.len()));
        let outcomes: Mutex<Vec<Option<Result<Summary, FailedRun>>>> =
            Mutex::new(members.iter().map(|_| None).collect());
        let notices: Mutex<BTreeSet<String>> = Mutex::default();
        let is_interrupted = || signals::interruption_flag().load(Ordering::Relaxed);
        let work = &|pool: &ThreadPool| {
            while let Some((number, member)) =
                Some(next.fetch_add(1, Ordering::Relaxed)).and_then(|at| Some((at, members.get(at)?)))
                && !is_interrupted()
            {
                let mut before = 0;
                let progress = |part: u64, all: u64| {
                    let part = (PARTS as f64 * part as f64 / all.max(1) as f64) as u64;
                    bar.set_position(done.fetch_add(part - before, Ordering::Relaxed) + part - before);
                    before = part;
                };
                let notice = |note: &str| {
                    let mut all = notices.lock().unwrap_or_else(PoisonError::into_inner);
                    if all.insert(note.to_owned()) && !self.common.quiet {
                        print_message(format_args!("{}: {note}", quoted::path(&member.folder)));
                    }
                };
                let outcome = pool.install(|| self.run_one(member, progress, notice));
                outcomes.lock().unwrap_or_else(PoisonError::into_inner)[number] = Some(outcome);
            }
        };
        let pools: Result<Vec<ThreadPool>, _> =
            (0..workers).map(|_| ThreadPoolBuilder::new().num_threads(threads / workers).build()).collect();
        let pools = pools.map_err(CommandFailure::Threads)?;
        thread::scope(|scope| {
            let spawn = |pool| thread::Builder::new().spawn_scoped(scope, move || work(pool)).map(drop);
            pools.iter().try_for_each(spawn)
        })
        .map_err(CommandFailure::writing("the threads of the runs"))?;
        clear_progress();
        let outcomes = outcomes.into_inner().unwrap_or_else(PoisonError::into_inner);
        let not_begun = || Err(self.interrupted("the start of a run".to_owned()).into());
        Ok(outcomes.into_iter().map(|outcome| outcome.unwrap_or_else(not_begun)).collect())
    }

    fn interrupted(&self, moment: String) -> CommandFailure {
        CommandFailure::Interrupted { moment, folder: self.folder.to_owned() }
    }

    fn run_one(
        &self,
        PlannedRun { folder, overrides }: &PlannedRun,
        progress: impl FnMut(u64, u64) + Send,
        notice: impl FnMut(&str) + Send,
    ) -> Result<Summary, FailedRun> {
        let (prepared, entry) = (self.prepare)(overrides)?;
        let quantities = prepared.quantities(entry);
        let job = RunJob { prepared: prepared.into(), quantities, program: &built(), is_open_ended: false };
        match run(job, folder, self.existing, signals::interruption_flag(), progress, notice) {
            Ok(Ending::Done(summary)) => {
                for warning in &summary.warnings {
                    warn(format_args!("{}: {warning}", quoted::path(folder)));
                }
                Ok(*summary)
            }
            Ok(Ending::Interrupted { clock }) => Err(self.interrupted(clock.to_string()).into()),
            Err(error) => {
                let has_means = matches!(error, RunError::Unreached { .. });
                Err(FailedRun { failure: error.into(), has_means })
            }
        }
    }
}
