//! Failures of verbs, as messages and as the document that `--json` prints instead of a result.

use super::MOST_THREADS;
use super::output::{is_untouched, print_json, print_message};
use serde::Serialize;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};
use stripmine_physics::quoted;
use stripmine_physics::reported::{ErrorClass, FilePlace, Reported};
use stripmine_physics::scene::SceneErrors;
use stripmine_physics::signals::{self, ProcessEnd};
use stripmine_physics::words::suggestion;

/// Failure of a verb; each kind has its exit code.
#[derive(Debug, thiserror::Error)]
pub enum CommandFailure {
    /// Invalid arguments: exit code 2.
    #[error(transparent)]
    Arguments(clap::Error),
    /// Options that make an invalid scene: exit code 2.
    #[error(transparent)]
    Options(SceneErrors),
    /// Unknown option of a benchmark: exit code 2.
    #[error("bench {bench} has no option --{option}\n  help: stripmine bench --help lists the options")]
    NoSuchOption {
        /// Name of the benchmark.
        bench: &'static str,
        /// Name of the option.
        option: &'static str,
    },
    /// Invalid value of an option of a benchmark: exit code 2.
    #[error("--{option} cannot be {value}\n  help: use one of: {}", values.join(", "))]
    NoSuchValue {
        /// Name of the option.
        option: &'static str,
        /// The given value.
        value: String,
        /// The allowed values.
        values: &'static [&'static str],
    },
    /// Ranks with too many threads in total: exit code 2.
    #[error(
        "{ranks} ranks with {threads} threads each are more than {MOST_THREADS} threads in total; use fewer --ranks or --threads"
    )]
    ManyThreads {
        /// Number of ranks.
        ranks: u16,
        /// Threads per rank.
        threads: usize,
    },
    /// Invalid number of threads in the environment: exit code 2.
    #[error(
        "RAYON_NUM_THREADS is {0}; expected a whole number from 1 to {MOST_THREADS}: correct it, or give --threads"
    )]
    ThreadsOfEnvironment(String),
    /// Several numbers of threads for a verb that takes one: exit code 2.
    #[error("{0} takes one number of threads; only bench takes several")]
    SeveralThreads(String),
    /// Unknown verb: exit code 2.
    #[error("unknown verb {verb}; expected one of: {}{}", verbs.join(", "), suggestion(verb, verbs.iter().map(String::as_str)))]
    UnknownVerb {
        /// The given verb.
        verb: String,
        /// The known verbs.
        verbs: Vec<String>,
    },
    /// Failure of another process: the exit code is that of its class.
    #[error("{process}: {said}")]
    OfProcess {
        /// Name of the process, or its task.
        process: String,
        /// Class of its failure; none if a signal ended it.
        class: Option<ErrorClass>,
        /// Its message.
        said: String,
    },
    /// The system refuses to start threads: exit code 5.
    #[error("threads cannot be started: {0}; use fewer with --threads")]
    Threads(rayon::ThreadPoolBuildError),
    /// Any other error: the exit code is that of its class.
    #[error("{0}")]
    Reported(Box<dyn Reported>),
    /// Interrupted or terminated: exit code 130.
    #[error(
        "interrupted at {moment}; a checkpoint is written, resume with --resume --out {}",
        quoted::path(folder)
    )]
    Interrupted {
        /// Clock of the run.
        moment: String,
        /// Folder of the run.
        folder: PathBuf,
    },
    /// Ended by a signal, without a checkpoint: exit code 130.
    #[error("{}", match .0 {
        ProcessEnd::Whole => "interrupted: finished results are kept, and no file is incomplete",
        ProcessEnd::Forced => "interrupted twice and ended at once: the last file may be incomplete",
    })]
    Stopped(ProcessEnd),
    /// Standard output cannot be written: exit code 5, or 0 if its reader closed the pipe.
    #[error("standard output cannot be written: {0}")]
    StandardOutput(std::io::Error),
    /// Reading or writing failed: exit code 5.
    #[error("{what}: {cause}")]
    InputOutput {
        /// The action or its object.
        what: String,
        /// Error of the system.
        cause: std::io::Error,
    },
}

impl<E: Reported + 'static> From<E> for CommandFailure {
    fn from(error: E) -> Self {
        CommandFailure::Reported(Box::new(error))
    }
}

/// Document of `--json` for a failure.
#[derive(Serialize)]
struct FailureDocument<'f> {
    error: FailureReport,
    /// All mistakes of an input file, if there are any; `error` is the first.
    #[serde(skip_serializing_if = "Option::is_none")]
    errors: Option<&'f SceneErrors>,
}

/// One failure as data.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub(crate) struct FailureReport {
    /// Name of the class, or `interrupted`.
    kind: &'static str,
    /// Description of the failure, with the numbers.
    pub(crate) message: String,
    /// Location, if known.
    place: Option<FilePlace>,
    /// Advice, if the message does not include it.
    remedy: Option<String>,
    /// Details of a failed simulation: kind of failure, time, particles and values.
    #[serde(skip_serializing_if = "Option::is_none")]
    details: Option<serde_json::Value>,
}

/// Reports a failure: as a message on standard error and, with `--json` and no output yet, as data on standard output.
pub(crate) fn report_failure(failure: &CommandFailure, as_data: bool) {
    match failure {
        CommandFailure::Arguments(mistake) if is_plain(mistake) => {
            #[expect(
                clippy::let_underscore_must_use,
                reason = "if standard error is full or closed, nothing can be reported"
            )]
            let _ = mistake.print();
        }
        // The parser's messages begin with "error:" as ours do.
        CommandFailure::Arguments(mistake) => print_message(mistake.render().to_string().trim_end()),
        _ => print_message(format_args!("error: {failure}")),
    }
    if as_data && is_untouched() {
        #[expect(
            clippy::let_underscore_must_use,
            reason = "the first failure decides the exit code, reported or not"
        )]
        let _ = print_json(&FailureDocument { error: failure.report(), errors: failure.mistakes() });
    }
}

/// Returns true if an argument error quotes no control characters.
fn is_plain(mistake: &clap::Error) -> bool {
    let text = mistake.render().to_string();
    quoted::message(&text) == text
}

impl CommandFailure {
    /// Makes a failure of a system error while `what` was being written or read.
    pub fn writing(what: impl Into<String>) -> impl FnOnce(std::io::Error) -> CommandFailure {
        let what = what.into();
        move |cause| CommandFailure::InputOutput { what, cause }
    }

    /// Class of the failure; none if a signal ended the verb.
    pub(crate) fn class(&self) -> Option<ErrorClass> {
        Some(match self {
            CommandFailure::Arguments(_)
            | CommandFailure::Options(_)
            | CommandFailure::NoSuchOption { .. }
            | CommandFailure::NoSuchValue { .. }
            | CommandFailure::SeveralThreads(_)
            | CommandFailure::ManyThreads { .. }
            | CommandFailure::ThreadsOfEnvironment(_)
            | CommandFailure::UnknownVerb { .. } => ErrorClass::Usage,
            CommandFailure::Reported(error) => error.class(),
            CommandFailure::OfProcess { class, .. } => return *class,
            CommandFailure::Threads(_)
            | CommandFailure::StandardOutput(_)
            | CommandFailure::InputOutput { .. } => ErrorClass::InputOutput,
            CommandFailure::Interrupted { .. } | CommandFailure::Stopped(_) => return None,
        })
    }

    /// Exit code of the failure.
    pub fn exit_code(&self) -> u8 {
        match self {
            CommandFailure::StandardOutput(cause) if cause.kind() == ErrorKind::BrokenPipe => 0,
            _ => self.class().map_or(signals::INTERRUPTED, ErrorClass::exit_code),
        }
    }

    fn mistakes(&self) -> Option<&SceneErrors> {
        match self {
            CommandFailure::Options(errors) => Some(errors),
            CommandFailure::Reported(error) => error.mistakes(),
            _ => None,
        }
    }

    /// Message as `report_failure` prints it after "error: ".
    pub fn message_text(&self) -> String {
        let text = match self {
            CommandFailure::Arguments(mistake) => mistake.render().to_string(),
            _ => self.to_string(),
        };
        text.strip_prefix("error: ").unwrap_or(&text).to_owned()
    }

    /// The failure as data.
    pub(crate) fn report(&self) -> FailureReport {
        let kind = self.class().map_or("interrupted", ErrorClass::name);
        if let Some(first) = self.mistakes().and_then(|mistakes| mistakes.0.first()) {
            let [line, column] = [
                first.place.map(|place| place.line as usize),
                first.place.map(|place| place.column as usize),
            ];
            let expected = first.expected.as_ref().map(|expected| format!("expected: {expected}"));
            return FailureReport {
                kind,
                message: first.message.clone(),
                place: Some(FilePlace { file: first.file.clone(), line, column }),
                remedy: first.suggestion.clone().or(expected),
                details: None,
            };
        }
        let text = self.message_text();
        // The remedy is a separate paragraph, or follows "help:".
        let (message, remedy) = match text.split_once("\n\n").or_else(|| text.split_once("\n  help: ")) {
            Some((message, remedy)) => (message, Some(remedy.trim().to_owned())),
            None => (text.as_str(), None),
        };
        let message = message.trim().to_owned();
        let (place, details) = (self.place(), self.details());
        FailureReport { kind, message, place, remedy: remedy.or_else(|| self.remedy()), details }
    }

    fn details(&self) -> Option<serde_json::Value> {
        match self {
            CommandFailure::Reported(error) => error.details(),
            _ => None,
        }
    }

    fn place(&self) -> Option<FilePlace> {
        match self {
            CommandFailure::Reported(error) => error.place(),
            CommandFailure::InputOutput { what, .. } => Some(FilePlace::at(Path::new(what))),
            CommandFailure::Interrupted { folder, .. } => Some(FilePlace::at(folder)),
            _ => None,
        }
    }

    fn remedy(&self) -> Option<String> {
        let words = match self {
            CommandFailure::Reported(error) => return error.remedy(),
            CommandFailure::Threads(_) => "use fewer with --threads",
            CommandFailure::Interrupted { folder, .. } => {
                return Some(format!("resume with --resume --out {}", quoted::path(folder)));
            }
            CommandFailure::Stopped(_) => "repeat the command; a run resumes with --resume",
            CommandFailure::InputOutput { .. } | CommandFailure::StandardOutput(_) => {
                "check that the location exists, is writable, and has free space"
            }
            _ => return None,
        };
        Some(words.to_owned())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::io;

    #[derive(Debug, thiserror::Error)]
    #[error("a file is in the way")]
    struct FileInTheWay;

    impl Reported for FileInTheWay {
        fn class(&self) -> ErrorClass {
            ErrorClass::Usage
        }

        fn place(&self) -> Option<FilePlace> {
            Some(FilePlace::at(Path::new("a.run")))
        }

        fn remedy(&self) -> Option<String> {
            Some("move it away".to_owned())
        }
    }

    #[test]
    fn advice_is_separate_from_the_message() {
        let failure = CommandFailure::from(FileInTheWay).report();
        assert_eq!((failure.kind, failure.remedy.is_some()), ("usage", true));
        assert_eq!(failure.place, Some(FilePlace::at(Path::new("a.run"))));
        let failure = CommandFailure::StandardOutput(io::ErrorKind::StorageFull.into()).report();
        assert_eq!((failure.kind, failure.place), ("input-output", None));
    }
}
