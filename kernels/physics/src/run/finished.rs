//! Finished runs: their rows, their scenes, and averages over several of them.

use super::folder::{LONGEST_SCENE, SCENE, THERMO};
use super::identity::{first_difference, physics};
use super::table::{TableError, TableReader};
use crate::averages::{AveragedRows, RunAverages, joined};
use crate::io::{FileError, regular_file};
use crate::method::{Methods, ObservedQuantity, observed_quantities};
use crate::quoted;
use crate::reported::{ErrorClass, FilePlace, Reported};
use std::path::{Path, PathBuf};

/// Reason why runs have no averages.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum FinishedError {
    /// The table of observables is invalid.
    #[error(transparent)]
    Table(#[from] TableError),
    /// A file cannot be read.
    #[error(transparent)]
    File(#[from] FileError),
    /// A file of the run has been changed.
    #[error(
        "{}:{line}: expected {expected}\n  help: run it again, or restore the file from a copy",
        quoted::path(file)
    )]
    Damaged {
        /// Path of the file.
        file: PathBuf,
        /// Line, from 1.
        line: usize,
        /// Expected content of the line.
        expected: String,
    },
    /// The columns are those of no method.
    #[error("{}: its columns are not those of any method of this version", quoted::path(.0))]
    NoMethod(PathBuf),
    /// The runs have different scenes.
    #[error(
        "{} and {} have different scenes: `{ours}` in the first, `{theirs}` in the other; only [run], [output] and seeds may differ\n  \
         help: average them separately",
        quoted::path(first),
        quoted::path(other)
    )]
    OtherScene {
        /// Folder of the first run.
        first: PathBuf,
        /// Folder of a run that differs.
        other: PathBuf,
        /// First line that differs, of the first run.
        ours: String,
        /// Corresponding line of the other run.
        theirs: String,
    },
    /// A run occurs twice.
    #[error(
        "{} and {} are the same run, with the same scene and seeds: together they have no smaller error than one\n  help: give each \
         run its own seed",
        quoted::path(first),
        quoted::path(other)
    )]
    Twice {
        /// Folder of the first run.
        first: PathBuf,
        /// Folder of its duplicate.
        other: PathBuf,
    },
    /// Two runs have the same noise.
    #[error(
        "{} and {} have the same noise, of seed {seed}: once they have decorrelated from their starts they are the same run\n  help: give each \
         run its own law.noise_seed, or leave it out, so that it follows particles.seed",
        quoted::path(first),
        quoted::path(other)
    )]
    OneNoise {
        /// Folder of the first run.
        first: PathBuf,
        /// Folder of the run with the same noise.
        other: PathBuf,
        /// Seed of the noise.
        seed: String,
    },
    /// A run has not written the function.
    #[error(
        "{}: the run has written no {name}, or has not ended\n  help: run it with --set 'output.structure=[\"{name}\"]'",
        quoted::path(folder)
    )]
    NoStructure {
        /// Folder of the run.
        folder: PathBuf,
        /// Name of the function.
        name: &'static str,
    },
    /// A function that all runs have written, each over other distances, wave numbers or times.
    #[error(
        "{file} of these runs has no value of {name} that all of them have: expected runs of one box and one [output]; average them one by one"
    )]
    NothingShared {
        /// The function.
        name: &'static str,
        /// The file that each run has.
        file: &'static str,
    },
}

impl Reported for FinishedError {
    fn class(&self) -> ErrorClass {
        match self {
            FinishedError::Table(error) => error.class(),
            FinishedError::File(_) => ErrorClass::InputOutput,
            FinishedError::NoMethod(_) | FinishedError::Damaged { .. } => ErrorClass::Input,
            FinishedError::OtherScene { .. }
            | FinishedError::Twice { .. }
            | FinishedError::OneNoise { .. }
            | FinishedError::NoStructure { .. }
            | FinishedError::NothingShared { .. } => ErrorClass::Usage,
        }
    }

    fn inner_error(&self) -> Option<&dyn Reported> {
        if let FinishedError::Table(error) = self { Some(error) } else { None }
    }

    fn place(&self) -> Option<FilePlace> {
        match self {
            FinishedError::Table(error) => error.place(),
            FinishedError::File(error) => Some(FilePlace::at(&error.file)),
            FinishedError::Damaged { file, line, .. } => {
                Some(FilePlace { line: Some(*line), ..FilePlace::at(file) })
            }
            FinishedError::NoMethod(file)
            | FinishedError::OtherScene { other: file, .. }
            | FinishedError::Twice { other: file, .. }
            | FinishedError::OneNoise { other: file, .. }
            | FinishedError::NoStructure { folder: file, .. } => Some(FilePlace::at(file)),
            FinishedError::NothingShared { .. } => None,
        }
    }
}

/// Finished run, read from its files.
#[derive(Clone, Debug)]
pub struct FinishedRun {
    folder: PathBuf,
    scene: String,
    rows: AveragedRows,
}

impl FinishedRun {
    /// Reads the files of a run in their present state.
    ///
    /// # Errors
    /// If its scene or its table cannot be read, or no method observes its columns.
    pub fn read(folder: &Path, methods: Methods) -> Result<FinishedRun, FinishedError> {
        let path = folder.join(THERMO);
        let table = TableReader::open(&path)?;
        let quantities =
            observed_quantities(methods, table.columns()).ok_or(FinishedError::NoMethod(path))?;
        let rows = rows_of(table, quantities)?;
        let path = folder.join(SCENE);
        let scene = regular_file::read(&path, LONGEST_SCENE).map_err(FileError::at(&path, "reading"))?;
        let scene = String::from_utf8_lossy(&scene).into_owned();
        Ok(FinishedRun { folder: folder.to_owned(), scene, rows })
    }

    /// Lines of the scene that determine the physics.
    pub(super) fn physics(&self) -> Vec<&str> {
        physics(&self.scene)
    }

    /// Checks that another run has the same scene with another seed.
    pub(super) fn check_joinable(&self, other: &FinishedRun) -> Result<(), FinishedError> {
        let (first, other_folder) = (self.folder.clone(), other.folder.clone());
        if self.physics() == other.physics() {
            return Err(FinishedError::Twice { first, other: other_folder });
        }
        let without_seeds = |run: &FinishedRun| -> Vec<String> {
            let is_seed = |line: &&str| ["seed = ", "noise_seed = "].iter().any(|it| line.starts_with(it));
            run.physics().into_iter().filter(|line| !is_seed(line)).map(str::to_owned).collect()
        };
        let [ours, theirs] = [self, other].map(without_seeds);
        let [ours, theirs] = [&ours, &theirs].map(|it| it.iter().map(String::as_str).collect::<Vec<_>>());
        if let Some([theirs, ours]) = first_difference(&theirs, &ours) {
            return Err(FinishedError::OtherScene { first, other: other_folder, ours, theirs });
        }
        match [self, other].map(FinishedRun::noise) {
            [Some((ours, is_stated)), Some((theirs, other_states))]
                if ours == theirs && (is_stated || other_states) =>
            {
                Err(FinishedError::OneNoise { first, other: other_folder, seed: ours.to_owned() })
            }
            _ => Ok(()),
        }
    }

    /// Seed of the noise, and true if the scene states it; otherwise it is that of the start.
    fn noise(&self) -> Option<(&str, bool)> {
        let physics = self.physics();
        let value = |key| physics.iter().find_map(|line| line.strip_prefix(key));
        value("noise_seed = ").map(|seed| (seed, true)).or_else(|| Some((value("seed = ")?, false)))
    }
}

/// Averages of a run, or joined ones of several runs of one scene.
///
/// # Errors
/// If two of them have different scenes, or are the same run.
pub fn averages_of(runs: &[FinishedRun]) -> Result<RunAverages, FinishedError> {
    for (place, run) in runs.iter().enumerate() {
        runs[..place].iter().try_for_each(|before| before.check_joinable(run))?;
    }
    Ok(joined(&runs.iter().map(|run| RunAverages::of(&run.rows)).collect::<Vec<_>>()))
}

/// Reads the rows of a table, whose first column is the step.
///
/// # Errors
/// If they cannot be read, or one is not a row of numbers.
pub(super) fn rows_of(
    mut table: TableReader,
    quantities: &'static [ObservedQuantity],
) -> Result<AveragedRows, TableError> {
    let mut rows = AveragedRows::new(quantities);
    while let Some(row) = table.next_row()? {
        rows.add(&row[1..]);
    }
    Ok(rows)
}
