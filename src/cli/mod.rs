//! The command line: one file per verb; composes, decides nothing.

mod bench;
mod calibrate;
mod chart;
mod completions;
mod listing;
mod man;
mod reproduce;
mod run;
mod scene;
mod scene_choice;
mod table;
mod validate_model;

use crate::model::machine::MachineError;
use crate::run::RunError;
use crate::study::StudyError;
use crate::study::break_even::AtlasError;
use crate::study::calibration::CalibrationError;
use crate::study::host_ladder::LadderError;
use crate::study::model_validation::ValidationError;
use crate::study::throughput::MeasurementError;
use clap::{Args, Parser, Subcommand};
use std::ffi::OsString;
use std::io::{ErrorKind, Write};
use std::process::ExitCode;

/// A SIMD vector machine for 2D particle dynamics.
#[derive(Parser)]
#[command(name = "stripmine", version, arg_required_else_help = true)]
struct CommandLine {
    #[command(subcommand)]
    verb: Verb,
    #[command(flatten)]
    common: Common,
}

/// What every verb takes.
#[derive(Args, Clone, Debug)]
struct Common {
    /// One JSON document on standard output
    #[arg(long, global = true)]
    json: bool,
    /// Nothing on standard error but errors
    #[arg(long, global = true)]
    quiet: bool,
    /// Threads; all cores by default
    #[arg(long, global = true, value_parser = clap::value_parser!(u16).range(1..))]
    threads: Option<u16>,
}

#[derive(Subcommand)]
enum Verb {
    Reproduce(reproduce::Reproduce),
    Table(table::TableVerb),
    Listing(listing::ListingVerb),
    Scene(scene::SceneVerb),
    Run(run::RunVerb),
    Bench(bench::BenchVerb),
    Calibrate(calibrate::CalibrateVerb),
    ValidateModel(validate_model::ValidateModel),
    Chart(chart::ChartVerb),
    Completions(completions::Completions),
    Man(man::ManVerb),
}

/// Why a verb did not come to its end; each kind has its exit code.
#[derive(Debug, thiserror::Error)]
pub(crate) enum Failure {
    /// A question that has no answer: exit code 2.
    #[error(transparent)]
    Usage(#[from] crate::study::efficiency_table::QuestionError),
    /// A machine that there is not: exit code 2; a bad machine file: 3; one that cannot be read: 5.
    #[error(transparent)]
    Machine(#[from] crate::model::machine::MachineError),
    /// A bad host file: exit code 3.
    #[error(transparent)]
    HostFile(#[from] crate::model::host::HostFileError),
    /// A file that a calibration would write over: exit code 2.
    #[error("{} is there already: --force writes over it, --out elsewhere", .0.display())]
    HostFileExists(std::path::PathBuf),
    /// A machine too busy to be measured: exit code 4.
    #[error(
        "{0}: the machine is too busy to be measured; nothing is written, try again when it is quiet, with more \
             --sweeps, or --force"
    )]
    TooNoisy(String),
    /// A calibration that broke: the exit code is that of the reason.
    #[error(transparent)]
    Calibration(#[from] crate::study::calibration::CalibrationError),
    /// A step that the host model does not reach: exit code 4; no such lattice: 2.
    #[error(transparent)]
    HostLadder(#[from] crate::study::host_ladder::LadderError),
    /// A validation that broke: outside the calibrated range 4, else that of the reason.
    #[error(transparent)]
    Validation(#[from] crate::study::model_validation::ValidationError),
    /// An atlas that broke: outside the calibrated range 4, else that of the reason.
    #[error(transparent)]
    Atlas(#[from] crate::study::break_even::AtlasError),
    /// A verb that there is not: exit code 2.
    #[error("there is no verb {verb}; these are: {}", verbs.join(", "))]
    UnknownVerb {
        /// The verb asked for.
        verb: String,
        /// Those there are.
        verbs: Vec<String>,
    },
    /// A bad scene: exit code 3.
    #[error(transparent)]
    Scene(#[from] crate::scene::SceneErrors),
    /// A run that did not come to its end: the exit code is that of the reason.
    #[error(transparent)]
    Run(#[from] crate::run::RunError),
    /// A measurement that broke: the exit code is that of the reason.
    #[error(transparent)]
    Measurement(#[from] crate::study::throughput::MeasurementError),
    /// A study that broke: the exit code is that of the reason.
    #[error(transparent)]
    Study(#[from] crate::study::StudyError),
    /// A picture that cannot be drawn: a mistake of ours, exit code 5.
    #[error(transparent)]
    Figure(#[from] crate::report::figure::FigureError),
    /// A folder of results that is another's, or in which another process writes: exit code 2; one that cannot be written: 5.
    #[error(transparent)]
    Results(#[from] reproduce::FolderError),
    /// Interrupted or terminated: exit code 130.
    #[error("interrupted at step {step}; a checkpoint is written, go on with --resume --out {}", folder.display())]
    Interrupted {
        /// Steps done.
        step: u64,
        /// The folder of the run.
        folder: std::path::PathBuf,
    },
    /// Reading or writing: exit code 5.
    #[error("{what}: {cause}")]
    InputOutput {
        /// What was being done.
        what: String,
        /// What the system said.
        cause: std::io::Error,
    },
}

impl Failure {
    fn writing(what: impl Into<String>) -> impl FnOnce(std::io::Error) -> Failure {
        let what = what.into();
        move |cause| Failure::InputOutput { what, cause }
    }

    fn exit_code(&self) -> u8 {
        match self {
            // A reader that closes the pipe has seen enough.
            Failure::InputOutput { cause, .. } if cause.kind() == ErrorKind::BrokenPipe => 0,
            Failure::Usage(_) | Failure::UnknownVerb { .. } | Failure::HostFileExists(_) => 2,
            Failure::HostFile(_) => 3,
            Failure::HostLadder(LadderError::Question(_)) => 2,
            Failure::HostLadder(LadderError::OutOfRange(_)) | Failure::TooNoisy(_) => 4,
            Failure::Calibration(CalibrationError::Program(_))
            | Failure::Validation(ValidationError::Calibration(CalibrationError::Program(_))) => 5,
            Failure::Validation(ValidationError::OutOfRange { .. })
            | Failure::Atlas(AtlasError::OutOfRange(_)) => 4,
            Failure::Validation(
                ValidationError::Measurement(error)
                | ValidationError::Calibration(CalibrationError::Measurement(error)),
            )
            | Failure::Calibration(CalibrationError::Measurement(error))
            | Failure::Atlas(AtlasError::Measurement(error))
            | Failure::Measurement(error) => match error {
                MeasurementError::Scene(_) => 3,
                MeasurementError::Physics(_) => 4,
                MeasurementError::Threads(_) => 5,
            },
            Failure::Machine(MachineError::Unknown { .. }) => 2,
            Failure::Machine(MachineError::File(_)) => 3,
            Failure::Machine(MachineError::Read { .. }) => 5,
            Failure::Scene(_) => 3,
            Failure::Study(error) | Failure::Atlas(AtlasError::Study(error)) => match error {
                StudyError::Scene(_) => 3,
                StudyError::Physics(_) => 4,
                StudyError::Question(_) => 2,
            },
            Failure::Figure(_) => 5,
            Failure::Results(error) if error.is_refusal() => 2,
            Failure::Results(_) => 5,
            Failure::Interrupted { .. } => 130,
            Failure::Run(error) => match error {
                error if error.is_refusal() => 2,
                error if error.is_damage() => 6,
                RunError::Scene(_) => 3,
                RunError::Physics { .. } | RunError::Start(_) => 4,
                _ => 5,
            },
            Failure::InputOutput { .. } => 5,
        }
    }
}

/// Runs the command with its arguments, the first of which is its name.
pub fn run(arguments: impl Iterator<Item = OsString>) -> ExitCode {
    let CommandLine { verb, common } = CommandLine::parse_from(arguments);
    // Without an answer the default pool has a thread for each core.
    let threads = common.threads.map_or(0, usize::from);
    if let Err(error) = rayon::ThreadPoolBuilder::new().num_threads(threads).build_global() {
        eprintln!("warning: {error}");
    }
    let outcome = match verb {
        Verb::Reproduce(verb) => verb.run(&common),
        Verb::Table(verb) => verb.run(&common),
        Verb::Listing(verb) => verb.run(&common),
        Verb::Scene(verb) => verb.run(&common),
        Verb::Run(verb) => verb.run(&common),
        Verb::Bench(verb) => verb.run(&common),
        Verb::Calibrate(verb) => verb.run(&common),
        Verb::ValidateModel(verb) => verb.run(&common),
        Verb::Chart(verb) => verb.run(&common),
        Verb::Completions(verb) => verb.run(),
        Verb::Man(verb) => verb.run(),
    };
    match outcome {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => {
            if failure.exit_code() != 0 {
                eprintln!("error: {failure}");
            }
            ExitCode::from(failure.exit_code())
        }
    }
}

/// Progress in thousandths, with ETA, on a terminal; nothing elsewhere.
fn progress(common: &Common, what: &'static str) -> indicatif::ProgressBar {
    use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
    let target = if common.quiet { ProgressDrawTarget::hidden() } else { ProgressDrawTarget::stderr() };
    let bar = ProgressBar::with_draw_target(Some(1000), target);
    let style = ProgressStyle::with_template("{wide_bar} {msg} {percent}% [{elapsed}, ETA {eta}]");
    bar.set_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()));
    bar.set_message(what);
    bar
}

/// Writes data to standard output.
fn print(text: &str) -> Result<(), Failure> {
    let mut out = std::io::stdout().lock();
    out.write_all(text.as_bytes()).and_then(|()| out.flush()).map_err(Failure::writing("standard output"))
}

/// Writes data to standard output as one JSON document.
fn print_json(data: &impl serde::Serialize) -> Result<(), Failure> {
    print(&(to_json(data)? + "\n"))
}

/// Data as JSON, floats in shortest round-trip form.
fn to_json(data: &impl serde::Serialize) -> Result<String, Failure> {
    serde_json::to_string_pretty(data).map_err(|cause| Failure::writing("JSON")(cause.into()))
}
