//! The command line: one file per verb; composes, decides nothing.

mod bench;
mod calibrate;
mod chart;
mod completions;
mod failure;
mod listing;
mod man;
mod output;
mod reproduce;
mod run;
mod scene;
mod scene_choice;
mod table;
mod validate_model;

use crate::model::host::HostFileError;
use crate::model::machine_file::MachineError;
use crate::origin::command_line;
use crate::run::RunError;
use crate::signals::{self, End};
use crate::study::StudyError;
use crate::study::break_even::AtlasError;
use crate::study::calibration::CalibrationError;
use crate::study::host_ladder::LadderError;
use crate::study::model_validation::ValidationError;
use crate::study::throughput::MeasurementError;
use clap::{Args, Parser, Subcommand};
use output::{print, print_json, say, to_json, warn};
use std::ffi::OsString;
use std::io::ErrorKind;
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

/// More threads than any machine at hand has cores; each takes memory of its own.
const MOST_THREADS: i64 = 1024;

/// What every verb takes.
#[derive(Args, Clone, Debug)]
struct Common {
    /// One JSON document on standard output
    #[arg(long, global = true)]
    json: bool,
    /// Nothing on standard error but errors
    #[arg(long, global = true)]
    quiet: bool,
    /// Threads, at most 1024; all cores by default
    #[arg(long, global = true, value_parser = clap::value_parser!(u16).range(1..=MOST_THREADS))]
    threads: Option<u16>,
    /// The whole command line, for the record of where results come from.
    #[arg(skip)]
    command: String,
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
    /// Arguments that the command does not understand: exit code 2.
    #[error(transparent)]
    Arguments(clap::Error),
    /// Options of which no scene can be made: exit code 2.
    #[error(transparent)]
    Options(crate::scene::SceneErrors),
    /// Threads that the system does not give: exit code 5.
    #[error("the threads cannot be had: {0}; ask for fewer with --threads")]
    Threads(rayon::ThreadPoolBuildError),
    /// A question that has no answer: exit code 2.
    #[error(transparent)]
    Usage(#[from] crate::study::efficiency_table::QuestionError),
    /// A machine that there is not: exit code 2; a bad machine file: 3; one that cannot be read: 5.
    #[error(transparent)]
    Machine(#[from] crate::model::machine_file::MachineError),
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
    /// Ended by a signal, and nothing of it goes on: exit code 130.
    #[error("{}", match .0 {
        End::Whole => "interrupted: what was finished before is kept, nothing is half written",
        End::Forced => "interrupted twice, and ended at once: what was being written may be incomplete",
    })]
    Stopped(End),
    /// Standard output takes no more: exit code 5; 0 where its reader closed the pipe, for it has seen enough.
    #[error("standard output cannot be written: {0}")]
    StandardOutput(std::io::Error),
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
            Failure::StandardOutput(cause) if cause.kind() == ErrorKind::BrokenPipe => 0,
            Failure::Arguments(_)
            | Failure::Options(_)
            | Failure::Usage(_)
            | Failure::UnknownVerb { .. }
            | Failure::HostFileExists(_) => 2,
            Failure::HostFile(HostFileError::Read(_)) => 5,
            Failure::HostFile(_) => 3,
            Failure::HostLadder(LadderError::Question(_)) => 2,
            Failure::HostLadder(LadderError::OutOfRange(_)) | Failure::TooNoisy(_) => 4,
            Failure::Calibration(CalibrationError::Program(_))
            | Failure::Validation(ValidationError::Calibration(CalibrationError::Program(_))) => 5,
            Failure::Validation(ValidationError::OutOfRange { .. })
            | Failure::Atlas(AtlasError::OutOfRange(_)) => 4,
            // Its scenes are made of options.
            Failure::Validation(ValidationError::Measurement(MeasurementError::Scene(_))) => 2,
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
            // Bytes that are no text.
            Failure::Machine(MachineError::Read { cause, .. }) if cause.kind() == ErrorKind::InvalidData => 3,
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
            Failure::Interrupted { .. } | Failure::Stopped(_) => signals::INTERRUPTED,
            Failure::Run(error) => match error {
                error if error.is_refusal() => 2,
                error if error.is_damage() => 6,
                RunError::Scene(_) => 3,
                RunError::Physics { .. } | RunError::Start(_) => 4,
                _ => 5,
            },
            Failure::Threads(_) | Failure::StandardOutput(_) | Failure::InputOutput { .. } => 5,
        }
    }
}

/// Runs the command with its arguments, the first of which is its name.
pub fn run(arguments: impl Iterator<Item = OsString>) -> ExitCode {
    let arguments: Vec<OsString> = arguments.collect();
    // Asked before the arguments are understood: a mistake among them is told as data too.
    let as_data = arguments.iter().any(|argument| argument == "--json");
    let last_words = move |end| {
        output::clear_progress();
        failure::tell(&Failure::Stopped(end), as_data);
    };
    let outcome = signals::install(last_words)
        .map_err(Failure::writing("the handler of interruptions"))
        .and_then(|()| understood(&arguments))
        .and_then(|line| line.map_or(Ok(()), |line| carried_out(line, command_line(&arguments))));
    output::clear_progress();
    match outcome {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => {
            let code = failure.exit_code();
            if code != 0 {
                failure::tell(&failure, as_data);
            }
            ExitCode::from(code)
        }
    }
}

/// What the arguments ask for; nothing where the answer, help or version, is given.
fn understood(arguments: &[OsString]) -> Result<Option<CommandLine>, Failure> {
    match CommandLine::try_parse_from(arguments) {
        Ok(line) => Ok(Some(line)),
        Err(mistake) if mistake.use_stderr() => Err(Failure::Arguments(mistake)),
        Err(answer) => output::print_answer(&answer).map(|()| None),
    }
}

fn carried_out(CommandLine { verb, common }: CommandLine, command: String) -> Result<(), Failure> {
    let common = Common { command, ..common };
    // Without an answer the default pool has a thread for each core.
    let threads = common.threads.map_or(0, usize::from);
    rayon::ThreadPoolBuilder::new().num_threads(threads).build_global().map_err(Failure::Threads)?;
    match verb {
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
    }
}
