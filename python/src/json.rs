//! JSON data as Python objects.

use pyo3::prelude::*;
use serde_json::Value;

/// Converts data to dicts, lists, numbers and strings.
pub(crate) fn to_python<'py>(py: Python<'py>, value: &Value) -> PyResult<Bound<'py, PyAny>> {
    of_text(py, &value.to_string())
}

/// Parses a JSON text into Python objects.
pub(crate) fn of_text<'py>(py: Python<'py>, text: &str) -> PyResult<Bound<'py, PyAny>> {
    py.import("json")?.call_method1("loads", (text,))
}
