//! Why a verb did not come to its end, in words and as data: what `--json` prints in the place of a result.

use super::MOST_THREADS;
use super::output::{is_untouched, print_json, say};
use serde::Serialize;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};
use stripmine_physics::quoted;
use stripmine_physics::reported::{Class, FilePlace, Reported};
use stripmine_physics::scene::SceneErrors;
use stripmine_physics::signals::{self, End};
use stripmine_physics::words::suggestion;

/// Why a verb did not come to its end; each kind has its exit code.
#[derive(Debug, thiserror::Error)]
pub enum Failure {
    /// Arguments that the command does not understand: exit code 2.
    #[error(transparent)]
    Arguments(clap::Error),
    /// Options of which no scene can be made: exit code 2.
    #[error(transparent)]
    Options(SceneErrors),
    /// An option that a bench does not have: exit code 2.
    #[error("bench {bench} takes no --{option}")]
    NoSuchOption {
        /// The bench.
        bench: &'static str,
        /// The option.
        option: &'static str,
    },
    /// A value that an option of a bench does not have: exit code 2.
    #[error("--{option} cannot be {value}\n  help: one of {}", values.join(", "))]
    NoSuchValue {
        /// The option.
        option: &'static str,
        /// The value.
        value: String,
        /// Those there are.
        values: &'static [&'static str],
    },
    /// Ranks with more threads together than a run may have: exit code 2.
    #[error(
        "{ranks} ranks of {threads} threads are more than {MOST_THREADS} threads; take fewer --ranks or --threads"
    )]
    ManyThreads {
        /// Ranks.
        ranks: u16,
        /// Threads of each.
        threads: usize,
    },
    /// A number of threads in the environment that cannot be: exit code 2.
    #[error(
        "RAYON_NUM_THREADS is {0}; expected a whole number from 1 to {MOST_THREADS}: correct it, or give --threads"
    )]
    ThreadsOfEnvironment(String),
    /// Several numbers of threads for a verb that takes one: exit code 2.
    #[error("several numbers of threads are for bench; {0} takes one")]
    SeveralThreads(String),
    /// A verb that there is not: exit code 2.
    #[error("there is no verb {verb}; these are: {}{}", verbs.join(", "), suggestion(verb, verbs.iter().map(String::as_str)))]
    UnknownVerb {
        /// The verb asked for.
        verb: String,
        /// Those there are.
        verbs: Vec<String>,
    },
    /// Another of several processes failed: the exit code is that of its class.
    #[error("{process}: {said}")]
    OfProcess {
        /// Name of the process, or its task.
        process: String,
        /// The class of its failure; none where a signal ended it.
        class: Option<Class>,
        /// Its words.
        said: String,
    },
    /// Threads that the system does not give: exit code 5.
    #[error("the threads cannot be had: {0}; ask for fewer with --threads")]
    Threads(rayon::ThreadPoolBuildError),
    /// Any other error: the exit code is that of its class.
    #[error("{0}")]
    Reported(Box<dyn Reported>),
    /// Interrupted or terminated: exit code 130.
    #[error(
        "interrupted at {moment}; a checkpoint is written, go on with --resume --out {}",
        quoted::path(folder)
    )]
    Interrupted {
        /// How far the run has come.
        moment: String,
        /// The folder of the run.
        folder: PathBuf,
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

impl<E: Reported + 'static> From<E> for Failure {
    fn from(error: E) -> Self {
        Failure::Reported(Box::new(error))
    }
}

/// The document.
#[derive(Serialize)]
struct Document<'f> {
    error: Report,
    /// All mistakes of an input file, if there are any; `error` is the first.
    #[serde(skip_serializing_if = "Option::is_none")]
    errors: Option<&'f SceneErrors>,
}

/// One failure.
#[derive(Debug, PartialEq, Eq, Serialize)]
struct Report {
    /// By the exit code: the name of the class, or interrupted.
    kind: &'static str,
    /// What is wrong, with the numbers.
    message: String,
    /// Where, if it has a place.
    place: Option<FilePlace>,
    /// What to do about it, where the message does not say so itself.
    remedy: Option<String>,
    /// What more is known, where a simulation broke: what kind of failure, when, who, and the values found.
    #[serde(skip_serializing_if = "Option::is_none")]
    details: Option<serde_json::Value>,
}

/// Says a failure: in words on standard error and, where data is asked for and none is there yet, as data on standard output.
pub(crate) fn tell(failure: &Failure, as_data: bool) {
    match failure {
        Failure::Arguments(mistake) if is_plain(mistake) => {
            #[expect(
                clippy::let_underscore_must_use,
                reason = "where standard error is full or closed there is nowhere to say so"
            )]
            let _ = mistake.print();
        }
        // The parser's own words begin as ours do.
        Failure::Arguments(mistake) => say(mistake.render().to_string().trim_end()),
        _ => say(format_args!("error: {failure}")),
    }
    if as_data && is_untouched() {
        #[expect(
            clippy::let_underscore_must_use,
            reason = "the first failure decides the exit code, said or not"
        )]
        let _ = print_json(&Document { error: failure.report(), errors: failure.mistakes() });
    }
}

/// Whether a mistake among the arguments quotes nothing that a terminal would obey.
fn is_plain(mistake: &clap::Error) -> bool {
    let text = mistake.render().to_string();
    quoted::message(&text) == text
}

impl Failure {
    /// A system error while `what` was being written or read.
    pub fn writing(what: impl Into<String>) -> impl FnOnce(std::io::Error) -> Failure {
        let what = what.into();
        move |cause| Failure::InputOutput { what, cause }
    }

    /// The class; none where a signal ended the verb.
    pub(crate) fn class(&self) -> Option<Class> {
        Some(match self {
            Failure::Arguments(_)
            | Failure::Options(_)
            | Failure::NoSuchOption { .. }
            | Failure::NoSuchValue { .. }
            | Failure::SeveralThreads(_)
            | Failure::ManyThreads { .. }
            | Failure::ThreadsOfEnvironment(_)
            | Failure::UnknownVerb { .. } => Class::Usage,
            Failure::Reported(error) => error.class(),
            Failure::OfProcess { class, .. } => return *class,
            Failure::Threads(_) | Failure::StandardOutput(_) | Failure::InputOutput { .. } => {
                Class::InputOutput
            }
            Failure::Interrupted { .. } | Failure::Stopped(_) => return None,
        })
    }

    /// The exit code.
    pub fn exit_code(&self) -> u8 {
        match self {
            Failure::StandardOutput(cause) if cause.kind() == ErrorKind::BrokenPipe => 0,
            _ => self.class().map_or(signals::INTERRUPTED, Class::exit_code),
        }
    }

    /// Mistakes of an input file.
    fn mistakes(&self) -> Option<&SceneErrors> {
        match self {
            Failure::Options(errors) => Some(errors),
            Failure::Reported(error) => error.mistakes(),
            _ => None,
        }
    }

    /// The failure in words, as `tell` says it behind "error:".
    pub fn words(&self) -> String {
        let text = match self {
            Failure::Arguments(mistake) => mistake.render().to_string(),
            _ => self.to_string(),
        };
        text.strip_prefix("error: ").unwrap_or(&text).to_owned()
    }

    fn report(&self) -> Report {
        let kind = self.class().map_or("interrupted", Class::name);
        if let Some(first) = self.mistakes().and_then(|mistakes| mistakes.0.first()) {
            let [line, column] = [
                first.place.map(|place| place.line as usize),
                first.place.map(|place| place.column as usize),
            ];
            let expected = first.expected.as_ref().map(|expected| format!("expected: {expected}"));
            return Report {
                kind,
                message: first.message.clone(),
                place: Some(FilePlace { file: first.file.clone(), line, column }),
                remedy: first.suggestion.clone().or(expected),
                details: None,
            };
        }
        let text = self.words();
        // What to do stands in a paragraph of its own, or after "help".
        let (message, remedy) = match text.split_once("\n\n").or_else(|| text.split_once("\n  help: ")) {
            Some((message, remedy)) => (message, Some(remedy.trim().to_owned())),
            None => (text.as_str(), None),
        };
        let message = message.trim().to_owned();
        let (place, details) = (self.place(), self.details());
        Report { kind, message, place, remedy: remedy.or_else(|| self.remedy()), details }
    }

    fn details(&self) -> Option<serde_json::Value> {
        match self {
            Failure::Reported(error) => error.details(),
            _ => None,
        }
    }

    fn place(&self) -> Option<FilePlace> {
        match self {
            Failure::Reported(error) => error.place(),
            Failure::InputOutput { what, .. } => Some(FilePlace::at(Path::new(what))),
            Failure::Interrupted { folder, .. } => Some(FilePlace::at(folder)),
            _ => None,
        }
    }

    fn remedy(&self) -> Option<String> {
        let words = match self {
            Failure::Reported(error) => return error.remedy(),
            Failure::Threads(_) => "ask for fewer with --threads",
            Failure::Interrupted { folder, .. } => {
                return Some(format!("go on with --resume --out {}", quoted::path(folder)));
            }
            Failure::Stopped(_) => "repeat the command; a run goes on with --resume",
            Failure::InputOutput { .. } | Failure::StandardOutput(_) => {
                "see that the place is there, may be written, and has room"
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
    struct InTheWay;

    impl Reported for InTheWay {
        fn class(&self) -> Class {
            Class::Usage
        }

        fn place(&self) -> Option<FilePlace> {
            Some(FilePlace::at(Path::new("a.run")))
        }

        fn remedy(&self) -> Option<String> {
            Some("move it away".to_owned())
        }
    }

    #[test]
    fn advice_stands_apart_from_the_message() {
        let failure = Failure::from(InTheWay).report();
        assert_eq!((failure.kind, failure.remedy.is_some()), ("usage", true));
        assert_eq!(failure.place, Some(FilePlace::at(Path::new("a.run"))));
        let failure = Failure::StandardOutput(io::ErrorKind::StorageFull.into()).report();
        assert_eq!((failure.kind, failure.place), ("input-output", None));
    }
}
