//! `stripmine chart`: studies as data and charts. Methods add studies of their own.

use crate::console::{Common, Failure, clear_progress, print, print_json, progress, say};
use crate::method::Methods;
use crate::model::machines;
use crate::origin::Provenance;
use crate::results::{Folder, Journal};
use crate::signals;
use crate::study::Subject;
use crate::study::work_precision::section::{NAME, made};
use crate::study::work_precision::{Effort, work_precision};
use clap::{Args, Subcommand};
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

/// Seconds that a study may take.
const BUDGET: std::ops::RangeInclusive<i64> = 1..=86_400;
/// Timed runs of each.
const REPEATS: std::ops::RangeInclusive<i64> = 1..=100;
/// Starts a step of a collision.
const PHASES: u32 = 16;
/// Progress moves at least this often.
const TICK: Duration = Duration::from_millis(500);

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
    WorkPrecision(WorkPrecisionVerb),
}

/// The error of a scene over its cost, for every way to run it and every step; which way for which wish
#[derive(Args)]
struct WorkPrecisionVerb {
    /// A preset's name, or a scene file
    scene: String,
    /// Overrides a value; may be given several times
    #[arg(long = "set", value_name = "SECTION.KEY=VALUE")]
    overrides: Vec<String>,
    /// Also clock periods on a machine, for ways whose operations are counted: a preset of `table`, or a machine file
    #[arg(long)]
    machine: Option<String>,
    /// Processor seconds that it may take about; what does not fit is left out and named
    #[arg(long, default_value_t = 150, value_parser = clap::value_parser!(u32).range(BUDGET))]
    budget: u32,
    /// Timed runs of each way and step
    #[arg(long, default_value_t = 3, value_parser = clap::value_parser!(u16).range(REPEATS))]
    repeats: u16,
    /// Folder for data, tables and figures; the scene's name with `.work-precision` by default. A study that was interrupted
    /// goes on there
    #[arg(long)]
    out: Option<PathBuf>,
}

impl ChartVerb {
    pub(super) fn run(&self, common: &Common, methods: Methods) -> Result<(), Failure> {
        match &self.what {
            Study::WorkPrecision(verb) => verb.run(common, methods),
        }
    }
}

impl WorkPrecisionVerb {
    fn run(&self, common: &Common, methods: Methods) -> Result<(), Failure> {
        let machine = self.machine.as_deref().map(machines::find).transpose()?;
        let subject = Subject::load(&self.scene, &self.overrides, methods)?;
        let stem = Path::new(&self.scene).file_stem().unwrap_or_default().to_string_lossy().into_owned();
        let out = self.out.clone().unwrap_or_else(|| PathBuf::from(format!("{stem}.{NAME}")));
        // Before anything takes its time.
        let folder = Folder::open(&out, &[NAME], true)?;
        let named = machine.as_ref().map_or("", |machine| machine.title());
        let options = format!("budget {} repeats {} machine {named}", self.budget, self.repeats);
        let journal = Journal::open(&out, &subject.identity(NAME, &options))?;
        if !common.quiet && !journal.is_empty() {
            say(format_args!("going on with {} finished runs in {}", journal.len(), out.display()));
        }
        let effort =
            Effort { budget: f64::from(self.budget), repeats: self.repeats.into(), phases: PHASES, machine };
        let bar = progress(common, NAME);
        bar.enable_steady_tick(TICK);
        let start = Instant::now();
        let show = |share: f64| bar.set_position((1e3 * share) as u64);
        let data = work_precision(&subject, &effort, &journal, &show)?;
        let provenance = Provenance::here(common.command.clone(), start.elapsed().as_secs_f64());
        let again = format!("stripmine chart {NAME} {}", subject.arguments());
        let made = made(&[(stem, data)], again)?;
        let path = signals::whole(|| {
            let path = folder.write(&made, &provenance)?;
            folder.write_page(&[NAME]).map(|()| path)
        })?;
        clear_progress();
        if !common.quiet {
            say(format_args!("written: {}", path.display()));
        }
        if common.json {
            return print_json(&made.data);
        }
        print(&(made.section.came_out + "\n"))
    }
}
