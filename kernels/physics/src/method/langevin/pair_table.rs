//! Pair potential of a user, read from a table of distance and energy.

use crate::io::numbers::number;
use crate::io::regular_file;
use crate::number::significant;
use crate::quoted::{self, quoted};
use crate::scene::path_beside;
use sha2::{Digest, Sha256};
use std::path::{Path, PathBuf};
use stripmine_kernels::law::potential::PairPotential;
use stripmine_kernels::law::tabulated::{Tabulated, TabulatedError};

/// Longest table (bytes).
const LONGEST: u64 = 1 << 26;
/// Largest difference of a stated force from −dU/dr of the rows, relative to the largest force of the row and its two neighbours.
const TOLERANCE: f64 = 0.05;
/// Difference that rounding may make, relative to the largest force of the table.
const ROUNDING: f64 = 1e-9;

/// Table as a scene names it, and what was read.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct PairTable {
    path: PathBuf,
    /// Digest of all distances and energies.
    digest: String,
    /// Potential times the strength of the scene.
    pub(super) potential: Tabulated,
}

/// Mistake in a table, with its location.
#[derive(Debug, thiserror::Error)]
#[error("{}{}: {reason}", quoted::path(file), line.map(|line| format!(":{line}")).unwrap_or_default())]
pub(super) struct PairTableError {
    file: PathBuf,
    /// Line, from 1; none if the file cannot be read.
    line: Option<usize>,
    reason: PairTableMistake,
}

/// Reason of a mistake in a table.
#[derive(Debug, thiserror::Error)]
enum PairTableMistake {
    #[error("cannot be read: {0}; expected rows of r and U")]
    System(#[from] std::io::Error),
    #[error("the line is not UTF-8 text; expected a row of numbers")]
    NoText,
    #[error("found `{}`; expected a number", quoted(.0))]
    NoNumber(String),
    #[error("the row has {found} fields; expected {expected}")]
    Fields { found: usize, expected: &'static str },
    #[error(transparent)]
    Rows(TabulatedError),
    #[error(
        "F = {stated}, but -dU/dr of the rows is {}; expected a difference of at most {}: check unit and sign of F, remove its column, or give \
         more rows there", significant(*found, 5), significant(*most, 3)
    )]
    Force { stated: f64, found: f64, most: f64 },
}

/// Row of a table.
struct PotentialRow {
    line: usize,
    r: f64,
    energy: f64,
    force: Option<f64>,
}

impl PairTable {
    /// Table at a path, relative to a scene file; not read yet.
    pub(super) fn at(scene_file: &str, path: &str) -> PairTable {
        PairTable { path: path_beside(scene_file, path), ..PairTable::default() }
    }

    /// Path of the file.
    pub(super) fn path(&self) -> &Path {
        &self.path
    }

    /// Path, and the digest of its rows.
    pub(super) fn origin(&self) -> (PathBuf, String) {
        (self.path.clone(), self.digest.clone())
    }

    /// Reads the file: rows of r, U and perhaps F, separated by commas or blanks, after an optional line of names; `#` begins a comment. All
    /// energies are multiplied by `strength`.
    ///
    /// # Errors
    /// [`PairTableError`] names the file, the line and the mistake.
    pub(super) fn read(&mut self, strength: f64) -> Result<(), PairTableError> {
        let wrong = |line, reason| PairTableError { file: self.path.clone(), line, reason };
        let bytes = regular_file::read(&self.path, LONGEST).map_err(|cause| wrong(None, cause.into()))?;
        if let Some(line) = regular_file::line_that_is_not_text(&bytes) {
            return Err(wrong(Some(line), PairTableMistake::NoText));
        }
        let rows =
            rows(&String::from_utf8_lossy(&bytes)).map_err(|(line, reason)| wrong(Some(line), reason))?;
        let points: Vec<[f64; 2]> = rows.iter().map(|row| [row.r, row.energy]).collect();
        let potential = Tabulated::new(&points).map_err(|reason| {
            let row = match reason {
                TabulatedError::TooFew(_) => None,
                TabulatedError::NotFinite { row, .. }
                | TabulatedError::NotIncreasing { row, .. }
                | TabulatedError::TooUneven { row, .. } => rows.get(row),
            };
            wrong(row.map(|row| row.line), PairTableMistake::Rows(reason))
        })?;
        check_forces(&rows, &potential).map_err(|(line, reason)| wrong(Some(line), reason))?;
        let mut sum = Sha256::new();
        points.iter().flatten().for_each(|number| sum.update(number.to_bits().to_le_bytes()));
        self.digest = sum.finalize().iter().map(|byte| format!("{byte:02x}")).collect();
        self.potential = potential.scaled(strength);
        Ok(())
    }
}

/// Rows of a text, each with its line.
fn rows(text: &str) -> Result<Vec<PotentialRow>, (usize, PairTableMistake)> {
    const EXPECTED: [&str; 2] = ["r and U, or r, U and F = -dU/dr", "as many as the row before"];
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    let mut rows: Vec<PotentialRow> = vec![];
    let mut is_first = true;
    for (line, content) in (1..).zip(text.lines()) {
        let content = content.split('#').next().unwrap_or_default().trim();
        if content.is_empty() {
            continue;
        }
        let fields: Vec<&str> = match content.contains([',', ';']) {
            true => content.split([',', ';']).map(str::trim).collect(),
            false => content.split_whitespace().collect(),
        };
        let numbers: Vec<Option<f64>> = fields.iter().map(|field| number(field)).collect();
        // Names of columns may come before the first row.
        if std::mem::take(&mut is_first) && numbers.iter().all(Option::is_none) {
            continue;
        }
        if let Some(at) = numbers.iter().position(Option::is_none) {
            return Err((line, PairTableMistake::NoNumber(fields[at].to_owned())));
        }
        let numbers: Vec<f64> = numbers.into_iter().flatten().collect();
        let (&[r, energy, ref rest @ ..], true) = (&numbers[..], numbers.len() <= 3) else {
            return Err((line, PairTableMistake::Fields { found: numbers.len(), expected: EXPECTED[0] }));
        };
        let force = rest.first().copied();
        if rows.first().is_some_and(|first| first.force.is_some() != force.is_some()) {
            return Err((line, PairTableMistake::Fields { found: numbers.len(), expected: EXPECTED[1] }));
        }
        rows.push(PotentialRow { line, r, energy, force });
    }
    Ok(rows)
}

/// Compares stated forces with those of the potential.
fn check_forces(rows: &[PotentialRow], potential: &Tabulated) -> Result<(), (usize, PairTableMistake)> {
    let Some(forces) = rows.iter().map(|row| row.force).collect::<Option<Vec<f64>>>() else { return Ok(()) };
    let largest = |forces: &[f64]| forces.iter().fold(0.0, |most: f64, force| most.max(force.abs()));
    let floor = ROUNDING * largest(&forces);
    let end = potential.ends()[1].next_down();
    for (at, (row, &stated)) in rows.iter().zip(&forces).enumerate() {
        let found = potential.force(row.r.min(end));
        let near = &forces[at.saturating_sub(1)..(at + 2).min(forces.len())];
        let most = TOLERANCE * largest(near) + floor;
        let apart = (found - stated).abs();
        if apart.is_nan() || apart > most {
            return Err((row.line, PairTableMistake::Force { stated, found, most }));
        }
    }
    Ok(())
}
