//! Frames of a trajectory, read one at a time.

use crate::exceptions;
use crate::particles::{Particles, dimensions};
use crate::pickling::class_of_attributes;
use crate::scratch::Scratch;
use pyo3::prelude::*;
use std::path::Path;
use std::sync::{Arc, Mutex, PoisonError};
use stripmine_physics::io::extxyz;
use stripmine_physics::io::trajectory::{Trajectory, TrajectoryError};
use stripmine_physics::reported::ErrorClass;

class_of_attributes! {
    /// Particles in their box at one time.
    Frame, made again by _frame {
        /// Time since the start (time).
        time: f64,
        /// Steps since the start; for hard discs the number of events.
        step: u64,
        /// The particles.
        particles: Py<Particles>,
        /// Sides of the box along x and y (length); infinite without a box.
        sides: [f64; 2],
        /// Lower left corner of the box (length).
        origin: [f64; 2],
        /// True where the box is periodic, along x and along y.
        periodic: Option<[bool; 2]>,
    }
}

#[pymethods]
impl Frame {
    fn __repr__(&self, py: Python<'_>) -> PyResult<String> {
        let count = self.particles.bind(py).len()?;
        Ok(format!("<Frame: step {}, time {:?}, {count} particles>", self.step, self.time))
    }
}

/// Frames of a trajectory, each read when it is requested.
#[pyclass(frozen, module = "stripmine")]
pub(crate) struct Frames {
    reading: Mutex<TrajectoryReading>,
    /// Keeps a temporary folder alive while it is read.
    _scratch: Option<Arc<Scratch>>,
}

struct TrajectoryReading {
    frames: Trajectory,
    /// Dimensions in which the particles of the first frame move.
    dimensions: Option<usize>,
}

impl Frames {
    /// Opens the trajectory of the run in a folder.
    ///
    /// # Errors
    /// If it cannot be read.
    pub(crate) fn open(py: Python<'_>, folder: &Path, scratch: Option<Arc<Scratch>>) -> PyResult<Frames> {
        let frames = Trajectory::open(folder).map_err(|error| wrong(py, &error))?;
        let reading = Mutex::new(TrajectoryReading { frames, dimensions: None });
        Ok(Frames { reading, _scratch: scratch })
    }
}

fn wrong(py: Python<'_>, error: &TrajectoryError) -> PyErr {
    exceptions::of_file(py, ErrorClass::Input, &error.words, &error.file)
}

#[pymethods]
impl Frames {
    fn __iter__(slf: PyRef<'_, Self>) -> PyRef<'_, Self> {
        slf
    }

    fn __next__(&self, py: Python<'_>) -> PyResult<Option<Frame>> {
        let next = py.detach(|| {
            let mut reading = self.reading.lock().unwrap_or_else(PoisonError::into_inner);
            let TrajectoryReading { frames, dimensions: known } = &mut *reading;
            let frame = frames.next()?;
            Some(frame.map(|frame| (*known.get_or_insert_with(|| dimensions(&frame.particles)), frame)))
        });
        let Some(frame) = next else { return Ok(None) };
        let (dimensions, frame) = frame.map_err(|error| wrong(py, &error))?;
        let extxyz::ParticleFrame { particles, cell, origin, periodic, time, step, .. } = frame;
        let particles = Py::new(py, Particles::of(py, particles.all(), dimensions)?)?;
        Ok(Some(Frame { time, step, particles, sides: cell, origin, periodic }))
    }
}
