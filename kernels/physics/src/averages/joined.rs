//! Averages of several runs of one scene.

use super::estimate::{Estimate, FEWEST_SAMPLES, Outcome, bar};
use super::{Average, Averages, BAR};

/// Joins the averages of runs that observe the same quantities.
///
/// A mean is that of the runs' means, each by the time that it is over; its error is that of theirs. Where the runs differ by more
/// than their errors explain, the error grows by √(χ²/(R − 1)) of the R runs (Birge, Phys. Rev. 40, 207 (1932)).
pub fn joined(runs: &[Averages]) -> Averages {
    let quantities = match runs.first() {
        Some(first) => first.quantities.iter().enumerate().map(|(place, average)| {
            let outcomes: Vec<Outcome> = runs.iter().map(|run| run.quantities[place].outcome).collect();
            Average { outcome: joined_outcome(&outcomes), ..average.clone() }
        }),
        None => return Averages { bar: BAR, rows: 0, runs: 0, quantities: vec![] },
    };
    let rows = runs.iter().map(|run| run.rows).sum();
    Averages { bar: BAR, rows, runs: runs.len(), quantities: quantities.collect() }
}

fn joined_outcome(outcomes: &[Outcome]) -> Outcome {
    if let [only] = outcomes {
        return *only;
    }
    let mut estimates = vec![];
    let mut constants = vec![];
    for outcome in outcomes {
        match *outcome {
            Outcome::Mean(estimate) | Outcome::TooShort { estimate: Some(estimate), .. } => {
                estimates.push(estimate);
            }
            Outcome::Constant { mean } => constants.push(mean),
            Outcome::TooShort { .. } | Outcome::Changing { .. } => return *outcome,
            Outcome::Kept { .. } => return worst_kept(outcomes),
        }
    }
    match (estimates.is_empty(), constants.as_slice()) {
        (true, [first, rest @ ..]) if rest.iter().all(|mean| (mean - first).abs() <= 1e-9 * first.abs()) => {
            Outcome::Constant { mean: *first }
        }
        // Each run keeps its own value: what varies is between runs.
        (true, constants) => between(constants),
        (false, []) => within(&estimates),
        (false, _) => outcomes[0],
    }
}

/// The one that went farthest.
fn worst_kept(outcomes: &[Outcome]) -> Outcome {
    let far = |outcome: &Outcome| if let Outcome::Kept { farthest, .. } = outcome { *farthest } else { 0.0 };
    outcomes.iter().copied().max_by(|a, b| far(a).total_cmp(&far(b))).unwrap_or(outcomes[0])
}

/// Of values that do not vary within a run, each an independent sample.
fn between(values: &[f64]) -> Outcome {
    let n = values.len() as f64;
    let mean = values.iter().sum::<f64>() / n;
    let squares: f64 = values.iter().map(|value| (value - mean).powi(2)).sum();
    let (standard_error, freedoms) = ((squares / (n - 1.0) / n).sqrt(), n - 1.0);
    Outcome::Mean(Estimate {
        mean,
        bar: bar(standard_error, freedoms),
        standard_error,
        standard_error_by_blocks: None,
        freedoms,
        inefficiency: 1.0,
        correlation_time: 0.0,
        equilibrated_at: 0.0,
        independent_samples: n,
        span: 0.0,
    })
}

/// Of means with errors of their own.
fn within(estimates: &[Estimate]) -> Outcome {
    let all: f64 = estimates.iter().map(|it| it.span).sum();
    let weighted =
        |of: fn(&Estimate) -> f64| -> f64 { estimates.iter().map(|it| it.span / all * of(it)).sum() };
    let total = |of: fn(&Estimate) -> f64| -> f64 { estimates.iter().map(of).sum() };
    let mean = weighted(|it| it.mean);
    let error_of = |it: &Estimate| it.standard_error.max(it.standard_error_by_blocks.unwrap_or(0.0));
    let squares: f64 = estimates.iter().map(|it| (it.span / all * error_of(it)).powi(2)).sum();
    let spread: f64 = estimates.iter().map(|it| ((it.mean - mean) / error_of(it)).powi(2)).sum();
    let runs = estimates.len() as f64;
    let standard_error = squares.sqrt() * (spread / (runs - 1.0)).sqrt().max(1.0);
    let freedoms = total(|it| it.freedoms);
    let equilibrated_at = estimates.iter().map(|it| it.equilibrated_at).fold(0.0, f64::max);
    let estimate = Estimate {
        mean,
        bar: bar(standard_error, freedoms),
        standard_error,
        standard_error_by_blocks: None,
        freedoms,
        inefficiency: weighted(|it| it.inefficiency),
        correlation_time: weighted(|it| it.correlation_time),
        equilibrated_at,
        independent_samples: total(|it| it.independent_samples),
        span: all,
    };
    if estimate.independent_samples < FEWEST_SAMPLES {
        let Estimate { independent_samples, span, .. } = estimate;
        let enough_at = equilibrated_at + span / runs * FEWEST_SAMPLES / independent_samples;
        return Outcome::TooShort { independent_samples, enough_at, estimate: Some(estimate) };
    }
    Outcome::Mean(estimate)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::averages::estimated;
    use crate::averages::noise::Noise;

    fn mean(outcome: Outcome) -> Estimate {
        match outcome {
            Outcome::Mean(estimate) => estimate,
            other => panic!("{other:?}"),
        }
    }

    #[test]
    fn joined_bars_hold_the_truth_as_often_as_they_say() {
        let held = (0..200).filter(|seed| {
            let runs = [400, 800, 1200].into_iter().zip(0..);
            let runs = runs.map(|(length, run)| {
                estimated(&Noise::new(3 * seed + run).relaxing(length, 0.6, 8.0, 10.0), 0.0, 1.0)
            });
            let joined = mean(joined_outcome(&runs.collect::<Vec<_>>()));
            joined.mean.abs() <= joined.bar
        });
        let share = held.count() as f64 / 200.0;
        println!("joined: {share}");
        assert!((0.92..=0.99).contains(&share), "{share}");
    }

    /// Runs of different truths: the bar grows to what lies between them.
    #[test]
    fn runs_that_differ_widen_the_bar() {
        let run = |seed, shift: f64| {
            let series: Vec<f64> = Noise::new(seed).series(1000, 0.5).iter().map(|x| x + shift).collect();
            estimated(&series, 0.0, 1.0)
        };
        let alike = mean(joined_outcome(&[run(1, 0.0), run(2, 0.0)]));
        let apart = mean(joined_outcome(&[run(1, 0.0), run(2, 5.0)]));
        assert!(apart.bar > 2.0 && alike.bar < 0.2, "{} {}", apart.bar, alike.bar);
        let one = mean(run(1, 0.0));
        assert!((alike.independent_samples / one.independent_samples - 2.0).abs() < 0.4);
    }

    /// By hand: 1 and 3 have the mean 2 and the standard error 1.
    #[test]
    fn what_is_constant_in_each_run_varies_between_them() {
        let of = |mean| Outcome::Constant { mean };
        assert_eq!(joined_outcome(&[of(1.5), of(1.5)]), of(1.5));
        let estimate = mean(joined_outcome(&[of(1.0), of(3.0)]));
        assert_eq!((estimate.mean, estimate.standard_error, estimate.freedoms), (2.0, 1.0, 1.0));
        let kept = |farthest| Outcome::Kept { first: 0.0, last: 0.0, farthest };
        assert_eq!(joined_outcome(&[kept(1.0), kept(2.0)]), kept(2.0));
        let changing = Outcome::Changing { first: 0.0, last: 1.0 };
        assert_eq!(joined_outcome(&[of(1.0), changing]), changing);
    }
}
