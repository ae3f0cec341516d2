//! A scene of a study that runs: by its preset and overrides, and seen by the names of what is observed.

use crate::study::StudyError;
use std::sync::atomic::AtomicBool;
use stripmine_physics::domain::Domain;
use stripmine_physics::method::observed::{UnknownName, observed};
use stripmine_physics::method::{self, Entry, METHODS, Prepared, Purpose, Quantity, Simulation, Until, load};

/// A preset with overrides.
///
/// # Errors
/// [`StudyError`] if the scene is bad.
pub fn prepared(preset: &str, overrides: &[String]) -> Result<Prepared, StudyError> {
    Ok(load(preset, overrides, METHODS)?.0)
}

/// Does something on a number of threads.
///
/// # Errors
/// [`StudyError`] if they cannot be had, or what is done fails.
pub fn on_threads<T: Send>(
    threads: usize,
    work: impl FnOnce() -> Result<T, StudyError> + Send,
) -> Result<T, StudyError> {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
    pool.map_err(StudyError::Threads)?.install(work)
}

/// A scene that runs.
pub struct Running {
    /// The simulation, as it stands.
    pub simulation: Box<dyn Simulation>,
    /// The box.
    pub domain: Domain,
    quantities: &'static [Quantity],
}

impl Running {
    /// A preset with overrides, at its start, to be observed.
    ///
    /// # Errors
    /// [`StudyError`] if the scene is bad, or the processor lacks what it asks for.
    pub fn begin(preset: &str, overrides: &[String]) -> Result<Running, StudyError> {
        let (prepared, method) = load(preset, overrides, METHODS)?;
        Running::of(method, &prepared, Purpose::Run)
    }

    /// A preset with overrides, at its start, of which nothing is followed that the motion does not need.
    ///
    /// # Errors
    /// As of [`begin`](Self::begin).
    pub fn timed(preset: &str, overrides: &[String]) -> Result<Running, StudyError> {
        let (prepared, method) = load(preset, overrides, METHODS)?;
        Running::of(method, &prepared, Purpose::Measurement)
    }

    /// A scene of a method, at its start.
    ///
    /// # Errors
    /// [`StudyError`] if the processor or the memory lacks what it asks for.
    pub fn of(method: &'static Entry, prepared: &Prepared, purpose: Purpose) -> Result<Running, StudyError> {
        prepared.memory.fits("scene")?;
        let (simulation, domain) = (prepared.start(purpose)?, prepared.domain);
        Ok(Running { simulation, domain, quantities: method.quantities })
    }

    /// Goes on for some steps.
    ///
    /// # Errors
    /// [`method::Failure`] if the physics breaks.
    pub fn steps(&mut self, steps: u64) -> Result<(), method::Failure> {
        self.until(Until::Steps(steps).after(&self.simulation.clock()))
    }

    /// Lets some events happen.
    ///
    /// # Errors
    /// [`method::Failure`] if the physics breaks.
    pub fn events(&mut self, events: u64) -> Result<(), method::Failure> {
        self.until(Until::Events(events).after(&self.simulation.clock()))
    }

    /// Goes on until a moment has come.
    ///
    /// # Errors
    /// [`method::Failure`] if the physics breaks.
    pub fn until(&mut self, moment: Until) -> Result<(), method::Failure> {
        self.simulation.advance(&[moment], &AtomicBool::new(false))
    }

    /// What is observed now, by its name.
    ///
    /// # Errors
    /// [`UnknownName`] if it is not observed.
    pub fn observed<const N: usize>(&self, names: [&str; N]) -> Result<[f64; N], UnknownName> {
        observed(self.quantities, &self.simulation.observe(), names)
    }
}
