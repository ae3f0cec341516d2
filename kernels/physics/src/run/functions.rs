//! Structure functions read from the files of runs, joined over several runs of one scene.

use super::finished::FinishedError;
use super::folder::SUMMARY;
use crate::averages::{MeanWithBar, mean_of_independent};
use crate::io::{FileError, regular_file};
use crate::quoted;
use crate::structure::{OBSERVABLES, StructureObservable};
use serde::Serialize;
use serde_json::Value;
use std::io::ErrorKind;
use std::path::Path;

/// Longest file (bytes).
const LONGEST: u64 = 1 << 20;
/// Relative difference below which coordinates count as equal.
const SAME: f64 = 1e-6;

/// Structure function from one run or several.
#[derive(Clone, Debug, Serialize)]
pub struct StructureFunction {
    /// Name of the observable.
    pub name: &'static str,
    /// Name of its file.
    pub file: &'static str,
    /// Number of runs.
    pub runs: usize,
    /// Points: coordinates, mean, and half-width of the 95 % confidence interval, over blocks of one run, or over runs by Student's t.
    pub points: Vec<FunctionPoint>,
    /// Numbers that summarise it.
    pub headlines: Vec<Number>,
    /// Reservation about the values, or the reason why there are no headlines.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub doubt: Option<String>,
    /// Description of the function.
    #[serde(skip)]
    pub observable: &'static StructureObservable,
}

/// Value of a function at a point.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(into = "Vec<f64>")]
pub struct FunctionPoint {
    /// Coordinates: one or two.
    pub over: Vec<f64>,
    /// Mean of the function there.
    pub mean: MeanWithBar,
}

impl From<FunctionPoint> for Vec<f64> {
    fn from(FunctionPoint { mut over, mean }: FunctionPoint) -> Self {
        over.extend(<[f64; 2]>::from(mean));
        over
    }
}

/// Number that summarises a function.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Number {
    /// Name of the number.
    pub name: &'static str,
    /// Unit; empty for pure numbers.
    pub unit: &'static str,
    /// Its mean.
    #[serde(flatten)]
    pub mean: MeanWithBar,
}

/// Functions that all of some runs have written. A mean is that of the runs, with an error bar from their spread; for one run both are its own.
///
/// # Errors
/// [`FinishedError::File`] and [`FinishedError::Damaged`] if a file exists and cannot be read completely.
pub fn functions_of<'f>(
    folders: impl Iterator<Item = &'f Path>,
) -> Result<Vec<StructureFunction>, FinishedError> {
    let folders: Vec<&Path> = folders.collect();
    let summaries: Vec<Value> = folders.iter().map(|folder| summary(folder)).collect::<Result<_, _>>()?;
    let of = |observable: &'static StructureObservable| {
        let StructureObservable { name, file, .. } = *observable;
        let runs = folders.len();
        let files = folders.iter().map(|folder| table(&folder.join(file), observable));
        let files: Option<Vec<FunctionTable>> = files.collect::<Result<_, _>>()?;
        let Some(files) = files else { return Ok(None) };
        let files: Result<Vec<Vec<FunctionPoint>>, String> =
            files.into_iter().map(FunctionTable::points).collect();
        let mut points = match files {
            Ok(files) => joined(&files),
            Err(doubt) => {
                let (points, headlines) = (vec![], vec![]);
                return Ok(Some(StructureFunction {
                    name,
                    file,
                    runs,
                    points,
                    headlines,
                    doubt: Some(doubt),
                    observable,
                }));
            }
        };
        if observable.is_density_of_places() {
            // Positions where no disc was sampled have no known error.
            let never_sampled = points.iter_mut().filter(|point| point.mean.value == 0.0);
            never_sampled.for_each(|point| point.mean.bar = f64::NAN);
        }
        let headline = |name: &'static str, unit: &'static str| {
            let of = |summary: &Value| number(summary, observable.name, name);
            let runs: Option<Vec<FunctionPoint>> = summaries.iter().map(of).collect();
            let joined = joined(&runs?.into_iter().map(|run| vec![run]).collect::<Vec<_>>());
            joined.first().map(|&FunctionPoint { mean, .. }| Number { name, unit, mean })
        };
        let headlines = observable.headlines.iter();
        let headlines = headlines.filter_map(|it| headline(it.name, it.unit)).collect();
        let doubt = doubt(&summaries, name);
        let is_known = !points.is_empty() || doubt.is_some();
        Ok(is_known.then_some(StructureFunction { name, file, runs, points, headlines, doubt, observable }))
    };
    OBSERVABLES.iter().filter_map(|observable| of(observable).transpose()).collect()
}

/// Returns one of the functions that all of some runs have written.
///
/// # Errors
/// [`FinishedError::NoStructure`] if one has not; others as for [`functions_of`].
pub fn function_of<'f>(
    folders: impl Iterator<Item = &'f Path> + Clone,
    observable: &'static StructureObservable,
) -> Result<StructureFunction, FinishedError> {
    let found = functions_of(folders.clone())?.into_iter().find(|it| it.name == observable.name);
    found.ok_or_else(|| {
        let mut without = folders.clone().filter(|folder| !folder.join(observable.file).exists());
        match without.next() {
            Some(folder) => FinishedError::NoStructure { folder: folder.to_owned(), name: observable.name },
            None => FinishedError::NothingShared { name: observable.name, file: observable.file },
        }
    })
}

/// Heading of a function's file, without its line end.
fn heading(observable: &StructureObservable) -> String {
    let with_unit = |[name, unit]: [&str; 2]| match unit {
        "" => name.to_owned(),
        unit => format!("{name} ({unit})"),
    };
    let columns = observable.over.iter().chain([&observable.value]);
    let columns: Vec<String> = columns.map(|&column| with_unit(column)).chain(["error".to_owned()]).collect();
    columns.join(",")
}

/// Formats a function as comma-separated values: coordinates, mean and error bar, without lines that lack a mean.
pub(super) fn csv(observable: &StructureObservable, points: &[FunctionPoint]) -> String {
    let mut text = heading(observable) + "\n";
    let has_mean = |point: &&FunctionPoint| !point.mean.value.is_nan();
    for FunctionPoint { over, mean: MeanWithBar { value, bar } } in points.iter().filter(has_mean) {
        over.iter().for_each(|over| text.extend([format!("{over:?}"), ",".to_owned()]));
        text.push_str(&format!("{value:?},{bar:?}\n"));
    }
    text
}

impl StructureFunction {
    /// Function as comma-separated values.
    pub fn csv(&self) -> String {
        csv(self.observable, &self.points)
    }
}

/// Reads the bytes of a file; none if it does not exist.
fn read(path: &Path, most: u64) -> Result<Option<Vec<u8>>, FinishedError> {
    match regular_file::read(path, most) {
        Ok(bytes) => Ok(Some(bytes)),
        Err(error) if error.kind() == ErrorKind::NotFound => Ok(None),
        Err(error) => Err(FileError::at(path, "reading")(error).into()),
    }
}

/// Content of a function's file.
enum FunctionTable {
    Points(Vec<FunctionPoint>),
    /// Columns that another version of the program has written: the heading.
    OtherColumns(String),
}

impl FunctionTable {
    /// The points; a sentence if there are none that this version can read.
    fn points(self) -> Result<Vec<FunctionPoint>, String> {
        match self {
            FunctionTable::Points(points) => Ok(points),
            FunctionTable::OtherColumns(heading) => Err(format!(
                "its file has the columns `{}` of another version of the program; run the scene again",
                quoted::message(&heading)
            )),
        }
    }
}

/// Table of a function in a file; `None` if the file does not exist.
fn table(path: &Path, observable: &StructureObservable) -> Result<Option<FunctionTable>, FinishedError> {
    let damaged = |line, expected| FinishedError::Damaged { file: path.to_owned(), line, expected };
    let Some(bytes) = read(path, LONGEST)? else { return Ok(None) };
    let text = String::from_utf8(bytes).map_err(|error| {
        let line = regular_file::line_that_is_not_text(error.as_bytes());
        damaged(line.unwrap_or(1), "text in UTF-8".to_owned())
    })?;
    let point = |line: &str| -> Option<FunctionPoint> {
        let mut over: Vec<f64> = line.split(',').map(str::parse).collect::<Result<_, _>>().ok()?;
        let (bar, value) = (over.pop()?, over.pop()?);
        let mean = MeanWithBar { value, bar };
        (over.len() == observable.over.len()).then_some(FunctionPoint { over, mean })
    };
    let mut lines = (1..).zip(text.split_inclusive('\n'));
    let whole = |line: &str| line.strip_suffix('\n').map(|line| line.trim_end_matches('\r').to_owned());
    let count = observable.over.len() + 2;
    match lines.next().and_then(|(_, line)| whole(line)) {
        Some(first) if first == heading(observable) => {}
        // Versions differ in the number of columns; damage rarely leaves a heading whole.
        Some(first) if first.ends_with(",error") && first.split(',').count() != count => {
            return Ok(Some(FunctionTable::OtherColumns(first)));
        }
        _ => return Err(damaged(1, format!("`{}`", heading(observable)))),
    }
    let row = |(number, line): (usize, &str)| {
        let row = whole(line).and_then(|line| point(&line));
        row.ok_or_else(|| damaged(number, format!("{count} numbers and the end of the line")))
    };
    lines.map(row).collect::<Result<_, _>>().map(FunctionTable::Points).map(Some)
}

/// Reads the summary of a run; null if it has not ended.
fn summary(folder: &Path) -> Result<Value, FinishedError> {
    let file = folder.join(SUMMARY);
    let Some(bytes) = read(&file, LONGEST << 4)? else { return Ok(Value::Null) };
    serde_json::from_slice(&bytes).map_err(|error| FinishedError::Damaged {
        line: error.line().max(1),
        file,
        expected: "the JSON that a run writes at its end".to_owned(),
    })
}

/// Headline of an observable, as a point without coordinates.
fn number(summary: &Value, observable: &str, name: &str) -> Option<FunctionPoint> {
    let find = |list: &Value, name: &str| list.as_array()?.iter().find(|it| it["name"] == name).cloned();
    let found = find(&find(&summary["structure"], observable)?["headlines"], name)?;
    let mean = MeanWithBar { value: found["mean"].as_f64()?, bar: found["bar"].as_f64()? };
    Some(FunctionPoint { over: vec![], mean })
}

/// Reservation about an observable from one run or several.
fn doubt(summaries: &[Value], observable: &str) -> Option<String> {
    let of = |summary: &Value| {
        let all = summary["structure"].as_array()?;
        Some(all.iter().find(|it| it["name"] == observable)?["doubt"].as_str()?.to_owned())
    };
    let doubts: Vec<String> = summaries.iter().filter_map(of).collect();
    let first = doubts.first()?;
    let (some, all) = (doubts.len(), summaries.len());
    Some(if all == 1 { first.clone() } else { format!("in {some} of {all} runs: {first}") })
}

/// Joins the points that all runs have.
fn joined(runs: &[Vec<FunctionPoint>]) -> Vec<FunctionPoint> {
    let [first, others @ ..] = runs else { return vec![] };
    if others.is_empty() {
        return first.clone();
    }
    let of = |FunctionPoint { over, mean, .. }: &FunctionPoint| {
        let there = |run: &Vec<FunctionPoint>| {
            let close = |point: &&FunctionPoint| {
                let mut places = point.over.iter().zip(over);
                places.all(|(other, over)| (other - over).abs() <= SAME * over.abs())
            };
            run.iter().find(close).map(|point| point.mean.value)
        };
        let means: Option<Vec<f64>> =
            std::iter::once(Some(mean.value)).chain(others.iter().map(there)).collect();
        Some(FunctionPoint { over: over.clone(), mean: mean_of_independent(&means?)? })
    };
    first.iter().filter_map(of).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Hand calculation: 1, 2 and 3 have the mean 2 and the standard error 1/√3, and Student's t for two degrees of freedom is 4.303.
    #[test]
    fn only_points_of_all_runs_are_joined() {
        let runs =
            [vec![[0.5, 1.0], [1.5, 7.0]], vec![[0.5, 2.0], [1.0, 9.0], [1.5, 7.0]], vec![[0.5 + 1e-9, 3.0]]];
        let point = |[over, value]: [f64; 2]| FunctionPoint {
            over: vec![over],
            mean: MeanWithBar { value, bar: 0.1 },
        };
        let runs = runs.map(|run| run.into_iter().map(point).collect::<Vec<_>>());
        let [FunctionPoint { over, mean: MeanWithBar { value: mean, bar } }] = &joined(&runs)[..] else {
            panic!()
        };
        assert!(
            over[..] == [0.5] && (mean - 2.0).abs() < 1e-12 && (bar - 4.3027 / 3_f64.sqrt()).abs() < 1e-3
        );
        assert_eq!(joined(&runs[..2]).len(), 2);
        assert_eq!(joined(&runs[..1]), runs[0]);
        assert_eq!(joined(&[]), vec![] as Vec<FunctionPoint>);
    }
}
