//! Class `Scene`: reads, checks, starts and runs scenes.

use crate::checked::{CheckedScene, SceneSource};
use crate::computing::computed;
use crate::exceptions;
use crate::json;
use crate::overrides::{GivenOverrides, overrides};
use crate::particles::Particles;
use crate::run::Run;
use crate::running::{begin_scratch, carry_out, existing};
use crate::simulation::Simulation;
use crate::table::{Table, TableColumn};
use pyo3::prelude::*;
use serde_json::{Map, Value, json};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use stripmine_physics::method::SectionCounts;
use stripmine_physics::run::{RunError, choices_of_the_run, forecast};

/// Scene that was read and checked. `stripmine.scene` makes it.
#[pyclass(frozen, module = "stripmine")]
pub(crate) struct Scene {
    source: SceneSource,
    given: GivenOverrides,
    checked: Arc<CheckedScene>,
}

/// Reads and checks a scene, and makes its particles.
///
/// `source` is a preset name, a file path, or the scene itself as TOML text of several lines. `overrides` changes values:
/// `{"particles.count": 400}`, by section `{"particles": {"count": 400}}`, or as on the command line `["particles.count=400"]`.
/// Raises `SceneError` with all mistakes at once.
#[pyfunction]
#[pyo3(signature = (source, overrides = None))]
pub(crate) fn scene(source: &Bound<'_, PyAny>, overrides: Option<&Bound<'_, PyAny>>) -> PyResult<Scene> {
    let py = source.py();
    let named: String = py.import("os")?.call_method1("fspath", (source,))?.extract()?;
    let source = if named.contains('\n') { SceneSource::Text(named) } else { SceneSource::Named(named) };
    let given = overrides.map(self::overrides).transpose()?.unwrap_or_default();
    let read = computed(py, || source.values(&given).and_then(CheckedScene::of))?;
    let checked = Arc::new(read.map_err(|mistakes| exceptions::of(py, &mistakes))?);
    Ok(Scene { source, given, checked })
}

impl Scene {
    /// Checks that the machine has enough memory for it.
    fn fits(&self, py: Python<'_>) -> PyResult<()> {
        let fits = self.checked.prepared.memory.fits(self.source.name());
        fits.map_err(|mistakes| exceptions::of(py, &mistakes))
    }

    /// The scene with the choices of the run in a folder, where this scene leaves them open.
    fn as_begun(&self, py: Python<'_>, folder: &Path) -> PyResult<Arc<CheckedScene>> {
        let CheckedScene { prepared, entry, values, .. } = &*self.checked;
        let chosen = choices_of_the_run(values, entry.vocabulary, &prepared.scene, folder);
        if chosen.is_empty() {
            return Ok(self.checked.clone());
        }
        let mut given = self.given.clone();
        given.texts.extend(chosen);
        let read = computed(py, || self.source.values(&given).and_then(CheckedScene::of))?;
        Ok(Arc::new(read.map_err(|mistakes| exceptions::of(py, &mistakes))?))
    }
}

#[pymethods]
impl Scene {
    /// The scene as TOML, with every value and every choice explicit.
    fn toml(&self) -> &str {
        &self.checked.prepared.scene
    }

    /// Name of its method.
    #[getter]
    fn method(&self) -> &'static str {
        self.checked.entry.vocabulary.keys.method
    }

    /// Particles at the start.
    fn particles(&self, py: Python<'_>) -> PyResult<Particles> {
        Particles::of(py, self.checked.prepared.particles().all(), self.checked.dimensions)
    }

    /// Step limits, expected time and memory, choices and warnings, as `stripmine scene check --json`.
    fn check<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        self.fits(py)?;
        let CheckedScene { prepared, entry, .. } = &*self.checked;
        let mut facts = prepared.facts.clone();
        facts.extend(forecast::step_forecast(prepared));
        facts.extend(forecast::output_forecast(prepared));
        facts.extend(computed(py, || forecast::time_forecast(prepared))?);
        facts.push(forecast::memory_forecast(prepared));
        let mut data = Map::new();
        data.insert("scene".to_owned(), json!(self.source.name()));
        data.insert("method".to_owned(), json!(entry.vocabulary.keys.method));
        data.extend(forecast::as_data(facts));
        data.insert("choices".to_owned(), json!(prepared.choices));
        data.insert("left_out".to_owned(), json!(prepared.left_out));
        data.insert("warnings".to_owned(), json!(prepared.warnings));
        json::to_python(py, &Value::Object(data))
    }

    /// Whole-array operations of a step, as `stripmine scene programs --json` counts them: for the lattice programs, whichever search a
    /// run of the scene uses. The table is empty if a step has no vector programs.
    fn counts(&self, py: Python<'_>) -> PyResult<Table> {
        let model = &self.checked.prepared.model;
        let counted = computed(py, || SectionCounts::of(&model.programs()))?;
        let words =
            |of: fn(&SectionCounts) -> &'static str| counted.iter().map(|it| of(it).to_owned()).collect();
        let counts = |of: fn(&SectionCounts) -> u64| counted.iter().map(of).collect();
        Ok(Table::new(vec![
            TableColumn::words("part", words(|it| it.part)),
            TableColumn::words("section", words(|it| it.section)),
            TableColumn::words("length", words(|it| it.length)),
            TableColumn::counts("n", counts(|it| it.n as u64)),
            TableColumn::counts("operations", counts(|it| it.operations)),
            TableColumn::counts("computing", counts(|it| it.computing)),
            TableColumn::counts("divisions_and_roots", counts(|it| it.divisions_and_roots)),
        ]))
    }

    /// Starts a simulation that is advanced step by step.
    ///
    /// With a folder `out` it is a run: rows, frames, checkpoints and changes are written there, as `run` does. `resume`, `overwrite` and
    /// `other_version` are those of `run`.
    #[pyo3(signature = (out = None, *, resume = false, overwrite = false, other_version = false))]
    fn start(
        &self,
        py: Python<'_>,
        out: Option<PathBuf>,
        resume: bool,
        overwrite: bool,
        other_version: bool,
    ) -> PyResult<Simulation> {
        let existing = existing(py, [resume, overwrite, other_version])?;
        self.fits(py)?;
        match out {
            Some(out) => {
                let checked = if resume { self.as_begun(py, &out)? } else { self.checked.clone() };
                Simulation::recorded(py, checked, out, existing)
            }
            None if resume || overwrite => {
                Err(exceptions::refused(py, "resume and overwrite need a folder, out"))
            }
            None => Simulation::start(py, self.checked.clone()),
        }
    }

    /// Runs the whole scene into the folder `out`, as `stripmine run` does.
    ///
    /// Without `out` the folder is temporary, and removed with its last `Run`. `resume` resumes the run in the folder, or starts it if there
    /// is none; `other_version` also resumes a run of another version; `overwrite` replaces a run. Ctrl-C ends it with a checkpoint.
    #[pyo3(signature = (out = None, *, resume = false, overwrite = false, other_version = false))]
    fn run(
        &self,
        py: Python<'_>,
        out: Option<PathBuf>,
        resume: bool,
        overwrite: bool,
        other_version: bool,
    ) -> PyResult<Run> {
        let existing = existing(py, [resume, overwrite, other_version])?;
        self.fits(py)?;
        let Some(folder) = out else {
            let scratch = begin_scratch(py)?;
            let done = carry_out(py, &self.checked, scratch.path(), existing)?;
            // The temporary folder is removed, so the failure must not refer to its files.
            return match done {
                Ok(()) => Ok(Run::in_scratch(scratch)),
                Err(RunError::Physics { failure, .. }) => Err(exceptions::of(py, &failure)),
                Err(error) => Err(exceptions::of(py, &error)),
            };
        };
        let checked = if resume { self.as_begun(py, &folder)? } else { self.checked.clone() };
        carry_out(py, &checked, &folder, existing)?.map_err(|error| exceptions::of(py, &error))?;
        Ok(Run::in_folder(folder))
    }

    fn __repr__(&self) -> String {
        let particles = self.checked.prepared.particles().len();
        format!("<Scene {}: {}, {particles} particles>", self.source.name(), self.method())
    }
}
