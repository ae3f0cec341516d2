//! Speed against accuracy: the error of a scene over its cost, for every way to run it and every step.
//!
//! First the growth of a small disturbance says up to which time trajectories are comparable. A reference with halved steps,
//! and one by another integrator, say what the error of the reference is. Then every way is run with the scene's own step, with
//! smaller ones down to the reference's error and with larger ones until it breaks, and timed in alternating repeats.

mod conclusions;
mod dataset;
mod engine;
mod frames;
mod front;
mod measures;
mod plan;
mod points;

use dataset::WorkPrecision;
pub use frames::made;

use super::choice::Choice;
use super::encounters::{Encounters, encounters};
use super::growth::{EndedBy, Growth, HALVINGS, growth, own_in_full_digits};
use super::observables::SEEDS;
use super::{StudyError, Subject};
use crate::model::machine::MachineModel;
use crate::results::{Journal, JournalError, Meter, Progress};
use crate::statistics::median;
use engine::{Work, probes, way};
use plan::{COARSEST, plan};
use std::time::Instant;
use stripmine_physics::number::significant;

/// The share of the time that the growth takes at most.
const GROWTH_SHARE: f64 = 0.1;
/// The share that means over seeds take at most.
const MEANS_SHARE: f64 = 0.2;
/// Contacts, or turns of its motion, that a particle has at least in a time from which a way is recommended.
const FEW: f64 = 3.0;
/// Failures that an error names at most.
const TRIED: usize = 8;

/// How much is done.
#[derive(Clone, Debug)]
pub struct Effort {
    /// Processor seconds that it may take about.
    pub budget: f64,
    /// Timed runs of each.
    pub repeats: usize,
    /// Starts a step of a collision.
    pub phases: u32,
    /// The machine whose clock periods are asked for.
    pub machine: Option<MachineModel>,
}

/// Measures a scene.
///
/// # Errors
/// [`StudyError`] if no run of the scene comes to its end, or finished runs cannot be kept.
pub fn work_precision(
    subject: &Subject,
    effort: &Effort,
    journal: &Journal,
    progress: Progress<'_>,
) -> Result<WorkPrecision, StudyError> {
    if !subject.trials.has_trajectories {
        return Err(StudyError::NoTrajectories(subject.arguments()));
    }
    let start = Instant::now();
    let meter = Meter::new(effort.budget, progress);
    let choices = Choice::all(subject.entry.axes);
    let probes = journal.once(|| probes(subject, &choices, journal))?;
    let rates: Vec<Option<f64>> = probes.iter().map(|probe| probe.as_ref().ok().copied()).collect();
    let own_place = choices.iter().position(|choice| *choice == subject.own).unwrap_or(0);
    let all_rates = || rates.iter().flatten().copied();
    if all_rates().next().is_none() {
        let tried = choices.iter().zip(&probes);
        let tried = tried.filter_map(|(choice, probe)| Some((choice.label(), probe.clone().err()?)));
        return Err(StudyError::EveryRunFails { tried: tried.take(TRIED).collect() });
    }
    let own_rate = rates[own_place].unwrap_or_else(|| median(all_rates()));
    let most = (GROWTH_SHARE * effort.budget / (4.0 * own_rate)) as u64;
    let most = subject.steps.min(most.max(1 << COARSEST));
    let growth = journal.once(|| longest_growth(subject, most, own_rate, journal, &meter))?;
    let comparable = (growth.window / subject.step).round() as u64;
    let seconds = effort.budget;
    // It follows from what is recalled.
    let plan = plan(&choices, &rates, &subject.own, comparable, seconds, effort.repeats);
    let work =
        Work { subject, effort, journal, meter: &meter, choices: &choices, rates: &rates, plan: &plan };
    meter.expect(plan.seconds + MEANS_SHARE * effort.budget);
    let (reference, state) = work.reference(own_rate)?;
    let mut runs = work.runs(&reference, &state)?;
    if runs.iter().all(|run| run.outcome.is_err()) {
        let tried = runs.iter().filter_map(|run| {
            Some((
                format!("{}, step {}", choices[run.way].label(), significant(run.step, 6)),
                run.outcome.clone().err()?,
            ))
        });
        return Err(StudyError::EveryRunFails { tried: tried.take(TRIED).collect() });
    }
    let counted = (&own_in_full_digits(subject), growth.step);
    let encounters: Encounters = journal.once(|| {
        let fits = |it: &Encounters| {
            it.of_contacts == subject.trials.has_contacts && it.each.is_finite() && it.each >= 0.0
        };
        journal.recall("encounters", fits, || {
            Ok::<_, JournalError>(encounters(subject, counted, work.duration(), own_rate, &meter))
        })
    })?;
    let observables = work.observables(own_rate)?;
    let collision = work.collision()?;
    work.time(&mut runs, start)?;
    Ok(WorkPrecision {
        particles: subject.prepared.particles().grain_count(),
        unit: subject.trials.length.unit.to_owned(),
        time_unit: subject.unit("time"),
        step: subject.step,
        own: subject.own.label(),
        duration: work.duration(),
        undecided: undecided(&encounters, work.duration(), subject),
        encounters,
        growth,
        orders: work.orders(&runs, &reference),
        reference,
        ways: choices.iter().zip(&probes).map(|(choice, probe)| way(choice, &subject.own, probe)).collect(),
        runs,
        seeds: if observables.is_some() { SEEDS.to_vec() } else { vec![] },
        observables,
        collision,
        machine: effort.machine.as_ref().map(|machine| machine.title().to_owned()),
        plan,
    })
}

/// How long trajectories are comparable: those of the scene's own way, or, where its error alone ends the time, those of the reference's.
fn longest_growth(
    subject: &Subject,
    most: u64,
    each: f64,
    journal: &Journal,
    meter: &Meter<'_>,
) -> Result<Growth, StudyError> {
    let own = own_in_full_digits(subject);
    let fits = |growth: &Growth| growth.is_of(subject);
    let first: Growth = journal.recall("growth", fits, || {
        growth(subject, (&own, HALVINGS), most, each, meter)
            .map_err(|tried| StudyError::EveryRunFails { tried })
    })?;
    let reference = subject.own.with(subject.trials.references[0]);
    if first.ended_by != EndedBy::Growth || reference == own {
        return Ok(first);
    }
    let fits = |found: &Option<Growth>| found.as_ref().is_none_or(|growth| growth.is_of(subject));
    let second: Option<Growth> = journal.recall("growth of the reference", fits, || {
        Ok::<_, JournalError>(growth(subject, (&reference, 0), most, each, meter).ok())
    })?;
    Ok(second.filter(|second| second.window > first.window).unwrap_or(first))
}

/// Why nothing is decided: hardly anything happens in the time that is compared.
fn undecided(encounters: &Encounters, duration: f64, subject: &Subject) -> Option<String> {
    let whole = subject.steps as f64 * subject.step;
    // Of a scene that is compared as a whole nothing is left out; something must happen in it.
    let least = if duration > 0.95 * whole { 1.0 } else { FEW };
    (encounters.each < least).then(|| {
        format!(
            "in the time that is compared, {} of {}, a particle has {} {} in the mean, fewer than {least}",
            significant(duration, 3),
            significant(whole, 3),
            significant(encounters.each, 2),
            encounters.name(),
        )
    })
}
