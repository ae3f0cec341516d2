//! Speed against accuracy: error of positions and energy of a scene over its cost, for every configuration and step.
//!
//! The growth of a small disturbance gives the time over which trajectories are comparable. A reference at a fraction of the
//! step, compared with one by another integrator, has a known error. Then every configuration is run at the scene's own step, at
//! smaller ones down to the reference's error and at larger ones until it fails, and timed in alternating repeats.

mod collision;
mod conclusions;
mod dataset;
mod encounters;
mod engine;
mod frames;
mod front;
mod growth;
mod measures;
mod orders;
mod plan;
mod points;
#[cfg(test)]
mod tests;

use dataset::{DiagramConfiguration, DiagramRun, WorkPrecision};
pub(crate) use frames::made;

use super::choice::SettingChoice;
use super::runs::StudyRuns;
use super::trial::TrialControl;
use super::{StudyError, Subject};
use crate::model::machine::MachineModel;
use crate::results::{Journal, Progress, ProgressMeter};
use crate::statistics::median;
use collision::collision;
use encounters::{ParticleEvents, encounters};
use engine::{PlannedDiagram, configurations};
use growth::{DisturbanceGrowth, EndedBy, growth};
use plan::{COARSEST, plan};
use stripmine_physics::number::significant;

/// Largest share of the time for the growth.
const GROWTH_SHARE: f64 = 0.1;
/// Fewest contacts, or turns of the velocity, per particle in a time that allows a recommendation.
const FEW: f64 = 3.0;
/// Smallest part of the duration of a scene over which trajectories must be comparable.
const USEFUL: f64 = 0.1;
/// Largest step of a collision: this power of two times the scene's own.
const COARSEST_COLLISION: i32 = 2;
/// Most failures listed in an error.
const TRIED: usize = 8;

/// Extent of a diagram.
#[derive(Clone, Debug)]
pub(crate) struct DiagramEffort {
    /// Available seconds, approximately.
    pub budget: f64,
    /// Timed runs of each configuration and step.
    pub(crate) repeats: usize,
    /// Starts of each step of a collision.
    pub phases: u32,
    /// Machine whose clock periods are computed.
    pub machine: Option<MachineModel>,
}

/// Measures a scene. Finished runs are recorded in the journal.
///
/// # Errors
/// [`StudyError`] if trajectories cannot be compared, every run of the scene fails, the user interrupts, or finished runs cannot be
/// recorded.
pub(crate) fn work_precision(
    subject: &Subject,
    effort: &DiagramEffort,
    trial: TrialControl<'_>,
    journal: &Journal,
    progress: Progress<'_>,
) -> Result<WorkPrecision, StudyError> {
    if !subject.trials.has_trajectories {
        return Err(diverging_trajectories(
            subject,
            "noise moves the particles along a different path at each step".to_owned(),
        ));
    }
    let begun = trial.watch.now();
    let meter = ProgressMeter::new(effort.budget, progress);
    let runs = &StudyRuns { subject, trial, journal, meter: &meter };
    let choices = SettingChoice::all(subject.entry.axes);
    let configurations = journal.run_on_one(|| configurations(runs, &choices))?;
    let rates: Vec<Option<f64>> = configurations.iter().map(|it| it.each.as_ref().ok().copied()).collect();
    let all_rates = || rates.iter().flatten().copied();
    if all_rates().next().is_none() {
        let failed = |it: &DiagramConfiguration| Some((it.label.clone(), it.each.clone().err()?.why));
        let tried = configurations.iter().filter_map(failed).take(TRIED).collect();
        return Err(StudyError::EveryRunFails { tried });
    }
    let own_rate = choices.iter().position(|choice| *choice == subject.own).and_then(|place| rates[place]);
    let own_rate = own_rate.unwrap_or_else(|| median(all_rates()));
    let most = (GROWTH_SHARE * effort.budget / (4.0 * own_rate)) as u64;
    let most = subject.steps.min(most.max(1 << COARSEST));
    let growth = journal.run_on_one(|| growth(runs, most, own_rate))?;
    let comparable = (growth.window / subject.step).round() as u64;
    let plan = plan(&choices, &rates, &subject.own, comparable, effort.budget, effort.repeats);
    let planned = PlannedDiagram { runs, effort, choices: &choices, rates: &rates, plan: &plan };
    meter.expect(plan.seconds);
    let duration = planned.duration();
    let encounters = journal.run_on_one(|| encounters(runs, growth.step, duration, own_rate))?;
    let undecided = undecided(subject, &growth, &encounters, duration)?;
    let (reference, state) = planned.reference(own_rate)?;
    let mut all = planned.all(&reference, &state)?;
    if all.iter().all(|run| run.outcome.is_err()) {
        let failed = |run: &DiagramRun| {
            let label = choices[run.configuration].label();
            let why = run.outcome.as_ref().err()?.why.clone();
            Some((format!("{label}, step {}", significant(run.step, 6)), why))
        };
        return Err(StudyError::EveryRunFails { tried: all.iter().filter_map(failed).take(TRIED).collect() });
    }
    let steps: Vec<f64> = (-plan.finest..=COARSEST_COLLISION).map(|power| planned.step(power)).collect();
    let collision = collision(runs, &steps, effort.phases)?;
    planned.time(&mut all, begun)?;
    Ok(WorkPrecision {
        particles: subject.prepared.particles().grain_count(),
        unit: subject.trials.length.unit.to_owned(),
        time_unit: subject.unit("time"),
        step: subject.step,
        own: subject.own.label(),
        duration,
        undecided,
        encounters,
        growth,
        orders: planned.orders(&all, &reference),
        reference,
        configurations,
        runs: all,
        collision,
        machine: effort.machine.as_ref().map(|machine| machine.title().to_owned()),
        plan,
    })
}

fn diverging_trajectories(subject: &Subject, why: String) -> StudyError {
    let quantity = subject.trials.observables.first().copied().unwrap_or_default();
    StudyError::NoTrajectories { scene: subject.arguments(), why, quantity }
}

/// Reason why nothing is decided, where too little happens in the compared time.
///
/// # Errors
/// [`StudyError::NoTrajectories`] where more time would not help, because trajectories diverge at once.
fn undecided(
    subject: &Subject,
    growth: &DisturbanceGrowth,
    encounters: &ParticleEvents,
    duration: f64,
) -> Result<Option<String>, StudyError> {
    let whole = subject.duration();
    // A scene compared over its whole duration needs a single event.
    let least = if duration > 0.95 * whole { 1.0 } else { FEW };
    let is_little = encounters.each < least;
    let is_cut_by_growth = growth.ended_by == EndedBy::Growth;
    let is_all_of_window = duration > 0.9 * growth.window;
    if is_cut_by_growth && (growth.window < USEFUL * whole || is_little && is_all_of_window) {
        let [window, whole] = [growth.window, whole].map(|time| significant(time, 3));
        return Err(diverging_trajectories(
            subject,
            format!("trajectories diverge after a time of {window} of {whole}"),
        ));
    }
    let [time, whole] = [duration, whole].map(|time| significant(time, 3));
    let [each, events] = [&significant(encounters.each, 2), encounters.name()];
    let little = || {
        format!(
            "in the compared time of {time} of {whole}, a particle has {each} {events} on average, fewer than {least}"
        )
    };
    Ok(is_little.then(little))
}
