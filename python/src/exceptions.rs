//! Errors as Python exceptions, with the messages of the command line.

use crate::json;
use pyo3::call::PyCallArgs;
use pyo3::prelude::*;
use pyo3::types::PyList;
use serde_json::Value;
use std::io;
use std::path::Path;
use stripmine_physics::quoted;
use stripmine_physics::reported::{ErrorClass, Reported};
use stripmine_physics::scene::{SceneError, SceneErrors};

/// Converts an error of the physics to its exception.
pub(crate) fn of(py: Python<'_>, error: &dyn Reported) -> PyErr {
    let message = quoted::escaped_for_terminal(&error.to_string());
    if let Some(mistakes) = error.mistakes() {
        return raised(of_scene(py, &message, mistakes));
    }
    match error.details() {
        Some(details) => raised(of_failure(py, &message, error.remedy(), &details)),
        None => {
            let file = error.place().map(|place| place.file);
            made(py, "RunError", (message, error.class().name(), error.remedy(), file))
        }
    }
}

/// `RunError` for a file that cannot be read or has invalid content.
pub(crate) fn of_file(py: Python<'_>, class: ErrorClass, message: &str, file: &Path) -> PyErr {
    let file = file.display().to_string();
    made(py, "RunError", (quoted::escaped_for_terminal(message), class.name(), None::<String>, file))
}

/// `Error` for an invalid request.
pub(crate) fn refused(py: Python<'_>, message: impl Into<String>) -> PyErr {
    made(py, "Error", (message.into(),))
}

/// `Error` for threads that cannot be started.
pub(crate) fn without_threads(py: Python<'_>, cause: &io::Error) -> PyErr {
    refused(py, format!("threads cannot be started: {cause}"))
}

/// `BusyError` for a simulation in use by another thread.
pub(crate) fn busy(py: Python<'_>) -> PyErr {
    let message = "the simulation is in use by another thread: wait for it, or start another simulation of the same scene";
    made(py, "BusyError", (message,))
}

/// `Error` for a bug in the program, with its message.
pub(crate) fn fault(py: Python<'_>, said: &str) -> PyErr {
    let said = quoted::one_line(said);
    refused(py, format!("bug in the program, not in the scene: {said}\n  help: report this with the scene"))
}

fn of_scene(py: Python<'_>, message: &str, SceneErrors(mistakes): &SceneErrors) -> PyResult<PyErr> {
    let class = py.import("stripmine._errors")?.getattr("Mistake")?;
    let one = |error: &SceneError| {
        let SceneError { file, place, reason, message, expected, suggestion } = error;
        let reason = serde_json::to_value(reason).ok();
        let reason = reason.as_ref().and_then(Value::as_str).unwrap_or_default();
        let [line, column] = [place.map(|place| place.line), place.map(|place| place.column)];
        class.call1((file, line, column, reason, message, expected, suggestion))
    };
    let mistakes = mistakes.iter().map(one).collect::<PyResult<Vec<_>>>()?;
    Ok(made(py, "SceneError", (message, PyList::new(py, mistakes)?)))
}

fn of_failure(py: Python<'_>, message: &str, remedy: Option<String>, details: &Value) -> PyResult<PyErr> {
    Ok(made(py, "SimulationError", (message, remedy, json::to_python(py, details)?)))
}

/// Makes an exception of a class in `stripmine._errors`; if that fails, returns the reason as an exception.
fn made<'py>(py: Python<'py>, class: &str, arguments: impl PyCallArgs<'py>) -> PyErr {
    let module = py.import("stripmine._errors");
    match module.and_then(|module| module.getattr(class)?.call1(arguments)) {
        Ok(exception) => PyErr::from_value(exception),
        Err(error) => error,
    }
}

fn raised(made: PyResult<PyErr>) -> PyErr {
    made.unwrap_or_else(|error| error)
}
