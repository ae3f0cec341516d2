//! What came out.

use super::alarm::Finding;
use super::boundary::Edge;
use super::outcome::{Cell, Class};
use crate::statistics::median;
use crate::study::Subject;
use stripmine_physics::method::{Beyond, Parameter};

/// The dataset.
#[derive(Clone, Debug)]
pub struct Stability {
    /// The name of the method.
    pub method: &'static str,
    pub way: String,
    pub time_unit: Option<String>,
    /// Its own step (time).
    pub step: f64,
    /// The time of each run (time).
    pub duration: f64,
    /// What is left out for want of time, in words.
    pub left_out: Option<String>,
    /// What is varied beside the step.
    pub parameter: Varied,
    /// Its values, rising.
    pub values: Vec<f64>,
    /// The steps, rising (time).
    pub steps: Vec<f64>,
    /// `map[i][j]`: what became of value i with step j, from the first seed.
    pub map: Vec<Vec<Cell>>,
    /// Edges at each value.
    pub boundaries: Vec<Boundary>,
    /// How far apart the two ends of an edge are at most, in parts of the step.
    pub tolerance: f64,
    /// What theory says of the step.
    pub limits: Vec<Limit>,
    /// Values of the parameter that theory names.
    pub marks: Vec<(f64, String)>,
    /// The edges of every integrator, at the scene's own value.
    pub schemes: Vec<SchemeLimit>,
    /// Values at which nothing is known of what is right, and why.
    pub unjudged: Vec<(f64, String)>,
    /// Seeds of the edges.
    pub seeds: Vec<u64>,
}

/// What is varied.
#[derive(Clone, Debug)]
pub struct Varied {
    pub name: &'static str,
    pub label: &'static str,
    /// Its unit; none of a pure number.
    pub unit: Option<String>,
    /// Whether equal ratios lie at equal distances.
    pub is_logarithmic: bool,
}

impl Varied {
    /// A parameter of a scene.
    pub fn of(parameter: &Parameter, subject: &Subject) -> Varied {
        let Parameter { name, label, unit, is_logarithmic, .. } = *parameter;
        Varied { name, label, unit: subject.unit(unit), is_logarithmic }
    }
}

/// The edges at a value, for each seed.
#[derive(Clone, Debug)]
pub struct Boundary {
    /// Up to which step runs are right.
    pub works: Vec<Edge>,
    /// Up to which step runs come to their end.
    pub ends: Vec<Edge>,
}

/// The middle of edges over seeds, with the lowest and the highest (time); none unless every seed has one.
pub fn over_seeds(edges: &[Edge]) -> Option<[f64; 3]> {
    let steps: Option<Vec<f64>> = edges.iter().map(|edge| edge.step()).collect();
    let mut steps = steps.filter(|steps| !steps.is_empty())?;
    steps.sort_by(f64::total_cmp);
    Some([median(steps.iter().copied()), steps[0], steps[steps.len() - 1]])
}

/// A limit that theory gives.
#[derive(Clone, Debug)]
pub struct Limit {
    pub name: &'static str,
    /// What becomes of longer steps.
    pub beyond: Beyond,
    /// Where it comes from, at the last value.
    pub why: String,
    /// Value and step (time).
    pub points: Vec<(f64, f64)>,
}

/// The edges of an integrator.
#[derive(Clone, Debug)]
pub struct SchemeLimit {
    pub scheme: String,
    pub edges: Boundary,
    /// What becomes of the first step that is no longer right, in the first seed.
    pub first: Option<Class>,
    /// The step beyond which theory says that errors grow (time), and its name.
    pub theory: Option<(f64, &'static str)>,
}

/// How many places of a class there are, and what was said of them.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Said {
    pub all: usize,
    /// Of which the program refuses to run the scene.
    pub refused: usize,
    /// Of which it warns before the run.
    pub warned_before: usize,
    /// Of which the run itself warns, and nothing was said before.
    pub warned_by_run_alone: usize,
    /// Of which the run itself warns.
    pub warned_by_run: usize,
}

impl Said {
    /// Places of which nothing is said.
    pub fn unsaid(self) -> usize {
        self.all - self.refused - self.warned_before - self.warned_by_run_alone
    }
}

impl Stability {
    /// Every place.
    pub fn cells(&self) -> impl Iterator<Item = &Cell> {
        self.map.iter().flatten()
    }

    /// What was said of the places of some classes.
    pub fn said(&self, belongs: impl Fn(&Cell) -> bool) -> Said {
        self.cells().filter(|cell| belongs(cell)).fold(Said::default(), |mut said, cell| {
            said.all += 1;
            let warned = cell.warned_by_run();
            said.warned_by_run += usize::from(warned);
            match cell.foreseen() {
                Finding::Refused => said.refused += 1,
                Finding::Warned => said.warned_before += 1,
                _ => said.warned_by_run_alone += usize::from(warned),
            }
            said
        })
    }

    /// The smallest step of theory beyond which errors grow, at a value (time), and its name.
    pub fn unstable_beyond(&self, value: f64) -> Option<(f64, &'static str)> {
        let unstable = self.limits.iter().filter(|limit| limit.beyond == Beyond::Unstable);
        let at = unstable.filter_map(|limit| {
            let (_, step) = limit.points.iter().find(|(known, _)| *known == value)?;
            Some((*step, limit.name))
        });
        at.min_by(|a, b| a.0.total_cmp(&b.0))
    }
}
