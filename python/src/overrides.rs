//! A dict of Python as overrides `section.key=value`.

use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;
use pyo3::types::{PyBool, PyDict, PyFloat, PyInt, PyList, PyString, PyTuple};
use serde_json::Value;

/// Lists within lists are read as deep as this.
const DEEPEST: usize = 8;

/// The overrides of a dict, whose keys are `section.key`, or sections that hold dicts of their keys; or those of a list of texts.
///
/// # Errors
/// `TypeError` where a key is no text, or a value has no form in a scene.
pub(crate) fn overrides(given: &Bound<'_, PyAny>) -> PyResult<Vec<String>> {
    let Ok(given) = given.cast::<PyDict>() else { return given.extract() };
    let mut found = vec![];
    for (name, value) in given {
        let name = text(&name)?;
        match value.cast::<PyDict>() {
            Ok(section) if !name.contains('.') => {
                for (key, value) in section {
                    let path = format!("{name}.{}", text(&key)?);
                    found.push(format!("{path}={}", toml(&path, &value, 0)?));
                }
            }
            _ => found.push(format!("{name}={}", toml(&name, &value, 0)?)),
        }
    }
    Ok(found)
}

fn text(key: &Bound<'_, PyAny>) -> PyResult<String> {
    match key.cast::<PyString>() {
        Ok(text) => Ok(text.to_str()?.to_owned()),
        Err(_) => Err(PyTypeError::new_err(format!(
            "a key of a scene is a text such as \"particles.count\", and {} is none",
            key.repr()?
        ))),
    }
}

/// A value as a scene has it: numbers to the bit.
fn toml(path: &str, value: &Bound<'_, PyAny>, depth: usize) -> PyResult<String> {
    let list = |items: Vec<Bound<'_, PyAny>>| {
        let items: PyResult<Vec<String>> = items.iter().map(|item| toml(path, item, depth + 1)).collect();
        Ok(format!("[{}]", items?.join(", ")))
    };
    if depth > DEEPEST {
        return Err(PyTypeError::new_err(format!("`{path}` holds lists within lists without end")));
    }
    if let Ok(switch) = value.cast::<PyBool>() {
        Ok(switch.is_true().to_string())
    } else if value.is_instance_of::<PyInt>() {
        // Enumerations of whole numbers print as something else.
        Ok(value.py().get_type::<PyInt>().call_method1("__repr__", (value,))?.extract()?)
    } else if let Ok(number) = value.cast::<PyFloat>() {
        Ok(of_number(number.value()))
    } else if let Ok(word) = value.cast::<PyString>() {
        Ok(quoted(word.to_str()?))
    } else if let Ok(items) = value.cast::<PyList>() {
        list(items.iter().collect())
    } else if let Ok(items) = value.cast::<PyTuple>() {
        list(items.iter().collect())
    } else if let Ok(fields) = value.cast::<PyDict>() {
        let field = |(name, value): (Bound<'_, PyAny>, Bound<'_, PyAny>)| {
            Ok(format!("{} = {}", quoted(&text(&name)?), toml(path, &value, depth + 1)?))
        };
        let fields: PyResult<Vec<String>> = fields.iter().map(field).collect();
        Ok(format!("{{ {} }}", fields?.join(", ")))
    } else if value.hasattr("tolist")? {
        // Arrays and numbers of numpy.
        toml(path, &value.call_method0("tolist")?, depth + 1)
    } else if value.hasattr("__fspath__")? {
        toml(path, &value.call_method0("__fspath__")?, depth + 1)
    } else {
        let kind = value.get_type().qualname()?;
        Err(PyTypeError::new_err(format!(
            "`{path}` cannot be of the type {kind}: numbers, texts, True and False, lists, dicts and arrays can stand in a scene"
        )))
    }
}

/// A number as TOML reads it, to the bit.
fn of_number(number: f64) -> String {
    match number {
        _ if number.is_nan() => "nan".to_owned(),
        _ if number.is_infinite() => if number > 0.0 { "inf" } else { "-inf" }.to_owned(),
        _ => format!("{number:?}"),
    }
}

/// A text in quotes: what JSON escapes, TOML reads as the same, but for the character that only JSON lets stand.
fn quoted(text: &str) -> String {
    Value::from(text).to_string().replace('\u{7f}', "\\u007f")
}
