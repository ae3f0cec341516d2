//! Class `Simulation`: simulations advanced step by step.

use crate::checked::{CheckedScene, SceneSource};
use crate::computing::computed;
use crate::exceptions;
use crate::interruption::beside;
use crate::overrides::GivenOverrides;
use crate::particles::{self, Particles};
use crate::pulse::{self, BEAT};
use crate::run::Run;
use crate::running::{built, existing, warn};
use crate::steering::changes;
use numpy::PyArray2;
use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, TryLockError};
use std::time::Instant;
use stripmine_physics::method::{self, PhysicsFailure, StartPurpose, SteeringError, Until, steps_over};
use stripmine_physics::origin::Origin;
use stripmine_physics::reported::Reported;
use stripmine_physics::run::{ExistingRun, RunInProgress, RunJob};
use stripmine_physics::structure::{StructureSetting, net_forces};

/// Running simulation, for one thread at a time. `Scene.start` and `Simulation.restore` make it.
#[pyclass(frozen, module = "stripmine")]
pub(crate) struct Simulation {
    checked: Arc<CheckedScene>,
    /// Folder of its run, if it is recorded.
    folder: Option<PathBuf>,
    state: Mutex<SimulationState>,
    /// Flag raised at every beat, so that Ctrl-C is handled.
    pause: Arc<AtomicBool>,
}

struct SimulationState {
    running: Box<dyn method::Simulation>,
    /// Record in the folder, if there is one.
    record: Option<RunInProgress>,
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
    /// The physics, or a file of the run, failed.
    Failure(Box<dyn Reported>),
    /// The run is finished.
    Finished,
    /// The program panicked in a step.
    Fault,
}

impl SimulationState {
    /// Checks that it can continue.
    fn is_sound(&self, py: Python<'_>) -> PyResult<()> {
        match &self.broken {
            None => Ok(()),
            Some(StopReason::Failure(failure)) => Err(exceptions::of(py, failure.as_ref())),
            Some(StopReason::Finished) => {
                let message = "the run is finished\n  help: continue it with scene.start(out, resume=True)";
                Err(exceptions::refused(py, message))
            }
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
    fn advance(
        &mut self,
        checked: &CheckedScene,
        end: Until,
        interrupted: &AtomicBool,
    ) -> Result<(), Box<dyn Reported>> {
        let Some(record) = &mut self.record else {
            let advanced = self.running.advance(&[end], interrupted);
            // Only runs write event rows; here they would accumulate.
            self.running.take_events();
            return advanced.map_err(|failure| Box::new(failure) as Box<dyn Reported>);
        };
        let program = built();
        let job = job(checked, &program);
        while !(end.has_been_reached(&self.running.clock()) || interrupted.load(Ordering::Relaxed)) {
            let advanced = record.advance(&job, self.running.as_mut(), &[end], interrupted);
            advanced.map_err(|error| Box::new(error) as Box<dyn Reported>)?;
        }
        Ok(())
    }

    /// Advances to the end, or at most until the next beat.
    fn advance_for_a_beat(
        &mut self,
        py: Python<'_>,
        checked: &CheckedScene,
        end: Until,
        pause: &AtomicBool,
    ) -> PyResult<()> {
        let from = self.running.clock();
        pause.store(false, Ordering::Relaxed);
        let advanced = computed(py, || self.advance(checked, end, pause));
        self.settle(py, advanced)?;
        let clock = self.running.clock();
        self.is_slow = !end.has_been_reached(&clock) && clock == from;
        Ok(())
    }

    /// Advances to the end in a separate thread, while this one handles signals.
    fn advance_beside(&mut self, py: Python<'_>, checked: &CheckedScene, end: Until) -> PyResult<()> {
        let begun = Instant::now();
        let done = computed(py, || beside(|interrupted| self.advance(checked, end, interrupted)));
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
    fn settle<R>(&mut self, py: Python<'_>, done: PyResult<Result<R, Box<dyn Reported>>>) -> PyResult<R> {
        match done {
            Ok(Ok(done)) => Ok(done),
            Ok(Err(failure)) => {
                let error = exceptions::of(py, failure.as_ref());
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
        Simulation::of(py, checked, running, None)
    }

    /// Starts a simulation that is recorded as a run in a folder, or resumes that run.
    ///
    /// # Errors
    /// As of [`start`](Self::start), and if the folder cannot be used.
    pub(crate) fn recorded(
        py: Python<'_>,
        checked: Arc<CheckedScene>,
        folder: PathBuf,
        existing: ExistingRun,
    ) -> PyResult<Simulation> {
        let folder = std::path::absolute(&folder).unwrap_or(folder);
        let (program, mut notes) = (built(), vec![]);
        let notice = |note: &str| notes.push(note.to_owned());
        let opened =
            computed(py, || RunInProgress::open(&mut job(&checked, &program), &folder, existing, notice))?;
        let (record, running) = opened.map_err(|error| exceptions::of(py, &error))?;
        warn(py, notes)?;
        Simulation::of(py, checked, running, Some((folder, record)))
    }

    fn of(
        py: Python<'_>,
        checked: Arc<CheckedScene>,
        running: Box<dyn method::Simulation>,
        record: Option<(PathBuf, RunInProgress)>,
    ) -> PyResult<Simulation> {
        let pause = pulse::flag().map_err(|cause| exceptions::without_threads(py, &cause))?;
        let (folder, record) = record.unzip();
        let state = SimulationState { running, record, broken: None, is_slow: false, asked: None };
        Ok(Simulation { checked, folder, state: Mutex::new(state), pause })
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

/// Job of a run that is advanced piece by piece.
fn job<'j>(checked: &'j CheckedScene, program: &'j Origin) -> RunJob<'j> {
    let quantities = checked.quantities();
    RunJob { prepared: (&checked.prepared).into(), quantities, program, is_open_ended: true }
}

#[pymethods]
impl Simulation {
    /// Restores a simulation from the newest checkpoint of a folder, which `save`, a run, or a recorded simulation has written.
    ///
    /// Nothing is written to the folder, and any number can be restored. `other_version` also restores one of another version.
    #[staticmethod]
    #[pyo3(signature = (folder, *, other_version = false))]
    fn restore(py: Python<'_>, folder: PathBuf, other_version: bool) -> PyResult<Simulation> {
        let source = SceneSource::Named(folder.join("scene.toml").display().to_string());
        let read = computed(py, || source.values(&GivenOverrides::default()).and_then(CheckedScene::of))?;
        let checked = Arc::new(read.map_err(|mistakes| exceptions::of(py, &mistakes))?);
        let program = built();
        let restored =
            computed(py, || RunInProgress::restored(&mut job(&checked, &program), &folder, other_version))?;
        let running = restored.map_err(|error| exceptions::of(py, &error))?;
        Simulation::of(py, checked, running, None)
    }

    /// Folder of its run, as an absolute path; none if it is not recorded.
    #[getter]
    fn folder(&self) -> Option<&Path> {
        self.folder.as_deref()
    }

    /// Writes a checkpoint: of a recorded simulation into its own folder, of any other into `folder`.
    #[pyo3(signature = (folder = None, *, overwrite = false))]
    fn save(&self, py: Python<'_>, folder: Option<PathBuf>, overwrite: bool) -> PyResult<()> {
        let mut state = self.state(py)?;
        state.is_sound(py)?;
        let SimulationState { running, record, .. } = &mut *state;
        let (checked, program) = (&*self.checked, built());
        let existing = existing(py, [false, overwrite, false])?;
        let saved = match (record, folder) {
            (Some(record), None) => computed(py, || record.checkpoint(running.as_mut()))?,
            (None, Some(folder)) => computed(py, || {
                RunInProgress::save(&job(checked, &program), &folder, existing, running.as_mut())
            })?,
            (Some(_), Some(_)) => {
                let message =
                    "a recorded simulation is saved in its own folder\n  help: call save without a folder";
                return Err(exceptions::refused(py, message));
            }
            (None, None) => {
                return Err(exceptions::refused(py, "save needs a folder: the simulation is not recorded"));
            }
        };
        saved.map_err(|error| exceptions::of(py, &error))
    }

    /// Ends a recorded simulation as a run: writes a last checkpoint, the last frame and the summary.
    fn finish(&self, py: Python<'_>) -> PyResult<Run> {
        let mut state = self.state(py)?;
        state.is_sound(py)?;
        let SimulationState { running, record, .. } = &mut *state;
        let (Some(record), Some(folder)) = (record, &self.folder) else {
            let message =
                "only a recorded simulation can be finished\n  help: start it with scene.start(out)";
            return Err(exceptions::refused(py, message));
        };
        let (checked, program) = (&*self.checked, built());
        let finished = computed(py, || record.finish(&job(checked, &program), running.as_mut()))?;
        finished.map_err(|error| exceptions::of(py, &error))?;
        (state.record, state.broken) = (None, Some(StopReason::Finished));
        Ok(Run::in_folder(folder.clone()))
    }

    /// Changes quantities now, in the order given: `velocities`, `angular_velocities`, `bath_temperature` or `gravity`.
    ///
    /// The integrator restarts at the present state, and the work of a change is no error of the energy balance. A recorded simulation logs
    /// each change, and makes it again where it resumes from an earlier checkpoint. A refused change changes nothing.
    #[pyo3(
        signature = (**quantities),
        text_signature = "($self, *, velocities=None, angular_velocities=None, bath_temperature=None, gravity=None)"
    )]
    fn set(&self, py: Python<'_>, quantities: Option<&Bound<'_, PyDict>>) -> PyResult<()> {
        let Some(quantities) = quantities else { return Ok(()) };
        let (count, walls) = self.look(py, |state| {
            (state.running.particles().len(), state.running.wall_velocities().len())
        })?;
        let mut state = self.state(py)?;
        state.is_sound(py)?;
        for change in changes(quantities, count, self.checked.dimensions, walls)? {
            let (checked, program) = (&*self.checked, built());
            let SimulationState { running, record, .. } = &mut *state;
            let changed = computed(py, || match record {
                Some(record) => {
                    let changed = record.change(&job(checked, &program), running.as_mut(), &change);
                    changed.map_err(|error| Box::new(error) as Box<dyn Reported>)
                }
                None => Ok(running.steer(&change)),
            });
            match state.settle(py, changed)? {
                Ok(()) => {}
                Err(SteeringError::Failed(failure)) => state.settle(py, Ok(Err(Box::new(failure))))?,
                Err(refused) => return Err(exceptions::refused(py, refused.to_string())),
            }
        }
        Ok(())
    }

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
            state.advance_for_a_beat(py, &self.checked, end, &self.pause)?;
        }
        if !end.has_been_reached(&state.running.clock()) {
            py.check_signals()?;
            state.advance_beside(py, &self.checked, end)?;
        }
        state.asked = asked;
        Ok(())
    }

    /// Values of the quantities of the method, by name: the columns of `thermo.csv`. `compressibility` and `collision_rate` of hard discs
    /// are means since the start or the last change; of a recorded simulation, since the last row.
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
