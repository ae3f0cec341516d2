//! `stripmine plot`: a run to look at, without another program.

mod particles;
mod window;

use crate::console::{Common, Failure, print, print_json, say};
use crate::io::replace::replace;
use crate::method::{Methods, Quantity};
use crate::report::figure::{Axis, Chart, Figure, Picture, Point, Series, Style, png, svg};
use crate::report::table::{Cell, Table};
use crate::report::terminal;
use clap::Args;
use serde_json::json;
use std::collections::BTreeMap;
use std::fs;
use std::io::{Error, ErrorKind, Write};
use std::path::{Path, PathBuf};

/// A run to look at: its observables over time, its last state and the density along a long box as pictures, and small in the terminal
#[derive(Args)]
pub(super) struct PlotVerb {
    /// The folder of a run
    run: PathBuf,
    /// Columns of thermo.csv, with commas between them; all that change by default
    #[arg(long, value_delimiter = ',')]
    columns: Vec<String>,
    /// Folder for the pictures; the run's name with `.plots` by default
    #[arg(long)]
    out: Option<PathBuf>,
}

/// Curves of a picture: more cannot be told apart.
const CURVES: usize = 5;
/// Points of a curve: more cannot be seen.
const POINTS: usize = 2000;
/// Characters of a curve in the terminal.
const SMALL: usize = 40;

impl PlotVerb {
    pub(super) fn run(&self, common: &Common, methods: Methods) -> Result<(), Failure> {
        let table = Observed::read(&self.run.join("thermo.csv"))?;
        let wanted = table.wanted(&self.columns, methods)?;
        let mut figures = table.figures(&wanted);
        match particles::pictures(&self.run) {
            Ok(pictures) => figures.extend(pictures),
            Err(why) if !common.quiet => say(format_args!("the particles are not drawn: {why}")),
            Err(_) => {}
        }
        let out = self.out.clone().unwrap_or_else(|| {
            let stem = self.run.file_stem().unwrap_or_default();
            PathBuf::from(format!("{}.plots", stem.to_string_lossy()))
        });
        fs::create_dir_all(&out).map_err(Failure::writing(format!("creating {}", out.display())))?;
        let mut written = vec![];
        for figure in &figures {
            let drawn =
                |cause: &dyn std::fmt::Display| Failure::writing("drawing")(Error::other(cause.to_string()));
            let pictures = [
                ("svg", svg(figure).map_err(|cause| drawn(&cause))?.into_bytes()),
                ("png", png(figure).map_err(|cause| drawn(&cause))?),
            ];
            for (kind, bytes) in pictures {
                let file = out.join(format!("{}.{kind}", figure.name));
                let done = replace(&file, |out| out.write_all(&bytes));
                done.map_err(|error| {
                    Failure::writing(format!("{} {}", error.action, error.file.display()))(error.cause)
                })?;
                written.push(file.display().to_string());
            }
        }
        if common.json {
            return print_json(&json!({ "files": written }));
        }
        print(&terminal::render(&table.small(&wanted, &out)))
    }
}

/// `thermo.csv`.
struct Observed {
    columns: Vec<String>,
    rows: Vec<Vec<f64>>,
}

/// A column that is asked for, with what is known of it.
struct Wanted {
    column: usize,
    unit: &'static str,
}

impl Observed {
    fn read(path: &Path) -> Result<Observed, Failure> {
        let text =
            fs::read_to_string(path).map_err(Failure::writing(format!("reading {}", path.display())))?;
        let wrong = |line: usize| {
            let cause =
                Error::new(ErrorKind::InvalidData, format!("line {line} is no row of numbers of a run"));
            Failure::writing(format!("reading {}", path.display()))(cause)
        };
        let mut lines = text.lines();
        let columns: Vec<String> =
            lines.next().ok_or_else(|| wrong(1))?.split(',').map(str::to_owned).collect();
        let mut rows = vec![];
        for (number, line) in lines.enumerate() {
            let row: Result<Vec<f64>, _> = line.split(',').map(str::parse).collect();
            let row = row.ok().filter(|row: &Vec<f64>| row.len() == columns.len());
            rows.push(row.ok_or_else(|| wrong(number + 2))?);
        }
        let has = |name: &str| columns.iter().any(|column| column == name);
        if rows.is_empty() || !has("time") {
            return Err(wrong(2));
        }
        Ok(Observed { columns, rows })
    }

    fn column(&self, column: usize) -> impl Iterator<Item = f64> {
        self.rows.iter().map(move |row| row[column])
    }

    fn time(&self) -> usize {
        self.columns.iter().position(|column| column == "time").unwrap_or_default()
    }

    fn wanted(&self, names: &[String], methods: Methods) -> Result<Vec<Wanted>, Failure> {
        // The method of the run is the one that observes all its columns.
        let is_its = |quantities: &&'static [Quantity]| {
            let known = |name: &String| quantities.iter().any(|quantity| quantity.name == name);
            self.columns.iter().skip(1).all(known)
        };
        let quantities = methods.iter().map(|method| method.quantities).find(is_its).unwrap_or_default();
        let of = |column: usize| {
            let name = &self.columns[column];
            let unit = quantities.iter().find(|quantity| quantity.name == name).map_or("", |it| it.unit);
            Wanted { column, unit }
        };
        if names.is_empty() {
            let changes = |column: &usize| {
                let first = self.rows[0][*column];
                self.column(*column).any(|value| value != first)
            };
            let all = 0..self.columns.len();
            let shown = all.filter(|&column| !["step", "time"].contains(&self.columns[column].as_str()));
            return Ok(shown.filter(changes).map(of).collect());
        }
        let find = |name: &String| match self.columns.iter().position(|column| column == name) {
            Some(column) => Ok(of(column)),
            None => {
                let cause = format!("there is no column {name}; these are: {}", self.columns.join(", "));
                Err(Failure::writing("--columns")(Error::new(ErrorKind::InvalidInput, cause)))
            }
        };
        names.iter().map(find).collect()
    }

    /// A picture for each unit, of a few curves at most.
    fn figures(&self, wanted: &[Wanted]) -> Vec<Figure> {
        let mut units: BTreeMap<&str, Vec<usize>> = BTreeMap::new();
        wanted.iter().for_each(|it| units.entry(it.unit).or_default().push(it.column));
        let mut figures = vec![];
        for (unit, columns) in units {
            for columns in columns.chunks(CURVES) {
                let names: Vec<&str> = columns.iter().map(|&column| self.columns[column].as_str()).collect();
                figures.push(self.figure(unit, columns, &names));
            }
        }
        figures
    }

    fn figure(&self, unit: &str, columns: &[usize], names: &[&str]) -> Figure {
        let every = self.rows.len().div_ceil(POINTS);
        let time = self.time();
        let series = columns.iter().zip(names).enumerate().map(|(hue, (&column, name))| Series {
            name: name.replace('_', " "),
            style: Style::Line,
            hue,
            points: self.rows.iter().step_by(every).map(|row| Point::at(row[time], row[column])).collect(),
        });
        let label = if names.len() == 1 { names[0].replace('_', " ") } else { "value".to_owned() };
        Figure {
            name: names.join("-").replace('_', "-"),
            title: names.iter().map(|name| name.replace('_', " ")).collect::<Vec<_>>().join(", "),
            caption: "Of thermo.csv.".into(),
            picture: Picture::Chart(Chart {
                x: Axis::linear("time", Some("the scene's unit")),
                y: Axis::linear(&label, (!unit.is_empty()).then_some(unit)),
                series: series.collect(),
                bands: vec![],
            }),
        }
    }

    /// Every column in a line: first, last, and its course.
    fn small(&self, wanted: &[Wanted], out: &Path) -> Table {
        let rows = wanted.iter().map(|it| {
            let values: Vec<f64> = self.column(it.column).collect();
            let text =
                |value: Option<&f64>| Cell::Text(value.map_or(String::new(), |value| format!("{value:.4}")));
            vec![
                Cell::Text(self.columns[it.column].clone()),
                text(values.first()),
                text(values.last()),
                Cell::Text(course(&values)),
            ]
        });
        let columns = ["quantity", "first", "last", "course"].map(str::to_owned).to_vec();
        let notes = vec![format!("pictures in {}", out.display())];
        Table { name: "plot".into(), title: "The run".into(), columns, rows: rows.collect(), notes }
    }
}

/// A curve of a few characters, from the smallest to the largest value.
fn course(values: &[f64]) -> String {
    const STEPS: [char; 8] = ['▁', '▂', '▃', '▄', '▅', '▆', '▇', '█'];
    let low = values.iter().copied().fold(f64::INFINITY, f64::min);
    let high = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let count = values.len().min(SMALL);
    let of = |at: usize| {
        let value = values[at * (values.len() - 1) / (count - 1).max(1)];
        let share = if high > low { (value - low) / (high - low) } else { 0.0 };
        STEPS[((share * 8.0) as usize).min(7)]
    };
    (0..count).map(of).collect()
}

#[cfg(test)]
mod tests {
    use super::course;

    #[test]
    fn a_course_goes_from_the_smallest_to_the_largest() {
        assert_eq!(course(&[0.0, 1.0, 2.0, 4.0]), "▁▃▅█");
        assert_eq!(course(&[3.0]), "▁");
        assert_eq!(course(&[1.0; 100]).chars().count(), 40);
    }
}
