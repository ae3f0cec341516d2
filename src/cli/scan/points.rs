//! Points of a scan: checked before anything runs, and their rows in the table.

use super::grid::{ScanKey, ScanPoint, grid};
use super::table::TablePoint;
use super::{ScanVerb, UNTIL};
use crate::cli::run::seeds::{seed_keys, seeded_runs};
use crate::cli::run::side_by_side::{FailedRun, PlannedRun};
use crate::console::CommandFailure;
use std::path::Path;
use stripmine_physics::averages::joined;
use stripmine_physics::input::MistakeList;
use stripmine_physics::memory::MemoryForecast;
use stripmine_physics::method::{MethodEntry, Methods, ObservedQuantity, Prepared, prepare};
use stripmine_physics::reported::ErrorClass;
use stripmine_physics::run::{FinishedRun, Summary, averages_of};
use stripmine_physics::scene::{MistakeKind, SceneErrors, SceneValues, Spot};
use toml::Value;

/// Point of a scan that was checked.
pub(super) struct CheckedPoint {
    point: ScanPoint,
    pub(super) runs: Vec<PlannedRun>,
    pub(super) memory: MemoryForecast,
    pub(super) entry: &'static MethodEntry,
    /// Observed quantities.
    pub(super) quantities: &'static [ObservedQuantity],
    /// Resolved scene of its first run.
    pub(super) scene: String,
}

impl ScanVerb {
    /// Checks the scenes of all points, so that every mistake is reported before anything runs.
    ///
    /// # Errors
    /// The mistakes of all scenes, each once.
    pub(super) fn checked_points(
        &self,
        keys: &[ScanKey],
        folder: &Path,
        values: &dyn Fn(&[String]) -> Result<SceneValues, SceneErrors>,
        methods: Methods,
    ) -> Result<Vec<CheckedPoint>, CommandFailure> {
        let (mut checked, mut refused) = (vec![], vec![]);
        let points = grid(keys);
        let count = points.len();
        for point in points {
            match self.checked_point(&point, keys, folder, values, methods) {
                Ok(point) => checked.push(point),
                Err(errors) => refused.push((point, errors)),
            }
        }
        let kinds = |point: &CheckedPoint| point.entry.vocabulary.keys.method;
        if let Some(other) = checked.iter().find(|point| kinds(point) != kinds(&checked[0])) {
            let spot = Spot { file: "--over".to_owned(), place: None };
            let message =
                format!("the points have different methods: {} and {}", kinds(&checked[0]), kinds(other));
            let error = spot.error(MistakeKind::Contradiction, message);
            return Err(CommandFailure::Options(
                error.advising("scan the scene of each method by itself").into(),
            ));
        }
        all_mistakes(&refused, count, self.until.as_deref(), &self.scene)?;
        Ok(checked)
    }

    fn checked_point(
        &self,
        point: &ScanPoint,
        keys: &[ScanKey],
        folder: &Path,
        values: &dyn Fn(&[String]) -> Result<SceneValues, SceneErrors>,
        methods: Methods,
    ) -> Result<CheckedPoint, SceneErrors> {
        let scene = values(&point.overrides)?;
        let seeds = match methods.iter().find(|method| method.vocabulary.keys.method == scene.method()) {
            Some(method) if self.seeds.is_some() => seed_keys(&scene, method.vocabulary),
            _ => vec![],
        };
        let folder = folder.join(&point.name);
        let mut runs = match self.seeds {
            None => vec![PlannedRun { folder, overrides: vec![] }],
            Some(count) => {
                let scanned = seeds
                    .iter()
                    .map(|(key, _)| key.path())
                    .find(|path| keys.iter().any(|key| key.path == *path));
                let refusal = match scanned {
                    _ if seeds.is_empty() => {
                        Some("this scene has no random numbers: every seed gives the same run".to_owned())
                    }
                    Some(path) => Some(format!("--seeds varies `{path}`, which --over gives too")),
                    None => None,
                };
                if let Some(message) = refusal {
                    let spot = Spot { file: "--seeds".to_owned(), place: None };
                    return Err(spot.error(MistakeKind::Unused, message).into());
                }
                seeded_runs(&seeds, count, &folder)
            }
        };
        for run in &mut runs {
            run.overrides = [point.overrides.as_slice(), &run.overrides].concat();
        }
        let (prepared, entry) = prepare(values(&runs[0].overrides)?, methods)?;
        prepared.memory.fits(&self.scene)?;
        let quantities = prepared.quantities(entry);
        let Prepared { memory, scene, .. } = prepared;
        Ok(CheckedPoint { point: point.clone(), runs, memory, entry, quantities, scene })
    }
}

/// Row of a point.
///
/// # Errors
/// A failure that is not of the point: an interruption, a folder of others, a full disk.
pub(super) fn table_point(
    checked: &CheckedPoint,
    keys: &[ScanKey],
    outcomes: Vec<Result<Summary, FailedRun>>,
    methods: Methods,
) -> Result<TablePoint, CommandFailure> {
    let resolved: Option<toml::Table> = checked.scene.parse().ok();
    let value = |(key, typed): (&ScanKey, &Value)| {
        Some(resolved.as_ref().and_then(|scene| found(scene, &key.path)).unwrap_or(typed).clone())
    };
    let values = keys.iter().zip(&checked.point.values).map(value).collect();
    let folders = checked.runs.iter().map(|run| run.folder.display().to_string()).collect();
    let (mut means, mut failure, mut is_complete) = (vec![], None, true);
    for outcome in outcomes {
        match outcome {
            Ok(summary) => means.push(summary.averages),
            Err(FailedRun { failure: error, has_means }) => {
                let is_of_point = [ErrorClass::Precondition, ErrorClass::Input, ErrorClass::Checkpoint];
                if error.class().is_none_or(|class| !is_of_point.contains(&class)) {
                    return Err(error);
                }
                is_complete &= has_means;
                failure = failure.or(Some(error.report()));
            }
        }
    }
    let averages = match (&failure, is_complete) {
        (None, _) => Some(joined(&means)),
        (Some(_), true) => {
            let read = checked.runs.iter().map(|run| FinishedRun::read(&run.folder, methods));
            Some(averages_of(&read.collect::<Result<Vec<_>, _>>()?)?)
        }
        (Some(_), false) => None,
    };
    Ok(TablePoint { values, folders, averages, failure })
}

/// Value of a scene at a path such as `walls.2.to`; items of lists are numbered from 1.
fn found<'s>(scene: &'s toml::Table, path: &str) -> Option<&'s Value> {
    let mut parts = path.split('.');
    let first = scene.get(parts.next()?)?;
    parts.try_fold(first, |value, part| match value {
        Value::Array(items) => items.get(part.parse::<usize>().ok()?.checked_sub(1)?),
        _ => value.get(part),
    })
}

/// All mistakes of the scenes that were refused, each once, with the options as they were given. A mistake of the scene that not all points have is
/// named by their values.
///
/// # Errors
/// If there is any.
fn all_mistakes(
    refused: &[(ScanPoint, SceneErrors)],
    points: usize,
    until: Option<&str>,
    scene: &str,
) -> Result<(), SceneErrors> {
    let mut list = MistakeList::default();
    let mut known = vec![];
    for (point, errors) in refused {
        for error in &errors.0 {
            let own = point.overrides.iter().find(|text| error.file == format!("--set {text}"));
            let mut error = error.clone();
            if let Some(text) = own {
                error.file = format!("--over {text}");
            } else if let Some(until) = until.filter(|_| error.file.starts_with(&format!("--set {UNTIL}="))) {
                error.file = format!("--until {until}");
            } else if refused.iter().filter(|(_, others)| others.0.contains(&error)).count() < points {
                error.message = format!("{}: {}", point.overrides.join(", "), error.message);
            }
            let same = (error.message.clone(), error.expected.clone());
            if !known.contains(&same) {
                known.push(same);
                list.push(error);
            }
        }
    }
    list.ok_without_mistakes(scene)
}
