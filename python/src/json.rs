//! Data as values of Python.

use pyo3::prelude::*;
use serde_json::Value;

/// Data as dicts, lists, numbers and texts.
pub(crate) fn to_python<'py>(py: Python<'py>, value: &Value) -> PyResult<Bound<'py, PyAny>> {
    of_text(py, &value.to_string())
}

/// The data of a JSON text.
pub(crate) fn of_text<'py>(py: Python<'py>, text: &str) -> PyResult<Bound<'py, PyAny>> {
    py.import("json")?.call_method1("loads", (text,))
}
