//! `stripmine chart`: studies as data and charts. Methods add studies of their own.

use super::explain::{failed, width};
use super::processes;
use crate::console::{Common, Failure, clear_progress, print, print_json, progress, say, warn};
use crate::model::machines;
use crate::provenance::{Provenance, built};
use crate::results::Made;
use crate::results::Progress;
use crate::results::{Folder, Journal, Team};
use crate::study::explain::{Target, accuracy};
use crate::study::stability::{self, Over, stability};
use crate::study::trial::{Stopwatch, Trial};
use crate::study::work_precision::{self, work_precision};
use crate::study::{Case, Subject};
use clap::{Args, Subcommand};
use std::path::{Path, PathBuf};
use std::time::Instant;
use stripmine_physics::method::Methods;
use stripmine_physics::number::counted;
use stripmine_physics::quoted;
use stripmine_physics::ranks::Crew;
use stripmine_physics::scene::Width;
use stripmine_physics::signals;

/// Seconds that a study may take.
const BUDGET: std::ops::RangeInclusive<i64> = 1..=86_400;
/// Timed runs of each.
const REPEATS: std::ops::RangeInclusive<i64> = 1..=100;
/// Values, and steps, of a map.
const SIZE: std::ops::RangeInclusive<i64> = 3..=200;
/// Seeds of its edges.
const SEEDS: std::ops::RangeInclusive<i64> = 1..=100;
/// Starts a step of a collision.
const PHASES: u32 = 16;

/// Studies as data and charts
#[derive(Args)]
#[command(
    subcommand_value_name = "WHAT",
    subcommand_help_heading = "What to chart",
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

/// The error of positions and energy of a scene over its cost, for every configuration and step, where trajectories can be compared; which is the cheapest for an error
#[derive(Args)]
struct WorkPrecisionVerb {
    /// A preset's name, or a scene file
    scene: String,
    /// Overrides a value; may be given several times
    #[arg(long = "set", value_name = "SECTION.KEY=VALUE")]
    overrides: Vec<String>,
    /// Also clock periods on a machine, for configurations whose operations are counted: a preset of `table`, or a machine file
    #[arg(long)]
    machine: Option<String>,
    /// Processor seconds that it may take about; runs that do not fit are left out and named
    #[arg(long, default_value_t = 150, value_parser = clap::value_parser!(u32).range(BUDGET))]
    budget: u32,
    /// Timed runs of each configuration and step
    #[arg(long, default_value_t = 3, value_parser = clap::value_parser!(u16).range(REPEATS))]
    repeats: u16,
    /// Charts the error of the mean of a quantity, as `chart accuracy` does, and not that of positions
    #[arg(long = "of", value_name = "QUANTITY", conflicts_with_all = ["machine", "repeats"])]
    quantity: Option<String>,
    /// Folder for data, tables and figures; by default the scene's name with `.work-precision`, or `.accuracy` for the error of a mean. A study that was
    /// interrupted resumes there
    #[arg(long)]
    out: Option<PathBuf>,
}

/// The error of a mean over the wall time of a run, for each integrator and step: bias and chance added, the scene as it stands and the plan marked
#[derive(Args)]
struct AccuracyVerb {
    /// A preset's name, or a scene file
    scene: String,
    /// Overrides a value; may be given several times
    #[arg(long = "set", value_name = "SECTION.KEY=VALUE")]
    overrides: Vec<String>,
    /// The quantity whose mean it is; the first of the method by default
    #[arg(long = "of", value_name = "QUANTITY")]
    quantity: Option<String>,
    /// Marks the plan for this error of the mean, such as 1% or 0.02
    #[arg(long, value_parser = width)]
    error: Option<Width>,
    /// Averages each run from one time to another, instead of over its steady state
    #[arg(long, num_args = 2, value_names = ["FROM", "TO"])]
    window: Option<Vec<f64>>,
    /// Processor seconds of trials, about
    #[arg(long, default_value_t = 60, value_parser = clap::value_parser!(u32).range(BUDGET))]
    budget: u32,
    /// Folder for data, tables and figures; the scene's name with `.accuracy` by default
    #[arg(long)]
    out: Option<PathBuf>,
}

/// Where a scene works, over the step and a second parameter: edges by bisection, failures by kind, theory beside them. Scenes of hard-disks take no steps, and have
/// no such map
#[derive(Args)]
struct StabilityVerb {
    /// A preset's name, or a scene file
    scene: String,
    /// Overrides a value; may be given several times
    #[arg(long = "set", value_name = "SECTION.KEY=VALUE")]
    overrides: Vec<String>,
    /// What is varied beside the step: stiffness, damping, density or speed of lattice-md, strength, temperature or friction of langevin, eccentricity or softening
    /// of nbody, and more; one that does not exist names them all. By default the first that the scene has a value of
    #[arg(long, value_name = "NAME")]
    over: Option<String>,
    /// From where to where it goes; a range about the scene's own value by default
    #[arg(long, num_args = 2, value_names = ["LOW", "HIGH"])]
    range: Option<Vec<f64>>,
    /// Values, and steps, at most
    #[arg(long, default_value_t = 24, value_parser = clap::value_parser!(u16).range(SIZE))]
    size: u16,
    /// Seeds of the edges, at most
    #[arg(long, default_value_t = 3, value_parser = clap::value_parser!(u16).range(SEEDS))]
    seeds: u16,
    /// Edges are found within this part of the step
    #[arg(long, default_value_t = 0.05, value_parser = part)]
    tolerance: f64,
    /// Processor seconds that it may take; where these are not enough, there are fewer seeds, values and steps, and shorter runs
    #[arg(long, default_value_t = 300, value_parser = clap::value_parser!(u32).range(BUDGET))]
    budget: u32,
    /// Folder for data, tables and figures; the scene's name with `.stability` by default. A study that was interrupted resumes
    /// there
    #[arg(long)]
    out: Option<PathBuf>,
}

/// A part of a step within which edges can be found.
fn part(text: &str) -> Result<f64, String> {
    let is_one = |part: &f64| (1e-6..=1.0).contains(part);
    text.parse()
        .ok()
        .filter(is_one)
        .ok_or_else(|| "a tolerance is a part of the step, from 1e-6 to 1".to_owned())
}

impl ChartVerb {
    pub(super) fn run(&self, common: &Common, methods: Methods) -> Result<(), Failure> {
        match &self.what {
            Study::Accuracy(verb) => verb.run(common, methods),
            Study::WorkPrecision(verb) => verb.run(common, methods),
            Study::Stability(verb) => verb.run(common, methods),
        }
    }
}

impl WorkPrecisionVerb {
    fn run(&self, common: &Common, methods: Methods) -> Result<(), Failure> {
        let case = Case::load(&self.scene, &self.overrides, methods)?;
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
        let effort = work_precision::Effort { budget, repeats, phases: PHASES, machine };
        let place = Place { name: "work-precision", scene: &self.scene, out: self.out.as_deref() };
        place.study((common, common.crew), &subject, &options, |trial, journal, progress, stem| {
            let data = work_precision(&subject, &effort, trial, journal, progress)?;
            Ok(work_precision::made(&[(stem, data)]))
        })
    }
}

impl AccuracyVerb {
    fn run(&self, common: &Common, methods: Methods) -> Result<(), Failure> {
        // The next trial depends on times: trials are the first process's alone.
        if processes::rank(common.crew) > 0 {
            return Ok(());
        }
        let case = Case::load(&self.scene, &self.overrides, methods)?;
        let target = Target::of(&case, self.quantity.as_deref(), self.error);
        let target = target.and_then(|target| target.over(self.window.as_deref())).map_err(failed)?;
        let place = Place { name: accuracy::NAME, scene: &self.scene, out: self.out.as_deref() };
        let options =
            format!("{} {:?} {:?} budget {}", target.quantity.name, self.error, target.window, self.budget);
        place.study((common, Crew::One), &case, &options, |_, journal, progress, stem| {
            let seconds = f64::from(self.budget) / rayon::current_num_threads() as f64;
            let trial = Trial { watch: &Stopwatch::wall(), stop: signals::asked() };
            let tell = |share: f64| progress(share);
            let shown: (&str, &dyn Fn(f64), &Journal) = (&stem, &tell, journal);
            accuracy::accuracy(&case, &target, seconds, trial, shown).map_err(failed)
        })
    }
}

impl StabilityVerb {
    fn run(&self, common: &Common, methods: Methods) -> Result<(), Failure> {
        let subject = Subject::load(&self.scene, &self.overrides, methods)?;
        let range = self.range.as_ref().map(|ends| [ends[0], ends[1]]);
        let over = Over::of(&subject, self.over.as_deref(), range)?;
        let effort = stability::Effort {
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
        let place = Place { name: "stability", scene: &self.scene, out: self.out.as_deref() };
        place.study((common, common.crew), &subject, &options, |trial, journal, progress, stem| {
            let data = stability(&subject, over, &effort, trial, journal, progress)?;
            Ok(stability::made(&[(stem, data)]))
        })
    }
}

/// Writes what a study made, and says it.
fn written(common: &Common, folder: &Folder, name: &str, made: &Made, begun: Instant) -> Result<(), Failure> {
    let provenance = Provenance::here(common.command.clone(), begun.elapsed().as_secs_f64());
    let (path, section) = signals::whole(|| {
        let written = folder.write(name, made, &provenance)?;
        folder.write_page(&[name]).map(|()| written)
    })?;
    clear_progress();
    if !common.quiet {
        say(format_args!("written: {}", quoted::path(&path)));
    }
    if common.json {
        return print_json(&made.json());
    }
    print(&(section.paragraphs().collect::<Vec<_>>().join("\n\n") + "\n"))
}

/// Where a study's results go.
struct Place<'p> {
    /// The study.
    name: &'static str,
    /// The scene, as it is named on the command line.
    scene: &'p str,
    /// The folder that was asked for.
    out: Option<&'p Path>,
}

impl Place<'_> {
    fn out(&self, stem: &str) -> PathBuf {
        self.out.map_or_else(|| PathBuf::from(format!("{stem}.{}", self.name)), Path::to_owned)
    }

    /// The folder, before anything takes its time, and the scene's stem.
    fn folder(&self) -> Result<(Folder, String), Failure> {
        let stem = self.stem();
        Ok((Folder::open(&self.out(&stem), &[self.name], true)?, stem))
    }

    fn stem(&self) -> String {
        Path::new(self.scene).file_stem().unwrap_or_default().to_string_lossy().into_owned()
    }

    /// Makes a study of the finished runs in its folder, with progress and the scene's stem.
    fn study(
        &self,
        (common, crew): (&Common, Crew),
        case: &Case,
        options: &str,
        make: impl FnOnce(Trial<'_>, &Journal, Progress<'_>, String) -> Result<Made, Failure>,
    ) -> Result<(), Failure> {
        if let Crew::Processes(join) = crew {
            let same = format!("{}\n{:?}\n{:?}", common.command, built(), case.identity(self.name, options));
            processes::begin(join().as_ref(), &same)?;
        }
        let team = Team::of(crew);
        // The first of several processes writes there, and says what it does.
        let is_first = team.as_ref().is_none_or(Team::is_first);
        let (folder, stem) = if is_first {
            self.folder().map(|(folder, stem)| (Some(folder), stem))?
        } else {
            (None, self.stem())
        };
        let out = self.out(&stem);
        let journal = Journal::open(&out, &case.identity(self.name, options), team)?;
        journal.notes().iter().for_each(warn);
        if !common.quiet && !journal.is_empty() {
            let finished = counted(journal.len(), "finished run", "finished runs");
            say(format_args!("going on with {finished} in {}", quoted::path(&out)));
        }
        let bar = progress(common, self.name);
        let start = Instant::now();
        let show = |share: f64| bar.set_position((1e3 * share) as u64);
        let trial = Trial { watch: &Stopwatch::processor(), stop: signals::asked() };
        let made = make(trial, &journal, &show, stem)?;
        folder.map_or(Ok(()), |folder| written(common, &folder, self.name, &made, start))
    }
}
