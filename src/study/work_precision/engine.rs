//! Runs of a diagram.

use super::DiagramEffort;
use super::dataset::{ConvergenceOrder, DiagramConfiguration, DiagramReference, DiagramResult, DiagramRun};
use super::measures::{Errors, Measure, errors};
use super::orders::fit;
use super::plan::{BELOW, COARSEST, DiagramPlan};
use crate::model::clock::{Clock, ProgramWork};
use crate::model::machine::MachineModel;
use crate::study::alarm::{Alarm, WarningLevel};
use crate::study::choice::SettingChoice;
use crate::study::runs::StudyRuns;
use crate::study::state::ParticleState;
use crate::study::trial::{FailureCause, RunFailure, RunSampling};
use crate::study::{StudyError, Subject};
use serde::{Deserialize, Serialize};
use stripmine_physics::method::{ChoiceEffect, Simulation, StartPurpose};
use stripmine_physics::number::significant;
use stripmine_physics::scene::Overrides;

/// Samples of the energy in a run.
const LOOKS: u64 = 16;
/// Multiple of the reference's own error below which an error is not resolved.
const ABOVE_FLOOR: f64 = 3.0;
/// Most repeats, as a multiple of the requested number, and the share of the time within which more are made.
const MORE: usize = 3;
const SPARE: f64 = 0.7;

/// True for a positive finite time.
fn is_time(seconds: &f64) -> bool {
    seconds.is_finite() && *seconds > 0.0
}

/// Times a step of each configuration, over its first steps.
///
/// # Errors
/// [`StudyError`] as for [`StudyRuns::recall`].
pub(crate) fn configurations(
    runs: &StudyRuns<'_>,
    choices: &[SettingChoice],
) -> Result<Vec<DiagramConfiguration>, StudyError> {
    let subject = runs.subject;
    let of = |choice: &SettingChoice| {
        let each = runs.recall(&format!("probe|{}", choice.label()), is_time, || {
            runs.probe(&subject.prepared_as(choice, subject.step, &Overrides::new())?)
        })?;
        let agrees = |decides| choice.agrees_on(&subject.own, decides);
        Ok(DiagramConfiguration {
            label: choice.label(),
            scheme: choice.names(ChoiceEffect::Order).join(" "),
            precision: choice.names(ChoiceEffect::Precision).join(" "),
            cost: choice.names(ChoiceEffect::Cost).join(" "),
            is_primary: agrees(ChoiceEffect::Cost),
            is_own_arithmetic: agrees(ChoiceEffect::Order) && agrees(ChoiceEffect::Precision),
            each,
        })
    };
    choices.iter().map(of).collect()
}

/// Planned runs of a diagram.
pub(crate) struct PlannedDiagram<'p> {
    pub runs: &'p StudyRuns<'p>,
    pub(crate) effort: &'p DiagramEffort,
    pub choices: &'p [SettingChoice],
    /// Seconds of a step, by index of the choice.
    pub rates: &'p [Option<f64>],
    pub(crate) plan: &'p DiagramPlan,
}

/// Results at the end of a run.
#[derive(Clone, Debug, Serialize, Deserialize)]
struct RunEnd {
    state: ParticleState,
    /// Error of the energy balance (moving energy).
    balance: Option<f64>,
    /// Clock periods per step.
    clocks: Option<f64>,
    /// Warnings about the configuration and the step.
    objections: Vec<String>,
}

impl PlannedDiagram<'_> {
    fn subject(&self) -> &Subject {
        self.runs.subject
    }

    /// Compared time (time).
    pub(super) fn duration(&self) -> f64 {
        self.plan.own_steps as f64 * self.subject().step
    }

    /// Steps of the compared time, at the scene's own step times two to a power.
    fn steps(&self, power: i32) -> u64 {
        (self.plan.own_steps as f64 * 0.5f64.powi(power)).round() as u64
    }

    /// The scene's own step times two to a power (time).
    pub(super) fn step(&self, power: i32) -> f64 {
        self.subject().step * 2f64.powi(power)
    }

    /// Runs a choice to the end of the time.
    fn ended(&self, choice: &SettingChoice, power: i32, each: f64) -> Result<RunEnd, RunFailure> {
        let scene = self.subject().prepared_as(choice, self.step(power), &Overrides::new())?;
        let mut alarms = Alarm::before(&scene);
        let steps = self.steps(power);
        let course = RunSampling { steps, looks: LOOKS.min(steps), each };
        let (mut worst, mut scale, mut clocks) = (0.0, 0.0, vec![]);
        let look = |simulation: &dyn Simulation| {
            let machine = self.effort.machine.as_ref();
            clocks.extend(machine.and_then(|machine| clock_periods(machine, simulation)));
            let Some(balance) = &self.subject().observed.balance else { return };
            let values = simulation.observe();
            worst = f64::max(worst, balance.error(&values).abs());
            scale = f64::max(scale, balance.energies(&values));
        };
        let end = self.runs.follow(&scene, StartPurpose::Run, course, look)?;
        alarms.extend(end.warnings().iter().map(Alarm::of_run));
        let told = alarms.into_iter().filter(|alarm| alarm.finding != WarningLevel::Within);
        Ok(RunEnd {
            state: ParticleState::of(&end.particles()),
            balance: (scale > 0.0).then(|| worst / scale),
            clocks: (!clocks.is_empty()).then(|| clocks.iter().sum::<f64>() / clocks.len() as f64),
            objections: told.map(|alarm| alarm.message).collect(),
        })
    }

    fn errors(&self, RunEnd { state, balance, .. }: &RunEnd, reference: &ParticleState) -> Errors {
        let subject = self.subject();
        let inertia = (subject.trials.inertia)(&subject.values);
        let length = (subject.trials.length.of)(subject.prepared.particles());
        let mut errors = errors(state, reference, (&subject.prepared.domain, length), inertia);
        errors.extend(balance.map(|error| (Measure::Energy, error)));
        errors
    }

    /// Runs the reference and returns it with its final state. It has a fraction of the smallest step tried, and is compared with a run at twice that
    /// step and one with another scheme.
    ///
    /// # Errors
    /// [`StudyError::EveryRunFails`] if one of the three fails.
    pub(crate) fn reference(&self, each: f64) -> Result<(DiagramReference, ParticleState), StudyError> {
        let choices = [0, 1].map(|number| self.subject().reference(number));
        let [first, second] = &choices;
        let power = -(self.plan.finest + BELOW);
        let cases = [(first, power), (first, power + 1), (second, power)];
        let ends: Vec<RunEnd> = self.runs.journal.run_all(&cases, |&(choice, power)| {
            let key = format!("reference|{}|{power}", choice.label());
            let grains = self.subject().prepared.particles().grain_count();
            let fits = |ended: &RunEnd| ended.state.len() == grains;
            let ended = self.runs.recall(&key, fits, || self.ended(choice, power, each))?;
            ended.map_err(|failure| {
                let step = significant(self.step(power), 6);
                let run = format!("the reference by {}, step {step}", choice.label());
                StudyError::EveryRunFails { tried: vec![(run, failure.why)] }
            })
        })?;
        #[expect(clippy::unreachable, reason = "there is an end for each of the three cases")]
        let [best, whole, other] = ends.as_slice() else { unreachable!("there are three cases") };
        let [halving, second] = [whole, other].map(|end| self.errors(end, &best.state));
        let mut floor = self.errors(best, &best.state);
        // The balance is an error of the run itself, not a difference.
        for (measure, error) in floor.iter_mut().filter(|(measure, _)| **measure != Measure::Energy) {
            let off = [&halving, &second].map(|errors| errors.get(measure).copied().unwrap_or(0.0));
            *error = off[0].max(off[1]);
        }
        let configurations = choices.map(|choice| choice.label());
        let reference = DiagramReference { configurations, step: self.step(power), halving, second, floor };
        Ok((reference, best.state.clone()))
    }

    /// Every run, without its cost.
    ///
    /// # Errors
    /// [`StudyError`] as for [`StudyRuns::recall`].
    pub(super) fn all(
        &self,
        reference: &DiagramReference,
        state: &ParticleState,
    ) -> Result<Vec<DiagramRun>, StudyError> {
        let floor = ABOVE_FLOOR * reference.floor.get(&Measure::Position).copied().unwrap_or(0.0);
        let runs: Vec<Vec<DiagramRun>> = self.runs.journal.run_all(&self.plan.choices, |&configuration| {
            let mut runs: Vec<DiagramRun> = vec![];
            for power in (-self.plan.finest..=0).rev() {
                runs.push(self.run(configuration, power, state)?);
                // A single error may be small by coincidence.
                let is_fine =
                    |run: &DiagramRun| run.error(Measure::Position).is_some_and(|error| error < floor);
                if matches!(runs.as_slice(), [.., before, last] if is_fine(before) && is_fine(last)) {
                    break;
                }
            }
            let mut last_ended = runs[0].outcome.is_ok();
            for power in 1..=COARSEST {
                // A step that is too large remains so when doubled.
                if !last_ended {
                    break;
                }
                let run = self.run(configuration, power, state)?;
                last_ended = run.outcome.is_ok();
                runs.push(run);
            }
            runs.sort_by(|a, b| a.step.total_cmp(&b.step));
            Ok::<_, StudyError>(runs)
        })?;
        Ok(runs.into_iter().flatten().collect())
    }

    fn run(
        &self,
        configuration: usize,
        power: i32,
        reference: &ParticleState,
    ) -> Result<DiagramRun, StudyError> {
        let choice = &self.choices[configuration];
        let each = self.rates[configuration].unwrap_or(0.0);
        let fits = |run: &DiagramResult| run.errors.values().copied().all(f64::is_finite);
        let outcome = self.runs.recall(&format!("run|{}|{power}", choice.label()), fits, || {
            let end = self.ended(choice, power, each)?;
            let errors = self.errors(&end, reference);
            if let Some((measure, error)) = errors.iter().find(|(_, error)| !error.is_finite()) {
                let why = format!("the error of the {} is {error}", measure.name());
                return Err(RunFailure { cause: FailureCause::NonFinite, why });
            }
            let clocks = end.clocks.map(|each| each * self.steps(power) as f64 / self.duration());
            Ok(DiagramResult { errors, objections: end.objections, clocks })
        })?;
        Ok(DiagramRun { configuration, step: self.step(power), power, outcome, costs: vec![] })
    }

    /// Times the runs that finished, on the first of several processes, in alternating repeats: as many as requested, and more while there
    /// is time, as short runs are easily disturbed. `begun` is the start of the study on its watch (s).
    ///
    /// # Errors
    /// [`StudyError`] as for [`StudyRuns::recall`].
    pub(super) fn time(&self, runs: &mut [DiagramRun], begun: f64) -> Result<(), StudyError> {
        let watch = self.runs.trial.watch;
        let repeats = if self.runs.journal.is_first() { MORE * self.effort.repeats } else { 0 };
        for repeat in 0..repeats {
            let before = watch.now();
            for run in runs.iter_mut().filter(|run| run.outcome.is_ok()) {
                let choice = &self.choices[run.configuration];
                let key = format!("time|{}|{}|{repeat}", choice.label(), run.power);
                let seconds = self.runs.recall(&key, is_time, || {
                    let scene = self.subject().prepared_as(choice, run.step, &Overrides::new())?;
                    let seconds = self.runs.trial.seconds_of_a_run(&scene, self.steps(run.power))?;
                    self.runs.meter.add(seconds);
                    Ok(seconds)
                })?;
                run.costs.extend(seconds.ok().map(|seconds| seconds / self.duration()));
            }
            let now = watch.now();
            let next = (now - begun) + (now - before);
            let share = if repeat + 1 < self.effort.repeats { 1.0 } else { SPARE };
            if next > share * self.effort.budget {
                break;
            }
        }
        Ok(())
    }

    /// Orders of convergence of positions and energy, for every scheme in the precision of the reference.
    pub(crate) fn orders(&self, runs: &[DiagramRun], reference: &DiagramReference) -> Vec<ConvergenceOrder> {
        let first = self.subject().reference(0);
        let is_fitted = |choice: &SettingChoice| {
            choice.agrees_on(&first, ChoiceEffect::Precision)
                && choice.agrees_on(&self.subject().own, ChoiceEffect::Cost)
        };
        let order = |configuration: usize, measure: Measure| {
            let floor = reference.floor.get(&measure).copied().unwrap_or(0.0);
            let own = runs.iter().filter(|run| run.configuration == configuration && !run.is_lost());
            let errors: Vec<(f64, f64)> =
                own.filter_map(|run| Some((run.step, run.error(measure)?))).collect();
            let scheme = self.choices[configuration].scheme().filter(|_| measure == Measure::Position);
            let theory = scheme.and_then(|scheme| self.subject().theory(scheme));
            ConvergenceOrder {
                configuration,
                measure,
                fitted: fit(&errors, ABOVE_FLOOR * floor, f64::INFINITY),
                theory: theory.map(|theory| (theory.order, theory.why)),
            }
        };
        let fitted = self.plan.choices.iter().filter(|place| is_fitted(&self.choices[**place]));
        fitted
            .flat_map(|&place| [Measure::Position, Measure::Energy].map(|measure| order(place, measure)))
            .collect()
    }
}

/// Clock periods of the last step by the paper's clock; none where operations are not counted.
fn clock_periods(machine: &MachineModel, simulation: &dyn Simulation) -> Option<f64> {
    let operations = simulation.operations();
    let is_counted = !operations.is_empty();
    let clocks =
        operations.into_iter().map(|(counts, n)| Clock::Paper.clocks(machine, &ProgramWork::from(counts), n));
    is_counted.then(|| clocks.sum())
}
