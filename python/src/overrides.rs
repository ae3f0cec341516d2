//! Python dicts as overrides `section.key=value`. Arrays of numbers are passed as they are, without a text in between.

use numpy::{PyArrayDyn, PyArrayMethods, PyUntypedArrayMethods};
use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;
use pyo3::types::{PyBool, PyDict, PyFloat, PyInt, PyList, PyString, PyTuple};
use serde_json::Value;
use stripmine_physics::scene::NumberArray;

/// Deepest nesting of lists.
const DEEPEST: usize = 8;

/// Overrides of a scene.
#[derive(Clone, Default)]
pub(crate) struct GivenOverrides {
    /// Overrides as texts.
    pub(crate) texts: Vec<String>,
    /// Arrays by their keys.
    pub(crate) arrays: Vec<(String, NumberArray)>,
}

impl GivenOverrides {
    fn add(&mut self, path: String, value: &Bound<'_, PyAny>) -> PyResult<()> {
        match array(value)? {
            Some(array) => self.arrays.push((path, array)),
            None => self.texts.push(format!("{path}={}", toml(&path, value, 0)?)),
        }
        Ok(())
    }
}

/// Numbers of a numpy array of floats or integers; none for anything else, and for a single number.
fn array(value: &Bound<'_, PyAny>) -> PyResult<Option<NumberArray>> {
    let is_array = value.hasattr("dtype")? && value.hasattr("astype")?;
    if !is_array || value.getattr("ndim")?.extract::<usize>()? == 0 {
        return Ok(None);
    }
    let kind: String = value.getattr("dtype")?.getattr("kind")?.extract()?;
    if !["f", "i", "u"].contains(&kind.as_str()) {
        return Ok(None);
    }
    let numbers = value.call_method1("astype", ("float64", "C"))?;
    let numbers = numbers.cast_into::<PyArrayDyn<f64>>()?;
    Ok(Some(NumberArray { shape: numbers.shape().to_vec(), numbers: numbers.to_vec()? }))
}

/// Converts to overrides a dict with keys `section.key`, a dict of sections with dicts of keys, or a list of strings.
///
/// # Errors
/// `TypeError` if a key is not a string, or a value has no form in a scene.
pub(crate) fn overrides(given: &Bound<'_, PyAny>) -> PyResult<GivenOverrides> {
    let mut found = GivenOverrides::default();
    let Ok(given) = given.cast::<PyDict>() else {
        found.texts = given.extract()?;
        return Ok(found);
    };
    for (name, value) in given {
        let name = text(&name)?;
        match value.cast::<PyDict>() {
            Ok(section) if !name.contains('.') => {
                for (key, value) in section {
                    found.add(format!("{name}.{}", text(&key)?), &value)?;
                }
            }
            _ => found.add(name, &value)?,
        }
    }
    Ok(found)
}

fn text(key: &Bound<'_, PyAny>) -> PyResult<String> {
    match key.cast::<PyString>() {
        Ok(text) => Ok(text.to_str()?.to_owned()),
        Err(_) => Err(PyTypeError::new_err(format!(
            "{} is not a scene key; expected a string such as \"particles.count\"",
            key.repr()?
        ))),
    }
}

/// Formats a value as TOML, numbers exact to the bit.
fn toml(path: &str, value: &Bound<'_, PyAny>, depth: usize) -> PyResult<String> {
    let list = |items: Vec<Bound<'_, PyAny>>| {
        let items: PyResult<Vec<String>> = items.iter().map(|item| toml(path, item, depth + 1)).collect();
        Ok(format!("[{}]", items?.join(", ")))
    };
    if depth > DEEPEST {
        return Err(PyTypeError::new_err(format!("`{path}` has lists nested too deeply")));
    }
    if let Ok(switch) = value.cast::<PyBool>() {
        Ok(switch.is_true().to_string())
    } else if value.is_instance_of::<PyInt>() {
        // The `__repr__` of int itself: integer enumerations print their names.
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
        // numpy arrays and scalars.
        toml(path, &value.call_method0("tolist")?, depth + 1)
    } else if value.hasattr("__fspath__")? {
        toml(path, &value.call_method0("__fspath__")?, depth + 1)
    } else {
        let kind = value.get_type().qualname()?;
        Err(PyTypeError::new_err(format!(
            "`{path}` cannot be of type {kind}; expected a number, string, bool, list, dict or array"
        )))
    }
}

/// Formats a number for TOML, exact to the bit.
fn of_number(number: f64) -> String {
    match number {
        _ if number.is_nan() => "nan".to_owned(),
        _ if number.is_infinite() => if number > 0.0 { "inf" } else { "-inf" }.to_owned(),
        _ => format!("{number:?}"),
    }
}

/// Quotes a string for TOML. JSON's escapes are valid TOML, except for DEL, which JSON leaves unescaped.
fn quoted(text: &str) -> String {
    Value::from(text).to_string().replace('\u{7f}', "\\u007f")
}
