//! Joined averages of several runs of one scene.

use super::estimate::{AverageOutcome, Estimate, FEWEST_SAMPLES, LIKELY_ENOUGH, bar};
use super::{Average, BAR, RunAverages};

/// Relative difference below which numbers count as equal.
const SAME: f64 = 1e-9;
/// Largest change of a conserved number within a run, as a fraction of its range between runs.
const CONSERVED: f64 = 0.1;

/// Number of runs of one ensemble from which on their spread determines the error. With fewer, Student's t of one or two degrees of freedom would
/// make error bars several times as long.
const ENOUGH_RUNS: usize = 4;
/// Largest accidental excess of χ²/(R − 1) above 1, in standard deviations: one of a hundred joins of one ensemble exceeds it.
const CHANCE: f64 = 3.0;

/// Joins the averages of runs that observe the same quantities.
///
/// Runs of a closed system may differ permanently, for instance in energy. Each is then one independent sample, and Student's t of R runs has R − 1
/// degrees of freedom. Runs that differ in no conserved number are of one ensemble and are weighted by their time. Four or more have the error of
/// their spread. Two or three have the errors of each; if they differ by more than statistical error, the error is multiplied by √(χ²/(R − 1))
/// (Birge, Phys. Rev. 40, 207 (1932)). If most runs are too short for a mean, their transients are unknown, and the join is too short as well.
pub fn joined(runs: &[RunAverages]) -> RunAverages {
    let Some(first) = runs.first() else {
        return RunAverages { bar: BAR, rows: 0, span: 0.0, runs: 0, quantities: vec![] };
    };
    let outcomes = |place: usize| -> Vec<AverageOutcome> {
        runs.iter().map(|run| run.quantities[place].outcome).collect()
    };
    let spans: Vec<f64> = runs.iter().map(|run| run.span).collect();
    let is_one_ensemble = !(0..first.quantities.len()).any(|place| differ_permanently(&outcomes(place)));
    let quantities = first.quantities.iter().enumerate().map(|(place, average)| {
        let outcome = joined_outcome(&outcomes(place), &spans, is_one_ensemble);
        Average { outcome, ..average.clone() }
    });
    let rows = runs.iter().map(|run| run.rows).sum();
    RunAverages {
        bar: BAR,
        rows,
        span: spans.iter().sum(),
        runs: runs.len(),
        quantities: quantities.collect(),
    }
}

/// Tests if every run conserves the quantity and runs differ in it.
fn differ_permanently(outcomes: &[AverageOutcome]) -> bool {
    let conserved = outcomes.iter().map(|outcome| match *outcome {
        AverageOutcome::Constant { mean } => Some((mean, 0.0)),
        AverageOutcome::Kept { first, farthest, .. } => Some((first, farthest)),
        _ => None,
    });
    let Some(conserved) = conserved.collect::<Option<Vec<(f64, f64)>>>() else { return false };
    let values = || conserved.iter().map(|it| it.0);
    let apart = values().fold(f64::NEG_INFINITY, f64::max) - values().fold(f64::INFINITY, f64::min);
    let largest = values().map(f64::abs).fold(0.0, f64::max);
    let farthest = conserved.iter().map(|it| it.1).fold(0.0, f64::max);
    apart > SAME * largest && farthest < CONSERVED * apart
}

fn joined_outcome(outcomes: &[AverageOutcome], spans: &[f64], is_one_ensemble: bool) -> AverageOutcome {
    if let [only] = outcomes {
        return *only;
    }
    if let Some(outcome) = outcome_without_mean(outcomes) {
        return outcome;
    }
    // Mean of each run with its time; a constant has no samples.
    let of_run = |(outcome, span): (&AverageOutcome, &f64)| match *outcome {
        AverageOutcome::Mean(it) | AverageOutcome::TooShort { estimate: Some(it), .. } => {
            (it.mean, it.span, Some(it))
        }
        AverageOutcome::Constant { mean } => (mean, *span, None),
        _ => (f64::NAN, 0.0, None),
    };
    let parts: Vec<(f64, f64, Option<Estimate>)> = outcomes.iter().zip(spans).map(of_run).collect();
    let values: Vec<[f64; 2]> = parts.iter().map(|&(mean, span, _)| [mean, span]).collect();
    let estimates: Vec<Estimate> = parts.iter().filter_map(|part| part.2).collect();
    let largest = values.iter().fold(0.0_f64, |largest, [mean, _]| largest.max(mean.abs()));
    if estimates.is_empty() && values.iter().all(|[mean, _]| (mean - values[0][0]).abs() <= SAME * largest) {
        return AverageOutcome::Constant { mean: values[0][0] };
    }
    let short = outcomes.iter().filter_map(|outcome| match *outcome {
        AverageOutcome::TooShort { enough_at, .. } => Some(enough_at),
        _ => None,
    });
    let short: Vec<f64> = short.collect();
    let have_errors = outcomes.iter().all(|outcome| matches!(outcome, AverageOutcome::Mean(_)));
    // Runs of one ensemble are weighted by their time; runs that are single samples have equal weights.
    let by_time = is_one_ensemble && have_errors;
    let values: Vec<[f64; 2]> =
        values.into_iter().map(|[mean, span]| [mean, if by_time { span } else { 1.0 }]).collect();
    let independent_samples: f64 = estimates.iter().map(|it| it.independent_samples).sum();
    let is_within = by_time && values.len() < ENOUGH_RUNS;
    let mut error = if is_within { Error::within(&estimates) } else { Error::between(&values) };
    if by_time {
        error.samples = independent_samples;
    }
    let span = parts.iter().map(|part| part.1).sum();
    let estimate = error.estimate(&values, span, &estimates);
    if !estimates.is_empty() && independent_samples < FEWEST_SAMPLES {
        let longer = LIKELY_ENOUGH / independent_samples;
        let enough_at = estimate.equilibrated_at + longer * estimate.span / values.len() as f64;
        return AverageOutcome::TooShort { independent_samples, enough_at, estimate: Some(estimate) };
    }
    if 2 * short.len() > outcomes.len() {
        let enough_at = short.into_iter().fold(0.0, f64::max);
        return AverageOutcome::TooShort { independent_samples, enough_at, estimate: Some(estimate) };
    }
    AverageOutcome::Mean(estimate)
}

/// Outcome that prevents a joined mean, the gravest of all, so that it is independent of the order of the runs.
fn outcome_without_mean(outcomes: &[AverageOutcome]) -> Option<AverageOutcome> {
    let weight = |outcome: &AverageOutcome| match *outcome {
        AverageOutcome::Undefined => Some([4.0, 0.0]),
        AverageOutcome::Kept { farthest, .. } => Some([3.0, farthest]),
        AverageOutcome::Changing { first, last } => Some([2.0, (last - first).abs()]),
        AverageOutcome::TooShort { enough_at, estimate: None, .. } => Some([1.0, enough_at]),
        _ => None,
    };
    let gravest = outcomes.iter().copied().max_by(|a, b| {
        let [a, b] = [a, b].map(|it| weight(it).unwrap_or_default());
        a[0].total_cmp(&b[0]).then(a[1].total_cmp(&b[1]))
    });
    gravest.filter(|outcome| weight(outcome).is_some())
}

/// Error of a joined mean.
struct Error {
    standard_error: f64,
    freedoms: f64,
    samples: f64,
}

/// Weighted mean of [mean, weight]; 0 for an empty list.
fn weighted(values: &[[f64; 2]]) -> f64 {
    let all: f64 = values.iter().map(|[_, weight]| weight).sum();
    values.iter().fold(0.0, |sum, [mean, weight]| sum + weight / all * mean)
}

impl Error {
    /// Error from the spread between runs. Their effective number is that with the same error for equal weights, (Σw)²/Σw².
    fn between(values: &[[f64; 2]]) -> Error {
        let (all, mean) = (values.iter().map(|[_, weight]| weight).sum::<f64>(), weighted(values));
        let weights = || values.iter().map(|[it, weight]| (it - mean, weight / all));
        let runs = 1.0 / weights().map(|(_, weight)| weight * weight).sum::<f64>();
        let squares: f64 = weights().map(|(off, weight)| (weight * off).powi(2)).sum();
        let freedoms = (runs - 1.0).max(1.0);
        Error { standard_error: (squares * runs / freedoms).sqrt(), freedoms, samples: runs }
    }

    /// Error from the errors of the runs.
    fn within(estimates: &[Estimate]) -> Error {
        let runs = estimates.len() as f64;
        let mean = weighted(&estimates.iter().map(|it| [it.mean, it.span]).collect::<Vec<_>>());
        let total = |of: &dyn Fn(&Estimate) -> f64| -> f64 { estimates.iter().map(of).sum() };
        let all = total(&|it| it.span);
        let squares = total(&|it| (it.span / all * it.standard_error).powi(2));
        let spread = total(&|it| ((it.mean - mean) / it.standard_error).powi(2));
        let excess = spread / (runs - 1.0);
        let is_chance = excess < 1.0 + CHANCE * (2.0 / (runs - 1.0)).sqrt();
        Error {
            standard_error: squares.sqrt() * if is_chance { 1.0 } else { excess.sqrt() },
            freedoms: total(&|it| it.freedoms),
            samples: total(&|it| it.independent_samples),
        }
    }

    fn estimate(self, values: &[[f64; 2]], span: f64, estimates: &[Estimate]) -> Estimate {
        let of = |of: fn(&Estimate) -> f64| {
            weighted(&estimates.iter().map(|it| [of(it), it.span]).collect::<Vec<_>>())
        };
        Estimate {
            mean: weighted(values),
            bar: bar(self.standard_error, self.freedoms),
            standard_error: self.standard_error,
            freedoms: self.freedoms,
            inefficiency: of(|it| it.inefficiency),
            correlation_time: of(|it| it.correlation_time),
            equilibrated_at: estimates.iter().map(|it| it.equilibrated_at).fold(0.0, f64::max),
            independent_samples: self.samples,
            span,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::averages::estimate_mean;
    use crate::averages::noise::Noise;

    fn mean(outcome: AverageOutcome) -> Estimate {
        match outcome {
            AverageOutcome::Mean(estimate) => estimate,
            other => panic!("{other:?}"),
        }
    }

    fn join(outcomes: &[AverageOutcome], is_one_ensemble: bool) -> AverageOutcome {
        joined_outcome(outcomes, &vec![1000.0; outcomes.len()], is_one_ensemble)
    }

    /// Runs of one ensemble, and runs of different energies, which shift their means by three of their error bars.
    #[test]
    fn joined_intervals_have_their_coverage() {
        for (runs, own) in [(2, 0.0), (3, 0.0), (4, 0.0), (8, 0.0), (2, 0.4), (4, 0.4), (8, 0.4)] {
            let held = (0..300).map(|seed| {
                let means = Noise::new(1_000_000 + seed).series(runs, 0.0);
                let runs = means.into_iter().zip(0_u64..).map(|(energy, run)| {
                    let series = Noise::new(10 * seed + run).relaxing(1200, 0.6, 8.0, 10.0);
                    estimate_mean(&series.iter().map(|x| x + own * energy).collect::<Vec<_>>(), 0.0, 1.0)
                });
                runs.collect::<Vec<_>>()
            });
            let with_means =
                held.filter(|runs| runs.iter().all(|run| matches!(run, AverageOutcome::Mean(_))));
            let joined = with_means.map(|runs| mean(join(&runs, own == 0.0)));
            let held: Vec<bool> = joined.map(|joined| joined.mean.abs() <= joined.bar).collect();
            let share = held.iter().filter(|held| **held).count() as f64 / held.len() as f64;
            assert!(held.len() > 200, "{}", held.len());
            println!("{runs} runs, {own}: {share}");
            assert!((0.92..=0.985).contains(&share), "{runs} runs, {own}: {share}");
        }
    }

    /// Hand calculation: 1 and 3 have the mean 2 and the standard error 1, with one degree of freedom.
    #[test]
    fn constants_of_runs_vary_between_runs() {
        let of = |mean| AverageOutcome::Constant { mean };
        assert_eq!(join(&[of(1.5), of(1.5)], true), of(1.5));
        let estimate = mean(join(&[of(1.0), of(3.0)], true));
        assert_eq!((estimate.mean, estimate.standard_error, estimate.freedoms), (2.0, 1.0, 1.0));
        let kept = |farthest| AverageOutcome::Kept { first: 0.0, last: 0.0, farthest };
        assert_eq!(join(&[kept(1.0), kept(2.0)], true), kept(2.0));
        let changing = AverageOutcome::Changing { first: 0.0, last: 1.0 };
        assert_eq!(join(&[of(1.0), changing], true), changing);
    }

    /// Two runs with a mean and one without events: the outcome is the same in every order, and includes all three.
    #[test]
    fn joins_are_independent_of_order() {
        let varying = [1, 2].map(|seed| estimate_mean(&Noise::new(seed).series(1000, 0.5), 0.0, 1.0));
        let [a, b] = varying;
        let (still, short) =
            (AverageOutcome::Constant { mean: 0.0 }, estimate_mean(&Noise::new(3).series(60, 0.9), 0.0, 1.0));
        assert!(matches!(short, AverageOutcome::TooShort { estimate: Some(_), .. }));
        for third in [still, short] {
            let joined = |order: [AverageOutcome; 3]| mean(join(&order, true));
            let first = joined([a, b, third]);
            assert_eq!(first.freedoms, 2.0);
            for order in [[third, a, b], [b, third, a], [b, a, third]] {
                assert!((joined(order).mean - first.mean).abs() < 1e-15);
                assert!((joined(order).bar / first.bar - 1.0).abs() < 1e-12);
            }
        }
        let expected = (mean(a).mean + mean(b).mean) / 3.0;
        assert!((mean(join(&[still, b, a], true)).mean - expected).abs() < 0.05);
        assert!(matches!(join(&[still, short], true), AverageOutcome::TooShort { .. }));
        for gravest in [AverageOutcome::Undefined, AverageOutcome::Changing { first: 0.0, last: 9.0 }] {
            let other = AverageOutcome::Changing { first: 0.0, last: 1.0 };
            assert_eq!([join(&[a, other, gravest], true), join(&[gravest, other, a], true)], [gravest; 2]);
        }
    }

    /// Hand calculation: means 1, 2, 3, 6 over equal times have the mean 3 and the standard error √(14/12), with three degrees of freedom, whatever
    /// their errors. Over times of 1, 1, 1, 3 the mean is 4, with an effective number of three runs.
    #[test]
    fn four_runs_have_the_error_of_their_spread() {
        let AverageOutcome::Mean(some) = estimate_mean(&Noise::new(1).series(1000, 0.5), 0.0, 1.0) else {
            panic!()
        };
        let run = |mean, span| AverageOutcome::Mean(Estimate { mean, span, ..some });
        let joined = mean(join(&[run(1.0, 9.0), run(2.0, 9.0), run(3.0, 9.0), run(6.0, 9.0)], true));
        assert!((joined.mean - 3.0).abs() < 1e-12 && (joined.freedoms - 3.0).abs() < 1e-12, "{joined:?}");
        assert!((joined.standard_error - (14.0_f64 / 12.0).sqrt()).abs() < 1e-12, "{joined:?}");
        assert!((joined.independent_samples / some.independent_samples - 4.0).abs() < 1e-12, "{joined:?}");
        let joined = mean(join(&[run(1.0, 1.0), run(2.0, 1.0), run(3.0, 1.0), run(6.0, 3.0)], true));
        assert!((joined.mean - 4.0).abs() < 1e-12 && (joined.freedoms - 2.0).abs() < 1e-12, "{joined:?}");
    }

    /// One of two runs may be too short, but not two of three.
    #[test]
    fn joins_of_mostly_short_runs_are_too_short() {
        let long = estimate_mean(&Noise::new(1).series(1000, 0.5), 0.0, 1.0);
        let short = estimate_mean(&Noise::new(3).series(60, 0.9), 0.0, 1.0);
        let AverageOutcome::TooShort { enough_at, .. } = short else { panic!("{short:?}") };
        assert!(matches!(join(&[long, short], true), AverageOutcome::Mean(_)));
        let AverageOutcome::TooShort { enough_at: found, .. } = join(&[short, long, short], true) else {
            panic!()
        };
        assert_eq!(found, enough_at);
    }

    /// Different energies make runs of a closed system independent samples; momenta that differ by rounding do not.
    #[test]
    fn different_conserved_numbers_are_detected() {
        let kept = |first, farthest| AverageOutcome::Kept { first, last: first, farthest };
        assert!(differ_permanently(&[
            AverageOutcome::Constant { mean: 51.4 },
            AverageOutcome::Constant { mean: 48.0 }
        ]));
        assert!(differ_permanently(&[kept(0.3, 1e-12), kept(-0.2, 1e-12)]));
        assert!(!differ_permanently(&[kept(1e-17, 1e-13), kept(-2e-16, 1e-13)]));
        assert!(!differ_permanently(&[kept(0.3, 2.0), kept(-0.2, 3.0)]));
        assert!(!differ_permanently(&[AverageOutcome::Constant { mean: 0.0 }; 3]));
        assert!(!differ_permanently(&[
            AverageOutcome::Constant { mean: 0.0 },
            estimate_mean(&[1.0, 2.0], 0.0, 1.0)
        ]));
    }
}
