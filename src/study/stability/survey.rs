//! Runs of a stability map.

use super::averages::{self, LOOKS, ObservedMeans, RunningMeans};
use super::boundary::{StepBoundary, find_boundary};
use super::dataset::{Boundary, SchemeLimit};
use super::outcome::{JudgedRun, MapPoint, RunClass, WholeTrial};
use super::reference::{ExpectedMeans, SEEDS};
use crate::results::run_in_parallel;
use crate::statistics::RunSpread;
use crate::study::StudyError;
use crate::study::alarm::Alarm;
use crate::study::choice::SettingChoice;
use crate::study::runs::StudyRuns;
use crate::study::state::delayed_scene;
use crate::study::trial::{RunFailure, RunSampling};
use stripmine_physics::method::{
    ChoiceEffect, LimitConsequence, Parameter, Prepared, Simulation, StartPurpose, StepLimit,
};
use stripmine_physics::scene::{Overrides, SEED, SceneErrors};

/// Offset from a seed to the one that confirms it.
const ANOTHER: u64 = 1000;

/// State of a map.
pub(crate) struct Survey<'s> {
    pub runs: &'s StudyRuns<'s>,
    pub(crate) parameter: &'static Parameter,
    /// Steps, rising (time).
    pub steps: &'s [f64],
    /// Duration of each run (time).
    pub duration: f64,
    /// Expected seconds of a step.
    pub(crate) each: f64,
    /// Seeds of the boundaries.
    pub seeds: &'s [u64],
    /// Tolerance of a boundary, in parts of the step.
    pub(crate) tolerance: f64,
}

/// Scene of a map: its configuration, and the value of the parameter, none for the scene's own.
#[derive(Clone, Copy)]
pub(crate) struct MapVariant<'v> {
    pub(crate) choice: &'v SettingChoice,
    pub value: Option<f64>,
}

/// Expected means of a variant, or the reason why there are none.
pub(crate) type ReferenceResult = Result<ExpectedMeans, String>;

impl Survey<'_> {
    /// Measures the reference of a value: the most accurate configuration at the smallest step, over seeds.
    pub(crate) fn measure_reference(&self, value: Option<f64>) -> Result<ReferenceResult, StudyError> {
        let subject = self.runs.subject;
        let mut why = String::new();
        for number in 0..subject.trials.references.len() {
            let choice = subject.reference(number);
            let seeds: Vec<_> = (1..=SEEDS).collect();
            let run = |&seed: &_| self.run(MapVariant { choice: &choice, value }, self.steps[0], seed);
            let runs: Vec<JudgedRun> = run_in_parallel(&seeds, run)?;
            let whole: Result<Vec<WholeTrial>, RunFailure> = runs.into_iter().map(|ran| ran.end).collect();
            match whole {
                Ok(whole) => {
                    let (means, speeds): (Vec<ObservedMeans>, Vec<f64>) =
                        whole.into_iter().map(|whole| (whole.means, whole.speed)).unzip();
                    let speed = RunSpread::of(&speeds).mean;
                    let at_least = |name: &str| if subject.is_velocity(name) { speed } else { 0.0 };
                    return Ok(ExpectedMeans::of(&means, at_least).ok_or_else(|| "too few runs".to_owned()));
                }
                Err(failure) => why = failure.why,
            }
        }
        Ok(Err(why))
    }

    /// Runs a variant at a step. Wrong means in a single run may be statistical: they only count if another seed confirms
    /// them.
    pub(super) fn cell(
        &self,
        variant: MapVariant<'_>,
        known: &ReferenceResult,
        step: f64,
        seed: u64,
    ) -> Result<MapPoint, StudyError> {
        let expected = known.as_ref().ok();
        let cell = self.run(variant, step, seed)?.judged(expected);
        if cell.class != RunClass::Silent {
            return Ok(cell);
        }
        let other = self.run(variant, step, seed + ANOTHER)?.judged(expected);
        let is_chance = other.class == RunClass::Works;
        Ok(if is_chance { MapPoint { class: RunClass::Works, what: String::new(), ..cell } } else { cell })
    }

    /// Boundaries of a variant over seeds; `guesses` are the indices of the first step that does not work, and that does not finish.
    pub(crate) fn boundary(
        &self,
        variant: MapVariant<'_>,
        known: &ReferenceResult,
        guesses: [usize; 2],
    ) -> Result<Boundary, StudyError> {
        let edges = |guess: usize, is_so: fn(RunClass) -> bool| -> Result<Vec<StepBoundary>, StudyError> {
            let of = |&seed: &u64| {
                find_boundary(self.steps, guess, self.tolerance, |step| {
                    self.cell(variant, known, step, seed).map(|cell| is_so(cell.class))
                })
            };
            self.seeds.iter().map(of).collect()
        };
        Ok(Boundary {
            works: edges(guesses[0], |class| class == RunClass::Works)?,
            ends: edges(guesses[1], RunClass::ends)?,
        })
    }

    /// Boundaries of an integrator at the scene's own value.
    pub(super) fn scheme(
        &self,
        choice: &SettingChoice,
        known: &ReferenceResult,
    ) -> Result<SchemeLimit, StudyError> {
        let variant = MapVariant { choice, value: None };
        let edges = self.boundary(variant, known, [self.steps.len() / 2; 2])?;
        let first = match (edges.works.first(), self.seeds.first()) {
            (Some(StepBoundary::Between([_, fails])), Some(&seed)) => {
                Some(self.cell(variant, known, *fails, seed)?.class)
            }
            _ => None,
        };
        let unstable =
            self.limits(variant).into_iter().filter(|limit| limit.beyond == LimitConsequence::Unstable);
        let least = unstable.min_by(|a, b| a.step.total_cmp(&b.step));
        Ok(SchemeLimit {
            scheme: choice.names(ChoiceEffect::Order).join(" "),
            edges,
            first,
            theory: least.map(|limit| (limit.step, limit.name)),
        })
    }

    /// Theoretical limits of the step of a variant.
    pub(crate) fn limits(&self, variant: MapVariant<'_>) -> Vec<StepLimit> {
        let scene = self.prepared(variant, self.runs.subject.step, 1);
        scene.map_or(vec![], |scene| scene.step_limits)
    }

    /// Prepares the scene of a variant, even where theory forbids the step.
    fn prepared(&self, variant: MapVariant<'_>, step: f64, seed: u64) -> Result<Prepared, SceneErrors> {
        let subject = self.runs.subject;
        let varied = |value| (self.parameter.overrides)(&subject.values, value);
        let overrides = variant.value.map_or_else(Overrides::new, varied);
        if subject.prepared.seed.is_some() {
            return subject.prepared_at_any_step(variant.choice, step, &overrides.set(&SEED, seed));
        }
        let scene = subject.prepared_at_any_step(variant.choice, step, &overrides)?;
        // A start without a seed is varied by the phase of the step at which contacts begin.
        let phase = (seed - 1) as f64 / (SEEDS as f64 + 0.5);
        Ok(delayed_scene(&scene, phase * step))
    }

    fn run(&self, variant: MapVariant<'_>, step: f64, seed: u64) -> Result<JudgedRun, StudyError> {
        let value = variant.value.map_or("own".to_owned(), |value| format!("{value:?}"));
        let key = format!("run|{}|{value}|{step:?}|{seed}", variant.choice.label());
        let fits = |ran: &JudgedRun| {
            let is_ours = |whole: &WholeTrial| {
                averages::are_means_of(self.runs.subject, &whole.means) && whole.speed.is_finite()
            };
            ran.end.as_ref().map_or(true, is_ours)
        };
        let ran = self.runs.recall(&key, fits, || self.ran(variant, step, seed))?;
        Ok(ran.unwrap_or_else(|refused| JudgedRun { foreseen: vec![], end: Err(refused) }))
    }

    fn ran(&self, variant: MapVariant<'_>, step: f64, seed: u64) -> Result<JudgedRun, RunFailure> {
        let subject = self.runs.subject;
        let scene = self.prepared(variant, step, seed)?;
        let foreseen = Alarm::before(&scene);
        let course =
            RunSampling { steps: (self.duration / step).round() as u64, looks: LOOKS, each: self.each };
        let mut averages = RunningMeans::new(subject, scene.domain);
        let (mut energy, mut scale) = (None, 0.0);
        let look = |simulation: &dyn Simulation| {
            let values = simulation.observe();
            averages.look(simulation, &values);
            if let Some(balance) = &subject.observed.balance {
                scale = f64::max(scale, balance.energies(&values) + balance.inputs(&values));
                energy = Some(balance.error(&values));
            }
        };
        let end = match self.runs.follow(&scene, StartPurpose::Run, course, look) {
            Err(failure) if failure.is_interruption() => return Err(failure),
            Err(failure) => Err(failure),
            Ok(end) => Ok(WholeTrial {
                energy: energy.filter(|_| scale > 0.0).map(|error| error / scale),
                speed: averages.speed,
                means: averages.means,
                warned: end.warnings().iter().map(Alarm::of_run).collect(),
            }),
        };
        Ok(JudgedRun { foreseen, end })
    }
}
