//! `stripmine run`: runs one simulation into a folder, or several with different seeds.

pub(super) mod seeds;
pub(super) mod side_by_side;

use super::display::{UnitSystem, structure_lines};
use super::processes;
use crate::console::{
    CommandFailure, Common, MOST_THREADS, STEPS, bar, clear_progress, count_up_to, print_json, print_message,
    print_text, warn,
};
use crate::provenance::built;
use crate::study::StudyCase;
use crate::study::explain::{PlanCache, tuned_settings};
use clap::Args;
use std::path::{Path, PathBuf};
use stripmine_physics::method::{
    Clock, MethodEntry, Methods, Prepared, StartPurpose, StepLimit, prepare, vocabularies,
};
use stripmine_physics::number::significant;
use stripmine_physics::quoted;
use stripmine_physics::ranks::{self, RankBackend};
use stripmine_physics::run::{
    Ending, ExistingRun, RunJob, StructureSummary, Summary, choices_of_the_run, forecast, run,
    starts_from_beginning,
};
use stripmine_physics::scene::SceneValues;
use stripmine_physics::signals;

/// Limit of `--ranks`, above the cores of any machine at hand.
pub(super) const MOST_RANKS: u16 = MOST_THREADS;
/// Limit of `--seeds`.
pub(super) const MOST_SEEDS: u64 = 100_000;

/// Runs a scene and writes its results to a folder
///
/// The folder holds observables, trajectory, summary and checkpoints.
#[derive(Args)]
pub(super) struct RunVerb {
    /// Preset name or scene file
    scene: String,
    /// Overrides a value; can be repeated
    #[arg(long = "set", value_name = "SECTION.KEY=VALUE")]
    overrides: Vec<String>,
    /// Folder for the results; default: SCENE.run
    #[arg(long)]
    out: Option<PathBuf>,
    /// Resumes the run in the folder; starts it if there is none
    #[arg(long, conflicts_with = "overwrite")]
    resume: bool,
    /// Also resumes a run of another version, without the guarantee of identical bits
    #[arg(long, requires = "resume")]
    other_version: bool,
    /// Replaces an existing run in the folder; removes only files which that run wrote
    #[arg(long)]
    overwrite: bool,
    /// Makes N runs side by side with different seeds, at most 100000, and averages them
    #[arg(long, value_name = "N", value_parser = |text: &str| count_up_to(MOST_SEEDS, text))]
    seeds: Option<u64>,
    /// Ranks that share the particles (lattice MD, Langevin), each with --threads threads; results are identical to one rank
    #[arg(long, default_value_t = 1, conflicts_with = "seeds", value_parser = clap::value_parser!(u16).range(1..=i64::from(MOST_RANKS)))]
    ranks: u16,
    /// Sets keys that are `auto` to the fastest values that `explain` measured on this host for this or a similar scene
    #[arg(long, conflicts_with = "seeds")]
    tuned: bool,
}

impl RunVerb {
    pub(super) fn run(&self, common: &Common, methods: Methods) -> Result<(), CommandFailure> {
        if let Some(count) = self.seeds {
            return self.run_seeds(count, common, methods);
        }
        let folder = self.folder("run");
        let vocabularies = vocabularies(methods);
        // A resumed run keeps its choices.
        let is_open = self.tuned && starts_from_beginning(&folder, self.existing())?;
        let given = if is_open { self.tuned_overrides(common, methods)? } else { self.overrides.clone() };
        let text = SceneValues::text(&self.scene, &vocabularies)?;
        let values = SceneValues::parse(&self.scene, &text, &given, &vocabularies)?;
        let (mut prepared, entry) = prepare(values.clone(), methods)?;
        if self.resume {
            let chosen = choices_of_the_run(&values, entry.vocabulary, &prepared.scene, &folder);
            if !chosen.is_empty() {
                let overrides = [given.as_slice(), &chosen].concat();
                let values = SceneValues::parse(&self.scene, &text, &overrides, &vocabularies)?;
                (prepared, _) = prepare(values, methods)?;
            }
        }
        let crew = self.crew(common)?;
        prepared.memory = prepared.memory.for_crew(crew);
        prepared.memory.fits(&self.scene)?;
        let RankBackend::Processes(join) = crew else {
            return self.carry_out((prepared, entry), &folder, crew, common);
        };
        let same = format!("run\n{:?}\n{}", built(), prepared.scene);
        processes::run_jointly(join, &same, |is_first| match is_first {
            true => self.carry_out((prepared, entry), &folder, crew, common),
            false => {
                processes::serve(crew, || prepared.start(StartPurpose::Run).map(drop));
                Ok(())
            }
        })
    }

    /// Crew that executes the run.
    fn crew(&self, common: &Common) -> Result<RankBackend, CommandFailure> {
        match (common.crew, self.ranks) {
            (RankBackend::Processes(_), 2..) => Err(processes::duplicate_ranks_failure()),
            (crew @ RankBackend::Processes(_), _) => Ok(crew),
            (_, ranks) => {
                check_total_threads(ranks, rayon::current_num_threads())?;
                Ok(RankBackend::Threads(ranks.into()))
            }
        }
    }

    /// Executes the run and prints its summary.
    fn carry_out(
        &self,
        (prepared, entry): (Prepared, &'static MethodEntry),
        folder: &Path,
        crew: RankBackend,
        common: &Common,
    ) -> Result<(), CommandFailure> {
        let existing = self.existing();
        let begins = starts_from_beginning(folder, existing)?;
        if !common.quiet {
            print_expectations(&prepared, begins);
        }
        let bar = bar(common, 0, STEPS);
        let progress = |done, all| {
            bar.set_length(all);
            bar.set_position(done);
        };
        let notice = |note: &str| {
            if !common.quiet {
                warn(note);
            }
        };
        let scene = prepared.scene.clone();
        let quantities = prepared.quantities(entry);
        let job = RunJob { prepared: prepared.into(), quantities, program: &built(), is_open_ended: false };
        let work = || run(job, folder, existing, signals::interruption_flag(), progress, notice);
        let ending = ranks::with_backend(crew, work);
        clear_progress();
        match ending? {
            Ending::Done(summary) if common.json => print_json(&summary),
            Ending::Done(summary) => {
                if !common.quiet {
                    // Doubts about the structure are among the lines of the summary.
                    let doubts: Vec<&str> =
                        summary.structure.iter().filter_map(|it| it.doubt.as_deref()).collect();
                    let is_new = |warning: &&String| !doubts.iter().any(|doubt| warning.contains(doubt));
                    summary.warnings.iter().filter(is_new).for_each(warn);
                }
                print_text(&summary_text(&summary, folder, &scene))
            }
            Ending::Interrupted { clock } => {
                Err(CommandFailure::Interrupted { moment: clock.to_string(), folder: folder.to_owned() })
            }
        }
    }
}

/// Rejects ranks with more than the largest number of threads in total.
///
/// # Errors
/// [`CommandFailure::ManyThreads`]
pub(super) fn check_total_threads(ranks: u16, threads: usize) -> Result<(), CommandFailure> {
    match usize::from(ranks) * threads > MOST_THREADS.into() {
        true if ranks > 1 => Err(CommandFailure::ManyThreads { ranks, threads }),
        _ => Ok(()),
    }
}

impl RunVerb {
    /// Overrides, with the values that cached measurements choose for `auto`.
    fn tuned_overrides(&self, common: &Common, methods: Methods) -> Result<Vec<String>, CommandFailure> {
        let case = StudyCase::load(&self.scene, &self.overrides, methods)?;
        let found = tuned_settings(&case, &PlanCache::here());
        if !common.quiet {
            match &found {
                Err(error) => warn(format_args!("--tuned changes nothing: {error}")),
                Ok(found) => match found {
                    Some(found) => print_message(format_args!(
                        "tuned: {}: {}",
                        found.overrides.texts().join(", "),
                        found.origin
                    )),
                    None => print_message(format_args!(
                        "tuned: nothing to change: no key is `auto`, or no similar scene was measured (stripmine explain {} measures)",
                        self.scene
                    )),
                },
            }
        }
        let chosen = found.ok().flatten().map_or(vec![], |found| found.overrides.texts());
        Ok([&self.overrides[..], &chosen].concat())
    }

    /// Folder of `--out`, or one named after the scene.
    fn folder(&self, ending: &str) -> PathBuf {
        self.out.clone().unwrap_or_else(|| {
            let stem = Path::new(&self.scene).file_stem().unwrap_or_default();
            PathBuf::from(format!("{}.{ending}", stem.to_string_lossy()))
        })
    }

    /// Treatment of an existing run in the folder.
    fn existing(&self) -> ExistingRun {
        match (self.resume, self.overwrite) {
            (true, _) => ExistingRun::Resume { other_version: self.other_version },
            (_, true) => ExistingRun::Overwrite,
            _ => ExistingRun::Refuse,
        }
    }
}

/// Prints what to expect of the run; the time and the start only if it is not resumed.
fn print_expectations(prepared: &Prepared, begins: bool) {
    let of_the_time = begins.then(|| forecast::time_forecast(prepared)).flatten();
    let of_this_host = of_the_time.into_iter().chain([forecast::memory_forecast(prepared)]);
    forecast::above_limits(prepared).iter().for_each(warn);
    let of_the_start = forecast::start_forecast(prepared).filter(|_| begins);
    let facts = of_the_start.into_iter().chain(forecast::step_forecast(prepared)).chain(of_this_host);
    let limits = &prepared.step_limits;
    let is_shown = |name: &str| is_lowest(limits, name) || limits.iter().all(|limit| limit.name != name);
    for (label, words) in facts.filter_map(|fact| fact.words).filter(|(label, _)| is_shown(label)) {
        print_message(format_args!("expected: {label}: {words}"));
    }
}

/// Returns true for the lowest limit of the step among those with the same consequence.
fn is_lowest(limits: &[StepLimit], name: &str) -> bool {
    let is_higher =
        |one: &StepLimit| limits.iter().any(|other| other.beyond == one.beyond && other.share > one.share);
    limits.iter().any(|limit| limit.name == name && !is_higher(limit))
}

fn summary_text(summary: &Summary, folder: &Path, scene: &str) -> String {
    let &Summary { steps, events, time, seconds, from, .. } = summary;
    let done = Clock { steps, time, events }.done();
    let session = if from == Clock::default() { String::new() } else { format!(" (resumed at {from})") };
    let units = UnitSystem::of(scene.parse().ok().as_ref());
    let unit = if matches!(units, UnitSystem::Si) { " s" } else { "" };
    let [time, seconds] = [significant(time, 9), significant(seconds, 3)];
    let mut text = format!(
        "{done}, time {time}{unit}, in {seconds} s of wall time{session}\nat the end: {}\n",
        summary.in_words
    );
    text.push_str(&units.averages(&summary.averages).to_string());
    let functions = summary.structure.iter();
    let functions = functions.map(|StructureSummary { name, headlines, doubt, .. }| {
        (*name, headlines.as_slice(), doubt.as_deref())
    });
    text.push_str(&structure_lines(functions, &units));
    for choice in &summary.choices {
        text.push_str(&format!("chosen: {choice}\n"));
    }
    for reason in &summary.left_out {
        text.push_str(&format!("left out: {reason}\n"));
    }
    text.push_str(&format!("results: {}\n", quoted::path(folder)));
    text
}

#[cfg(test)]
mod tests {
    use super::*;
    use stripmine_physics::method::{METHODS, load};

    #[test]
    fn one_limit_is_shown_for_each_consequence() {
        let (prepared, _) = load("two-discs", &[], METHODS).unwrap();
        let limits = &prepared.step_limits;
        let lowest: Vec<&StepLimit> = limits.iter().filter(|it| is_lowest(limits, it.name)).collect();
        assert!(lowest.len() == 3 && limits.len() > 3);
        for limit in limits {
            assert!(lowest.iter().any(|it| it.beyond == limit.beyond && it.share >= limit.share));
        }
    }
}
