//! Runs of a scene from independent starts: side by side, with one thread each.

use super::super::PlanTarget;
use super::super::recommended::RunPlan;
use super::super::whole_runs::displaced_start;
use crate::study::trial::{SampleSpan, TrialControl, TrialSample};
use crate::study::{StudyCase, first_line};
use rayon::{ThreadPoolBuildError, ThreadPoolBuilder};
use std::panic::resume_unwind;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::thread;
use stripmine_physics::averages::AverageOutcome;
use stripmine_physics::method::Prepared;
use stripmine_physics::scene::{Overrides, SEED};

/// Factor on the limit of a plan after which a run is stopped.
const LATE: f64 = 5.0;
/// Window of a whole run, from one time to another (time).
pub(crate) const WHOLE: [f64; 2] = [0.0, f64::INFINITY];
/// Number of seeds, from the scene's own on, that trials may have used.
const OF_TRIALS: u64 = 1000;

/// Mean that a plan estimates: its runs, and the part of each run that is averaged.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct EstimatedMean {
    /// Time of a whole run, where the mean is taken over whole runs (time).
    pub whole: Option<f64>,
    /// Set where the mean depends on the scene's own start: another seed has another mean.
    pub(crate) is_of_own_start: bool,
}

impl From<&RunPlan> for EstimatedMean {
    fn from(plan: &RunPlan) -> EstimatedMean {
        EstimatedMean {
            whole: plan.is_whole.then_some(plan.time),
            is_of_own_start: plan.starts_differ.is_some(),
        }
    }
}

/// Runs of a scene from any number of starts.
pub(crate) struct StartEnsemble<'e> {
    pub case: &'e StudyCase,
    pub target: &'e PlanTarget,
    pub(crate) trial: TrialControl<'e>,
    pub(crate) asking: EstimatedMean,
}

impl StartEnsemble<'_> {
    /// Prepares the scene from a numbered start: another seed, or, without seeds, slightly displaced particles.
    pub(super) fn start(&self, overrides: &Overrides, number: usize) -> Result<Prepared, String> {
        let prepared = |overrides: &Overrides| {
            self.case.prepared_with(overrides).map_err(|errors| first_line(&errors.to_string()))
        };
        match self.case.prepared.seed.filter(|_| !self.asking.is_of_own_start) {
            Some(own) => {
                let seed = own.wrapping_add(OF_TRIALS).wrapping_add(number as u64);
                prepared(&overrides.clone().set(&SEED, seed))
            }
            None => {
                let own = prepared(overrides)?;
                Ok(own.model.started_from(displaced_start(&own, number as u64 + 1)))
            }
        }
    }

    /// Runs to the end of a span and returns the sample.
    pub(crate) fn sample(&self, prepared: &Prepared, span: SampleSpan) -> Result<TrialSample, String> {
        let observed = (self.case.quantities(), self.target.place);
        let sample = self.trial.sample(prepared, observed, span);
        let sample = sample.map_err(|failure| first_line(&failure.what_and_when()))?;
        match span {
            SampleSpan::Time(time, _) | SampleSpan::Planned(time, _) => {
                sample.early_end(time).map_or(Ok(sample), Err)
            }
            SampleSpan::Seconds(_) => Ok(sample),
        }
    }

    /// Result of a run: its mean, or the deviation of a conserved quantity.
    pub(super) fn value(&self, sample: &TrialSample) -> Result<f64, String> {
        match sample.outcome {
            AverageOutcome::Kept { .. } => {
                sample.deviations().map(|[_, largest]| largest).ok_or_else(|| sample.missing_mean_reason())
            }
            _ if self.asking.whole.is_some() => Ok(sample.mean_over(WHOLE)),
            _ => sample.known().map(|known| known.mean).ok_or_else(|| sample.missing_mean_reason()),
        }
    }

    /// Carries out a plan from starts that no other number uses, and returns the mean of all seeds and the wall seconds. The seeds run side by side
    /// if the plan is alone, otherwise one after the other.
    fn carried_out(&self, plan: &RunPlan, number: usize, is_alone: bool) -> Result<[f64; 2], String> {
        let seeds = plan.seeds as usize;
        let starts = (0..seeds).map(|seed| self.start(&plan.overrides, number * seeds + seed));
        let starts: Vec<Prepared> = starts.collect::<Result<_, _>>()?;
        let most = LATE * self.target.limit;
        // Every sample of a conserved quantity counts.
        let span = if self.target.is_kept() { SampleSpan::Time } else { SampleSpan::Planned };
        let one = |at: usize| self.value(&self.sample(&starts[at], span(plan.time, Some(most)))?);
        let begun = self.trial.watch.now();
        let values: Vec<Result<f64, String>> = match is_alone && seeds > 1 {
            true => side_by_side(seeds, one).map_err(|error| error.to_string())?,
            false => (0..seeds).map(one).collect(),
        };
        let seconds = self.trial.watch.now() - begun;
        let values: Vec<f64> = values.into_iter().collect::<Result<_, _>>()?;
        Ok([values.iter().sum::<f64>() / seeds as f64, seconds])
    }

    /// Makes estimates with a plan, each from its own starts. Returns the values, and the wall seconds of the first, which runs alone with all
    /// threads.
    ///
    /// # Errors
    /// [`ThreadPoolBuildError`] if threads cannot be started.
    pub(crate) fn estimates(
        &self,
        plan: &RunPlan,
        count: usize,
    ) -> Result<(Vec<Result<f64, String>>, f64), ThreadPoolBuildError> {
        let first = self.carried_out(plan, 0, true);
        let seconds = first.as_ref().map_or(f64::NAN, |[_, seconds]| *seconds);
        let others = side_by_side(count - 1, |at| self.carried_out(plan, at + 1, false));
        let all = std::iter::once(first).chain(others?);
        Ok((all.map(|it| it.map(|[value, _]| value)).collect(), seconds))
    }
}

/// Computes a result for each number, on all cores with one thread each, and returns them in order.
pub(crate) fn side_by_side<T: Send>(
    count: usize,
    work: impl Fn(usize) -> T + Sync,
) -> Result<Vec<T>, ThreadPoolBuildError> {
    let next = AtomicUsize::new(0);
    let worker = || {
        let pool = ThreadPoolBuilder::new().num_threads(1).build()?;
        let numbers = std::iter::repeat_with(|| next.fetch_add(1, Ordering::Relaxed));
        let numbers = numbers.take_while(|number| *number < count);
        Ok(numbers.map(|number| (number, pool.install(|| work(number)))).collect::<Vec<_>>())
    };
    let done: Vec<Result<Vec<(usize, T)>, ThreadPoolBuildError>> = thread::scope(|scope| {
        let workers: Vec<_> =
            (0..rayon::current_num_threads().min(count)).map(|_| scope.spawn(worker)).collect();
        workers.into_iter().map(|worker| worker.join().unwrap_or_else(|why| resume_unwind(why))).collect()
    });
    let mut all: Vec<(usize, T)> =
        done.into_iter().collect::<Result<Vec<_>, _>>()?.into_iter().flatten().collect();
    all.sort_by_key(|(number, _)| *number);
    Ok(all.into_iter().map(|(_, result)| result).collect())
}
