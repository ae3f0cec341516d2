//! Values of Python as changes of a running simulation.

use crate::exceptions;
use numpy::{PyArrayDyn, PyArrayMethods, PyUntypedArrayMethods};
use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use stripmine_physics::method::{Change, SteeredQuantity};
use stripmine_physics::words::Words;

/// Changes of keyword arguments, in their order, for a number of particles in some dimensions, and a number of walls.
///
/// # Errors
/// `TypeError` for another keyword or a value that is no number; `Error` for another shape.
pub(crate) fn changes(
    given: &Bound<'_, PyDict>,
    particles: usize,
    dimensions: usize,
    walls: usize,
) -> PyResult<Vec<Change>> {
    let py = given.py();
    let to_numbers = py.import("numpy")?.getattr("array")?;
    let mut changes = vec![];
    for (name, value) in given.iter().filter(|(_, value)| !value.is_none()) {
        let name: String = name.extract()?;
        let Some(quantity) = SteeredQuantity::parse(&name) else {
            let known = SteeredQuantity::WORDS.join(", ");
            return Err(PyTypeError::new_err(format!("set has no quantity {name}; expected one of {known}")));
        };
        let numbers = to_numbers.call1((value, "float64"))?.cast_into::<PyArrayDyn<f64>>()?;
        let expected = quantity.shape(particles, dimensions, walls);
        if numbers.shape() != expected {
            let [found, expected] = [numbers.shape(), &expected].map(shape);
            let message =
                format!("{name} has the shape {found}\n  help: give an array of the shape {expected}");
            return Err(exceptions::refused(py, message));
        }
        // In C order, whatever the order in memory.
        let values = numbers.to_owned_array().iter().copied().collect();
        changes.push(Change { quantity, values });
    }
    Ok(changes)
}

/// Shape as Python writes it.
fn shape(lengths: &[usize]) -> String {
    match lengths {
        [length] => format!("({length},)"),
        _ => format!("({})", lengths.iter().map(usize::to_string).collect::<Vec<_>>().join(", ")),
    }
}
