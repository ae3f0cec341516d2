//! `stripmine average`: mean and error of every quantity, over one run or several.

use super::display::{UnitSystem, decimals, mean_or_reason, reasons, scene_of};
use super::run::seeds::SEEDS;
use super::run_folder;
use super::scan::{KeyTable, SCAN, TableKey, TablePoint, check_names, main_quantities, unit_of};
use crate::console::{CommandFailure, Common, print, print_json, print_text, warn};
use crate::frame::{ResultFrame, csv};
use crate::report::{FormattedTable, FrameBuilder, TableCell, terminal};
use clap::Args;
use clap::builder::PossibleValuesParser;
use serde::Serialize;
use std::path::{Path, PathBuf};
use stripmine_physics::averages::{Average, AverageOutcome, Estimate, RunAverages};
use stripmine_physics::io::owned_folder::{FolderKind, names_in};
use stripmine_physics::method::{MethodEntry, Methods, method, observed_quantities};
use stripmine_physics::number::{count_with_noun, significant};
use stripmine_physics::run::{
    FinishedError, FinishedRun, FunctionPoint, Number, ScenePoint, ScenePoints, StructureFunction,
    TableReader, averages_of, function_of, functions_of, points_of,
};
use stripmine_physics::structure::{NAMES, observable};

/// Prints the mean of every quantity of a run with its error
///
/// Several runs of one scene with different seeds are joined. Runs of different scenes make a table over the keys in which the scenes differ.
#[derive(Args)]
pub(super) struct AverageVerb {
    /// Folders of runs, or of several runs made by `run --seeds` or `scan`
    #[arg(required = true, value_name = "RUN")]
    runs: Vec<PathBuf>,
    /// Quantities to print, separated by commas; default: all, and of runs of different scenes the main ones that fit into 80 columns
    #[arg(long, value_delimiter = ',', value_name = "QUANTITIES", conflicts_with = "structure")]
    of: Vec<String>,
    /// Prints the table as CSV
    #[arg(long, conflicts_with = "json")]
    csv: bool,
    /// Prints a structure function instead, such as "g(r)", with its error bars
    #[arg(long, value_name = "NAME", value_parser = PossibleValuesParser::new(NAMES))]
    structure: Option<String>,
}

/// Document of `--json`.
#[derive(Serialize)]
struct AveragesDocument<'a> {
    #[serde(flatten)]
    averages: &'a RunAverages,
    #[serde(skip_serializing_if = "<[_]>::is_empty")]
    structure: &'a [StructureFunction],
}

impl AverageVerb {
    pub(super) fn run(&self, common: &Common, methods: Methods) -> Result<(), CommandFailure> {
        let folders = folders_of_runs(&self.runs)?;
        let runs =
            folders.iter().map(|run| FinishedRun::read(run, methods)).collect::<Result<Vec<_>, _>>()?;
        let units = UnitSystem::of(folders.first().and_then(|run| scene_of(run)).as_ref());
        let scenes = if self.structure.is_none() { Some(points_of(&runs)?) } else { None };
        if let Some(scenes) = scenes.filter(|scenes| !scenes.keys.is_empty()) {
            return self.print_points(scenes, &folders, &units, common, methods);
        }
        let mut averages = averages_of(&runs)?;
        if !self.of.is_empty() {
            self.check_names(&folders[0], methods)?;
            averages.quantities.retain(|it| self.of.iter().any(|name| name == it.quantity));
        }
        let folders = || folders.iter().map(PathBuf::as_path);
        if let Some(observable) = self.structure.as_deref().and_then(observable) {
            let function = function_of(folders(), observable)?;
            if common.json {
                return print_json(&function);
            }
            // Warnings go to standard error: the table may be read by a program.
            warn_of_doubts(std::slice::from_ref(&function));
            return match self.csv {
                true => print(&function.csv()),
                false => print(&terminal::render(&function_table(&function, &units))),
            };
        }
        let functions = if self.of.is_empty() { functions_of(folders())? } else { vec![] };
        if common.json {
            return print_json(&AveragesDocument { averages: &averages, structure: &functions });
        }
        warn_of_doubts(&functions);
        if self.csv {
            let mut bytes = vec![];
            csv::write(&ResultFrame::from(&full_table(&averages)), &mut bytes)
                .map_err(CommandFailure::writing("CSV"))?;
            return print(&String::from_utf8_lossy(&bytes));
        }
        print(&terminal::render(&means_table(&units.averages(&averages))))?;
        if functions.is_empty() {
            return Ok(());
        }
        let names: Vec<&str> = functions.iter().map(|function| function.name).collect();
        let more = format!("--structure NAME prints a whole function: {}.", names.join(", "));
        match functions.iter().all(|function| function.headlines.is_empty()) {
            true => print_text(&format!("\nStructure: no numbers. {more}\n")),
            false => {
                print(&format!("\n{}", terminal::render(&structure_table(&functions, &units).note(more))))
            }
        }
    }
}

impl AverageVerb {
    /// Checks the names of the requested quantities; returns the method of a run.
    fn check_names(&self, run: &Path, methods: Methods) -> Result<&'static MethodEntry, CommandFailure> {
        let scene = scene_of(run);
        let kind = scene.as_ref().and_then(|scene| scene.get("method")?.get("kind")?.as_str());
        let entry = kind.and_then(|kind| method(methods, kind));
        let entry = entry.ok_or_else(|| FinishedError::NoMethod(run.to_owned()))?;
        let table = TableReader::open(&run.join("thermo.csv")).ok();
        let quantities = table.and_then(|table| observed_quantities(methods, table.columns()));
        check_names(&self.of, quantities.unwrap_or(entry.quantities)).map_err(CommandFailure::Options)?;
        Ok(entry)
    }

    /// Prints the means of runs of different scenes over the keys in which these differ.
    fn print_points(
        &self,
        scenes: ScenePoints,
        folders: &[PathBuf],
        units: &UnitSystem,
        common: &Common,
        methods: Methods,
    ) -> Result<(), CommandFailure> {
        let entry = self.check_names(&folders[0], methods)?;
        let names =
            |runs: Vec<usize>| runs.into_iter().map(|run| folders[run].display().to_string()).collect();
        let point = |ScenePoint { values, runs, averages }| TablePoint {
            values,
            folders: names(runs),
            averages: Some(averages),
            failure: None,
        };
        let keys = scenes.keys.into_iter().map(|key| TableKey { unit: unit_of(&key, entry), key });
        let table = KeyTable { keys: keys.collect(), points: scenes.points.into_iter().map(point).collect() };
        if common.json {
            return print_json(&table);
        }
        if self.csv {
            return print(&table.csv()?);
        }
        print(&table.text(&self.of, &main_quantities(entry), units, table.extent()))
    }
}

/// Folders of the runs that some paths name. A folder of several runs stands for all of them; files of this program beside runs are left out.
fn folders_of_runs(paths: &[PathBuf]) -> Result<Vec<PathBuf>, CommandFailure> {
    let has = |folder: &Path, kinds: &[FolderKind]| kinds.iter().any(|kind| folder.join(kind.list).is_file());
    let has_list = |folder: &Path| has(folder, &[SEEDS, SCAN]);
    // A point of a scan is a run, or holds one for each seed.
    let is_point = |folder: &Path| {
        folder.is_dir()
            && !folder.join("thermo.csv").is_file()
            && folder.parent().is_some_and(|above| has(above, &[SCAN]))
    };
    let mut folders = vec![];
    for path in paths.iter().map(|path| run_folder(path)) {
        if has_list(&path) || is_point(&path) {
            let below = names_in(&path)?.unwrap_or_default().into_iter().map(|name| path.join(name));
            folders.extend(folders_of_runs(&below.filter(|it| it.is_dir()).collect::<Vec<_>>())?);
        } else if !(path.is_file() && path.parent().is_some_and(has_list)) {
            folders.push(path);
        }
    }
    // Without a run, the first path is reported.
    Ok(if folders.is_empty() { paths.to_vec() } else { folders })
}

/// Warns of every function whose result is doubtful.
fn warn_of_doubts(functions: &[StructureFunction]) {
    for StructureFunction { name, doubt, .. } in functions {
        doubt.iter().for_each(|doubt| warn(format_args!("{name}: {doubt}")));
    }
}

/// Table of a structure function, one row per point.
fn function_table(function: &StructureFunction, units: &UnitSystem) -> FormattedTable {
    let with_unit = |[name, unit]: [&str; 2]| match unit {
        "" => name.to_owned(),
        unit => format!("{name} ({})", units.symbol(unit)),
    };
    let mut rows = FrameBuilder::of(&function.points);
    for (at, &over) in function.observable.over.iter().enumerate() {
        rows = rows.cell(with_unit(over), move |point| {
            TableCell::Number(point.over[at], decimals(point.over[at], 4))
        });
    }
    rows.cell(with_unit(function.observable.value), |FunctionPoint { mean, .. }| {
        TableCell::Number(mean.value, decimals_of_mean(mean.value, mean.bar))
    })
    .cell("± 95 %", |point| TableCell::Number(point.mean.bar, decimals(point.mean.bar, 2)))
    .table("structure", format!("{} of {}", function.name, count_with_noun(function.runs, "run", "runs")))
}

/// Table of the characteristic numbers of structure functions, such as a peak height.
fn structure_table(functions: &[StructureFunction], units: &UnitSystem) -> FormattedTable {
    let of = |function: &'_ StructureFunction| -> Vec<(&'static str, Number)> {
        function.headlines.iter().map(|number| (function.name, number.clone())).collect()
    };
    let headlines: Vec<(&str, Number)> = functions.iter().flat_map(of).collect();
    FrameBuilder::of(&headlines)
        .text("structure", |(name, _)| *name)
        .text("number", |(_, number)| number.name)
        .cell("mean", |(_, number)| {
            TableCell::Number(number.mean.value, decimals_of_mean(number.mean.value, number.mean.bar))
        })
        .cell("± 95 %", |(_, number)| TableCell::Number(number.mean.bar, decimals(number.mean.bar, 2)))
        .text("unit", |(_, number)| units.symbol(number.unit))
        .table("structure", "Structure".to_owned())
        .note("± 95 %: from blocks of one run, or from the scatter between runs (Student's t).")
}

/// Table of the means for the terminal, one line for each quantity.
fn means_table(averages: &RunAverages) -> FormattedTable {
    let estimate = |it: &&Average| match it.outcome {
        AverageOutcome::Mean(estimate) => Some(estimate),
        _ => None,
    };
    let runs = count_with_noun(averages.runs, "run", "runs");
    FrameBuilder::of(&averages.quantities)
        .text("quantity", |it| it.quantity)
        .text("mean ± 95 %", |it| mean_or_reason(it))
        .text("unit", |it| it.unit.clone())
        .cell("from", move |it| {
            let from = estimate(it).map(|it| it.equilibrated_at);
            from.map_or(TableCell::Nothing, |from| TableCell::Number(from, decimals(from, 3)))
        })
        .cell("samples", move |it| {
            estimate(it).map_or(TableCell::Nothing, |it| TableCell::Count(it.independent_samples as u64))
        })
        .table("averages", format!("Means of {runs}, {} rows", averages.rows))
        .notes(reasons(&averages.quantities).into_iter().map(str::to_owned))
        .note("From: end of the transient. Samples are independent. --csv has standard errors and correlation times.")
}

/// Full table of the averages, a row for each quantity.
fn full_table(averages: &RunAverages) -> FormattedTable {
    let runs = count_with_noun(averages.runs, "run", "runs");
    let number = |of: fn(&Estimate) -> f64| {
        move |average: &&Average| match &average.outcome {
            AverageOutcome::Mean(estimate) => TableCell::Number(of(estimate), decimals(of(estimate), 3)),
            _ => TableCell::Nothing,
        }
    };
    FrameBuilder::of(&averages.quantities)
        .text("quantity", |it| it.quantity)
        .cell("mean", |it| match &it.outcome {
            AverageOutcome::Mean(Estimate { mean, bar, .. }) => TableCell::Number(*mean, decimals(*bar, 2)),
            AverageOutcome::Constant { mean } => TableCell::Number(*mean, decimals(*mean, 6)),
            _ => TableCell::Nothing,
        })
        .cell("± 95 %", |it| match &it.outcome {
            AverageOutcome::Mean(Estimate { bar, .. }) => TableCell::Number(*bar, decimals(*bar, 2)),
            _ => TableCell::Nothing,
        })
        .text("unit", |it| it.unit.clone())
        .cell("standard error", number(|it| it.standard_error))
        .cell("correlation time", number(|it| it.correlation_time))
        .cell("from time", number(|it| it.equilibrated_at))
        .cell("independent samples", |it| match &it.outcome {
            AverageOutcome::Mean(Estimate { independent_samples: samples, .. })
            | AverageOutcome::TooShort { independent_samples: samples, .. } => TableCell::Number(*samples, 0),
            _ => TableCell::Nothing,
        })
        .text("remark", |it| remark(it))
        .table("averages", format!("Averages of {runs}, {} rows", averages.rows))
        .note(format!("± 95 %: the {}.", averages.bar))
}

/// Decimals of a mean: two digits of its error bar, or six digits if the bar is missing or only rounding.
fn decimals_of_mean(mean: f64, bar: f64) -> usize {
    if bar > 1e-9 * mean.abs() { decimals(bar, 2) } else { decimals(mean, 6) }
}

fn remark(average: &Average) -> String {
    match &average.outcome {
        AverageOutcome::Mean(_) if average.of == "values" => String::new(),
        AverageOutcome::Mean(_) => match average.of {
            "rate" => "rate of the count".to_owned(),
            _ => "mean over intervals between rows".to_owned(),
        },
        AverageOutcome::Constant { .. } => "constant".to_owned(),
        AverageOutcome::Undefined => "undefined in some rows".to_owned(),
        AverageOutcome::TooShort { enough_at, .. } => {
            format!("run too short, needs time {}", significant(*enough_at, 2))
        }
        AverageOutcome::Changing { first, last } => {
            format!("still changing, from {} to {}", significant(*first, 3), significant(*last, 3))
        }
        AverageOutcome::Kept { first, farthest, .. } => {
            format!("deviates by at most {} from {}", significant(*farthest, 2), significant(*first, 3))
        }
    }
}
