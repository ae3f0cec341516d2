//! What is left of a comparison once trajectories have parted: means over time, with error bars from independent seeds.

use super::averages::{self, Averages, LOOKS, Means, PROFILE};
use super::choice::Choice;
use super::shortened::first_line;
use super::subject::Subject;
use super::trial::{Course, follow};
use crate::results::{Journal, JournalError, Meter};
use crate::statistics::{Mean, Spread};
use stripmine_physics::method::{Purpose, Simulation};
use stripmine_physics::scene::{Overrides, SEED};

/// Seeds, each an independent start.
pub const SEEDS: [u64; 4] = [1, 2, 3, 4];
/// The share of comparisons whose bar misses zero by chance.
pub const CHANCE: f64 = 0.05;
/// Steps that are tried, in steps of the scene, and that of the reference.
pub const STEPS: [f64; 4] = [4.0, 2.0, 1.0, 0.5];
/// The step of the reference, in steps of the scene.
pub const REFERENCE: f64 = 0.25;

/// A mean over time held against that of the reference.
#[derive(Clone, Debug, PartialEq)]
pub struct Comparison {
    /// What is compared.
    pub observable: String,
    pub choice: String,
    /// The step (time).
    pub step: f64,
    pub reference: f64,
    /// The difference to it, relative to the reference; for the density profile the root of the mean square over the bins.
    pub difference: f64,
    /// Half the width of the interval that holds the difference in 95 of 100 studies, relative to the reference.
    pub bar: f64,
}

impl Comparison {
    /// Whether the error bar reaches zero: the difference is not significant.
    pub fn reaches_zero(&self) -> bool {
        self.difference.abs() <= self.bar
    }
}

/// What came out.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Observables {
    /// The time of each run (time).
    pub duration: f64,
    /// Every comparison; none of a mean that is itself not known to a tenth.
    pub comparisons: Vec<Comparison>,
    pub failed: Vec<(String, f64, String)>,
}

/// Runs every way to run the scene with every seed for `steps` own steps.
pub fn observables(
    subject: &Subject,
    choices: &[Choice],
    steps: u64,
    each: f64,
    journal: &Journal,
    meter: &Meter<'_>,
) -> Result<Observables, JournalError> {
    let reference = subject.own.with(subject.trials.references[0]);
    let mut cases: Vec<(Choice, f64)> = vec![(reference, REFERENCE)];
    cases.extend(choices.iter().flat_map(|choice| STEPS.map(|step| (choice.clone(), step))));
    let runs: Vec<(&(Choice, f64), u64)> =
        cases.iter().flat_map(|case| SEEDS.map(|seed| (case, seed))).collect();
    let means: Vec<Result<Means, String>> = journal.over(&runs, |&((choice, factor), seed)| {
        let key = format!("means|{}|{factor}|{seed}", choice.label());
        let fits = |found: &Result<Means, String>| {
            found.as_ref().map_or(true, |means| averages::are_of(subject, means))
        };
        journal.recall(&key, fits, || {
            Ok::<_, JournalError>(means(subject, choice, *factor, seed, (steps, each), meter))
        })
    })?;
    let mut by_case = cases.iter().zip(means.chunks(SEEDS.len()));
    let mut found = Observables { duration: steps as f64 * subject.step, ..Observables::default() };
    let Some((_, reference)) = by_case.next() else { return Ok(found) };
    for ((choice, factor), runs) in by_case {
        let step = factor * subject.step;
        if let Some(why) = runs.iter().chain(reference).find_map(|run| run.as_ref().err()) {
            found.failed.push((choice.label(), step, why.clone()));
            continue;
        }
        let [runs, reference] =
            [runs, reference].map(|runs| runs.iter().filter_map(|run| run.as_ref().ok()).collect::<Vec<_>>());
        for observable in reference[0].keys() {
            // A part of a mean means nothing where the mean itself is about zero.
            if !is_known(&reference, observable) {
                continue;
            }
            let of = |runs: &[&Means]| runs.iter().map(|run| run[observable].clone()).collect::<Vec<_>>();
            let (value, difference, bar) = compare(&of(&runs), &of(&reference));
            let (observable, choice) = (observable.clone(), choice.label());
            found.comparisons.push(Comparison {
                observable,
                choice,
                step,
                reference: value,
                difference,
                bar,
            });
        }
    }
    Ok(found)
}

fn means(
    subject: &Subject,
    choice: &Choice,
    factor: f64,
    seed: u64,
    (steps, each): (u64, f64),
    meter: &Meter<'_>,
) -> Result<Means, String> {
    let seeded = Overrides::new().set(&SEED, seed);
    let prepared =
        subject.prepared_as(choice, factor * subject.step, &seeded).map_err(|errors| errors.to_string())?;
    let domain = prepared.domain;
    let course = Course { steps: (steps as f64 / factor) as u64, looks: LOOKS, each };
    let mut averages = Averages::new(subject, domain);
    let see = |simulation: &dyn Simulation| {
        if averages.are_due() {
            averages.add(simulation, &simulation.observe());
        } else {
            averages.pass();
        }
    };
    follow(&prepared, Purpose::Measurement, course, None, meter, see)
        .map_err(|failure| first_line(&failure.what()))?;
    Ok(averages.means())
}

/// Whether a mean is known to a tenth; a profile always is.
fn is_known(runs: &[&Means], observable: &str) -> bool {
    let values: Vec<f64> = runs.iter().filter_map(|run| run[observable].first().copied()).collect();
    let spread = Spread::of(&values);
    observable == PROFILE || spread.error.is_some_and(|error| error < 0.1 * spread.mean.abs())
}

/// The mean of the reference, and the difference of runs to it with its bar, both relative to it: seed by seed. Of several
/// values, roots of the mean squares.
fn compare(runs: &[Vec<f64>], reference: &[Vec<f64>]) -> (f64, f64, f64) {
    let count = reference[0].len();
    let rms = |values: &[f64]| (values.iter().map(|v| v * v).sum::<f64>() / count as f64).sqrt();
    let (mut values, mut differences, mut bars) = (vec![], vec![], vec![]);
    for i in 0..count {
        values.push(Spread::of(&reference.iter().map(|run| run[i]).collect::<Vec<_>>()).mean);
        let paired: Vec<f64> = runs.iter().zip(reference).map(|(run, other)| run[i] - other[i]).collect();
        let Mean { value, bar } = Mean::of(&paired);
        differences.push(value);
        bars.push(bar);
    }
    let scale = rms(&values).max(f64::MIN_POSITIVE);
    let difference = if count == 1 { differences[0] } else { rms(&differences) };
    (if count == 1 { values[0] } else { rms(&values) }, difference / scale, rms(&bars) / scale)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::statistics::student;

    /// By hand: differences 1, 1, 1, 1 are certain; 1, −1, 1, −1 are none.
    #[test]
    fn a_difference_counts_where_seeds_agree_on_it() {
        let of = |values: [f64; 4]| values.map(|value| vec![value]).to_vec();
        let reference = of([10.0, 11.0, 9.0, 10.0]);
        let (value, difference, bar) = compare(&of([11.0, 12.0, 10.0, 11.0]), &reference);
        assert_eq!((value, difference, bar), (10.0, 0.1, 0.0));
        let (_, difference, bar) = compare(&of([11.0, 10.0, 10.0, 9.0]), &reference);
        // The standard error of ±1 four times is 1/√3.
        assert!(difference == 0.0 && (bar - 0.1 * student(1.0 - CHANCE, 3) / 3f64.sqrt()).abs() < 1e-15);
    }
}
