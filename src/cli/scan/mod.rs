//! `stripmine scan`: runs of one scene over one or more keys, and one table of all means.

mod charts;
mod grid;
mod points;
mod table;

pub(super) use table::{KeyTable, TableKey, TablePoint, check_names};

use super::display::UnitSystem;
use super::run::MOST_SEEDS;
use super::run::side_by_side::{PlannedRun, SideBySide};
use crate::console::{CommandFailure, Common, count_up_to, print, print_json, print_message, to_json, warn};
use crate::report::figure::svg;
use clap::Args;
use grid::{ScanKey, scan_keys};
use points::{CheckedPoint, table_point};
use std::io::Write;
use std::path::{Path, PathBuf};
use stripmine_physics::io::owned_folder::{FolderContent, FolderKind, LOCK, OwnedFolder};
use stripmine_physics::method::{MethodEntry, Methods, Prepared, QuantityKind, prepare, vocabularies};
use stripmine_physics::quoted;
use stripmine_physics::reported::{ErrorClass, Reported};
use stripmine_physics::run::{ExistingRun, check_scene_of_folder, starts_from_beginning};
use stripmine_physics::scene::{MeanTarget, MistakeKind, SceneErrors, SceneValues, Spot, Width};

/// Table as comma-separated values, and as JSON.
const CSV: &str = "scan.csv";
const JSON: &str = "scan.json";
/// Kind of the folder that holds the points and their table.
pub(super) const SCAN: FolderKind = FolderKind {
    lock: LOCK,
    list: "scan.files",
    holds: FolderContent::Files {
        heading: "stripmine scan.files 1",
        is_own: |name| [CSV, JSON].contains(&name) || name.ends_with(".svg"),
        is_shared: false,
    },
};
/// Key of the target error.
const UNTIL: &str = "run.until";

/// Runs a scene over one or more keys, and prints one table of all means
///
/// Runs go side by side, each in a folder of its own below --out. The folder also gets scan.csv, scan.json, and a chart of each quantity.
/// A point that fails is a row with its reason; the others continue.
#[derive(Args)]
pub(super) struct ScanVerb {
    /// Preset name or scene file
    scene: String,
    /// Key with its values a,b,c, or a:b:n for n points evenly from a to b; several make a grid
    #[arg(long, required = true, value_name = "SECTION.KEY=VALUES")]
    over: Vec<String>,
    /// Overrides a value at all points; can be repeated
    #[arg(long = "set", value_name = "SECTION.KEY=VALUE")]
    overrides: Vec<String>,
    /// Runs at each point, with different seeds; their means are joined
    #[arg(long, value_name = "N", value_parser = |text: &str| count_up_to(MOST_SEEDS, text))]
    seeds: Option<u64>,
    /// Ends each run once the mean of a quantity has this error (95 % confidence), such as compressibility=1%; steps, events or time of the scene are the latest end
    #[arg(long, value_name = "QUANTITY=ERROR")]
    until: Option<String>,
    /// Quantities to print, separated by commas; default: the main ones that fit into 80 columns
    #[arg(long, value_delimiter = ',', value_name = "QUANTITIES")]
    of: Vec<String>,
    /// Folder for the results; default: SCENE.scan
    #[arg(long)]
    out: Option<PathBuf>,
    /// Resumes the scan in the folder: finishes what is left, and adds points
    #[arg(long, conflicts_with = "overwrite")]
    resume: bool,
    /// Replaces existing runs of these points
    #[arg(long)]
    overwrite: bool,
}

/// Some points of a scan have failed.
#[derive(Debug, thiserror::Error)]
#[error(
    "{failed} of {all} points failed; the table has the reasons\n  help: add --resume to the command to finish what can be finished"
)]
struct PointsFailed {
    failed: usize,
    all: usize,
}

impl Reported for PointsFailed {
    fn class(&self) -> ErrorClass {
        ErrorClass::Precondition
    }
}

impl ScanVerb {
    pub(super) fn run(&self, common: &Common, methods: Methods) -> Result<(), CommandFailure> {
        let keys = scan_keys(&self.over).map_err(CommandFailure::Options)?;
        let base = self.base_overrides(&keys).map_err(CommandFailure::Options)?;
        let vocabularies = vocabularies(methods);
        // The scene and its start file are read once, so that later changes of the files cannot mix scenes.
        let text = SceneValues::text(&self.scene, &vocabularies)?;
        let values = |own: &[String]| {
            SceneValues::parse(&self.scene, &text, &[base.as_slice(), own].concat(), &vocabularies)
        };
        let folder = self.folder();
        let points = self.checked_points(&keys, &folder, &values, methods)?;
        let Some(CheckedPoint { entry, quantities, .. }) = points.first() else { return Ok(()) };
        check_names(&self.of, quantities).map_err(CommandFailure::Options)?;
        let own = self.claimed_folder(&folder, &points)?;
        let shared = values(&points[0].runs[0].overrides)?.sharing_start();
        let with = |overrides: &[String]| -> Result<(Prepared, &'static MethodEntry), CommandFailure> {
            Ok(prepare(values(overrides)?.with_start_of(&shared), methods)?)
        };
        let largest = points.iter().map(|point| &point.memory).max_by_key(|memory| memory.needed);
        let Some(memory) = largest else { return Ok(()) };
        let runs: Vec<PlannedRun> = points.iter().flat_map(|point| point.runs.clone()).collect();
        if !common.quiet {
            print_message(format_args!(
                "{} points, {} runs into {}",
                points.len(),
                runs.len(),
                quoted::path(&folder)
            ));
        }
        let existing = self.existing();
        let side_by_side = SideBySide { existing, memory, common, prepare: &with, folder: &folder };
        let mut outcomes = side_by_side.carry_out(&runs)?.into_iter();
        let mut rows = vec![];
        for point in &points {
            let own: Vec<_> = outcomes.by_ref().take(point.runs.len()).collect();
            rows.push(table_point(point, &keys, own, methods)?);
        }
        let table = KeyTable { keys: table_keys(&keys, entry), points: rows };
        let units = UnitSystem::of(points[0].scene.parse().ok().as_ref());
        self.write(&own, &table, &units, common)?;
        if common.json {
            print_json(&table)?;
        } else {
            let note = format!("{}: {}", table.extent(), quoted::path(&folder));
            print(&table.text(&self.of, &self.main_quantities(entry), &units, note))?;
        }
        match table.failed() {
            0 => Ok(()),
            failed => Err(PointsFailed { failed, all: points.len() }.into()),
        }
    }

    /// Overrides of all points: those given, and the target error.
    ///
    /// # Errors
    /// A target that cannot be read, and keys that are given twice.
    fn base_overrides(&self, keys: &[ScanKey]) -> Result<Vec<String>, SceneErrors> {
        let mut overrides = self.overrides.clone();
        let mut mistakes = vec![];
        let mut refuse = |option: String, message: String, expected: &str| {
            let spot = Spot { file: option, place: None };
            let mut error = spot.error(MistakeKind::Override, message);
            error.expected = Some(expected.to_owned());
            mistakes.push(error);
        };
        let mut set: Vec<(String, String)> =
            self.overrides.iter().map(|text| (path_of(text), format!("--set {text}"))).collect();
        if let Some(until) = &self.until {
            set.push((UNTIL.to_owned(), format!("--until {until}")));
            let target = until.split_once('=').and_then(|(quantity, error)| {
                Some(MeanTarget { quantity: quantity.trim().to_owned(), error: Width::parse(error.trim())? })
            });
            match target {
                Some(target) => overrides.push(format!("{UNTIL}={}", target.to_toml())),
                None => refuse(
                    format!("--until {until}"),
                    "the target is not a quantity with an error".to_owned(),
                    "QUANTITY=ERROR, such as compressibility=1% or pressure=0.01",
                ),
            }
        }
        for key in keys {
            if let Some((_, option)) = set.iter().find(|(path, _)| *path == key.path) {
                let message = format!("the key `{}` is also given by --over", key.path);
                refuse(option.clone(), message, "each key once");
            }
        }
        if self.until.is_some() && self.overrides.iter().any(|text| path_of(text) == UNTIL) {
            refuse(
                "--until".to_owned(),
                format!("the key `{UNTIL}` is also given by --set"),
                "one of the two",
            );
        }
        SceneErrors::ok_if_empty(mistakes).map(|()| overrides)
    }

    /// Folder of the scan, with the names of its table and charts, once no run is refused.
    fn claimed_folder(&self, folder: &Path, points: &[CheckedPoint]) -> Result<OwnedFolder, CommandFailure> {
        let charts: Vec<String> = points[0]
            .entry
            .quantities
            .iter()
            .filter(|it| !matches!(it.kind, QuantityKind::Time | QuantityKind::Kept))
            .map(|it| charts::file_name(it.name))
            .collect();
        let mut own = OwnedFolder::open(folder, SCAN, &[])?;
        let existing = self.existing();
        for point in points {
            for run in &point.runs {
                starts_from_beginning(&run.folder, existing)?;
            }
            if self.resume {
                check_scene_of_folder(&point.scene, &point.runs[0].folder)?;
            }
        }
        own.claim([CSV, JSON].into_iter().chain(charts.iter().map(String::as_str)), self.overwrite)?;
        // Tables and charts of earlier runs would be wrong if these are interrupted.
        own.clear(&[JSON])?;
        Ok(own)
    }

    /// Writes the table and the charts.
    fn write(
        &self,
        own: &OwnedFolder,
        table: &KeyTable,
        units: &UnitSystem,
        common: &Common,
    ) -> Result<(), CommandFailure> {
        for figure in charts::figures(table, units) {
            match svg(&figure) {
                Ok(text) => {
                    drop(own.write(&charts::file_name(&figure.name), |out| out.write_all(text.as_bytes()))?)
                }
                Err(error) if !common.quiet => warn(error),
                Err(_) => {}
            }
        }
        let (csv, json) = (table.csv()?, to_json(table)?);
        own.write(CSV, |out| out.write_all(csv.as_bytes()))?;
        own.write(JSON, |out| out.write_all(json.as_bytes()))?;
        Ok(())
    }

    /// Quantities to show first: that of the target, then the main ones of the method.
    fn main_quantities(&self, entry: &'static MethodEntry) -> Vec<&str> {
        let target = self.until.as_deref().and_then(|until| Some(until.split_once('=')?.0.trim()));
        target.into_iter().chain(main_quantities(entry)).collect()
    }

    fn existing(&self) -> ExistingRun {
        match (self.resume, self.overwrite) {
            (true, _) => ExistingRun::Resume { other_version: false },
            (_, true) => ExistingRun::Overwrite,
            _ => ExistingRun::Refuse,
        }
    }

    fn folder(&self) -> PathBuf {
        self.out.clone().unwrap_or_else(|| {
            let stem = Path::new(&self.scene).file_stem().unwrap_or_default();
            PathBuf::from(format!("{}.scan", stem.to_string_lossy()))
        })
    }
}

/// Main quantities of a method: those that its trials observe, and means over intervals.
pub(super) fn main_quantities(entry: &'static MethodEntry) -> Vec<&'static str> {
    let of_trials = entry.trials.map_or(&[][..], |trials| trials.observables);
    let of_intervals = entry.quantities.iter().filter(|it| it.kind == QuantityKind::Interval);
    of_trials.iter().copied().chain(of_intervals.map(|it| it.name)).collect()
}

/// Key of an override.
fn path_of(text: &str) -> String {
    text.split('=').next().unwrap_or_default().trim().to_owned()
}

fn table_keys(keys: &[ScanKey], entry: &'static MethodEntry) -> Vec<TableKey> {
    keys.iter().map(|key| TableKey { key: key.path.clone(), unit: unit_of(&key.path, entry) }).collect()
}

/// Unit of a key; empty for pure numbers and words.
pub(super) fn unit_of(path: &str, entry: &'static MethodEntry) -> &'static str {
    let (section, name) = path.split_once('.').unwrap_or(("", path));
    let keys = &entry.vocabulary.keys;
    // A value of a list of tables, such as `walls.2.to`.
    let of_list = || {
        let (_, name) = name.split_once('.')?;
        keys.keys_and_fields().find(|key| key.section == section && key.name == name)
    };
    keys.key(section, name).or_else(of_list).map_or("", |key| key.unit)
}
