//! Map of a scene.

use super::boundary::Edge;
use super::outcome::{Cell, Class};
use crate::statistics::median;
use crate::study::Subject;
use crate::study::alarm::Finding;
use stripmine_physics::method::{Beyond, Parameter};

/// Runs of a scene over the step and a parameter, with the edges between classes.
#[derive(Clone, Debug)]
pub(crate) struct Stability {
    /// Name of the method.
    pub method: &'static str,
    pub(crate) configuration: String,
    pub(crate) time_unit: Option<String>,
    /// Its own step (time).
    pub step: f64,
    /// The time of each run (time).
    pub duration: f64,
    /// Parts left out for want of time, in words.
    pub left_out: Option<String>,
    pub(crate) parameter: Varied,
    /// Values of the parameter, rising.
    pub values: Vec<f64>,
    /// The steps, rising (time).
    pub steps: Vec<f64>,
    /// `map[i][j]`: value i with step j, from the first seed.
    pub map: Vec<Vec<Cell>>,
    /// Edges at each value.
    pub(crate) boundaries: Vec<Boundary>,
    /// Largest distance of the two ends of an edge, in parts of the step.
    pub(crate) tolerance: f64,
    /// Limits of the step by theory.
    pub(crate) limits: Vec<Limit>,
    /// Values of the parameter that theory names.
    pub(crate) marks: Vec<(f64, String)>,
    /// Edges of every integrator, at the scene's own value.
    pub(crate) schemes: Vec<SchemeLimit>,
    /// Values without a reference, and why.
    pub(crate) unjudged: Vec<(f64, String)>,
    /// Seeds of the edges.
    pub seeds: Vec<u64>,
}

/// Parameter that is varied beside the step.
#[derive(Clone, Debug)]
pub(crate) struct Varied {
    pub name: &'static str,
    pub label: &'static str,
    /// Its unit; none of a pure number.
    pub unit: Option<String>,
    /// True if equal ratios lie at equal distances.
    pub(crate) is_logarithmic: bool,
}

impl Varied {
    /// A parameter of a scene.
    pub(crate) fn of(parameter: &Parameter, subject: &Subject) -> Varied {
        let Parameter { name, label, unit, is_logarithmic, .. } = *parameter;
        Varied { name, label, unit: subject.unit(unit), is_logarithmic }
    }
}

/// Edges at a value, for each seed.
#[derive(Clone, Debug)]
pub(crate) struct Boundary {
    /// Longest steps with which runs are right.
    pub works: Vec<Edge>,
    /// Longest steps with which runs come to their end.
    pub ends: Vec<Edge>,
}

/// Middle of edges over seeds, with the lowest and the highest (time); none unless every seed has one.
pub(crate) fn over_seeds(edges: &[Edge]) -> Option<[f64; 3]> {
    let steps: Option<Vec<f64>> = edges.iter().map(|edge| edge.step()).collect();
    let mut steps = steps.filter(|steps| !steps.is_empty())?;
    steps.sort_by(f64::total_cmp);
    Some([median(steps.iter().copied()), steps[0], steps[steps.len() - 1]])
}

/// Limit of the step by theory.
#[derive(Clone, Debug)]
pub(crate) struct Limit {
    pub name: &'static str,
    /// Effect of longer steps.
    pub beyond: Beyond,
    /// Value and step (time).
    pub(crate) points: Vec<(f64, f64)>,
}

/// Edges of an integrator.
#[derive(Clone, Debug)]
pub(crate) struct SchemeLimit {
    pub scheme: String,
    pub(crate) edges: Boundary,
    /// Class of the first step that is no longer right, in the first seed.
    pub first: Option<Class>,
    /// Step beyond which theory says that errors grow (time), and its name.
    pub theory: Option<(f64, &'static str)>,
}

/// Places of some classes, counted by the warnings that users get of them.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Said {
    pub all: usize,
    /// The program refuses to run the scene.
    pub refused: usize,
    /// The program warns before the run.
    pub(crate) warned_before: usize,
    /// The run itself warns.
    pub(crate) warned_by_run: usize,
    /// No warning, neither before nor by the run.
    pub(crate) unsaid: usize,
}

impl Stability {
    /// Every place.
    pub(crate) fn cells(&self) -> impl Iterator<Item = &Cell> {
        self.map.iter().flatten()
    }

    /// Counts the places of some classes.
    pub(crate) fn said(&self, belongs: impl Fn(&Cell) -> bool) -> Said {
        self.cells().filter(|cell| belongs(cell)).fold(Said::default(), |mut said, cell| {
            said.all += 1;
            let is_warned = !cell.warned_by_run().is_empty();
            said.warned_by_run += usize::from(is_warned);
            match cell.foreseen() {
                Finding::Refused => said.refused += 1,
                Finding::Warned => said.warned_before += 1,
                _ => said.unsaid += usize::from(!is_warned),
            }
            said
        })
    }

    /// Smallest step of theory beyond which errors grow, at a value (time), and its name.
    pub(crate) fn unstable_beyond(&self, value: f64) -> Option<(f64, &'static str)> {
        let unstable = self.limits.iter().filter(|limit| limit.beyond == Beyond::Unstable);
        let at = unstable.filter_map(|limit| {
            let (_, step) = limit.points.iter().find(|(known, _)| *known == value)?;
            Some((*step, limit.name))
        });
        at.min_by(|a, b| a.0.total_cmp(&b.0))
    }
}
