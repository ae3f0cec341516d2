//! What runs have written of the structure, and what several of one scene say of it together.

use super::finished::FinishedError;
use super::folder::SUMMARY;
use crate::averages::of_independent;
use crate::io::regular_file;
use crate::structure::{OBSERVABLES, Observable};
use serde::Serialize;
use serde_json::Value;
use std::io::{self, Write};
use std::path::Path;

/// Longer than any of the files (bytes).
const LONGEST: u64 = 1 << 20;
/// Coordinates are the same where they differ by less than this part of themselves.
const SAME: f64 = 1e-6;

/// A function of the structure by one run or several.
#[derive(Clone, Debug, Serialize)]
pub struct Function {
    /// The name of the observable.
    pub name: &'static str,
    /// The name of its file.
    pub file: &'static str,
    /// How many runs it is from.
    pub runs: usize,
    /// Where, the mean, and the half width of its interval of 95 %: over blocks of one run, or over runs by Student's t.
    pub points: Vec<Point>,
    /// The numbers that stand for it.
    pub headlines: Vec<Number>,
    /// What makes the values doubtful, or why no number stands for them.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub doubt: Option<String>,
    /// What it is.
    #[serde(skip)]
    pub observable: &'static Observable,
}

/// A function at a place.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(into = "Vec<f64>")]
pub struct Point {
    /// Its coordinates: one, or two.
    pub over: Vec<f64>,
    /// The mean.
    pub mean: f64,
    /// Half the width of its interval of 95 %.
    pub bar: f64,
}

impl From<Point> for Vec<f64> {
    fn from(Point { mut over, mean, bar }: Point) -> Self {
        over.extend([mean, bar]);
        over
    }
}

/// A number that stands for a function.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Number {
    /// Its name.
    pub name: &'static str,
    /// Its unit, empty for pure numbers.
    pub unit: &'static str,
    /// Its mean.
    pub mean: f64,
    /// Half the width of its interval of 95 %.
    pub bar: f64,
}

/// The functions that every one of some runs has written, each where all of them have it. A mean is that of the runs, its bar from
/// what lies between them; of one run they are its own.
pub fn functions_of<'f>(folders: impl Iterator<Item = &'f Path>) -> Vec<Function> {
    let folders: Vec<&Path> = folders.collect();
    let summaries: Vec<Value> = folders.iter().map(|folder| summary(folder)).collect();
    let of = |observable: &'static Observable| {
        let files: Option<Vec<Vec<Point>>> =
            folders.iter().map(|folder| points(&folder.join(observable.file), observable)).collect();
        let mut points = joined(&files?);
        if observable.is_density_of_places() {
            // Where no disc was ever seen, nothing tells how seldom one is there.
            points.iter_mut().filter(|point| point.mean == 0.0).for_each(|point| point.bar = f64::NAN);
        }
        let headline = |name: &'static str, unit: &'static str| {
            let of = |summary: &Value| number(summary, observable.name, name);
            let runs: Option<Vec<Point>> = summaries.iter().map(of).collect();
            let joined = joined(&runs?.into_iter().map(|run| vec![run]).collect::<Vec<_>>());
            joined.first().map(|&Point { mean, bar, .. }| Number { name, unit, mean, bar })
        };
        let headlines = observable.headlines.iter();
        let headlines = headlines.filter_map(|it| headline(it.name, it.unit)).collect();
        let Observable { name, file, .. } = *observable;
        let doubt = doubt(&summaries, name);
        (!points.is_empty() || doubt.is_some()).then_some(Function {
            name,
            file,
            runs: folders.len(),
            points,
            headlines,
            doubt,
            observable,
        })
    };
    OBSERVABLES.iter().filter_map(of).collect()
}

/// One of the functions that every one of some runs has written.
///
/// # Errors
/// [`FinishedError::NoStructure`], if one has not.
pub fn function_of<'f>(
    folders: impl Iterator<Item = &'f Path> + Clone,
    observable: &'static Observable,
) -> Result<Function, FinishedError> {
    let found = functions_of(folders.clone()).into_iter().find(|it| it.name == observable.name);
    found.ok_or_else(|| {
        let mut folders = folders.map(Path::to_owned);
        let without = folders.find(|folder| points(&folder.join(observable.file), observable).is_none());
        FinishedError::NoStructure { folder: without.unwrap_or_default(), name: observable.name }
    })
}

/// Writes a function as comma-separated values: what it is over, its mean and its bar, lines without a mean left out.
///
/// # Errors
/// Those of what is written to.
pub(super) fn write_csv(observable: &Observable, points: &[Point], out: &mut dyn Write) -> io::Result<()> {
    let with_unit = |[name, unit]: [&str; 2]| match unit {
        "" => name.to_owned(),
        unit => format!("{name} ({unit})"),
    };
    for &over in observable.over {
        write!(out, "{},", with_unit(over))?;
    }
    writeln!(out, "{},error", with_unit(observable.value))?;
    for Point { over, mean, bar } in points.iter().filter(|point| !point.mean.is_nan()) {
        over.iter().try_for_each(|over| write!(out, "{over:?},"))?;
        writeln!(out, "{mean:?},{bar:?}")?;
    }
    Ok(())
}

impl Function {
    /// As comma-separated values.
    pub fn csv(&self) -> Vec<u8> {
        let mut bytes = vec![];
        // Memory takes everything.
        write_csv(self.observable, &self.points, &mut bytes).unwrap_or_default();
        bytes
    }
}

/// The points of a file; none where there is no such file.
fn points(path: &Path, observable: &Observable) -> Option<Vec<Point>> {
    let text = String::from_utf8(regular_file::read(path, LONGEST).ok()?).ok()?;
    let point = |line: &str| -> Option<Point> {
        let mut over: Vec<f64> = line.split(',').map(str::parse).collect::<Result<_, _>>().ok()?;
        let (bar, mean) = (over.pop()?, over.pop()?);
        (over.len() == observable.over.len()).then_some(Point { over, mean, bar })
    };
    Some(text.lines().skip(1).map_while(point).collect())
}

/// What a run says at its end; nothing where it has not ended.
fn summary(folder: &Path) -> Value {
    let bytes = regular_file::read(&folder.join(SUMMARY), LONGEST << 4).unwrap_or_default();
    serde_json::from_slice(&bytes).unwrap_or_default()
}

/// A number that stands for an observable, as a point that is nowhere.
fn number(summary: &Value, observable: &str, name: &str) -> Option<Point> {
    let find = |list: &Value, name: &str| list.as_array()?.iter().find(|it| it["name"] == name).cloned();
    let found = find(&find(&summary["structure"], observable)?["headlines"], name)?;
    Some(Point { over: vec![], mean: found["mean"].as_f64()?, bar: found["bar"].as_f64()? })
}

/// What is doubtful of an observable by one run or several.
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

/// The points that are in all runs.
fn joined(runs: &[Vec<Point>]) -> Vec<Point> {
    let [first, others @ ..] = runs else { return vec![] };
    if others.is_empty() {
        return first.clone();
    }
    let of = |Point { over, mean, .. }: &Point| {
        let there = |run: &Vec<Point>| {
            let close = |point: &&Point| {
                let mut places = point.over.iter().zip(over);
                places.all(|(other, over)| (other - over).abs() <= SAME * over.abs())
            };
            run.iter().find(close).map(|point| point.mean)
        };
        let means: Option<Vec<f64>> = std::iter::once(Some(*mean)).chain(others.iter().map(there)).collect();
        let [mean, bar] = of_independent(&means?)?;
        Some(Point { over: over.clone(), mean, bar })
    };
    first.iter().filter_map(of).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// By hand: 1, 2 and 3 have the mean 2 and the standard error 1/√3, and Student's t for two degrees of freedom is 4.303.
    #[test]
    fn runs_are_joined_where_all_of_them_are() {
        let runs =
            [vec![[0.5, 1.0], [1.5, 7.0]], vec![[0.5, 2.0], [1.0, 9.0], [1.5, 7.0]], vec![[0.5 + 1e-9, 3.0]]];
        let point = |[over, mean]: [f64; 2]| Point { over: vec![over], mean, bar: 0.1 };
        let runs = runs.map(|run| run.into_iter().map(point).collect::<Vec<_>>());
        let [Point { over, mean, bar }] = &joined(&runs)[..] else { panic!() };
        assert!(
            over[..] == [0.5] && (mean - 2.0).abs() < 1e-12 && (bar - 4.3027 / 3_f64.sqrt()).abs() < 1e-3
        );
        assert_eq!(joined(&runs[..2]).len(), 2);
        assert_eq!(joined(&runs[..1]), runs[0]);
        assert_eq!(joined(&[]), vec![] as Vec<Point>);
    }
}
