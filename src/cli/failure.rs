//! A failure as data: what `--json` prints in the place of a result.

use super::Failure;
use super::output::{is_untouched, print_json, say};
use crate::io::checkpoint::CheckpointError;
use crate::model::host::HostFileError;
use crate::model::machine_file::{MachineError, MachineFileError};
use crate::quoted;
use crate::run::RunError;
use crate::scene::SceneErrors;
use crate::study::StudyError;
use crate::study::break_even::AtlasError;
use crate::study::calibration::CalibrationError;
use crate::study::model_validation::ValidationError;
use crate::study::throughput::MeasurementError;
use serde::Serialize;
use std::path::Path;

/// The document.
#[derive(Serialize)]
struct Document<'f> {
    error: Report,
    /// All mistakes, where a scene has some; `error` is the first.
    #[serde(skip_serializing_if = "Option::is_none")]
    errors: Option<&'f SceneErrors>,
}

/// One failure.
#[derive(Debug, PartialEq, Eq, Serialize)]
struct Report {
    /// By the exit code: usage, input, precondition, input-output, checkpoint or interrupted.
    kind: &'static str,
    /// What is wrong, with the numbers.
    message: String,
    /// Where, if it has a place.
    place: Option<Place>,
    /// What to do about it, where the message does not say so itself.
    remedy: Option<String>,
}

/// A place in a file, as far as it is known.
#[derive(Debug, PartialEq, Eq, Serialize)]
struct Place {
    file: String,
    line: Option<usize>,
    column: Option<usize>,
}

impl Place {
    fn at(file: &Path) -> Option<Place> {
        Some(Place { file: file.display().to_string(), line: None, column: None })
    }
}

/// Says a failure: in words on standard error and, where data is asked for and none is there yet, as data on standard output.
pub(super) fn tell(failure: &Failure, as_data: bool) {
    match failure {
        Failure::Arguments(mistake) if is_plain(mistake) => {
            // Where standard error is full or closed there is nowhere to say so.
            let _ = mistake.print();
        }
        // The parser's own words begin as ours do.
        Failure::Arguments(mistake) => say(mistake.render().to_string().trim_end()),
        _ => say(format_args!("error: {failure}")),
    }
    if as_data && is_untouched() {
        // The first failure decides the exit code, whether it can be told or not.
        let _ = print_json(&Document { error: failure.report(), errors: failure.mistakes() });
    }
}

/// Whether a mistake among the arguments quotes nothing that a terminal would obey.
fn is_plain(mistake: &clap::Error) -> bool {
    let text = mistake.render().to_string();
    quoted::message(&text) == text
}

impl Failure {
    fn kind(&self) -> &'static str {
        match self.exit_code() {
            2 => "usage",
            3 => "input",
            4 => "precondition",
            6 => "checkpoint",
            crate::signals::INTERRUPTED => "interrupted",
            _ => "input-output",
        }
    }

    /// The mistakes of a scene.
    fn mistakes(&self) -> Option<&SceneErrors> {
        match self {
            Failure::Scene(errors)
            | Failure::Options(errors)
            | Failure::Run(RunError::Scene(errors))
            | Failure::Measurement(MeasurementError::Scene(errors))
            | Failure::Calibration(CalibrationError::Measurement(MeasurementError::Scene(errors)))
            | Failure::Validation(
                ValidationError::Measurement(MeasurementError::Scene(errors))
                | ValidationError::Calibration(CalibrationError::Measurement(MeasurementError::Scene(errors))),
            )
            | Failure::Study(StudyError::Scene(errors))
            | Failure::Atlas(
                AtlasError::Measurement(MeasurementError::Scene(errors))
                | AtlasError::Study(StudyError::Scene(errors)),
            ) => Some(errors),
            _ => None,
        }
    }

    fn report(&self) -> Report {
        let kind = self.kind();
        if let Some(first) = self.mistakes().and_then(|mistakes| mistakes.0.first()) {
            let [line, column] = [
                first.place.map(|place| place.line as usize),
                first.place.map(|place| place.column as usize),
            ];
            let expected = first.expected.as_ref().map(|expected| format!("expected: {expected}"));
            return Report {
                kind,
                message: first.message.clone(),
                place: Some(Place { file: first.file.clone(), line, column }),
                remedy: first.suggestion.clone().or(expected),
            };
        }
        let text = match self {
            Failure::Arguments(mistake) => mistake.render().to_string(),
            _ => self.to_string(),
        };
        let text = text.strip_prefix("error: ").unwrap_or(&text);
        // What to do stands in a paragraph of its own, or after "help".
        let (message, remedy) = match text.split_once("\n\n").or_else(|| text.split_once("\n  help: ")) {
            Some((message, remedy)) => (message, Some(remedy.trim().to_owned())),
            None => (text, None),
        };
        let message = message.trim().to_owned();
        Report { kind, message, place: self.place(), remedy: remedy.or_else(|| self.remedy()) }
    }

    fn place(&self) -> Option<Place> {
        let of_entry = |file: &str, position: Option<crate::model::machine_file::Position>| {
            let (line, column) = (position.map(|at| at.line), position.map(|at| at.column));
            Some(Place { file: file.to_owned(), line, column })
        };
        match self {
            Failure::HostFileExists(file) => Place::at(file),
            Failure::HostFile(HostFileError::Read(error)) => Place::at(&error.file),
            Failure::HostFile(HostFileError::NotText { file, line }) => {
                Some(Place { file: file.clone(), line: Some(*line), column: None })
            }
            Failure::InputOutput { what, .. } => Place::at(Path::new(what)),
            Failure::HostFile(HostFileError::Syntax { file, .. })
            | Failure::Machine(
                MachineError::Read { file, .. } | MachineError::File(MachineFileError::Syntax { file, .. }),
            ) => of_entry(file, None),
            Failure::HostFile(HostFileError::Content { file, entries, .. }) => {
                of_entry(file, entries.first().and_then(|entry| entry.position))
            }
            Failure::Machine(MachineError::File(MachineFileError::Content { file, defects, .. })) => {
                of_entry(file, defects.first().and_then(|(position, _)| *position))
            }
            Failure::Interrupted { folder, .. }
            | Failure::Run(
                RunError::Exists(folder)
                | RunError::FewerSteps { folder, .. }
                | RunError::OtherDiscs { folder, .. }
                | RunError::OtherVersion { folder, .. }
                | RunError::OtherScene { folder, .. },
            ) => Place::at(folder),
            Failure::Run(
                RunError::Checkpoint(CheckpointError { file, .. }) | RunError::Foreign { file, .. },
            ) => Place::at(file),
            Failure::Run(RunError::File(error)) => Place::at(&error.file),
            _ => None,
        }
    }

    fn remedy(&self) -> Option<String> {
        let words = match self {
            Failure::Machine(MachineError::Unknown { .. }) => {
                "take one of the known machines, or write a file"
            }
            Failure::HostFileExists(_) => "--force writes over it, --out elsewhere",
            Failure::TooNoisy(_) => "try again when the machine is quiet, with more --sweeps, or --force",
            Failure::Threads(_) => "ask for fewer with --threads",
            Failure::Run(RunError::Exists(_)) => "--resume, --overwrite or another --out",
            Failure::Interrupted { folder, .. } => {
                return Some(format!("go on with --resume --out {}", folder.display()));
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

    #[test]
    fn advice_is_told_from_the_message() {
        let failure = Failure::HostFileExists("host.toml".into()).report();
        assert_eq!((failure.kind, failure.remedy.is_some()), ("usage", true));
        assert_eq!(failure.place, Place::at(Path::new("host.toml")));
        let failure = Failure::StandardOutput(io::ErrorKind::StorageFull.into()).report();
        assert_eq!((failure.kind, failure.place), ("input-output", None));
    }
}
