//! Where a method works: over the step and a second parameter.
//!
//! Every place of a grid is run and judged: what stops it, whether energy comes from nowhere, and whether means over time are
//! those of runs with a fine step. The edges of what works and of what comes to its end are found by bisection, from several
//! seeds. What theory says of the step is drawn in, and what the program says of it, before and during a run, is held against
//! what became of it.

mod alarm;
mod alarms;
mod boundary;
mod dataset;
mod extent;
mod frames;
mod outcome;
mod reference;
mod survey;

pub use frames::made;

use dataset::{Boundary, Limit, Stability, Varied};
use outcome::{Cell, Class};

use super::choice::Choice;
use super::{StudyError, Subject};
use crate::results::{Journal, JournalError, Meter, Progress};
use crate::statistics::median;
use cpu_time::ProcessTime;
use extent::Costs;
use rayon::iter::{IntoParallelRefIterator, ParallelIterator};
use stripmine_physics::method::{Decides, Parameter, Purpose, probed};
use stripmine_physics::number::significant;
use survey::{Case, Known, Survey};

/// Steps go from this part of the scene's own to this multiple.
const STEPS: [f64; 2] = [0.5, 128.0];
/// Steps of a probe at most.
const PROBED: u64 = 4096;
/// Failures that an error names at most.
const TRIED: usize = 8;

/// How much is done.
#[derive(Clone, Copy, Debug)]
pub struct Effort {
    /// Processor seconds that it may take.
    pub budget: f64,
    /// Values of the parameter, and steps, at most.
    pub size: usize,
    /// Seeds of the edges, at most.
    pub seeds: u64,
    /// How far apart the two ends of an edge are at most, in parts of the step.
    pub tolerance: f64,
}

/// What is varied, and from where to where.
#[derive(Clone, Copy, Debug)]
pub struct Over {
    parameter: &'static Parameter,
    range: [f64; 2],
}

impl Over {
    /// What a scene lets vary, by name, or the first that it has a value of; over a range that is asked for, or about the scene's own value.
    ///
    /// # Errors
    /// [`StudyError`] if it has nothing of that name, or the range is none.
    pub fn of(subject: &Subject, name: Option<&str>, asked: Option<[f64; 2]>) -> Result<Over, StudyError> {
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
        Ok(Over { parameter, range })
    }

    /// The name of what is varied.
    pub fn name(&self) -> &'static str {
        self.parameter.name
    }
}

/// Values from one end of a range to the other.
fn ladder([low, high]: [f64; 2], count: usize, is_logarithmic: bool) -> Vec<f64> {
    let last = count.saturating_sub(1).max(1) as f64;
    let at = |i: usize| {
        let part = i as f64 / last;
        let value = if is_logarithmic { low * (high / low).powf(part) } else { low + (high - low) * part };
        // Values are read again as they are written; few digits are enough.
        format!("{value:.5e}").parse().unwrap_or(value)
    };
    (0..count).map(at).collect()
}

/// Surveys a scene.
///
/// # Errors
/// [`StudyError`] if nothing works anywhere, or finished runs cannot be kept.
pub fn stability(
    subject: &Subject,
    Over { parameter, range }: Over,
    effort: &Effort,
    journal: &Journal,
    progress: Progress<'_>,
) -> Result<Stability, StudyError> {
    let meter = Meter::new(effort.budget, progress);
    let schemes = schemes(subject);
    let probed = || Ok::<_, JournalError>(probe(subject, parameter, range));
    let fits = |costs: &[f64; 2]| costs.iter().all(|cost| cost.is_finite() && *cost > 0.0);
    let [each, start] = journal.once(|| journal.recall("probe", fits, probed))?;
    let (asked, scene) = ((effort.size, effort.seeds), subject.steps as f64);
    let extent = Costs { each, start, schemes: schemes.len() }.extent(effort.budget, asked, scene)?;
    meter.expect(extent.seconds);
    let values = ladder(range, extent.size, parameter.is_logarithmic);
    let steps = ladder(STEPS.map(|factor| factor * subject.step), extent.size, true);
    let duration = extent.own_steps * subject.step;
    let survey = Survey { subject, parameter, journal, meter: &meter, steps: &steps, duration, each };
    let seeds: Vec<u64> = (1..=extent.seeds).collect();
    let own = |value: f64| Case { choice: &subject.own, value: Some(value) };
    let column = |&value: &f64| -> Result<(Vec<Cell>, Boundary, Option<String>), JournalError> {
        let known = survey.known(Some(value))?;
        let cells = steps.par_iter().map(|&step| survey.cell(own(value), &known, step, 1));
        let cells: Vec<Cell> = cells.collect::<Result<_, JournalError>>()?;
        let first = |is_so: fn(Class) -> bool| {
            cells.iter().position(|cell| !is_so(cell.class)).unwrap_or(cells.len())
        };
        let guesses = [first(|class| class == Class::Works), first(Class::ends)];
        let boundary = survey.boundary(own(value), &known, guesses, &seeds, effort.tolerance)?;
        Ok((cells, boundary, known.err()))
    };
    let columns: Vec<_> = journal.over(&values, column)?;
    let (mut map, mut boundaries, mut unjudged) = (vec![], vec![], vec![]);
    for (&value, (cells, boundary, why)) in values.iter().zip(columns) {
        map.push(cells);
        boundaries.push(boundary);
        unjudged.extend(why.map(|why| (value, why)));
    }
    if map.iter().flatten().all(|cell| cell.class != Class::Works) {
        return Err(StudyError::EveryRunFails { tried: tried(&values, &steps, &map, parameter) });
    }
    let known: Known = journal.once(|| survey.known(None))?;
    let scheme = |scheme: &Choice| survey.scheme(scheme, &known, &seeds, effort.tolerance);
    let schemes = journal.over(&schemes, scheme)?;
    Ok(Stability {
        method: subject.entry.vocabulary.keys.method,
        way: subject.own.label(),
        time_unit: subject.unit("time"),
        step: subject.step,
        duration,
        left_out: extent.left_out(asked, scene),
        parameter: Varied::of(parameter, subject),
        limits: limits(&survey, &values, own),
        marks: (parameter.marks)(&subject.values).into_iter().filter(|(at, _)| inside(*at, range)).collect(),
        values,
        steps: steps.clone(),
        map,
        boundaries,
        tolerance: effort.tolerance,
        schemes,
        unjudged,
        seeds,
    })
}

fn inside(value: f64, [low, high]: [f64; 2]) -> bool {
    low <= value && value <= high
}

/// The scene's own way to run, with every integrator.
fn schemes(subject: &Subject) -> Vec<Choice> {
    let axes = subject.entry.axes.iter().filter(|axis| axis.decides == Decides::Order);
    axes.flat_map(|axis| axis.settings.iter().map(|setting| subject.own.with(&[(axis.name, setting.name)])))
        .collect()
}

/// Seconds of a step, and those before the first: the middle over the ends and the middle of what is varied.
fn probe(subject: &Subject, parameter: &Parameter, range: [f64; 2]) -> [f64; 2] {
    let of = |value: f64| {
        let overrides = (parameter.overrides)(&subject.values, value);
        let before = ProcessTime::now();
        let scene = subject.prepared_at_any_step(&subject.own, subject.step, &overrides).ok()?;
        drop(scene.start(Purpose::Run).ok()?);
        let start = before.elapsed().as_secs_f64();
        Some((probed(&scene, subject.steps.min(PROBED)).ok()?, start))
    };
    let found: Vec<(f64, f64)> =
        ladder(range, 3, parameter.is_logarithmic).into_iter().filter_map(of).collect();
    if found.is_empty() {
        return SLOW;
    }
    [median(found.iter().map(|it| it.0)), median(found.iter().map(|it| it.1))]
}

/// Seconds of a step and before the first, where none could be timed.
const SLOW: [f64; 2] = [1e-3, 1e-2];

fn limits<'c>(survey: &Survey<'_>, values: &[f64], own: impl Fn(f64) -> Case<'c>) -> Vec<Limit> {
    let mut limits: Vec<Limit> = vec![];
    for &value in values {
        for found in survey.limits(own(value)) {
            let point = (value, found.step);
            match limits.iter_mut().find(|limit| limit.name == found.name) {
                Some(limit) => {
                    limit.points.push(point);
                    limit.why = found.why;
                }
                None => limits.push(Limit {
                    name: found.name,
                    beyond: found.beyond,
                    why: found.why,
                    points: vec![point],
                }),
            }
        }
    }
    limits
}

/// What was tried, one run a value.
fn tried(values: &[f64], steps: &[f64], map: &[Vec<Cell>], parameter: &Parameter) -> Vec<(String, String)> {
    let every = values.len().div_ceil(TRIED).max(1);
    let first = |(value, cells): (&f64, &Vec<Cell>)| {
        let Cell { class, what, .. } = cells.first()?;
        let tried = format!(
            "{} = {value}, step {}",
            parameter.name,
            significant(steps[0], 6),
            value = significant(*value, 6)
        );
        Some((tried, format!("{}: {what}", class.name())))
    };
    values.iter().zip(map).step_by(every).filter_map(first).collect()
}
