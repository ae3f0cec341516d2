//! The runs of a diagram.

use super::dataset::{Order, Reference, Run, Way};
use super::measures::{Errors, Measure, errors};
use super::plan::{BELOW, COARSEST, Plan};
use super::{Effort, MEANS_SHARE};
use crate::results::{Journal, JournalError, Meter};
use crate::study::choice::Choice;
use crate::study::collision::{Collision, collision, is_collision};
use crate::study::observables::{Observables, REFERENCE, SEEDS, STEPS, observables};
use crate::study::orders::fit;
use crate::study::state::State;
use crate::study::trial::{Course, follow, timed};
use crate::study::{StudyError, Subject, first_line};
use serde::{Deserialize, Serialize};
use std::time::Instant;
use stripmine_physics::method::{Decides, Prepared, Purpose, Simulation, probed};
use stripmine_physics::number::significant;
use stripmine_physics::scene::{Overrides, SceneErrors};

/// Looks at the energy in a run.
const LOOKS: u64 = 16;
/// Steps of a probe at most.
const PROBED: u64 = 4096;
/// An error below this many times the reference's own is not distinguished from it.
const ABOVE_FLOOR: f64 = 3.0;
/// The fewest steps of a run whose means are compared.
const FEWEST: u64 = 256;
/// Times the repeats that are asked for there may be, and the share of the time within which more are made.
const MORE: usize = 3;
const SPARE: f64 = 0.7;
/// Steps of a collision go up to this power of two times the scene's own.
const COARSEST_COLLISION: i32 = 2;

/// Seconds of a step of every way, by its first steps, or why the scene cannot be run so.
pub fn probes(
    subject: &Subject,
    choices: &[Choice],
    journal: &Journal,
) -> Result<Vec<Result<f64, String>>, JournalError> {
    let probe = |choice: &Choice| {
        let scene = subject
            .prepared_as(choice, subject.step, &Overrides::new())
            .map_err(|errors| refusal(&errors))?;
        probed(&scene, subject.steps.min(PROBED)).map_err(|failure| first_line(&failure.what()))
    };
    let of = |choice: &Choice| {
        let fits = |found: &Result<f64, String>| found.as_ref().map_or(true, |each| is_rate(*each));
        let key = format!("probe|{}", choice.label());
        journal.recall(&key, fits, || Ok::<_, JournalError>(probe(choice)))
    };
    choices.iter().map(of).collect()
}

/// Whether something takes a time.
fn is_rate(seconds: f64) -> bool {
    seconds.is_finite() && seconds > 0.0
}

/// Every mistake, in one line.
fn refusal(errors: &SceneErrors) -> String {
    let messages: Vec<&str> = errors.0.iter().map(|error| error.message.as_str()).collect();
    format!("refused: {}", messages.join("; "))
}

/// A way as it is shown, beside the scene's own.
pub fn way(choice: &Choice, own: &Choice, probe: &Result<f64, String>) -> Way {
    let agrees = |decides| choice.agrees(own, decides);
    Way {
        label: choice.label(),
        scheme: choice.names(Decides::Order).join(" "),
        digits: choice.names(Decides::Digits).join(" "),
        cost: choice.names(Decides::Cost).join(" "),
        is_primary: agrees(Decides::Cost),
        is_own_arithmetic: agrees(Decides::Order) && agrees(Decides::Digits),
        each: probe.as_ref().ok().copied(),
        refused: probe.as_ref().err().cloned(),
    }
}

/// A diagram under way.
pub struct Work<'w> {
    pub subject: &'w Subject,
    pub effort: &'w Effort,
    pub journal: &'w Journal,
    pub meter: &'w Meter<'w>,
    pub choices: &'w [Choice],
    /// Seconds of a step, by place of the choice.
    pub rates: &'w [Option<f64>],
    pub plan: &'w Plan,
}

/// A run that came to its end.
#[derive(Clone, Debug, Serialize, Deserialize)]
struct Ended {
    state: State,
    /// Error of the balance of energy (energy that moves).
    balance: Option<f64>,
    /// Clock periods a step.
    clocks: Option<f64>,
    /// What speaks against the way and the step.
    objections: Vec<String>,
}

/// What limits of theory and checks say against a scene before it runs.
fn objections(scene: &Prepared) -> Vec<String> {
    let limits = scene.step_limits.iter().filter(|limit| limit.share > 1.0);
    let limits = limits.map(|limit| {
        format!("the step is {} times the limit \"{}\" of theory", significant(limit.share, 3), limit.name)
    });
    let checks = scene.warnings.iter().map(|warning| format!("checked: {}", warning.message));
    limits.chain(checks).collect()
}

impl Work<'_> {
    /// The time that is compared (time).
    pub fn duration(&self) -> f64 {
        self.plan.own_steps as f64 * self.subject.step
    }

    /// Steps of the whole time with the step that is the scene's own times two to a power.
    fn steps(&self, power: i32) -> u64 {
        (self.plan.own_steps as f64 * 0.5f64.powi(power)).round() as u64
    }

    fn step(&self, power: i32) -> f64 {
        self.subject.step * 2f64.powi(power)
    }

    fn prepared(&self, choice: &Choice, power: i32) -> Result<Prepared, String> {
        let prepared = self.subject.prepared_as(choice, self.step(power), &Overrides::new());
        prepared.map_err(|errors| refusal(&errors))
    }

    /// Runs a choice to the end of the time.
    fn ended(&self, choice: &Choice, power: i32, each: f64) -> Result<Ended, String> {
        let scene = self.prepared(choice, power)?;
        let steps = self.steps(power);
        let course = Course { steps, looks: LOOKS.min(steps), each };
        let (mut worst, mut scale) = (0.0, 0.0);
        let mut objections = objections(&scene);
        let mut looks = 0;
        let see = |simulation: &dyn Simulation| {
            if looks == course.looks {
                let warned = simulation.warnings().into_iter();
                objections.extend(warned.map(|warning| format!("warned of: {}", warning.message)));
            }
            looks += 1;
            let Some(balance) = &self.subject.observed.balance else { return };
            let values = simulation.observe();
            worst = f64::max(worst, balance.error(&values).abs());
            scale = f64::max(scale, balance.energies(&values));
        };
        let machine = self.effort.machine.as_ref();
        let end = follow(&scene, Purpose::Run, course, machine, self.meter, see);
        let end = end.map_err(|failure| first_line(&failure.what()))?;
        let has_balance = self.subject.observed.balance.is_some() && scale > 0.0;
        let balance = has_balance.then(|| worst / scale);
        Ok(Ended { state: end.state, balance, clocks: end.clocks, objections })
    }

    fn errors(&self, Ended { state, balance, .. }: &Ended, reference: &State) -> Errors {
        let inertia = (self.subject.trials.inertia)(&self.subject.values);
        let mut errors =
            errors(state, reference, (&self.subject.prepared.domain, self.subject.length()), inertia);
        errors.extend(balance.map(|error| (Measure::Energy, error)));
        errors
    }

    /// The reference and its end: one with half the step of the smallest that is tried, held against one with the whole and one
    /// by another scheme.
    ///
    /// # Errors
    /// [`StudyError::EveryRunFails`], if one of the three breaks.
    pub fn reference(&self, each: f64) -> Result<(Reference, State), StudyError> {
        let [first, second] = self.subject.trials.references.map(|settings| self.subject.own.with(settings));
        let power = -(self.plan.finest + BELOW);
        let cases = [(&first, power), (&first, power + 1), (&second, power)];
        let ends: Vec<Ended> = self.journal.over(&cases, |&(choice, power)| {
            let key = format!("reference|{}|{power}", choice.label());
            let fits = |ended: &Ended| ended.state.len() == self.subject.prepared.particles().grain_count();
            self.journal.recall(&key, fits, || {
                self.ended(choice, power, each).map_err(|why| {
                    let what = format!(
                        "the reference by {}, step {}",
                        choice.label(),
                        significant(self.step(power), 6)
                    );
                    StudyError::EveryRunFails { tried: vec![(what, why)] }
                })
            })
        })?;
        let [best, whole, other] = ends.as_slice() else { unreachable!("there are three cases") };
        let [halving, second_off] = [whole, other].map(|end| self.errors(end, &best.state));
        let mut floor = self.errors(best, &best.state);
        for (measure, error) in &mut floor {
            let off = [&halving, &second_off].map(|errors| errors.get(measure).copied().unwrap_or(0.0));
            // The balance is an error of the run itself, not a difference.
            if *measure != Measure::Energy {
                *error = off[0].max(off[1]);
            }
        }
        let ways = [first.label(), second.label()];
        Ok((
            Reference { ways, step: self.step(power), halving, second: second_off, floor },
            best.state.clone(),
        ))
    }

    /// Every run, without its cost.
    ///
    /// # Errors
    /// [`JournalError`] if one cannot be kept.
    pub fn runs(&self, reference: &Reference, state: &State) -> Result<Vec<Run>, JournalError> {
        let floor = ABOVE_FLOOR * reference.floor.get(&Measure::Position).copied().unwrap_or(0.0);
        let runs: Vec<Vec<Run>> = self.journal.over(&self.plan.choices, |&way| {
            let mut runs: Vec<Run> = vec![];
            for power in (-self.plan.finest..=0).rev() {
                let run = self.run(way, power, state)?;
                runs.push(run);
                // One error alone may be small by chance.
                let is_fine = |run: &Run| run.error(Measure::Position).is_some_and(|error| error < floor);
                if matches!(runs.as_slice(), [.., before, last] if is_fine(before) && is_fine(last)) {
                    break;
                }
            }
            for power in 1..=COARSEST {
                // A step that is too large stays so when doubled.
                let is_worth = power > 1 || runs[0].outcome.is_ok();
                if !is_worth || power > 1 && runs.last().is_some_and(|run| run.outcome.is_err()) {
                    break;
                }
                runs.push(self.run(way, power, state)?);
            }
            runs.sort_by(|a, b| a.step.total_cmp(&b.step));
            Ok::<_, JournalError>(runs)
        })?;
        Ok(runs.into_iter().flatten().collect())
    }

    fn run(&self, way: usize, power: i32, reference: &State) -> Result<Run, JournalError> {
        let choice = &self.choices[way];
        let each = self.rates[way].unwrap_or(0.0);
        let fits = |run: &Run| {
            let is_ours = (run.way, run.power, run.step) == (way, power, self.step(power));
            let errors = run.outcome.iter().flat_map(Errors::values);
            is_ours && run.costs.is_empty() && errors.copied().all(f64::is_finite)
        };
        self.journal.recall(&format!("run|{}|{power}", choice.label()), fits, || {
            let end = self.ended(choice, power, each);
            let clocks = end.as_ref().ok().and_then(|end| end.clocks);
            let objections = end.as_ref().map_or(vec![], |end| end.objections.clone());
            Ok(Run {
                way,
                step: self.step(power),
                power,
                outcome: end.map(|end| self.errors(&end, reference)).and_then(all_finite),
                objections,
                clocks: clocks.map(|each| each * self.steps(power) as f64 / self.duration()),
                costs: vec![],
            })
        })
    }

    /// Times the runs that came to their end, on the first of several processes, in alternating repeats: as many as are asked for, and more while there is time,
    /// for short runs are easily disturbed.
    ///
    /// # Errors
    /// [`JournalError`] if a time cannot be kept.
    pub fn time(&self, runs: &mut [Run], start: Instant) -> Result<(), JournalError> {
        let repeats = if self.journal.is_first() { MORE * self.effort.repeats } else { 0 };
        for repeat in 0..repeats {
            let begun = Instant::now();
            for run in runs.iter_mut().filter(|run| run.outcome.is_ok()) {
                let choice = &self.choices[run.way];
                let key = format!("time|{}|{}|{repeat}", choice.label(), run.power);
                let fits = |seconds: &Option<f64>| seconds.is_none_or(is_rate);
                let seconds = self.journal.recall(&key, fits, || {
                    let each = self.rates[run.way].unwrap_or(0.0);
                    let course = Course { steps: self.steps(run.power), looks: 1, each };
                    let scene = self.prepared(choice, run.power);
                    let timed = scene.ok().and_then(|scene| timed(&scene, course, self.meter).ok());
                    Ok::<Option<f64>, JournalError>(timed)
                })?;
                run.costs.extend(seconds.map(|seconds| seconds / self.duration()));
            }
            let next = (start.elapsed() + begun.elapsed()).as_secs_f64();
            let share = if repeat + 1 < self.effort.repeats { 1.0 } else { SPARE };
            if next > share * self.effort.budget {
                break;
            }
        }
        Ok(())
    }

    /// Means over time, where the scene has seeds and there is time for it.
    ///
    /// # Errors
    /// [`JournalError`] if a run cannot be kept.
    pub fn observables(&self, each: f64) -> Result<Option<Observables>, JournalError> {
        let subject = self.subject;
        if subject.prepared.seed.is_none() || subject.trials.observables.is_empty() {
            return Ok(None);
        }
        let [first, _] = subject.trials.references.map(|settings| subject.own.with(settings));
        let is_compared = |choice: &&Choice| {
            choice.agrees(&subject.own, Decides::Cost)
                && (choice.agrees(&first, Decides::Digits) || choice.agrees(&subject.own, Decides::Order))
        };
        let choices: Vec<Choice> = self.choices.iter().filter(is_compared).cloned().collect();
        let a_step: f64 = STEPS.iter().map(|step| 1.0 / step).sum();
        let all = SEEDS.len() as f64 * each * (choices.len() as f64 * a_step + 1.0 / REFERENCE);
        let steps = subject.steps.min((MEANS_SHARE * self.effort.budget / all) as u64);
        if steps < FEWEST {
            return Ok(None);
        }
        observables(subject, &choices, steps, each, self.journal, self.meter).map(Some)
    }

    /// Outcomes of a collision, where the scene is one.
    ///
    /// # Errors
    /// [`JournalError`] if a run cannot be kept.
    pub fn collision(&self) -> Result<Option<Collision>, JournalError> {
        if !is_collision(self.subject) {
            return Ok(None);
        }
        let steps: Vec<f64> =
            (-self.plan.finest..=COARSEST_COLLISION).map(|power| self.step(power)).collect();
        collision(self.subject, &steps, self.effort.phases, self.journal, self.meter)
    }

    /// How positions and energy converge, for every scheme in the digits of the reference.
    pub fn orders(&self, runs: &[Run], reference: &Reference) -> Vec<Order> {
        let [first, _] = self.subject.trials.references.map(|settings| self.subject.own.with(settings));
        let is_fitted = |choice: &Choice| {
            choice.agrees(&first, Decides::Digits) && choice.agrees(&self.subject.own, Decides::Cost)
        };
        let ways = self.plan.choices.iter().filter(|way| is_fitted(&self.choices[**way]));
        let order = |way: usize, measure: Measure| {
            let floor = reference.floor.get(&measure).copied().unwrap_or(0.0);
            let errors: Vec<(f64, f64)> = runs
                .iter()
                .filter(|run| run.way == way && !run.is_lost())
                .filter_map(|run| Some((run.step, run.error(measure)?)))
                .collect();
            let theory = self.choices[way].scheme().and_then(|scheme| self.subject.theory(scheme));
            let is_of_theory = measure == Measure::Position;
            Order {
                way,
                measure,
                fitted: fit(&errors, ABOVE_FLOOR * floor, f64::INFINITY),
                theory: theory.filter(|_| is_of_theory).map(|theory| (theory.order, theory.why)),
            }
        };
        ways.flat_map(|&way| [Measure::Position, Measure::Energy].map(|measure| order(way, measure)))
            .collect()
    }
}

/// Errors that are numbers.
fn all_finite(errors: Errors) -> Result<Errors, String> {
    match errors.iter().find(|(_, error)| !error.is_finite()) {
        None => Ok(errors),
        Some((measure, error)) => Err(format!("the error of the {} is {error}", measure.name())),
    }
}
