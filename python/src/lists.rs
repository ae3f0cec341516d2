//! Lists of presets, methods and scene keys.

use crate::json;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use serde_json::{Value, json};
use stripmine_physics::method::observed::UnknownName;
use stripmine_physics::method::{METHODS, MethodEntry, ObservedQuantity, method};
use stripmine_physics::scene::{Fallback, Key};

/// Preset scenes of the package: name and title.
#[pyfunction]
pub(crate) fn presets(py: Python<'_>) -> PyResult<Bound<'_, PyDict>> {
    let all = PyDict::new(py);
    for preset in METHODS.iter().flat_map(|method| method.vocabulary.presets) {
        all.set_item(preset.name, preset.title())?;
    }
    Ok(all)
}

/// Methods: name, source, description and observed quantities.
#[pyfunction]
pub(crate) fn methods(py: Python<'_>) -> PyResult<Bound<'_, PyAny>> {
    let quantity = |it: &ObservedQuantity| json!({ "name": it.name, "unit": it.unit, "doc": it.doc });
    let one = |entry: &&MethodEntry| {
        json!({
            "name": entry.vocabulary.keys.method,
            "source": entry.source,
            "doc": entry.doc,
            "quantities": entry.quantities.iter().map(quantity).collect::<Vec<_>>(),
        })
    };
    json::to_python(py, &METHODS.iter().map(one).collect::<Value>())
}

/// Keys of the scenes of a method (default: the first), as `stripmine scene keys --json`.
#[pyfunction]
#[pyo3(signature = (method = None))]
pub(crate) fn keys<'py>(py: Python<'py>, method: Option<&str>) -> PyResult<Bound<'py, PyAny>> {
    let entry = match method {
        Some(name) => self::method(METHODS, name),
        None => METHODS.first().copied(),
    };
    let Some(entry) = entry else {
        let names = METHODS.iter().map(|entry| entry.vocabulary.keys.method);
        let error = UnknownName::new("method", method.unwrap_or_default(), names);
        return Err(PyValueError::new_err(error.to_string()));
    };
    json::to_python(py, &entry.vocabulary.keys.keys_and_fields().map(line).collect::<Value>())
}

fn line(key: &Key) -> Value {
    let default = match key.fallback {
        Fallback::Required => None,
        Fallback::Is(text) | Fallback::Otherwise(text) => Some(text),
    };
    json!({
        "section": key.section,
        "key": key.name,
        "type": key.kind.words(),
        "unit": key.unit,
        "default": default,
        "required": key.fallback == Fallback::Required,
        "used_with": key.used.map_or(&[][..], |(_, choices)| choices),
        "meaning": key.doc,
    })
}
