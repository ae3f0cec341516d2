//! How fast a small disturbance grows, and up to which time trajectories are therefore comparable.

use super::choice::Choice;
use super::shortened::first_line;
use super::state::{State, displaced};
use super::subject::Subject;
use super::trial::advance;
use crate::results::Meter;
use crate::statistics::slope;
use serde::{Deserialize, Serialize};
use stripmine_physics::method::{Decides, Failure, Prepared, Purpose, Simulation};
use stripmine_physics::number::significant;
use stripmine_physics::scene::Overrides;

/// How far particles of the second run are moved at the start (the method's length).
pub const DISTURBANCE: f64 = 1e-9;
/// Trajectories are comparable while the error is below this (the method's length).
pub const COMPARABLE: f64 = 0.1;
/// Times the scene's own step up to which they are to be comparable.
const COARSER: f64 = 4.0;
/// Looks at the runs.
const LOOKS: u64 = 64;
/// Where the window ends after fewer looks, runs as long as the window are looked at more closely.
const FEW: usize = 8;
/// Steps are halved this often where the scene's own does not serve.
pub const HALVINGS: i32 = 3;

/// What came out.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Growth {
    pub way: String,
    /// The step of the runs (time).
    pub step: f64,
    /// Times of the looks (time).
    pub times: Vec<f64>,
    /// Root mean square distance of the disturbed run (the method's length).
    pub separation: Vec<f64>,
    /// Root mean square distance of a run with half the step (the method's length).
    pub error: Vec<f64>,
    /// Rate of the exponential growth (1/time); none where there is none to be seen.
    pub rate: Option<f64>,
    /// Up to which time trajectories are comparable (time).
    pub window: f64,
    pub ended_by: EndedBy,
}

impl Growth {
    /// Whether it is what a run of the scene shows: as many distances as times, within the time of the scene.
    pub fn is_of(&self, subject: &Subject) -> bool {
        let Growth { step, times, separation, error, rate, window, .. } = self;
        let whole = subject.steps as f64 * subject.step * (1.0 + 1e-9);
        let least = subject.step * 0.5f64.powi(HALVINGS);
        let all = times.iter().chain(separation).chain(error).chain(rate).chain([step, window]);
        [separation.len(), error.len()] == [times.len(); 2]
            && (least..=subject.step).contains(step)
            && (0.0..=whole).contains(window)
            && times.iter().all(|time| (0.0..=whole).contains(time))
            && all.copied().all(f64::is_finite)
    }
}

/// What ends the time in which trajectories are compared.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum EndedBy {
    Growth,
    /// The scene does.
    Scene,
    Budget,
}

/// Follows a run in some way, one whose start is disturbed and one with half the step, for at most `most` own steps of the scene;
/// where the step does not serve it is halved up to `halvings` times.
///
/// # Errors
/// What was tried, and why it failed, if no run comes to its end.
pub fn growth(
    subject: &Subject,
    (choice, halvings): (&Choice, i32),
    most: u64,
    each: f64,
    meter: &Meter<'_>,
) -> Result<Growth, Vec<(String, String)>> {
    let mut tried = vec![];
    for halvings in 0..=halvings {
        let step = subject.step * 0.5f64.powi(halvings);
        let closely = |most: u64| at_step(subject, choice, step, most, each, meter);
        let mut found = closely(most << halvings);
        while let Ok(growth) = &found
            && growth.ended_by == EndedBy::Growth
            && growth.times.len() < FEW
            && growth.times.len() > 1
        {
            let looked_at = growth.times.last().map_or(0.0, |time| (time / step).round());
            if looked_at < LOOKS as f64 {
                break;
            }
            found = closely(looked_at as u64);
        }
        match found {
            Ok(growth) => return Ok(growth),
            Err(why) => {
                tried.push((format!("{} with step {step}", choice.label(), step = significant(step, 6)), why))
            }
        }
    }
    Err(tried)
}

/// The scene's own way, with the digits of the reference: a small disturbance must not be lost in rounding.
pub fn own_in_full_digits(subject: &Subject) -> Choice {
    let is_of_digits = |name: &str| {
        subject.entry.axes.iter().any(|axis| axis.name == name && axis.decides == Decides::Digits)
    };
    let [first, _] = subject.trials.references;
    subject.own.with(&first.iter().copied().filter(|(axis, _)| is_of_digits(axis)).collect::<Vec<_>>())
}

fn at_step(
    subject: &Subject,
    choice: &Choice,
    step: f64,
    most: u64,
    each: f64,
    meter: &Meter<'_>,
) -> Result<Growth, String> {
    let prepare =
        |step| subject.prepared_as(choice, step, &Overrides::new()).map_err(|errors| errors.to_string());
    let (base, halved) = (prepare(step)?, prepare(0.5 * step)?);
    let domain = base.domain;
    let length = (subject.trials.length.of)(base.particles());
    let disturbed = base.model.started_from(displaced(base.particles(), &domain, |place, _| {
        // Directions without a pattern, the same everywhere.
        let angle = 2.399_963_229_728_653 * (place as f64 + 1.0);
        [libm::cos(angle), libm::sin(angle)].map(|part| DISTURBANCE * length * part)
    }));
    let begin =
        |scene: &Prepared| scene.start(Purpose::Measurement).map_err(|failure| first_line(&failure.what()));
    let mut runs = [begin(&base)?, begin(&disturbed)?, begin(&halved)?];
    let looks = LOOKS.min(most);
    let mut growth = Growth {
        way: choice.label(),
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
        all_up_to(&mut runs, steps, each, meter).map_err(|failure| first_line(&failure.what()))?;
        let [base, disturbed, halved] = runs.each_ref().map(|run| State::of(&run.particles()));
        let apart = |other: &State| base.distance(other, &domain)[0] / length;
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

/// All runs at the time of `steps` steps of the first.
fn all_up_to(
    runs: &mut [Box<dyn Simulation>; 3],
    steps: u64,
    each: f64,
    meter: &Meter<'_>,
) -> Result<(), Failure> {
    let [base, disturbed, halved] = runs;
    advance(base.as_mut(), steps, each, meter)?;
    advance(disturbed.as_mut(), steps, each, meter)?;
    advance(halved.as_mut(), 2 * steps, each, meter)
}

/// Rate of exponential growth while a distance is neither the disturbance itself nor loss; none where it does not grow.
fn rate(times: &[f64], separation: &[f64]) -> Option<f64> {
    const GROWN: f64 = 3.0 * DISTURBANCE;
    const LOST: f64 = 0.01;
    let growing: Vec<(f64, f64)> = times
        .iter()
        .zip(separation)
        .filter(|(_, distance)| (GROWN..LOST).contains(distance))
        .map(|(time, distance)| (*time, libm::log(*distance)))
        .collect();
    let (times, logarithms): (Vec<f64>, Vec<f64>) = growing.into_iter().unzip();
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
