//! Class `Simulation`: simulations advanced step by step.

use crate::checked::CheckedScene;
use crate::computing::computed;
use crate::exceptions;
use crate::interruption::beside;
use crate::particles::{self, Particles};
use crate::pulse::{self, BEAT};
use numpy::PyArray2;
use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, TryLockError};
use std::time::Instant;
use stripmine_physics::method::{self, PhysicsFailure, StartPurpose, Until, steps_over};
use stripmine_physics::structure::{StructureSetting, net_forces};

/// Running simulation, for one thread at a time. `Scene.start` makes it.
#[pyclass(frozen, module = "stripmine")]
pub(crate) struct Simulation {
    checked: Arc<CheckedScene>,
    state: Mutex<SimulationState>,
    /// Flag raised at every beat, so that Ctrl-C is handled.
    pause: Arc<AtomicBool>,
}

struct SimulationState {
    running: Box<dyn method::Simulation>,
    broken: Option<StopReason>,
    /// True if a step takes longer than a beat, so that it would never end between two.
    is_slow: bool,
    /// Sum of the times of the advances so far; none if the last one was by steps or events, or was interrupted.
    asked: Option<TimeSum>,
}

/// Compensated sum of times, so that advancing in pieces ends at the same time as advancing at once.
#[derive(Clone, Copy)]
struct TimeSum {
    sum: f64,
    rest: f64,
}

impl TimeSum {
    fn of(time: f64) -> TimeSum {
        TimeSum { sum: time, rest: 0.0 }
    }

    fn plus(self, time: f64) -> TimeSum {
        let [sum, lost] = two_sum(self.sum, time);
        let [sum, rest] = two_sum(sum, lost + self.rest);
        TimeSum { sum, rest }
    }
}

/// Sum of two numbers, and its rounding error.
fn two_sum(a: f64, b: f64) -> [f64; 2] {
    let sum = a + b;
    let of_b = sum - a;
    [sum, (a - (sum - of_b)) + (b - of_b)]
}

/// Reason why a simulation cannot continue.
enum StopReason {
    /// The physics failed.
    Failure(PhysicsFailure),
    /// The program panicked in a step.
    Fault,
}

impl SimulationState {
    /// Checks that it can continue.
    fn is_sound(&self, py: Python<'_>) -> PyResult<()> {
        match &self.broken {
            None => Ok(()),
            Some(StopReason::Failure(failure)) => Err(exceptions::of(py, failure)),
            Some(StopReason::Fault) => Err(exceptions::fault(py, "a step was not completed")),
        }
    }

    /// End of an advance by a distance, and the sum of times reached then.
    fn end_of(&self, distance: Until) -> (Until, Option<TimeSum>) {
        let clock = self.running.clock();
        let Until::Time(time) = distance else { return (distance.after(&clock), None) };
        let asked = self.asked.unwrap_or(TimeSum::of(clock.time)).plus(time);
        let end = match self.running.time_step() {
            Some(dt) => Until::Steps(steps_over(asked.sum, dt)),
            None => Until::Time(asked.sum),
        };
        (end, Some(asked))
    }

    /// Advances to the end, or until the flag is set.
    fn advance(&mut self, end: Until, interrupted: &AtomicBool) -> Result<(), PhysicsFailure> {
        let advanced = self.running.advance(&[end], interrupted);
        // Only runs write event rows; here they would accumulate.
        self.running.take_events();
        advanced
    }

    /// Advances to the end, or at most until the next beat.
    fn advance_for_a_beat(&mut self, py: Python<'_>, end: Until, pause: &AtomicBool) -> PyResult<()> {
        let from = self.running.clock();
        pause.store(false, Ordering::Relaxed);
        let advanced = computed(py, || self.advance(end, pause));
        self.settle(py, advanced)?;
        let clock = self.running.clock();
        self.is_slow = !end.has_been_reached(&clock) && clock == from;
        Ok(())
    }

    /// Advances to the end in a separate thread, while this one handles signals.
    fn advance_beside(&mut self, py: Python<'_>, end: Until) -> PyResult<()> {
        let begun = Instant::now();
        let done = computed(py, || beside(|interrupted| self.advance(end, interrupted)));
        let (advanced, signal) = match done {
            Ok(Ok((advanced, signal))) => (Ok(advanced), signal),
            Ok(Err(cause)) => return Err(exceptions::without_threads(py, &cause)),
            Err(fault) => (Err(fault), None),
        };
        self.is_slow &= begun.elapsed() > BEAT;
        self.settle(py, advanced)?;
        signal.map_or(Ok(()), Err)
    }

    /// Records a failure, after which the simulation cannot continue.
    fn settle(&mut self, py: Python<'_>, advanced: PyResult<Result<(), PhysicsFailure>>) -> PyResult<()> {
        match advanced {
            Ok(Ok(())) => Ok(()),
            Ok(Err(failure)) => {
                let error = exceptions::of(py, &failure);
                self.broken = Some(StopReason::Failure(failure));
                Err(error)
            }
            Err(fault) => {
                self.broken = Some(StopReason::Fault);
                Err(fault)
            }
        }
    }
}

impl Simulation {
    /// Starts a simulation.
    ///
    /// # Errors
    /// If the start breaks a precondition, or no thread can be started.
    pub(crate) fn start(py: Python<'_>, checked: Arc<CheckedScene>) -> PyResult<Simulation> {
        let running = computed(py, || checked.prepared.start(StartPurpose::Run))?;
        let running = running.map_err(|failure| exceptions::of(py, &failure))?;
        let pause = pulse::flag().map_err(|cause| exceptions::without_threads(py, &cause))?;
        Ok(Simulation {
            checked,
            state: Mutex::new(SimulationState { running, broken: None, is_slow: false, asked: None }),
            pause,
        })
    }

    /// Locks the state, unless another thread has it.
    fn state(&self, py: Python<'_>) -> PyResult<MutexGuard<'_, SimulationState>> {
        match self.state.try_lock() {
            Ok(state) => Ok(state),
            // After a panic, `broken` describes the state.
            Err(TryLockError::Poisoned(poisoned)) => Ok(poisoned.into_inner()),
            Err(TryLockError::WouldBlock) => Err(exceptions::busy(py)),
        }
    }

    /// Computes a value from the current state.
    fn look<R: Send>(&self, py: Python<'_>, of: impl FnOnce(&SimulationState) -> R + Send) -> PyResult<R> {
        let mut state = self.state(py)?;
        let state = &mut *state;
        computed(py, move || of(state))
    }

    /// Distance of an advance from its arguments.
    fn distance(&self, steps: Option<i64>, time: Option<f64>, events: Option<i64>) -> PyResult<Until> {
        let takes_steps = matches!(self.checked.prepared.schedule.until, Until::Steps(_));
        let method = self.checked.entry.vocabulary.keys.method;
        let whole = |name: &str, count: i64| {
            u64::try_from(count).map_err(|_| {
                PyValueError::new_err(format!("{name} cannot be {count}; expected a whole number, 0 or more"))
            })
        };
        match (steps, time, events) {
            (Some(_), None, None) if !takes_steps => {
                Err(PyValueError::new_err(format!("{method} has no steps: use time or events")))
            }
            (None, None, Some(_)) if takes_steps => {
                Err(PyValueError::new_err(format!("{method} has no events: use steps or time")))
            }
            (Some(steps), None, None) => Ok(Until::Steps(whole("steps", steps)?)),
            (None, None, Some(events)) => Ok(Until::Events(whole("events", events)?)),
            (None, Some(time), None) if time.is_finite() && time >= 0.0 => Ok(Until::Time(time)),
            (None, Some(time), None) => Err(PyValueError::new_err(format!(
                "time cannot be {time}; expected a finite number, 0 or more"
            ))),
            _ => Err(PyTypeError::new_err("advance takes exactly one of steps, time and events")),
        }
    }
}

#[pymethods]
impl Simulation {
    /// Advances by a number of steps, by a time (time), or by a number of events.
    ///
    /// Hard discs have no steps; they advance by a time, which is reached exactly, or by events. The other methods end with the first
    /// step that reaches the time. Times add up: any pieces give the same bits and number of steps as one. Other threads continue
    /// meanwhile. Ctrl-C ends the call, and the simulation can continue. A failed simulation raises the same error again.
    #[pyo3(signature = (*, steps = None, time = None, events = None))]
    fn advance(
        &self,
        py: Python<'_>,
        steps: Option<i64>,
        time: Option<f64>,
        events: Option<i64>,
    ) -> PyResult<()> {
        let distance = self.distance(steps, time, events)?;
        let mut state = self.state(py)?;
        state.is_sound(py)?;
        let (end, asked) = state.end_of(distance);
        // An interrupted advance forgets the rest of its time.
        state.asked = None;
        if !state.is_slow {
            state.advance_for_a_beat(py, end, &self.pause)?;
        }
        if !end.has_been_reached(&state.running.clock()) {
            py.check_signals()?;
            state.advance_beside(py, end)?;
        }
        state.asked = asked;
        Ok(())
    }

    /// Values of the quantities of the method, by name: the columns of `thermo.csv`. `compressibility` and `collision_rate` of hard discs
    /// are means since the start.
    fn observe<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let seen = self.look(py, |SimulationState { running, broken, .. }| {
            // The state of a failed step is not checked again.
            if broken.is_none() {
                running.check()?;
            }
            Ok(running.observe())
        })?;
        let values = seen.map_err(|failure: PhysicsFailure| exceptions::of(py, &failure))?;
        let seen = PyDict::new(py);
        for (quantity, value) in self.checked.quantities().iter().zip(values) {
            seen.set_item(quantity.name, value)?;
        }
        Ok(seen)
    }

    /// Units of the quantities, by name; empty for pure numbers.
    #[getter]
    fn units<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let units = PyDict::new(py);
        for quantity in self.checked.quantities() {
            units.set_item(quantity.name, quantity.unit)?;
        }
        Ok(units)
    }

    /// Current particles, positions inside the box.
    fn particles(&self, py: Python<'_>) -> PyResult<Particles> {
        let particles = self.look(py, |state| state.running.particles())?;
        Particles::of(py, particles.all(), self.checked.dimensions)
    }

    /// Sum of the pair forces on each particle, shape (N, 2) (force), in the order of `particles()`.
    ///
    /// Excludes gravity, the bath and closed sides. Hard discs and bodies have no such forces.
    fn forces(&self, py: Python<'_>) -> PyResult<Py<PyArray2<f64>>> {
        let prepared = &self.checked.prepared;
        let Some(forces) = prepared.model.pair_forces() else {
            let method = self.checked.entry.vocabulary.keys.method;
            let message = format!("{method} has no continuous pair forces");
            return Err(exceptions::refused(py, message));
        };
        let sums = self.look(py, |state| {
            let particles = state.running.particles();
            if forces.reach == 0.0 {
                return vec![[0.0; 2]; particles.len()];
            }
            net_forces(&StructureSetting::new(prepared.domain, &particles), particles.all(), &forces)
        })?;
        particles::rows(py, sums.concat(), 2)
    }

    /// Warnings about suspicious events so far.
    fn warnings(&self, py: Python<'_>) -> PyResult<Vec<String>> {
        let warnings = self.look(py, |state| state.running.warnings())?;
        Ok(warnings.into_iter().map(|warning| warning.message).collect())
    }

    /// Time since the start (time).
    #[getter]
    fn time(&self, py: Python<'_>) -> PyResult<f64> {
        Ok(self.state(py)?.running.clock().time)
    }

    /// Steps since the start; 0 if the method has none.
    #[getter]
    fn step(&self, py: Python<'_>) -> PyResult<u64> {
        Ok(self.state(py)?.running.clock().steps)
    }

    /// Events since the start; 0 if the method has none.
    #[getter]
    fn events(&self, py: Python<'_>) -> PyResult<u64> {
        Ok(self.state(py)?.running.clock().events)
    }

    fn __repr__(&self) -> String {
        let method = self.checked.entry.vocabulary.keys.method;
        match self.state.try_lock() {
            Ok(state) => format!("<Simulation: {method}, {}>", state.running.clock()),
            Err(_) => format!("<Simulation: {method}, running>"),
        }
    }
}
