//! Report items made by studies.

use super::Subject;
use super::explain::certified::{self, PlanTestEffort, QUICK, SCENES, judge_plans};
use super::explain::{SECONDS, left_out};
use super::rivals;
use super::rvv;
use super::stability::{self, VariedRange, stability};
use super::trial::{Stopwatch, TrialControl};
use super::work_precision::{self, work_precision};
use crate::console::CommandFailure;
use crate::results::{FinishedItem, Item, Journal, StudyEnvironment, StudySize};
use stripmine_physics::method::METHODS;
use stripmine_physics::signals;

/// All items, in the order of their chapter.
pub(crate) const ITEMS: &[Item] = &[
    Item::of("work-precision", speed_against_accuracy),
    Item::of("stability", stability_maps),
    Item::of("plans", plan_tests),
    Item::of("left-out", simpler_models),
    Item::of("rivals", rivals::made),
    Item::with_tools("rvv", rvv::reproduce, rvv::missing_tools),
];

/// Tests of plans by carrying them out.
fn plan_tests(lab: &StudyEnvironment<'_>, size: StudySize) -> Result<FinishedItem, CommandFailure> {
    let (scenes, effort) = match size {
        StudySize::Quick => {
            (QUICK, PlanTestEffort { trials: [0.5; 2], limit: 0.6, estimates: 4, reference: 0.3, grid: 1.0 })
        }
        StudySize::Full | StudySize::All => (
            SCENES,
            PlanTestEffort { trials: SECONDS, limit: 10.0, estimates: 20, reference: 40.0, grid: 40.0 },
        ),
    };
    Ok(certified::made(&judge_plans(scenes, effort, lab.progress)?))
}

/// Simpler models of scenes.
fn simpler_models(lab: &StudyEnvironment<'_>, size: StudySize) -> Result<FinishedItem, CommandFailure> {
    Ok(match size {
        StudySize::Quick => left_out::compared(Some(&["shaken-box", "langevin-dense"]), 2.0, lab.progress)?,
        StudySize::Full | StudySize::All => left_out::compared(None, 2.0 * SECONDS[0], lab.progress)?,
    })
}

/// Scenes with comparable trajectories: name, preset and overrides as typed. In quick reports only the first of each method is used.
const TIMED: &[&[(&str, &str, &[&str])]] = &[
    &[("two-discs", "two-discs", &["run.time=3.2"]), ("dense-gas", "dense-gas", &["particles.count=100"])],
    &[("kepler", "kepler", &["run.time=31.4"]), ("figure-eight", "figure-eight", &[])],
];

/// A fluid of particles in a heat bath.
const FLUID: &[&str] = &["law.kind=wca", "particles.count=300", "domain.sides=[20.7, 20.7]", "run.time=5"];

/// Name, preset, overrides and varied parameter of a map.
type MappedScene = (&'static str, &'static str, &'static [&'static str], &'static str);

/// Maps; in quick reports only the first of each method is used.
const MAPPED: &[&[MappedScene]] = &[
    &[
        ("two-discs", "two-discs", &["run.time=3.2"], "damping"),
        ("dense-gas", "dense-gas", &["particles.count=100"], "speed"),
        ("pipe-small", "pipe-small", &[], "damping"),
        ("shaken-box", "shaken-box", &[], "stiffness"),
        (
            "wide-sizes",
            "wide-sizes",
            &[
                "domain.sides=[14.0, 14.0]",
                "search.by=lattice",
                "search.mask=5",
                "particles.radius_spread=0.02",
                "particles.radius_cut=0.04",
            ],
            "size-ratio",
        ),
        (
            "single-precision",
            "dense-gas",
            &["particles.count=100", "machine.precision=f32"],
            "distance-from-origin",
        ),
    ],
    &[
        ("langevin-strength", "langevin-dense", FLUID, "strength"),
        ("langevin-friction", "langevin-dense", FLUID, "friction"),
    ],
    &[("kepler", "kepler", &["run.time=62.8"], "eccentricity")],
];

/// Speed against accuracy of the scenes listed.
fn speed_against_accuracy(
    lab: &StudyEnvironment<'_>,
    effort: StudySize,
) -> Result<FinishedItem, CommandFailure> {
    let progress = lab.progress;
    let most = if effort == StudySize::Quick { 1 } else { usize::MAX };
    let (budget, repeats, phases) = match effort {
        StudySize::Quick => (0.7, 1, 4),
        StudySize::Full | StudySize::All => (12.0, 3, 16),
    };
    let effort = work_precision::DiagramEffort { budget, repeats, phases, machine: None };
    let shown: Vec<_> = TIMED.iter().flat_map(|of_method| of_method.iter().take(most)).collect();
    let (watch, mut scenes) = (Stopwatch::processor(), vec![]);
    let trial = TrialControl { watch: &watch, stop: signals::interruption_flag() };
    for (at, (name, preset, overrides)) in shown.iter().enumerate() {
        let subject = subject(preset, overrides)?;
        let share = |part: f64| progress((at as f64 + part) / shown.len() as f64);
        let data = work_precision(&subject, &effort, trial, &Journal::none(), &share)?;
        scenes.push(((*name).to_owned(), data));
    }
    Ok(work_precision::made(&scenes))
}

/// Loads a preset with overrides as typed.
fn subject(preset: &str, overrides: &[&str]) -> Result<Subject, CommandFailure> {
    let overrides: Vec<String> = overrides.iter().map(|&text| text.to_owned()).collect();
    Ok(Subject::load(preset, &overrides, METHODS)?)
}

/// Stability maps of the scenes listed.
fn stability_maps(lab: &StudyEnvironment<'_>, effort: StudySize) -> Result<FinishedItem, CommandFailure> {
    let progress = lab.progress;
    let most = if effort == StudySize::Quick { 1 } else { usize::MAX };
    let effort = match effort {
        StudySize::Quick => stability::MapEffort { budget: 6.0, size: 6, seeds: 1, tolerance: 0.2 },
        StudySize::Full | StudySize::All => {
            stability::MapEffort { budget: 16.0, size: 16, seeds: 2, tolerance: 0.05 }
        }
    };
    // Every scene is read before the first map takes its time.
    let mut surveys = vec![];
    for &(name, preset, overrides, parameter) in
        MAPPED.iter().flat_map(|of_method| of_method.iter().take(most))
    {
        let subject = subject(preset, overrides)?;
        let over = VariedRange::of(&subject, Some(parameter), None)?;
        surveys.push((name.to_owned(), subject, over));
    }
    let (mut maps, all) = (vec![], surveys.len() as f64);
    let watch = Stopwatch::processor();
    let trial = TrialControl { watch: &watch, stop: signals::interruption_flag() };
    for (at, (name, subject, over)) in surveys.into_iter().enumerate() {
        let share = |part: f64| progress((at as f64 + part) / all);
        maps.push((name, stability(&subject, over, &effort, trial, &Journal::none(), &share)?));
    }
    Ok(stability::made(&maps))
}
