//! `run --seeds`: runs one scene with several seeds side by side, and averages over the runs.

use super::RunVerb;
use crate::cli::display::UnitSystem;
use crate::cli::processes;
use crate::console::{
    CommandFailure, Common, SHARES, bar, clear_progress, print, print_json, print_message, to_json, warn,
};
use crate::provenance::built;
use rayon::{ThreadPool, ThreadPoolBuilder};
use serde::Serialize;
use std::collections::BTreeSet;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::sync::Mutex;
use std::sync::PoisonError;
use std::sync::atomic::{AtomicU64, AtomicUsize, Ordering};
use std::thread;
use std::time::Instant;
use stripmine_physics::averages::{RunAverages, joined};
use stripmine_physics::io::owned_folder::{FolderContent, FolderKind, LOCK, OwnedFolder};
use stripmine_physics::method::{MethodEntry, Methods, Prepared, prepare, vocabularies};
use stripmine_physics::number::significant;
use stripmine_physics::quoted;
use stripmine_physics::ranks::RankBackend;
use stripmine_physics::run::{
    Ending, FinishedRun, RunJob, StructureFunction, Summary, averages_of, functions_of, run,
    starts_from_beginning,
};
use stripmine_physics::scene::{Fallback, Key, KeyValue, MistakeKind, SceneValues, Vocabulary};
use stripmine_physics::signals;
use stripmine_physics::structure::{OBSERVABLES, observable};

/// File name of the joint summary.
const SUMMARY: &str = "seeds.json";
/// Kind of the folder that holds the runs and their joint summary.
const SEEDS: FolderKind = FolderKind {
    lock: LOCK,
    list: "seeds.files",
    holds: FolderContent::Files {
        heading: "stripmine seeds.files 1",
        is_own: |name| name == SUMMARY || OBSERVABLES.iter().any(|it| it.file == name),
        is_shared: true,
    },
};
/// Ticks of the progress bar per run.
const PARTS: u64 = 1000;

/// Joint result of runs with different seeds.
#[derive(Serialize)]
struct SeedEnsemble {
    /// Mean of each quantity over all runs.
    averages: RunAverages,
    /// Wall time of all runs together (s).
    seconds: f64,
    runs: Vec<SeedRun>,
    /// Structure functions over all runs, each stored in its own file beside this one.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    structure: Vec<StructureFunction>,
}

/// Folder of a run, and its seeds as overrides.
type SeededRun = (PathBuf, Vec<String>);
/// Prepares the scene with seeds.
type WithSeeds<'s> =
    &'s (dyn Fn(&[String]) -> Result<(Prepared, &'static MethodEntry), CommandFailure> + Sync);

/// One of several runs with different seeds.
#[derive(Serialize)]
struct SeedRun {
    folder: PathBuf,
    seeds: Vec<String>,
    averages: RunAverages,
}

/// Seed keys of a scene, each with its first value: seeds of the start, and of the noise if it is given or is the only
/// random input.
fn seed_keys(values: &SceneValues, vocabulary: &Vocabulary) -> Vec<(&'static Key, u64)> {
    let is_seed = |key: &&'static Key| key.name == "seed" || key.name.ends_with("_seed");
    let seed = |key: &&'static Key| match values.value(key) {
        Some(KeyValue::Whole(seed)) => Some((*key, seed)),
        _ => None,
    };
    let used: Vec<&'static Key> = vocabulary
        .keys
        .keys()
        .filter(is_seed)
        .filter(|key| values.is_used(key) && !values.is_idle(key))
        .collect();
    let found: Vec<(&'static Key, u64)> = used.iter().filter_map(seed).collect();
    if !found.is_empty() {
        return found;
    }
    used.into_iter()
        .filter(|key| matches!(key.fallback, Fallback::Otherwise(_)))
        .map(|key| (key, 1))
        .collect()
}

impl RunVerb {
    /// Runs the scene with `count` seeds, beginning with the scene's own.
    pub(super) fn run_seeds(
        &self,
        count: u64,
        common: &Common,
        methods: Methods,
    ) -> Result<(), CommandFailure> {
        let folder = self.folder("seeds");
        // The scene and its start file are read once, so that later changes of the files cannot mix scenes.
        let text = SceneValues::text(&self.scene, &vocabularies(methods))?;
        let values = self.values(&text, &[], methods)?.sharing_start();
        let method = methods.iter().find(|method| method.vocabulary.keys.method == values.method());
        let keys = method.map_or(vec![], |method| seed_keys(&values, method.vocabulary));
        if keys.is_empty() {
            let error = values.spot(&stripmine_physics::scene::METHOD);
            let message = "this scene has no random numbers: every seed gives the same run";
            return Err(CommandFailure::Options(error.error(MistakeKind::Unused, message).into()));
        }
        let members: Vec<SeededRun> = (0..count)
            .map(|number| {
                let seeds =
                    keys.iter().map(|(key, first)| format!("{}={}", key.path(), first.wrapping_add(number)));
                (folder.join(format!("seed-{}", keys[0].1.wrapping_add(number))), seeds.collect())
            })
            .collect();
        let with_seeds = |seeds: &[String]| -> Result<_, CommandFailure> {
            Ok(prepare(self.values(&text, seeds, methods)?.with_start_of(&values), methods)?)
        };
        // Mistakes of the scene are reported once, before anything is written.
        let (prepared, _) = with_seeds(&members[0].1)?;
        prepared.memory.fits(&self.scene)?;
        let begun = Instant::now();
        let asked = &prepared.output.structure;
        let files = asked.iter().filter_map(|name| observable(name)).map(|it| it.file);
        let files: Vec<&str> = std::iter::once(SUMMARY).chain(files).collect();
        let claimed = || -> Result<OwnedFolder, CommandFailure> {
            let mut own = OwnedFolder::open(&folder, SEEDS, &[])?;
            own.claim(files.iter().copied(), self.overwrite)?;
            // A summary of earlier runs would be wrong if these are interrupted.
            own.remove_own(SUMMARY)?;
            Ok(own)
        };
        // If a run is refused, nothing is changed.
        if processes::rank(common.crew) == 0 {
            members
                .iter()
                .try_for_each(|(folder, _)| starts_from_beginning(folder, self.existing()).map(drop))?;
        }
        let side_by_side = |some: &[SeededRun]| self.side_by_side(some, &prepared, common, &with_seeds);
        let (own, averages) = if let RankBackend::Processes(join) = common.crew {
            let same = format!("{count} seeds\n{:?}\n{}", built(), prepared.scene);
            let mut own = None;
            processes::run_independently(join, &same, |rank, ranks| {
                if rank == 0 {
                    own = Some(claimed()?);
                }
                let some: Vec<_> = members.iter().skip(rank).step_by(ranks).cloned().collect();
                side_by_side(&some).map(drop)
            })?;
            // Only the first rank has claimed the folder; it writes the summary.
            let Some(own) = own else { return Ok(()) };
            let read = |(folder, _): &SeededRun| averages_of(&[FinishedRun::read(folder, methods)?]);
            (own, members.iter().map(read).collect::<Result<_, _>>()?)
        } else {
            let own = claimed()?;
            let found = side_by_side(&members);
            clear_progress();
            (own, found?.into_iter().map(|summary| summary.averages).collect::<Vec<RunAverages>>())
        };
        let members = members.into_iter().zip(averages);
        let runs: Vec<SeedRun> =
            members.map(|((folder, seeds), averages)| SeedRun { folder, seeds, averages }).collect();
        let all: Vec<RunAverages> = runs.iter().map(|run| run.averages.clone()).collect();
        let structure = functions_of(runs.iter().map(|run| run.folder.as_path()))?;
        let structure: Vec<StructureFunction> =
            structure.into_iter().filter(|it| files.contains(&it.file)).collect();
        let seconds = begun.elapsed().as_secs_f64();
        let ensemble = SeedEnsemble { averages: joined(&all), seconds, runs, structure };
        for function in &ensemble.structure {
            own.write(function.file, |out| out.write_all(function.csv().as_bytes()))?;
        }
        let summary = to_json(&ensemble)?;
        own.write(SUMMARY, |out| out.write_all(summary.as_bytes()))?;
        if common.json {
            return print_json(&ensemble);
        }
        let SeedEnsemble { averages, seconds, structure, .. } = &ensemble;
        let averages = UnitSystem::of(prepared.scene.parse().ok().as_ref()).averages(averages);
        let doubt = |it: &StructureFunction| Some(format!("{}: {}\n", it.name, it.doubt.as_ref()?));
        let doubts: String = structure.iter().filter_map(doubt).collect();
        print(&format!(
            "{count} runs with different seeds, in {} s\n{averages}{doubts}results: {}\n",
            significant(*seconds, 3),
            quoted::path(&folder)
        ))
    }

    /// Values of the scene with seeds.
    fn values(&self, text: &str, seeds: &[String], methods: Methods) -> Result<SceneValues, CommandFailure> {
        let overrides = [self.overrides.as_slice(), seeds].concat();
        Ok(SceneValues::parse(&self.scene, text, &overrides, &vocabularies(methods))?)
    }

    /// Makes all runs, as many at a time as threads and memory allow; returns the first failure once all have ended.
    fn side_by_side(
        &self,
        members: &[SeededRun],
        prepared: &Prepared,
        common: &Common,
        with_seeds: WithSeeds<'_>,
    ) -> Result<Vec<Summary>, CommandFailure> {
        let threads = rayon::current_num_threads();
        let memory = &prepared.memory;
        let fit = memory.available.map_or(threads, |left| (left.bytes / memory.needed.max(1)) as usize);
        let workers = threads.min(members.len()).min(fit).max(1);
        let (next, done) = (AtomicUsize::new(0), AtomicU64::new(0));
        let bar = bar(common, PARTS * members.len() as u64, SHARES);
        bar.set_message(format!("{} runs", members.len()));
        let outcomes: Mutex<Vec<Option<Result<Summary, CommandFailure>>>> =
            Mutex::new(members.iter().map(|_| None).collect());
        let notices: Mutex<BTreeSet<String>> = Mutex::default();
        let work = &|pool: &ThreadPool| {
            while let Some((number, (folder, seeds))) =
                Some(next.fetch_add(1, Ordering::Relaxed)).and_then(|at| Some((at, members.get(at)?)))
            {
                let mut before = 0;
                let progress = |part: u64, all: u64| {
                    let part = (PARTS as f64 * part as f64 / all.max(1) as f64) as u64;
                    bar.set_position(done.fetch_add(part - before, Ordering::Relaxed) + part - before);
                    before = part;
                };
                let notice = |note: &str| {
                    let mut all = notices.lock().unwrap_or_else(PoisonError::into_inner);
                    if all.insert(note.to_owned()) && !common.quiet {
                        print_message(format_args!("{}: {note}", quoted::path(folder)));
                    }
                };
                let outcome = pool.install(|| self.run_one_seed(folder, with_seeds(seeds), progress, notice));
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
        let outcomes = outcomes.into_inner().unwrap_or_else(PoisonError::into_inner);
        outcomes.into_iter().flatten().collect()
    }

    fn run_one_seed(
        &self,
        folder: &Path,
        scene: Result<(Prepared, &'static MethodEntry), CommandFailure>,
        progress: impl FnMut(u64, u64) + Send,
        notice: impl FnMut(&str) + Send,
    ) -> Result<Summary, CommandFailure> {
        let (prepared, entry) = scene?;
        let job = RunJob { prepared: prepared.into(), quantities: entry.quantities, program: &built() };
        match run(job, folder, self.existing(), signals::interruption_flag(), progress, notice)? {
            Ending::Done(summary) => {
                for warning in &summary.warnings {
                    warn(format_args!("{}: {warning}", quoted::path(folder)));
                }
                Ok(*summary)
            }
            Ending::Interrupted { clock } => {
                let folder = folder.parent().unwrap_or(folder).to_owned();
                Err(CommandFailure::Interrupted { moment: clock.to_string(), folder })
            }
        }
    }
}
