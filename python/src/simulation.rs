//! A simulation that is advanced step by step.

use crate::checked::Checked;
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
use stripmine_physics::method::{self, Failure, Purpose, Until, steps_over};
use stripmine_physics::structure::{Setting, net_forces};

/// A simulation under way, for one thread at a time. `Scene.start` makes it.
#[pyclass(frozen, module = "stripmine")]
pub(crate) struct Simulation {
    checked: Arc<Checked>,
    state: Mutex<State>,
    /// Raised at every beat, so that Ctrl-C is answered.
    pause: Arc<AtomicBool>,
}

struct State {
    running: Box<dyn method::Simulation>,
    broken: Option<Broken>,
    /// Whether a step takes longer than a beat: it would not come to its end between two.
    is_slow: bool,
    /// The time that the advances by a time so far add up to; none where the last one was by something else, or did not come to its end.
    asked: Option<TimeSum>,
}

/// A sum of times, and the rounding that it lacks: a time in pieces ends where it does at once.
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

/// The sum of two numbers, and what rounding took from it.
fn two_sum(a: f64, b: f64) -> [f64; 2] {
    let sum = a + b;
    let of_b = sum - a;
    [sum, (a - (sum - of_b)) + (b - of_b)]
}

/// Why it does not go on.
enum Broken {
    /// The physics.
    Failure(Failure),
    /// The program, in the midst of a step.
    Fault,
}

impl State {
    /// That it may go on.
    fn is_sound(&self, py: Python<'_>) -> PyResult<()> {
        match &self.broken {
            None => Ok(()),
            Some(Broken::Failure(failure)) => Err(exceptions::of(py, failure)),
            Some(Broken::Fault) => Err(exceptions::fault(py, "a step was left half done")),
        }
    }

    /// End of an advance by a distance, and the sum of times that is then reached.
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

    /// Goes on until the end has come, or a flag is set.
    fn advance(&mut self, end: Until, interrupted: &AtomicBool) -> Result<(), Failure> {
        let advanced = self.running.advance(&[end], interrupted);
        // Only runs write rows of events; here they would pile up.
        self.running.take_events();
        advanced
    }

    /// Goes on until the end has come, or at most until the next beat.
    fn advance_for_a_beat(&mut self, py: Python<'_>, end: Until, pause: &AtomicBool) -> PyResult<()> {
        let from = self.running.clock();
        pause.store(false, Ordering::Relaxed);
        let advanced = computed(py, || self.advance(end, pause));
        self.settle(py, advanced)?;
        let clock = self.running.clock();
        self.is_slow = !end.has_come(&clock) && clock == from;
        Ok(())
    }

    /// Goes on until the end has come, in a thread of its own, while this one answers signals.
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

    /// Notes what does not go on.
    fn settle(&mut self, py: Python<'_>, advanced: PyResult<Result<(), Failure>>) -> PyResult<()> {
        match advanced {
            Ok(Ok(())) => Ok(()),
            Ok(Err(failure)) => {
                let error = exceptions::of(py, &failure);
                self.broken = Some(Broken::Failure(failure));
                Err(error)
            }
            Err(fault) => {
                self.broken = Some(Broken::Fault);
                Err(fault)
            }
        }
    }
}

impl Simulation {
    /// Begins.
    ///
    /// # Errors
    /// If the start breaks a precondition, or the system gives no thread.
    pub(crate) fn start(py: Python<'_>, checked: Arc<Checked>) -> PyResult<Simulation> {
        let running = computed(py, || checked.prepared.start(Purpose::Run))?;
        let running = running.map_err(|failure| exceptions::of(py, &failure))?;
        let pause = pulse::flag().map_err(|cause| exceptions::without_threads(py, &cause))?;
        Ok(Simulation {
            checked,
            state: Mutex::new(State { running, broken: None, is_slow: false, asked: None }),
            pause,
        })
    }

    /// The state, unless another thread has it.
    fn state(&self, py: Python<'_>) -> PyResult<MutexGuard<'_, State>> {
        match self.state.try_lock() {
            Ok(state) => Ok(state),
            // What panics while it has the state leaves it as it says itself.
            Err(TryLockError::Poisoned(poisoned)) => Ok(poisoned.into_inner()),
            Err(TryLockError::WouldBlock) => Err(exceptions::busy(py)),
        }
    }

    /// Looks at the state as it stands.
    fn look<R: Send>(&self, py: Python<'_>, of: impl FnOnce(&State) -> R + Send) -> PyResult<R> {
        let mut state = self.state(py)?;
        let state = &mut *state;
        computed(py, move || of(state))
    }

    /// How far to go.
    fn distance(&self, steps: Option<i64>, time: Option<f64>, events: Option<i64>) -> PyResult<Until> {
        let takes_steps = matches!(self.checked.prepared.schedule.until, Until::Steps(_));
        let method = self.checked.entry.vocabulary.keys.method;
        let whole = |name: &str, count: i64| {
            u64::try_from(count).map_err(|_| {
                PyValueError::new_err(format!("{name} cannot be {count}: a whole number, 0 or more"))
            })
        };
        match (steps, time, events) {
            (Some(_), None, None) if !takes_steps => {
                Err(PyValueError::new_err(format!("{method} takes no steps: give time or events")))
            }
            (None, None, Some(_)) if takes_steps => {
                Err(PyValueError::new_err(format!("{method} has no events: give steps or time")))
            }
            (Some(steps), None, None) => Ok(Until::Steps(whole("steps", steps)?)),
            (None, None, Some(events)) => Ok(Until::Events(whole("events", events)?)),
            (None, Some(time), None) if time.is_finite() && time >= 0.0 => Ok(Until::Time(time)),
            (None, Some(time), None) => {
                Err(PyValueError::new_err(format!("time cannot be {time}: a finite number, 0 or more")))
            }
            _ => Err(PyTypeError::new_err("advance takes one of steps, time and events")),
        }
    }
}

#[pymethods]
impl Simulation {
    /// Goes on by a number of steps, by a time (time), or by a number of events.
    ///
    /// Hard discs take no steps, and are advanced by a time, which is met exactly, or by events; the other methods come to the end of the
    /// first step at which the time is over. Times add up: any pieces give the bits, and the number of steps, of one. Other threads go on
    /// meanwhile; Ctrl-C ends it, and the simulation may go on then. What has failed does not go on: the same error is raised again.
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
        // What is cut off is not asked for any more.
        state.asked = None;
        if !state.is_slow {
            state.advance_for_a_beat(py, end, &self.pause)?;
        }
        if !end.has_come(&state.running.clock()) {
            py.check_signals()?;
            state.advance_beside(py, end)?;
        }
        state.asked = asked;
        Ok(())
    }

    /// A value for each quantity that the method observes, by name: the columns of `thermo.csv`. `compressibility` and `collision_rate` of hard discs are means since the start.
    fn observe<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let seen = self.look(py, |State { running, broken, .. }| {
            // The state of a failed step is seen as it is.
            if broken.is_none() {
                running.check()?;
            }
            Ok(running.observe())
        })?;
        let values = seen.map_err(|failure: Failure| exceptions::of(py, &failure))?;
        let seen = PyDict::new(py);
        for (quantity, value) in self.checked.entry.quantities.iter().zip(values) {
            seen.set_item(quantity.name, value)?;
        }
        Ok(seen)
    }

    /// The unit of each quantity, by name; empty for pure numbers.
    #[getter]
    fn units<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let units = PyDict::new(py);
        for quantity in self.checked.entry.quantities {
            units.set_item(quantity.name, quantity.unit)?;
        }
        Ok(units)
    }

    /// The particles as they stand, positions inside the box.
    fn particles(&self, py: Python<'_>) -> PyResult<Particles> {
        let particles = self.look(py, |state| state.running.particles())?;
        Particles::of(py, particles.all(), self.checked.dimensions)
    }

    /// The sum of the forces that pairs exert on each particle, shape (N, 2) (force), in the order of `particles()`.
    ///
    /// Gravity, a bath and closed sides are no pairs. Hard discs and bodies have no such forces.
    fn forces(&self, py: Python<'_>) -> PyResult<Py<PyArray2<f64>>> {
        let prepared = &self.checked.prepared;
        let Some(forces) = prepared.model.pair_forces() else {
            let method = self.checked.entry.vocabulary.keys.method;
            let message = format!("{method} has no forces between discs that act at any moment");
            return Err(exceptions::refused(py, message));
        };
        let sums = self.look(py, |state| {
            let particles = state.running.particles();
            if forces.reach == 0.0 {
                return vec![[0.0; 2]; particles.len()];
            }
            net_forces(&Setting::new(prepared.domain, &particles), particles.all(), &forces)
        })?;
        particles::rows(py, sums.concat(), 2)
    }

    /// What seldom means well and has happened on the way.
    fn warnings(&self, py: Python<'_>) -> PyResult<Vec<String>> {
        let warnings = self.look(py, |state| state.running.warnings())?;
        Ok(warnings.into_iter().map(|warning| warning.message).collect())
    }

    /// Time since the start (time).
    #[getter]
    fn time(&self, py: Python<'_>) -> PyResult<f64> {
        Ok(self.state(py)?.running.clock().time)
    }

    /// Steps since the start; 0 where a method takes none.
    #[getter]
    fn step(&self, py: Python<'_>) -> PyResult<u64> {
        Ok(self.state(py)?.running.clock().steps)
    }

    /// Events since the start; 0 where a method has none.
    #[getter]
    fn events(&self, py: Python<'_>) -> PyResult<u64> {
        Ok(self.state(py)?.running.clock().events)
    }

    fn __repr__(&self) -> String {
        let method = self.checked.entry.vocabulary.keys.method;
        match self.state.try_lock() {
            Ok(state) => format!("<Simulation: {method}, {}>", state.running.clock()),
            Err(_) => format!("<Simulation: {method}, under way>"),
        }
    }
}
