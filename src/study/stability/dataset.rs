//! Results of a stability map.

use super::boundary::StepBoundary;
use super::outcome::{MapPoint, RunClass};
use crate::statistics::median;
use crate::study::Subject;
use crate::study::alarm::WarningLevel;
use stripmine_physics::method::{LimitConsequence, Parameter};

/// Runs of a scene over the step and a parameter, with the boundaries between classes.
#[derive(Clone, Debug)]
pub(crate) struct StabilityMap {
    /// Name of the method.
    pub method: &'static str,
    pub(crate) configuration: String,
    pub(crate) time_unit: Option<String>,
    /// Its own step (time).
    pub step: f64,
    /// Duration of each run (time).
    pub duration: f64,
    /// Parts omitted to save time, in words.
    pub left_out: Option<String>,
    pub(crate) parameter: VariedParameter,
    /// Values of the parameter, rising.
    pub values: Vec<f64>,
    /// Steps, rising (time).
    pub steps: Vec<f64>,
    /// Runs of the first seed: `map[i][j]` has value i and step j.
    pub map: Vec<Vec<MapPoint>>,
    /// Boundaries at each value.
    pub(crate) boundaries: Vec<Boundary>,
    /// Tolerance of a boundary, in parts of the step.
    pub(crate) tolerance: f64,
    /// Theoretical limits of the step.
    pub(crate) limits: Vec<TheoryLimit>,
    /// Values of the parameter with a theoretical meaning.
    pub(crate) marks: Vec<(f64, String)>,
    /// Boundaries of every integrator, at the scene's own value.
    pub(crate) schemes: Vec<SchemeLimit>,
    /// Values without a reference, with the reason.
    pub(crate) unjudged: Vec<(f64, String)>,
    /// Seeds of the boundaries.
    pub seeds: Vec<u64>,
}

/// Parameter varied besides the step.
#[derive(Clone, Debug)]
pub(crate) struct VariedParameter {
    pub name: &'static str,
    pub label: &'static str,
    /// Unit; none for a pure number.
    pub unit: Option<String>,
    /// True if its values are spaced by equal ratios.
    pub(crate) is_logarithmic: bool,
}

impl VariedParameter {
    /// Describes a parameter of a scene.
    pub(crate) fn of(parameter: &Parameter, subject: &Subject) -> VariedParameter {
        let Parameter { name, label, unit, is_logarithmic, .. } = *parameter;
        VariedParameter { name, label, unit: subject.unit(unit), is_logarithmic }
    }
}

/// Boundaries at a value, for each seed.
#[derive(Clone, Debug)]
pub(crate) struct Boundary {
    /// Longest steps of right runs.
    pub works: Vec<StepBoundary>,
    /// Longest steps of runs that finish.
    pub ends: Vec<StepBoundary>,
}

/// Median of boundaries over seeds, with the lowest and the highest (time); none unless every seed has one.
pub(crate) fn over_seeds(edges: &[StepBoundary]) -> Option<[f64; 3]> {
    let steps: Option<Vec<f64>> = edges.iter().map(|edge| edge.step()).collect();
    let mut steps = steps.filter(|steps| !steps.is_empty())?;
    steps.sort_by(f64::total_cmp);
    Some([median(steps.iter().copied()), steps[0], steps[steps.len() - 1]])
}

/// Theoretical limit of the step.
#[derive(Clone, Debug)]
pub(crate) struct TheoryLimit {
    pub name: &'static str,
    /// Effect of longer steps.
    pub beyond: LimitConsequence,
    /// Pairs of value and step (time).
    pub(crate) points: Vec<(f64, f64)>,
}

/// Boundaries of an integrator.
#[derive(Clone, Debug)]
pub(crate) struct SchemeLimit {
    pub scheme: String,
    pub(crate) edges: Boundary,
    /// Class of the first step that is no longer right, in the first seed.
    pub first: Option<RunClass>,
    /// Step beyond which theory predicts growing errors (time), and the name of the limit.
    pub theory: Option<(f64, &'static str)>,
}

/// Numbers of runs of some classes, by the warnings that users get.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct WarningCounts {
    pub all: usize,
    pub refused: usize,
    /// Warned of before the run.
    pub(crate) warned_before: usize,
    /// Warned of during the run.
    pub(crate) warned_by_run: usize,
    /// Without any warning.
    pub(crate) unsaid: usize,
}

impl StabilityMap {
    pub(crate) fn cells(&self) -> impl Iterator<Item = &MapPoint> {
        self.map.iter().flatten()
    }

    /// Counts the runs that belong to some classes.
    pub(crate) fn warning_counts(&self, belongs: impl Fn(&MapPoint) -> bool) -> WarningCounts {
        self.cells().filter(|cell| belongs(cell)).fold(WarningCounts::default(), |mut said, cell| {
            said.all += 1;
            let is_warned = !cell.warned_by_run().is_empty();
            said.warned_by_run += usize::from(is_warned);
            match cell.worst_before_run() {
                WarningLevel::Refused => said.refused += 1,
                WarningLevel::Warned => said.warned_before += 1,
                _ => said.unsaid += usize::from(!is_warned),
            }
            said
        })
    }

    /// Smallest step beyond which theory predicts growing errors, at a value (time), and the name of the limit.
    pub(crate) fn unstable_beyond(&self, value: f64) -> Option<(f64, &'static str)> {
        let unstable = self.limits.iter().filter(|limit| limit.beyond == LimitConsequence::Unstable);
        let at = unstable.filter_map(|limit| {
            let (_, step) = limit.points.iter().find(|(known, _)| *known == value)?;
            Some((*step, limit.name))
        });
        at.min_by(|a, b| a.0.total_cmp(&b.0))
    }
}
