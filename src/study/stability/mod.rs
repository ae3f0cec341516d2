//! Stability maps: the steps at which a scene works, over a second parameter.
//!
//! Every point of a grid is run and judged: by the failure that stops it, by an error of the energy balance, and by comparing means over time
//! with those of runs at a short step. The boundaries between classes are found by bisection, from several seeds. Theoretical limits of the step
//! and warnings before and during a run are compared with the class of each point.

mod alarms;
mod averages;
mod boundary;
mod dataset;
mod extent;
mod frames;
mod outcome;
mod reference;
mod survey;
#[cfg(test)]
mod tests;

pub(crate) use frames::made;

use dataset::{Boundary, StabilityMap, TheoryLimit, VariedParameter};
use outcome::{MapPoint, RunClass};

use super::choice::SettingChoice;
use super::runs::StudyRuns;
use super::trial::{RunFailure, TrialControl};
use super::{StudyError, Subject};
use crate::results::{Journal, Progress, ProgressMeter, run_in_parallel};
use crate::statistics::median;
use extent::MapCosts;
use stripmine_physics::method::{ChoiceEffect, Parameter, StartPurpose};
use stripmine_physics::number::significant;
use survey::{MapVariant, Survey};

/// Shortest and longest step, in steps of the scene.
const STEPS: [f64; 2] = [0.5, 128.0];
/// Seconds of a step, and before the first, where neither could be timed.
const SLOW: [f64; 2] = [1e-3, 1e-2];
/// Most failures listed in an error.
const TRIED: usize = 8;

/// Extent and accuracy of a map.
#[derive(Clone, Copy, Debug)]
pub(crate) struct MapEffort {
    /// Available processor seconds.
    pub budget: f64,
    /// Most values of the parameter, and most steps.
    pub size: usize,
    /// Most seeds of the boundaries.
    pub seeds: u64,
    /// Tolerance of a boundary, in parts of the step.
    pub(crate) tolerance: f64,
}

/// Parameter that is varied, and its range.
#[derive(Clone, Copy, Debug)]
pub(crate) struct VariedRange {
    parameter: &'static Parameter,
    range: [f64; 2],
}

impl VariedRange {
    /// Selects a parameter by name, or the first that the scene sets; its range is the requested one, or lies around the scene's own value.
    ///
    /// # Errors
    /// [`StudyError`] if the parameter does not exist, or the range is invalid.
    pub(crate) fn of(
        subject: &Subject,
        name: Option<&str>,
        asked: Option<[f64; 2]>,
    ) -> Result<VariedRange, StudyError> {
        let all = subject.trials.parameters;
        let known = || all.iter().map(|parameter| parameter.name).collect();
        let is_meant = |parameter: &&Parameter| match name {
            Some(name) => parameter.name == name,
            None => (parameter.range)(&subject.values).is_some(),
        };
        let parameter = all.iter().find(is_meant).ok_or_else(|| match name {
            Some(name) => StudyError::NoSuchParameter { name: name.to_owned(), known: known() },
            None => StudyError::NothingOfItsOwn { known: known() },
        })?;
        let Some(range) = asked.or_else(|| (parameter.range)(&subject.values)) else {
            return Err(StudyError::NothingOfTheKind(parameter.name));
        };
        let [low, high] = range;
        let [least, most] = parameter.bounds;
        let is_allowed =
            least <= low && low < high && high <= most && (low > 0.0 || !parameter.is_logarithmic);
        if !is_allowed {
            return Err(StudyError::OutOfRange { name: parameter.name, range, bounds: parameter.bounds });
        }
        Ok(VariedRange { parameter, range })
    }

    /// Name of the parameter.
    pub(crate) fn name(&self) -> &'static str {
        self.parameter.name
    }
}

/// Values from one end of a range to the other.
fn ladder([low, high]: [f64; 2], count: usize, is_logarithmic: bool) -> Vec<f64> {
    let last = count.saturating_sub(1).max(1) as f64;
    let at = |i: usize| {
        let part = i as f64 / last;
        let value = if is_logarithmic { low * (high / low).powf(part) } else { low + (high - low) * part };
        // Values are parsed from text again, so few digits are used.
        format!("{value:.5e}").parse().unwrap_or(value)
    };
    (0..count).map(at).collect()
}

/// Surveys a scene. Finished runs are recorded in the journal.
///
/// # Errors
/// [`StudyError`] if no run works, the user interrupts, or finished runs cannot be recorded.
pub(crate) fn stability(
    subject: &Subject,
    VariedRange { parameter, range }: VariedRange,
    effort: &MapEffort,
    trial: TrialControl<'_>,
    journal: &Journal,
    progress: Progress<'_>,
) -> Result<StabilityMap, StudyError> {
    let meter = ProgressMeter::new(effort.budget, progress);
    let runs = StudyRuns { subject, trial, journal, meter: &meter };
    let schemes = schemes(subject);
    let [each, start] = journal.run_on_one(|| probe(&runs, parameter, range))?;
    let (asked, scene) = ((effort.size, effort.seeds), subject.steps as f64);
    let extent = MapCosts { each, start, schemes: schemes.len() }.extent(effort.budget, asked, scene)?;
    meter.expect(extent.seconds);
    let values = ladder(range, extent.size, parameter.is_logarithmic);
    let steps = ladder(STEPS.map(|factor| factor * subject.step), extent.size, true);
    let duration = extent.own_steps * subject.step;
    let seeds: Vec<u64> = (1..=extent.seeds).collect();
    let (runs, tolerance) = (&runs, effort.tolerance);
    let survey = Survey { runs, parameter, steps: &steps, duration, each, seeds: &seeds, tolerance };
    let own = |value: f64| MapVariant { choice: &subject.own, value: Some(value) };
    let column = |&value: &f64| -> Result<(Vec<MapPoint>, Boundary, Option<String>), StudyError> {
        let known = survey.measure_reference(Some(value))?;
        let cells = run_in_parallel(&steps, |&step| survey.cell(own(value), &known, step, 1))?;
        let first = |is_so: fn(RunClass) -> bool| {
            cells.iter().position(|cell| !is_so(cell.class)).unwrap_or(cells.len())
        };
        let guesses = [first(|class| class == RunClass::Works), first(RunClass::ends)];
        let boundary = survey.boundary(own(value), &known, guesses)?;
        Ok((cells, boundary, known.err()))
    };
    let columns: Vec<_> = journal.run_all(&values, column)?;
    let (mut map, mut boundaries, mut unjudged) = (vec![], vec![], vec![]);
    for (&value, (cells, boundary, why)) in values.iter().zip(columns) {
        map.push(cells);
        boundaries.push(boundary);
        unjudged.extend(why.map(|why| (value, why)));
    }
    if map.iter().flatten().all(|cell| cell.class != RunClass::Works) {
        return Err(StudyError::EveryRunFails { tried: tried(&values, &steps, &map, parameter) });
    }
    let known = journal.run_on_one(|| survey.measure_reference(None))?;
    let schemes = journal.run_all(&schemes, |scheme| survey.scheme(scheme, &known))?;
    let is_inside = |value: f64| range[0] <= value && value <= range[1];
    Ok(StabilityMap {
        method: subject.entry.vocabulary.keys.method,
        configuration: subject.own.label(),
        time_unit: subject.unit("time"),
        step: subject.step,
        duration,
        left_out: extent.left_out(asked, scene),
        parameter: VariedParameter::of(parameter, subject),
        limits: limits(&survey, &values, own),
        marks: (parameter.marks)(&subject.values).into_iter().filter(|(at, _)| is_inside(*at)).collect(),
        values,
        steps: steps.clone(),
        map,
        boundaries,
        tolerance,
        schemes,
        unjudged,
        seeds: seeds.clone(),
    })
}

/// Configurations of the scene with every integrator.
fn schemes(subject: &Subject) -> Vec<SettingChoice> {
    let axes = subject.entry.axes.iter().filter(|axis| axis.decides == ChoiceEffect::Order);
    axes.flat_map(|axis| axis.settings.iter().map(|setting| subject.own.with(&[(axis.name, setting.name)])))
        .collect()
}

/// Seconds of a step, and before the first: medians over the ends and the middle of the range.
fn probe(runs: &StudyRuns<'_>, parameter: &Parameter, range: [f64; 2]) -> Result<[f64; 2], StudyError> {
    let (subject, watch) = (runs.subject, runs.trial.watch);
    let of = |value: f64| -> Result<[f64; 2], RunFailure> {
        let overrides = (parameter.overrides)(&subject.values, value);
        let begun = watch.now();
        let scene = subject.prepared_at_any_step(&subject.own, subject.step, &overrides)?;
        drop(scene.start(StartPurpose::Run)?);
        let start = watch.now() - begun;
        Ok([runs.probe(&scene)?, start])
    };
    let fits =
        |[each, start]: &[f64; 2]| each.is_finite() && *each > 0.0 && start.is_finite() && *start >= 0.0;
    let found = ladder(range, 3, parameter.is_logarithmic)
        .into_iter()
        .map(|value| runs.recall(&format!("probe|{value:?}"), fits, || of(value)));
    let found: Vec<Result<[f64; 2], RunFailure>> = found.collect::<Result<_, StudyError>>()?;
    let found: Vec<[f64; 2]> = found.into_iter().flatten().collect();
    if found.is_empty() {
        return Ok(SLOW);
    }
    Ok([0, 1].map(|place| median(found.iter().map(|it| it[place]))))
}

/// Theoretical limits of the step, over the values.
fn limits<'v>(survey: &Survey<'_>, values: &[f64], own: impl Fn(f64) -> MapVariant<'v>) -> Vec<TheoryLimit> {
    let mut limits: Vec<TheoryLimit> = vec![];
    for &value in values {
        for found in survey.limits(own(value)) {
            let point = (value, found.step);
            match limits.iter_mut().find(|limit| limit.name == found.name) {
                Some(limit) => limit.points.push(point),
                None => {
                    limits.push(TheoryLimit { name: found.name, beyond: found.beyond, points: vec![point] })
                }
            }
        }
    }
    limits
}

/// Failures to list in an error, one per value.
fn tried(
    values: &[f64],
    steps: &[f64],
    map: &[Vec<MapPoint>],
    parameter: &Parameter,
) -> Vec<(String, String)> {
    let every = values.len().div_ceil(TRIED).max(1);
    let first = |(value, cells): (&f64, &Vec<MapPoint>)| {
        let MapPoint { class, what, .. } = cells.first()?;
        let [value, step] = [*value, steps[0]].map(|it| significant(it, 6));
        Some((format!("{} = {value}, step {step}", parameter.name), format!("{}: {what}", class.name())))
    };
    values.iter().zip(map).step_by(every).filter_map(first).collect()
}
