//! Cheapest step and run time of a configuration for an error, and the number of runs that share this time.

use super::bias::BiasEstimate;
use super::findings::{Findings, MeasuredConfiguration};
use super::margin::PredictedBars;
use super::optimum::{CostTerms, Optimum, SHORTEST, UNBIASED, cheapest_step_and_time};
use crate::study::StudyCase;
use crate::study::trial::MeanEstimate;
use stripmine_physics::averages::LIKELY_ENOUGH;
use stripmine_physics::method::Every;
use stripmine_physics::number::significant;

/// Fewest independent samples of a run: enough to estimate its own error with high probability.
pub(super) const SAMPLES: f64 = LIKELY_ENOUGH;

/// A configuration with its cheapest step and time for the error.
pub(super) struct PlanCandidate<'w> {
    pub(super) configuration: &'w MeasuredConfiguration,
    pub(super) optimum: Optimum,
}

/// Cheapest step and time of a configuration. Without a time step its bias is zero; with a step and no measured bias it is skipped.
pub(super) fn cheapest_optimum(
    configuration: &MeasuredConfiguration,
    findings: &Findings,
    chance: &StatisticalError,
    wanted: f64,
) -> Option<Optimum> {
    let terms = CostTerms {
        cost: configuration.cost?,
        rows: findings.row * findings.mean.rows(),
        transient: findings.mean.transient,
    };
    let time_for = |bar| chance.time_for(bar);
    match (configuration.step, configuration.bias) {
        (None, _) => cheapest_step_and_time(terms, (wanted, 1.0), |_, _| BiasEstimate::default(), time_for),
        (Some(step), Some(bias)) => {
            let shortest = if bias.is_significant() || bias.creep > 0.0 { SHORTEST } else { UNBIASED };
            cheapest_step_and_time(
                terms,
                (wanted, shortest),
                |part, time| bias.over(part * step, time),
                time_for,
            )
        }
        (Some(_), None) => None,
    }
}

/// Statistical error as a function of the total time of all runs.
pub(super) struct StatisticalError {
    bars: PredictedBars,
    /// Square of the error bar of a mean over one unit of time.
    square: f64,
    /// Time of a whole run, where the mean is taken over whole runs (time).
    whole: Option<f64>,
}

impl Findings {
    /// Wall seconds of the rows of a run of some time.
    pub(super) fn row_seconds(&self, time: f64) -> f64 {
        self.row * self.mean.rows_in(time)
    }

    /// Statistical error as a function of time.
    pub(super) fn chance(&self) -> StatisticalError {
        StatisticalError::of(&self.mean, self.whole)
    }
}

impl StatisticalError {
    /// Statistical error of a mean; `whole` is the time of a whole run, where the mean is taken over whole runs (time).
    pub(super) fn of(mean: &MeanEstimate, whole: Option<f64>) -> StatisticalError {
        StatisticalError { bars: mean.bars(), square: mean.square, whole }
    }

    /// Total time of all runs after which the statistical error is at most `bar` (time).
    pub(super) fn time_for(&self, bar: f64) -> f64 {
        let alone = self.square / (bar * bar);
        // If one whole run is enough, its error is the scatter between starts: it has no error bar of its own.
        if self.whole.is_some_and(|time| alone <= time) { alone } else { self.bars.time_for(bar) }
    }

    /// Upper bound of the statistical error of runs of a total time (time), consistent with [`time_for`](Self::time_for).
    pub(super) fn over(&self, time: f64) -> f64 {
        match self.whole {
            Some(whole) if time <= whole => (self.square / time).sqrt(),
            _ => self.bars.over(time),
        }
    }
}

/// Distribution of the total time over runs.
pub(super) struct RunLength {
    /// Total time averaged over, of all runs (time).
    pub(super) time: f64,
    pub(super) seeds: u64,
    /// Wall seconds of all runs.
    pub(super) seconds: f64,
    pub(super) why: String,
}

/// Run length and number of seeds of a plan.
///
/// # Errors
/// Error of a single run, where more are needed and the scene has only one start.
pub(super) fn length_and_seeds(
    case: &StudyCase,
    best: &PlanCandidate<'_>,
    findings: &Findings,
) -> Result<RunLength, f64> {
    if let Some(time) = findings.whole {
        return length_of_whole_runs(case, best, findings, time);
    }
    Ok(length_of_stretches(case, best, findings))
}

/// As many whole runs as the error requires.
fn length_of_whole_runs(
    case: &StudyCase,
    best: &PlanCandidate<'_>,
    findings: &Findings,
    time: f64,
) -> Result<RunLength, f64> {
    let seeds = (best.optimum.time / time).ceil().max(1.0);
    let chance = (findings.mean.square / time).sqrt();
    if seeds > 1.0 && case.prepared.seed.is_none() {
        return Err(best.optimum.bias.with_statistical_error(chance));
    }
    let cost = best.configuration.cost.unwrap_or(0.0) / best.optimum.part;
    let threads = findings.threads as f64;
    let (together, one_thread) = if seeds > 1.0 { (threads, findings.one_thread) } else { (1.0, 1.0) };
    let rounds = (seeds / together).ceil();
    Ok(RunLength {
        time: seeds * time,
        seeds: seeds as u64,
        seconds: rounds * (findings.start + findings.row_seconds(time) + cost * one_thread * time),
        why: format!("means of whole runs from different starts scatter by ± {}", significant(chance, 2)),
    })
}

fn length_of_stretches(case: &StudyCase, best: &PlanCandidate<'_>, findings: &Findings) -> RunLength {
    let transient = findings.mean.transient;
    // Each run needs an error bar of its own. A constant quantity needs the scene's own run time, or some rows.
    let first = match case.prepared.schedule.rows {
        Every::Time(time) => SAMPLES * time,
        _ => 1.0,
    };
    let least = match findings.mean.square {
        0.0 => case.duration().unwrap_or(first),
        _ => SAMPLES * findings.mean.apart,
    };
    let time = best.optimum.time.max(transient).max(least);
    let cost = best.configuration.cost.unwrap_or(0.0) / best.optimum.part;
    let seconds = |time: f64, cost: f64| findings.start + findings.row_seconds(time) + cost * time;
    let together = seconds(time + transient, cost);
    let threads = findings.threads as f64;
    if let Some(difference) = findings.starts_differ {
        let why = format!(
            "the mean from another start differs by {}: a conserved quantity, such as the energy, does not average out, so the plan applies to this start",
            significant(difference, 2)
        );
        return RunLength { time, seeds: 1, seconds: together, why };
    }
    let apart = seconds(time / threads + transient, cost * findings.one_thread);
    if findings.threads > 1 && apart < 0.95 * together && time / threads > transient.max(least) {
        return RunLength {
            time,
            seeds: findings.threads as u64,
            seconds: apart,
            why: format!(
                "one run per core: one thread takes {} times as long as {} threads, and each run repeats the transient ({})",
                significant(findings.one_thread, 2),
                findings.threads,
                significant(transient, 2)
            ),
        };
    }
    let why = if findings.threads == 1 {
        "only one thread is available".to_owned()
    } else {
        format!("several runs would each repeat the transient ({})", significant(transient, 2))
    };
    RunLength { time, seeds: 1, seconds: together, why }
}
