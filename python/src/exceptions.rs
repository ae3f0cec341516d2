//! What went wrong, as exceptions of Python; the words are those of the command line.

use crate::json;
use pyo3::call::PyCallArgs;
use pyo3::prelude::*;
use pyo3::types::PyList;
use serde_json::Value;
use std::io;
use std::path::Path;
use stripmine_physics::quoted;
use stripmine_physics::reported::{Class, Reported};
use stripmine_physics::scene::{SceneError, SceneErrors};

/// Any error of the physics as the exception that is meant for it.
pub(crate) fn of(py: Python<'_>, error: &dyn Reported) -> PyErr {
    let message = quoted::shown(&error.to_string());
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

/// A file that cannot be read, or whose content is wrong.
pub(crate) fn of_file(py: Python<'_>, class: Class, message: &str, file: &Path) -> PyErr {
    let file = file.display().to_string();
    made(py, "RunError", (quoted::shown(message), class.name(), None::<String>, file))
}

/// Something that is asked for and cannot be.
pub(crate) fn refused(py: Python<'_>, message: impl Into<String>) -> PyErr {
    made(py, "Error", (message.into(),))
}

/// Threads that the system does not give.
pub(crate) fn without_threads(py: Python<'_>, cause: &io::Error) -> PyErr {
    refused(py, format!("the threads cannot be had: {cause}"))
}

/// Something that another thread is using.
pub(crate) fn busy(py: Python<'_>) -> PyErr {
    let message = "the simulation is in use by another thread: wait for that one, or start another simulation of the same scene";
    made(py, "BusyError", (message,))
}

/// A fault of the program: what was said of it.
pub(crate) fn fault(py: Python<'_>, said: &str) -> PyErr {
    let said = quoted::one_line(said);
    refused(py, format!("the program is at fault, not the scene: {said}\n  help: report this with the scene"))
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

/// The exception of a class of `stripmine._errors`, or why there is none.
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
