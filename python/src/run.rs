//! Finished runs: their rows, frames, means and scenes.

use crate::computing::computed;
use crate::exceptions;
use crate::frames::Frames;
use crate::json;
use crate::scratch::Scratch;
use crate::table::{Table, TableColumn};
use pyo3::prelude::*;
use pyo3::types::PyTuple;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use stripmine_physics::averages::{Average, AverageOutcome, Estimate, RunAverages};
use stripmine_physics::io::{FileError, regular_file};
use stripmine_physics::method::{METHODS, observed_quantities};
use stripmine_physics::reported::ErrorClass;
use stripmine_physics::run::{FinishedRun, TableError, TableReader, averages_of};

const THERMO: &str = "thermo.csv";
const SCENE: &str = "scene.toml";
const SUMMARY: &str = "summary.json";

/// Limit of the size of a text file of a run (bytes).
const LONGEST_TEXT: u64 = 64 << 20;

/// Run in its folder. `Scene.run` and `stripmine.read` make it.
#[pyclass(frozen, module = "stripmine")]
pub(crate) struct Run {
    folder: PathBuf,
    /// Set if the folder is temporary.
    scratch: Option<Arc<Scratch>>,
}

/// Opens the run in a folder, finished or not.
#[pyfunction]
pub(crate) fn read(py: Python<'_>, folder: PathBuf) -> PyResult<Run> {
    let run = Run::in_folder(folder);
    run.finished(py)?;
    Ok(run)
}

/// Joins the means of several runs of one scene with different seeds.
#[pyfunction]
#[pyo3(signature = (*runs))]
pub(crate) fn average(runs: &Bound<'_, PyTuple>) -> PyResult<Table> {
    let py = runs.py();
    let runs: Vec<Bound<'_, Run>> = runs.extract()?;
    let finished = runs.iter().map(|run| run.get().finished(py)).collect::<PyResult<Vec<_>>>()?;
    joined(py, &finished)
}

impl Run {
    /// Run in a folder. The path is made absolute, since the process may change its directory.
    pub(crate) fn in_folder(folder: PathBuf) -> Run {
        Run { folder: std::path::absolute(&folder).unwrap_or(folder), scratch: None }
    }

    /// Run in a temporary folder, which is removed with it.
    pub(crate) fn in_scratch(scratch: Scratch) -> Run {
        Run { folder: scratch.path().to_owned(), scratch: Some(Arc::new(scratch)) }
    }

    fn finished(&self, py: Python<'_>) -> PyResult<FinishedRun> {
        let read = py.detach(|| FinishedRun::read(&self.folder, METHODS));
        read.map_err(|error| exceptions::of(py, &error))
    }

    fn text(&self, py: Python<'_>, name: &str) -> PyResult<String> {
        let path = self.folder.join(name);
        let bytes = regular_file::read(&path, LONGEST_TEXT).map_err(|cause| {
            let error = FileError::at(&path, "reading")(cause);
            exceptions::of_file(py, ErrorClass::InputOutput, &error.to_string(), &path)
        })?;
        Ok(String::from_utf8_lossy(&bytes).into_owned())
    }
}

#[pymethods]
impl Run {
    /// The folder, as an absolute path.
    #[getter]
    fn folder(&self) -> &Path {
        &self.folder
    }

    /// True if the folder is removed with its last `Run`.
    #[getter]
    fn _is_temporary(&self) -> bool {
        self.scratch.is_some()
    }

    /// Rows of `thermo.csv`.
    fn thermo(&self, py: Python<'_>) -> PyResult<Table> {
        let table = py.detach(|| thermo(&self.folder.join(THERMO)));
        table.map_err(|error| exceptions::of(py, &error))
    }

    /// Mean of each quantity with its error, as `stripmine average`.
    fn averages(&self, py: Python<'_>) -> PyResult<Table> {
        joined(py, &[self.finished(py)?])
    }

    /// Frames of the trajectory, read one at a time from `trajectory.xyz`, or from `trajectory.gsd` if that has none.
    fn frames(&self, py: Python<'_>) -> PyResult<Frames> {
        Frames::open(py, &self.folder, self.scratch.clone())
    }

    /// The scene as TOML, with every value and every choice explicit.
    fn toml(&self, py: Python<'_>) -> PyResult<String> {
        self.text(py, SCENE)
    }

    /// Contents of `summary.json`.
    fn summary<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        json::of_text(py, &self.text(py, SUMMARY)?)
    }

    fn __repr__(&self) -> String {
        format!("<Run in {}>", self.folder.display())
    }
}

/// Table of a run: the step, or the number of events, then the observables.
fn thermo(path: &Path) -> Result<Table, TableError> {
    let mut table = TableReader::open(path)?;
    let names = table.columns().to_vec();
    let units = observed_quantities(METHODS, &names).unwrap_or_default();
    let mut values = vec![vec![]; names.len()];
    while let Some(row) = table.next_row()? {
        values.iter_mut().zip(row).for_each(|(column, value)| column.push(value));
    }
    let unit = |name: &str| units.iter().find(|it| it.name == name).map_or("", |it| it.unit);
    let columns = names.iter().zip(values).enumerate().map(|(place, (name, values))| match place {
        0 => TableColumn::counts(name, values.into_iter().map(|value| value as u64).collect()),
        _ => TableColumn::numbers(name, unit(name), values),
    });
    Ok(Table::new(columns.collect()))
}

fn joined(py: Python<'_>, runs: &[FinishedRun]) -> PyResult<Table> {
    let averages = computed(py, || averages_of(runs))?;
    Ok(means(&averages.map_err(|error| exceptions::of(py, &error))?))
}

/// Table of averages, a row for each quantity; missing values are NaN.
fn means(RunAverages { quantities, .. }: &RunAverages) -> Table {
    let words = |name: &str, of: &dyn Fn(&Average) -> String| {
        TableColumn::words(name, quantities.iter().map(of).collect())
    };
    let numbers = |name: &str, unit: &str, of: fn(&AverageOutcome) -> Option<f64>| {
        let values = quantities.iter().map(|it| of(&it.outcome).unwrap_or(f64::NAN));
        TableColumn::numbers(name, unit, values.collect())
    };
    let estimate = |name: &str, unit: &str, of: fn(&Estimate) -> f64| {
        let values = quantities.iter().map(|it| match &it.outcome {
            AverageOutcome::Mean(estimate) => of(estimate),
            _ => f64::NAN,
        });
        TableColumn::numbers(name, unit, values.collect())
    };
    Table::new(vec![
        words("quantity", &|it| it.quantity.to_owned()),
        words("unit", &|it| it.unit.clone()),
        words("of", &|it| it.of.to_owned()),
        words("says", &|it| says(&it.outcome).to_owned()),
        numbers("mean", "", |outcome| match *outcome {
            AverageOutcome::Mean(Estimate { mean, .. }) | AverageOutcome::Constant { mean } => Some(mean),
            _ => None,
        }),
        estimate("bar", "", |it| it.bar),
        estimate("standard_error", "", |it| it.standard_error),
        estimate("correlation_time", "time", |it| it.correlation_time),
        estimate("equilibrated_at", "time", |it| it.equilibrated_at),
        numbers("independent_samples", "", |outcome| match *outcome {
            AverageOutcome::Mean(Estimate { independent_samples, .. })
            | AverageOutcome::TooShort { independent_samples, .. } => Some(independent_samples),
            _ => None,
        }),
        numbers("enough_at", "time", |outcome| match *outcome {
            AverageOutcome::TooShort { enough_at, .. } => Some(enough_at),
            _ => None,
        }),
        numbers("first", "", |outcome| match *outcome {
            AverageOutcome::Changing { first, .. } | AverageOutcome::Kept { first, .. } => Some(first),
            _ => None,
        }),
        numbers("last", "", |outcome| match *outcome {
            AverageOutcome::Changing { last, .. } | AverageOutcome::Kept { last, .. } => Some(last),
            _ => None,
        }),
    ])
}

/// Word for an outcome, as in `summary.json`.
fn says(outcome: &AverageOutcome) -> &'static str {
    match outcome {
        AverageOutcome::Mean(_) => "mean",
        AverageOutcome::Constant { .. } => "constant",
        AverageOutcome::TooShort { .. } => "too-short",
        AverageOutcome::Changing { .. } => "changing",
        AverageOutcome::Kept { .. } => "kept",
        AverageOutcome::Undefined => "undefined",
    }
}
