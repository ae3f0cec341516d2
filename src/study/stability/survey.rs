//! The runs of a map.

use super::alarm::Alarm;
use super::boundary::{Edge, edge};
use super::dataset::{Boundary, SchemeLimit};
use super::outcome::{Cell, Class, End, Ran};
use super::reference::{Expected, SEEDS};
use crate::results::{Journal, JournalError, Meter};
use crate::statistics::Spread;
use crate::study::averages::{self, Averages, LOOKS, Means};
use crate::study::choice::Choice;
use crate::study::first_line;
use crate::study::state::displaced;
use crate::study::subject::Subject;
use crate::study::trial::{Course, follow};
use rayon::iter::{IntoParallelIterator, ParallelIterator};
use stripmine_physics::method::{Beyond, Decides, Parameter, Prepared, Purpose, Simulation, StepLimit};
use stripmine_physics::scene::{Overrides, SEED, SceneErrors};

/// From a seed to the one that confirms what it shows.
const ANOTHER: u64 = 1000;

/// A map under way.
pub struct Survey<'s> {
    pub subject: &'s Subject,
    pub parameter: &'static Parameter,
    pub journal: &'s Journal,
    pub meter: &'s Meter<'s>,
    /// The steps, rising (time).
    pub steps: &'s [f64],
    /// The time of each run (time).
    pub duration: f64,
    /// Seconds that a step is expected to take.
    pub each: f64,
}

/// A scene of a map: the way it is run, and the value of the parameter, none for the scene's own.
#[derive(Clone, Copy)]
pub struct Case<'c> {
    pub choice: &'c Choice,
    pub value: Option<f64>,
}

/// What is held against runs of a case, or why there is nothing.
pub type Known = Result<Expected, String>;

impl Survey<'_> {
    /// The reference of a value: the most accurate way with the smallest step, over seeds.
    pub fn known(&self, value: Option<f64>) -> Result<Known, JournalError> {
        let mut why = String::new();
        for settings in self.subject.trials.references {
            let choice = self.subject.own.with(settings);
            let runs = (0..SEEDS)
                .into_par_iter()
                .map(|seed| self.run(Case { choice: &choice, value }, self.steps[0], seed + 1));
            let runs: Vec<Ran> = runs.collect::<Result<_, JournalError>>()?;
            let means = |ran: &Ran| match &ran.end {
                End::Whole { means, speed, .. } => Ok((means.clone(), *speed)),
                End::Broken(_, what) => Err(what.clone()),
            };
            match runs.iter().map(means).collect::<Result<(Vec<Means>, Vec<f64>), String>>() {
                Ok((means, speeds)) => {
                    let speed = Spread::of(&speeds).mean;
                    let at_least = |name: &str| if self.subject.is_velocity(name) { speed } else { 0.0 };
                    return Ok(Expected::of(&means, at_least).ok_or_else(|| "too few runs".to_owned()));
                }
                Err(what) => why = what,
            }
        }
        Ok(Err(why))
    }

    /// What becomes of a case. Means that are off in one run alone may be so by chance: they count if those of another seed are
    /// off, too.
    pub fn cell(&self, case: Case<'_>, known: &Known, step: f64, seed: u64) -> Result<Cell, JournalError> {
        let expected = known.as_ref().ok();
        let cell = self.run(case, step, seed)?.judged(expected);
        if cell.class != Class::Silent {
            return Ok(cell);
        }
        let other = self.run(case, step, seed + ANOTHER)?.judged(expected);
        let is_chance = other.class == Class::Works;
        Ok(if is_chance { Cell { class: Class::Works, what: String::new(), ..cell } } else { cell })
    }

    /// The edges of a case over seeds; `guesses` are the places of the first step that does not work, and that does not end.
    pub fn boundary(
        &self,
        case: Case<'_>,
        known: &Known,
        guesses: [usize; 2],
        seeds: &[u64],
        tolerance: f64,
    ) -> Result<Boundary, JournalError> {
        let edges = |guess: usize, is_so: fn(Class) -> bool| -> Result<Vec<Edge>, JournalError> {
            let of = |&seed: &u64| {
                edge(self.steps, guess, tolerance, |step| {
                    self.cell(case, known, step, seed).map(|cell| is_so(cell.class))
                })
            };
            seeds.iter().map(of).collect()
        };
        Ok(Boundary {
            works: edges(guesses[0], |class| class == Class::Works)?,
            ends: edges(guesses[1], Class::ends)?,
        })
    }

    /// The edges of an integrator at the scene's own value.
    pub fn scheme(
        &self,
        choice: &Choice,
        known: &Known,
        seeds: &[u64],
        tolerance: f64,
    ) -> Result<SchemeLimit, JournalError> {
        let case = Case { choice, value: None };
        let middle = [self.steps.len() / 2; 2];
        let edges = self.boundary(case, known, middle, seeds, tolerance)?;
        let first = match (edges.works.first(), seeds.first()) {
            (Some(Edge::Between([_, fails])), Some(&seed)) => {
                Some(self.cell(case, known, *fails, seed)?.class)
            }
            _ => None,
        };
        let unstable = self.limits(case).into_iter().filter(|limit| limit.beyond == Beyond::Unstable);
        let least = unstable.min_by(|a, b| a.step.total_cmp(&b.step));
        Ok(SchemeLimit {
            scheme: choice.names(Decides::Order).join(" "),
            edges,
            first,
            theory: least.map(|limit| (limit.step, limit.name)),
        })
    }

    /// What theory says of the step of a case.
    pub fn limits(&self, case: Case<'_>) -> Vec<StepLimit> {
        let scene = self.prepared(case, self.subject.step, 1);
        scene.map_or(vec![], |scene| scene.step_limits)
    }

    fn overrides(&self, case: Case<'_>, seed: u64) -> Overrides {
        let varied = |value| (self.parameter.overrides)(&self.subject.values, value);
        let overrides = case.value.map_or_else(Overrides::new, varied);
        if self.subject.prepared.seed.is_some() { overrides.set(&SEED, seed) } else { overrides }
    }

    /// The scene of a case, whatever its step.
    fn prepared(&self, case: Case<'_>, step: f64, seed: u64) -> Result<Prepared, SceneErrors> {
        let overrides = self.overrides(case, seed);
        let scene = self.subject.prepared_at_any_step(case.choice, step, &overrides)?;
        if self.subject.prepared.seed.is_some() {
            return Ok(scene);
        }
        // Where a start has no seed, contacts begin elsewhere in a step.
        let phase = (seed - 1) as f64 / (SEEDS as f64 + 0.5);
        let late = displaced(scene.particles(), &scene.domain, |_, disc| {
            disc.planar_velocity().map(|part| -phase * step * part)
        });
        Ok(scene.model.started_from(late))
    }

    fn run(&self, case: Case<'_>, step: f64, seed: u64) -> Result<Ran, JournalError> {
        let value = case.value.map_or("own".to_owned(), |value| format!("{value:?}"));
        let key = format!("run|{}|{value}|{step:?}|{seed}", case.choice.label());
        let fits = |ran: &Ran| match &ran.end {
            End::Broken(..) => true,
            End::Whole { means, speed, .. } => averages::are_of(self.subject, means) && speed.is_finite(),
        };
        self.journal.recall(&key, fits, || Ok(self.ran(case, step, seed)))
    }

    fn ran(&self, case: Case<'_>, step: f64, seed: u64) -> Ran {
        let scene = match self.prepared(case, step, seed) {
            Ok(scene) => scene,
            Err(errors) => {
                let why = errors.0.first().map_or(String::new(), |error| error.message.clone());
                return Ran { foreseen: vec![], end: End::Broken(Class::Refused, why) };
            }
        };
        let foreseen = Alarm::before(&scene);
        let steps = (self.duration / step).round() as u64;
        let course = Course { steps, looks: LOOKS, each: self.each };
        let mut averages = Averages::new(self.subject, scene.domain);
        let (mut energy, mut scale, mut warned, mut looks) = (None, 0.0, vec![], 0);
        let see = |simulation: &dyn Simulation| {
            let values = simulation.observe();
            if averages.are_due() {
                averages.add(simulation, &values);
            } else {
                averages.pass();
            }
            if let Some(balance) = &self.subject.observed.balance {
                scale = f64::max(scale, balance.energies(&values) + balance.inputs(&values));
                energy = Some(balance.error(&values));
            }
            if looks == LOOKS {
                warned = simulation.warnings().iter().map(Alarm::of_run).collect();
            }
            looks += 1;
        };
        let end = match follow(&scene, Purpose::Run, course, None, self.meter, see) {
            Ok(_) => {
                let energy = energy.filter(|_| scale > 0.0).map(|error| error / scale);
                End::Whole { speed: averages.speed(), means: averages.means(), energy, warned }
            }
            Err(failure) => End::Broken(Class::of(failure.kind), first_line(&failure.what())),
        };
        Ran { foreseen, end }
    }
}
