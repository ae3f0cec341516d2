//! Growth of a small disturbance, and the time over which trajectories are comparable.

use crate::statistics::slope;
use crate::study::choice::SettingChoice;
use crate::study::runs::StudyRuns;
use crate::study::state::{ParticleState, displaced};
use crate::study::trial::RunFailure;
use crate::study::{StudyError, Subject};
use serde::{Deserialize, Serialize};
use stripmine_physics::method::{ChoiceEffect, Prepared, StartPurpose};
use stripmine_physics::number::significant;
use stripmine_physics::scene::Overrides;

/// Initial displacement of the particles of the disturbed run (the method's length).
pub(crate) const DISTURBANCE: f64 = 1e-9;
/// Largest error at which trajectories are comparable (the method's length).
pub(crate) const COMPARABLE: f64 = 0.1;
/// Largest step, in steps of the scene, at which trajectories should be comparable.
const COARSER: f64 = 4.0;
/// Samples of the runs.
const LOOKS: u64 = 64;
/// Fewest samples of a window; with fewer it is sampled again, more closely.
const FEW: usize = 8;
/// Number of halvings where the scene's own step fails.
const HALVINGS: i32 = 3;

/// Distances over time, and the window in which trajectories are comparable.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct DisturbanceGrowth {
    /// Step of the runs (time).
    pub step: f64,
    /// Times of the samples (time).
    pub times: Vec<f64>,
    /// Root mean square distance of the disturbed run (the method's length).
    pub(crate) separation: Vec<f64>,
    /// Root mean square distance of a run at half the step (the method's length).
    pub error: Vec<f64>,
    /// Rate of the exponential growth (1/time); none where nothing grows.
    pub rate: Option<f64>,
    /// End of the window (time).
    pub window: f64,
    pub(crate) ended_by: EndedBy,
}

/// Reason for the end of the window in which trajectories are comparable.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) enum EndedBy {
    Growth,
    Scene,
    Budget,
}

impl DisturbanceGrowth {
    /// True if it can come from runs of the scene: as many distances as times, within the duration of the scene.
    fn is_of(&self, subject: &Subject) -> bool {
        let DisturbanceGrowth { step, times, separation, error, rate, window, .. } = self;
        let whole = subject.duration() * (1.0 + 1e-9);
        let least = subject.step * 0.5f64.powi(HALVINGS);
        let all = times.iter().chain(separation).chain(error).chain(rate).chain([step, window]);
        [separation.len(), error.len()] == [times.len(); 2]
            && (least..=subject.step).contains(step)
            && (0.0..=whole).contains(window)
            && times.iter().all(|time| (0.0..=whole).contains(time))
            && all.copied().all(f64::is_finite)
    }
}

/// Runs the scene's own configuration, with a disturbed start and at half the step, for at most `most` own steps of `each` seconds.
/// A step that fails is halved. Where the error of the step alone may end the window, the configuration of the reference is run, too.
///
/// # Errors
/// [`StudyError::EveryRunFails`] if no step works.
pub(crate) fn growth(runs: &StudyRuns<'_>, most: u64, each: f64) -> Result<DisturbanceGrowth, StudyError> {
    let own = own_in_full_precision(runs.subject);
    let mut tried = vec![];
    for halvings in 0..=HALVINGS {
        match of_step(runs, &own, halvings, (most, each))? {
            Ok(growth) => return longer_by_reference(runs, &own, growth, (most, each)),
            Err(failure) => {
                let step = runs.subject.step * 0.5f64.powi(halvings);
                tried.push((format!("{} with step {}", own.label(), significant(step, 6)), failure.why));
            }
        }
    }
    Err(StudyError::EveryRunFails { tried })
}

fn longer_by_reference(
    runs: &StudyRuns<'_>,
    own: &SettingChoice,
    first: DisturbanceGrowth,
    course: (u64, f64),
) -> Result<DisturbanceGrowth, StudyError> {
    let reference = runs.subject.reference(0);
    if first.ended_by != EndedBy::Growth || reference == *own {
        return Ok(first);
    }
    let second = of_step(runs, &reference, 0, course)?.ok();
    Ok(second.filter(|second| second.window > first.window).unwrap_or(first))
}

/// Growth at the scene's own step, halved some times, over a number of own steps.
fn of_step(
    runs: &StudyRuns<'_>,
    choice: &SettingChoice,
    halvings: i32,
    (most, each): (u64, f64),
) -> Result<Result<DisturbanceGrowth, RunFailure>, StudyError> {
    let step = runs.subject.step * 0.5f64.powi(halvings);
    let fits = |growth: &DisturbanceGrowth| growth.is_of(runs.subject);
    runs.recall(&format!("growth|{}|{halvings}", choice.label()), fits, || {
        let mut growth = observed(runs, choice, step, (most << halvings, each))?;
        while growth.ended_by == EndedBy::Growth && (2..FEW).contains(&growth.times.len()) {
            let steps = growth.times.last().map_or(0.0, |time| (time / step).round());
            if steps < LOOKS as f64 {
                break;
            }
            growth = observed(runs, choice, step, (steps as u64, each))?;
        }
        Ok(growth)
    })
}

/// The scene's own configuration in the precision of the reference: a small disturbance must not be lost in rounding.
pub(crate) fn own_in_full_precision(subject: &Subject) -> SettingChoice {
    let is_of_precision = |name: &str| {
        subject.entry.axes.iter().any(|axis| axis.name == name && axis.decides == ChoiceEffect::Precision)
    };
    let [first, _] = subject.trials.references;
    subject.own.with(&first.iter().copied().filter(|(axis, _)| is_of_precision(axis)).collect::<Vec<_>>())
}

fn observed(
    runs: &StudyRuns<'_>,
    choice: &SettingChoice,
    step: f64,
    (most, each): (u64, f64),
) -> Result<DisturbanceGrowth, RunFailure> {
    let subject = runs.subject;
    let prepared = |step| subject.prepared_as(choice, step, &Overrides::new());
    let (base, halved) = (prepared(step)?, prepared(0.5 * step)?);
    let domain = base.domain;
    let length = (subject.trials.length.of)(base.particles());
    let disturbed = base.model.started_from(displaced(base.particles(), &domain, |place, _| {
        // Irregular directions, equal on every machine.
        let angle = 2.399_963_229_728_653 * (place as f64 + 1.0);
        [libm::cos(angle), libm::sin(angle)].map(|part| DISTURBANCE * length * part)
    }));
    let begin = |scene: &Prepared| scene.start(StartPurpose::Measurement);
    let mut all = [(begin(&base)?, 1), (begin(&disturbed)?, 1), (begin(&halved)?, 2)];
    let looks = LOOKS.min(most);
    let mut growth = DisturbanceGrowth {
        step,
        times: vec![],
        separation: vec![],
        error: vec![],
        rate: None,
        window: 0.0,
        ended_by: if most < subject.steps { EndedBy::Budget } else { EndedBy::Scene },
    };
    for look in 1..=looks {
        let steps = most * look / looks;
        for (simulation, times) in &mut all {
            runs.trial.advance_to_step(simulation.as_mut(), *times * steps)?;
        }
        runs.meter.add(4.0 * each * (steps - most * (look - 1) / looks) as f64);
        let [base, disturbed, halved] = all.each_ref().map(|(run, _)| ParticleState::of(&run.particles()));
        let apart = |other: &ParticleState| base.distance(other, &domain)[0] / length;
        let error = apart(&halved);
        growth.times.push(steps as f64 * step);
        growth.separation.push(apart(&disturbed));
        growth.error.push(error);
        if error * COARSER.min(COARSER * step / subject.step) > COMPARABLE && look > 1 {
            growth.ended_by = EndedBy::Growth;
            break;
        }
        growth.window = steps as f64 * step;
    }
    growth.rate = rate(&growth.times, &growth.separation);
    Ok(growth)
}

/// Rate of exponential growth between the initial disturbance and divergence; none where nothing grows.
fn rate(times: &[f64], separation: &[f64]) -> Option<f64> {
    const GROWN: f64 = 3.0 * DISTURBANCE;
    const LOST: f64 = 0.01;
    let growing = times.iter().zip(separation).filter(|(_, distance)| (GROWN..LOST).contains(distance));
    let (times, logarithms): (Vec<f64>, Vec<f64>) =
        growing.map(|(time, distance)| (*time, libm::log(*distance))).unzip();
    let rate = slope(&times, &logarithms);
    (times.len() > 2 && rate > 0.0).then_some(rate)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn growth_is_exponential_between_the_disturbance_and_loss() {
        let times: Vec<f64> = (0..60).map(f64::from).collect();
        let separation: Vec<f64> =
            times.iter().map(|t| (DISTURBANCE * (0.5 * t).exp()).clamp(DISTURBANCE, 0.3)).collect();
        assert!((rate(&times, &separation).unwrap() - 0.5).abs() < 1e-9);
        assert_eq!(rate(&times, &vec![DISTURBANCE; 60]), None);
    }
}
