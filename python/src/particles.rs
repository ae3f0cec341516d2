//! Particles as numpy arrays.

use crate::pickling::class_of_attributes;
use numpy::{PyArray1, PyArray2, PyArrayMethods};
use pyo3::prelude::*;
use stripmine_physics::particles::{self, Particle, ParticleKind};

class_of_attributes! {
    /// Particles at one time, as arrays: moving particles first, then wall discs. N is their number; D is 2, or 3 for bodies in space.
    Particles, made again by _particles {
        /// Unique, permanent number of each particle; shape (N,).
        id: Py<PyArray1<u32>>,
        /// True for wall discs, which no force moves; shape (N,).
        wall: Py<PyArray1<bool>>,
        /// Centres (length), shape (N, D).
        positions: Py<PyArray2<f64>>,
        /// Velocities (length/time), shape (N, D).
        velocities: Py<PyArray2<f64>>,
        /// Angles (radian), counter-clockwise, shape (N,); 0 in frames, which store none.
        angle: Py<PyArray1<f64>>,
        /// Angular velocities (1/time), counter-clockwise, shape (N,).
        angular_velocity: Py<PyArray1<f64>>,
        /// Radii (length), shape (N,).
        radius: Py<PyArray1<f64>>,
        /// Masses (mass), shape (N,).
        mass: Py<PyArray1<f64>>,
    }
}

impl Particles {
    /// Arrays of particles in a number of dimensions.
    ///
    /// # Errors
    /// If memory is short.
    pub(crate) fn of(py: Python<'_>, all: &[Particle], dimensions: usize) -> PyResult<Particles> {
        let vectors = |of: fn(&Particle) -> [f64; 3]| {
            rows(py, all.iter().flat_map(|it| of(it).into_iter().take(dimensions)).collect(), dimensions)
        };
        let numbers = |of: fn(&Particle) -> f64| column(py, all.iter().map(of).collect());
        Ok(Particles {
            id: column(py, all.iter().map(|it| it.id).collect()),
            wall: column(py, all.iter().map(|it| it.kind == ParticleKind::Wall).collect()),
            positions: vectors(|it| it.position)?,
            velocities: vectors(|it| it.velocity)?,
            angle: numbers(|it| it.angle),
            angular_velocity: numbers(|it| it.omega),
            radius: numbers(|it| it.radius),
            mass: numbers(|it| it.mass),
        })
    }
}

#[pymethods]
impl Particles {
    fn __len__(&self, py: Python<'_>) -> PyResult<usize> {
        self.id.bind(py).len()
    }

    fn __repr__(&self, py: Python<'_>) -> PyResult<String> {
        Ok(format!("<Particles: {}>", self.__len__(py)?))
    }
}

/// Dimensions in which particles move: 2 if no third coordinate or velocity is nonzero, and then it stays so.
pub(crate) fn dimensions(particles: &particles::Particles) -> usize {
    let is_planar = |it: &Particle| it.position[2] == 0.0 && it.velocity[2] == 0.0;
    if particles.all().iter().all(is_planar) { 2 } else { 3 }
}

/// Array of rows of `width` numbers.
///
/// # Errors
/// If memory is short.
pub(crate) fn rows(py: Python<'_>, numbers: Vec<f64>, width: usize) -> PyResult<Py<PyArray2<f64>>> {
    let count = numbers.len() / width;
    Ok(PyArray1::from_vec(py, numbers).reshape([count, width])?.unbind())
}

fn column<T: numpy::Element>(py: Python<'_>, values: Vec<T>) -> Py<PyArray1<T>> {
    PyArray1::from_vec(py, values).unbind()
}
