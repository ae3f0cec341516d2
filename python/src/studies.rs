//! Functions of `stripmine/_studies.py`, which call the command, as methods.

use pyo3::prelude::*;
use pyo3::types::{PyDict, PyTuple};

/// Calls a function with an object; it defines its options.
pub(crate) fn study<'py, C>(
    of: &Bound<'py, C>,
    name: &str,
    given: &Bound<'py, PyTuple>,
    options: Option<&Bound<'py, PyDict>>,
) -> PyResult<Bound<'py, PyAny>> {
    let py = of.py();
    let whole = PyTuple::new(py, [of.as_any()])?.add(given)?;
    py.import("stripmine._studies")?.getattr(name)?.call(whole.cast_into::<PyTuple>()?, options)
}
