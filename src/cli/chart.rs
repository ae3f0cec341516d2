//! `stripmine chart`: studies written as data and charts. Methods add their own studies.

use super::explain::{parse_target_error, plan_failure};
use super::processes;
use crate::console::{
    CommandFailure, Common, clear_progress, print_json, print_message, print_prose, progress, warn,
};
use crate::model::machines;
use crate::provenance::{Provenance, built};
use crate::results::FinishedItem;
use crate::results::Progress;
use crate::results::{Folder, Journal, ProcessTeam};
use crate::study::explain::{PlanTarget, accuracy};
use crate::study::stability::{self, VariedRange, stability};
use crate::study::trial::{Stopwatch, TrialControl};
use crate::study::work_precision::{self, work_precision};
use crate::study::{StudyCase, Subject};
use clap::{Args, Subcommand};
use std::path::{Path, PathBuf};
use std::time::Instant;
use stripmine_physics::method::Methods;
use stripmine_physics::number::count_with_noun;
use stripmine_physics::quoted;
use stripmine_physics::ranks::RankBackend;
use stripmine_physics::scene::Width;
use stripmine_physics::signals;

/// Allowed budgets (processor seconds).
const BUDGET: std::ops::RangeInclusive<i64> = 1..=86_400;
/// Allowed numbers of timed runs.
const REPEATS: std::ops::RangeInclusive<i64> = 1..=100;
/// Allowed numbers of values, and of steps, of a map.
const SIZE: std::ops::RangeInclusive<i64> = 3..=200;
/// Allowed numbers of seeds per edge of a map.
const SEEDS: std::ops::RangeInclusive<i64> = 1..=100;
/// Phases of the step at which a collision starts.
const PHASES: u32 = 16;

/// Studies a scene and writes data and charts
#[derive(Args)]
#[command(
    subcommand_value_name = "WHAT",
    subcommand_help_heading = "Studies",
    disable_help_subcommand = true
)]
pub(super) struct ChartVerb {
    #[command(subcommand)]
    what: Study,
}

#[derive(Subcommand)]
enum Study {
    Accuracy(AccuracyVerb),
    WorkPrecision(WorkPrecisionVerb),
    Stability(StabilityVerb),
}

/// Charts the error of positions and energy over the cost, for every configuration and step
///
/// Marks the cheapest configuration for each error. Needs a method whose trajectories can be compared; for others the error of a mean is charted.
#[derive(Args)]
struct WorkPrecisionVerb {
    /// Preset name or scene file
    scene: String,
    /// Overrides a value; can be repeated
    #[arg(long = "set", value_name = "SECTION.KEY=VALUE")]
    overrides: Vec<String>,
    /// Also charts clock periods on this machine, where operations are counted: a preset of `table`, or a machine file
    #[arg(long)]
    machine: Option<String>,
    /// Approximate limit in processor seconds; runs that do not fit are skipped and named
    #[arg(long, default_value_t = 150, value_parser = clap::value_parser!(u32).range(BUDGET))]
    budget: u32,
    /// Timed runs per configuration and step
    #[arg(long, default_value_t = 3, value_parser = clap::value_parser!(u16).range(REPEATS))]
    repeats: u16,
    /// Charts the error of the mean of a quantity instead, as `chart accuracy` does
    #[arg(long = "of", value_name = "QUANTITY", conflicts_with_all = ["machine", "repeats"])]
    quantity: Option<String>,
    /// Folder for data, tables and figures; default: SCENE.work-precision, or SCENE.accuracy for the error of a mean. An interrupted study resumes there
    #[arg(long)]
    out: Option<PathBuf>,
}

/// Charts the error of a mean over the wall time of a run, for each integrator and step
///
/// The error is the bias plus the statistical error. The scene as it is and the plan are marked.
#[derive(Args)]
struct AccuracyVerb {
    /// Preset name or scene file
    scene: String,
    /// Overrides a value; can be repeated
    #[arg(long = "set", value_name = "SECTION.KEY=VALUE")]
    overrides: Vec<String>,
    /// Quantity to average; default: the first of the method
    #[arg(long = "of", value_name = "QUANTITY")]
    quantity: Option<String>,
    /// Marks the plan for this target error, such as 1% or 0.02
    #[arg(long, value_parser = parse_target_error)]
    error: Option<Width>,
    /// Averages each run between two times instead of over its steady state
    #[arg(long, num_args = 2, value_names = ["FROM", "TO"])]
    window: Option<Vec<f64>>,
    /// Approximate processor seconds of trial runs
    #[arg(long, default_value_t = 60, value_parser = clap::value_parser!(u32).range(BUDGET))]
    budget: u32,
    /// Folder for data, tables and figures; default: SCENE.accuracy
    #[arg(long)]
    out: Option<PathBuf>,
}

/// Maps where a scene is stable, over the step and a second parameter
///
/// Scenes of hard-disks have no time step and no such map. Edges are found by bisection and compared with theory; failures are classified.
#[derive(Args)]
struct StabilityVerb {
    /// Preset name or scene file
    scene: String,
    /// Overrides a value; can be repeated
    #[arg(long = "set", value_name = "SECTION.KEY=VALUE")]
    overrides: Vec<String>,
    /// Second parameter: stiffness, damping, density or speed (lattice-md); strength, temperature or friction (langevin); eccentricity or softening (nbody);
    /// an unknown name lists all. Default: the first that the scene sets
    #[arg(long, value_name = "NAME")]
    over: Option<String>,
    /// Range of the second parameter; default: a range around the scene's value
    #[arg(long, num_args = 2, value_names = ["LOW", "HIGH"])]
    range: Option<Vec<f64>>,
    /// Most values, and most steps, of the map
    #[arg(long, default_value_t = 24, value_parser = clap::value_parser!(u16).range(SIZE))]
    size: u16,
    /// Most seeds per edge
    #[arg(long, default_value_t = 3, value_parser = clap::value_parser!(u16).range(SEEDS))]
    seeds: u16,
    /// Relative tolerance of the step at an edge
    #[arg(long, default_value_t = 0.05, value_parser = edge_tolerance)]
    tolerance: f64,
    /// Limit in processor seconds; if it is short, the map has fewer seeds, values and steps, and shorter runs
    #[arg(long, default_value_t = 300, value_parser = clap::value_parser!(u32).range(BUDGET))]
    budget: u32,
    /// Folder for data, tables and figures; default: SCENE.stability. An interrupted study resumes there
    #[arg(long)]
    out: Option<PathBuf>,
}

/// Parses the relative tolerance of an edge.
fn edge_tolerance(text: &str) -> Result<f64, String> {
    let is_one = |part: &f64| (1e-6..=1.0).contains(part);
    text.parse()
        .ok()
        .filter(is_one)
        .ok_or_else(|| "expected a fraction of the step from 1e-6 to 1".to_owned())
}

impl ChartVerb {
    pub(super) fn run(&self, common: &Common, methods: Methods) -> Result<(), CommandFailure> {
        match &self.what {
            Study::Accuracy(verb) => verb.run(common, methods),
            Study::WorkPrecision(verb) => verb.run(common, methods),
            Study::Stability(verb) => verb.run(common, methods),
        }
    }
}

impl WorkPrecisionVerb {
    fn run(&self, common: &Common, methods: Methods) -> Result<(), CommandFailure> {
        let case = StudyCase::load(&self.scene, &self.overrides, methods)?;
        if self.quantity.is_some() || case.entry.trials.is_none_or(|trials| !trials.has_trajectories) {
            return AccuracyVerb {
                scene: self.scene.clone(),
                overrides: self.overrides.clone(),
                quantity: self.quantity.clone(),
                error: None,
                window: None,
                budget: self.budget,
                out: self.out.clone(),
            }
            .run(common, methods);
        }
        let machine = self.machine.as_deref().map(machines::find).transpose()?;
        let subject = Subject::load(&self.scene, &self.overrides, methods)?;
        let named = machine.as_ref().map_or("", |machine| machine.title());
        let options = format!("budget {} repeats {} machine {named}", self.budget, self.repeats);
        let (budget, repeats) = (f64::from(self.budget), self.repeats.into());
        let effort = work_precision::DiagramEffort { budget, repeats, phases: PHASES, machine };
        let place = StudyDestination { name: "work-precision", scene: &self.scene, out: self.out.as_deref() };
        place.run_study((common, common.crew), &subject, &options, |trial, journal, progress, stem| {
            let data = work_precision(&subject, &effort, trial, journal, progress)?;
            Ok(work_precision::made(&[(stem, data)]))
        })
    }
}

impl AccuracyVerb {
    fn run(&self, common: &Common, methods: Methods) -> Result<(), CommandFailure> {
        // The choice of the next trial depends on measured times, so the first process makes all trials.
        if processes::rank(common.crew) > 0 {
            return Ok(());
        }
        let case = StudyCase::load(&self.scene, &self.overrides, methods)?;
        let target = PlanTarget::of(&case, self.quantity.as_deref(), self.error);
        let target = target.and_then(|target| target.over(self.window.as_deref())).map_err(plan_failure)?;
        let place = StudyDestination { name: accuracy::NAME, scene: &self.scene, out: self.out.as_deref() };
        let options =
            format!("{} {:?} {:?} budget {}", target.quantity.name, self.error, target.window, self.budget);
        place.run_study((common, RankBackend::One), &case, &options, |_, journal, progress, stem| {
            let seconds = f64::from(self.budget) / rayon::current_num_threads() as f64;
            let trial = TrialControl { watch: &Stopwatch::wall(), stop: signals::interruption_flag() };
            let tell = |share: f64| progress(share);
            let shown: (&str, &dyn Fn(f64), &Journal) = (&stem, &tell, journal);
            accuracy::accuracy(&case, &target, seconds, trial, shown).map_err(plan_failure)
        })
    }
}

impl StabilityVerb {
    fn run(&self, common: &Common, methods: Methods) -> Result<(), CommandFailure> {
        let subject = Subject::load(&self.scene, &self.overrides, methods)?;
        let range = self.range.as_ref().map(|ends| [ends[0], ends[1]]);
        let over = VariedRange::of(&subject, self.over.as_deref(), range)?;
        let effort = stability::MapEffort {
            budget: f64::from(self.budget),
            size: self.size.into(),
            seeds: self.seeds.into(),
            tolerance: self.tolerance,
        };
        let again = range.map_or(String::new(), |[low, high]| format!(" --range {low} {high}"));
        let options = format!(
            "--over {}{again} --size {} --seeds {} --tolerance {} --budget {}",
            over.name(),
            self.size,
            self.seeds,
            self.tolerance,
            self.budget
        );
        let place = StudyDestination { name: "stability", scene: &self.scene, out: self.out.as_deref() };
        place.run_study((common, common.crew), &subject, &options, |trial, journal, progress, stem| {
            let data = stability(&subject, over, &effort, trial, journal, progress)?;
            Ok(stability::made(&[(stem, data)]))
        })
    }
}

/// Writes the result of a study and prints it.
fn write_results(
    common: &Common,
    folder: &Folder,
    name: &str,
    made: &FinishedItem,
    begun: Instant,
) -> Result<(), CommandFailure> {
    let provenance = Provenance::here(common.command.clone(), begun.elapsed().as_secs_f64());
    let (path, section) = signals::run_protected(|| {
        let written = folder.write(name, made, &provenance)?;
        folder.write_page(&[name]).map(|()| written)
    })?;
    clear_progress();
    if !common.quiet {
        print_message(format_args!("written: {}", quoted::path(&path)));
    }
    if common.json {
        return print_json(&made.json());
    }
    print_prose(&section.paragraphs().collect::<Vec<_>>().join("\n\n"))
}

/// Destination of the results of a study.
struct StudyDestination<'p> {
    /// Name of the study.
    name: &'static str,
    /// The scene as named on the command line.
    scene: &'p str,
    /// The folder of `--out`.
    out: Option<&'p Path>,
}

impl StudyDestination<'_> {
    fn out(&self, stem: &str) -> PathBuf {
        self.out.map_or_else(|| PathBuf::from(format!("{stem}.{}", self.name)), Path::to_owned)
    }

    /// Opens the folder, before any work is done; returns it with the scene's stem.
    fn folder(&self) -> Result<(Folder, String), CommandFailure> {
        let stem = self.stem();
        Ok((Folder::open(&self.out(&stem), &[self.name], true)?, stem))
    }

    fn stem(&self) -> String {
        Path::new(self.scene).file_stem().unwrap_or_default().to_string_lossy().into_owned()
    }

    /// Runs a study, resuming from the finished runs in its folder.
    fn run_study(
        &self,
        (common, crew): (&Common, RankBackend),
        case: &StudyCase,
        options: &str,
        make: impl FnOnce(
            TrialControl<'_>,
            &Journal,
            Progress<'_>,
            String,
        ) -> Result<FinishedItem, CommandFailure>,
    ) -> Result<(), CommandFailure> {
        if let RankBackend::Processes(join) = crew {
            let same = format!("{}\n{:?}\n{:?}", common.command, built(), case.identity(self.name, options));
            processes::begin(join().as_ref(), &same)?;
        }
        let team = ProcessTeam::of(crew);
        // The first of several processes writes the results and reports progress.
        let is_first = team.as_ref().is_none_or(ProcessTeam::is_first);
        let (folder, stem) = if is_first {
            self.folder().map(|(folder, stem)| (Some(folder), stem))?
        } else {
            (None, self.stem())
        };
        let out = self.out(&stem);
        let journal = Journal::open(&out, &case.identity(self.name, options), team)?;
        journal.notes().iter().for_each(warn);
        if !common.quiet && !journal.is_empty() {
            let finished = count_with_noun(journal.len(), "finished run", "finished runs");
            print_message(format_args!("resuming with {finished} in {}", quoted::path(&out)));
        }
        let bar = progress(common, self.name);
        let start = Instant::now();
        let show = |share: f64| bar.set_position((1e3 * share) as u64);
        let trial = TrialControl { watch: &Stopwatch::processor(), stop: signals::interruption_flag() };
        let made = make(trial, &journal, &show, stem)?;
        folder.map_or(Ok(()), |folder| write_results(common, &folder, self.name, &made, start))
    }
}
