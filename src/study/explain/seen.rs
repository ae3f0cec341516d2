//! The trials of a scene one after the other, and the plan that follows.

use super::findings::{Findings, Work};
use super::keeping::keeping;
use super::plan::plan;
use super::recommended::Plan;
use super::unreached::Unreached;
use super::{ExplainError, Target};
use crate::study::Case;
use crate::study::trial::Trial;

/// Measures a scene.
///
/// # Errors
/// [`ExplainError`] if every trial breaks, or the quantity comes to no mean.
fn findings(work: &mut Work<'_>, progress: &dyn Fn(f64)) -> Result<Findings, ExplainError> {
    let begun = work.trial.watch.now();
    let tell = |work: &Work<'_>| progress(((work.trial.watch.now() - begun) / work.seconds).min(1.0));
    let mut ways = work.timed_ways()?;
    tell(work);
    if work.target.is_kept() {
        return work.drifts(ways);
    }
    let mut mean = work.mean(&mut ways)?;
    tell(work);
    work.biases(&mut ways, &mean);
    tell(work);
    let best = &ways[0];
    let one_thread = work.one_thread(best);
    let starts_differ = work.starts_differ(best, &mut mean);
    // The end of a transient is found a part of the run too late, mostly.
    mean.known.transient = mean.transients.iter().copied().fold(f64::INFINITY, f64::min);
    let without = work.without(best, &mean);
    Ok(Findings {
        mean: mean.known,
        mean_way: mean.way,
        whole: work.whole,
        starts_differ,
        start: mean.start,
        row: mean.row,
        one_thread,
        threads: rayon::current_num_threads(),
        without,
        ways,
    })
}

/// Measurements of a scene in trials of some seconds.
///
/// # Errors
/// [`ExplainError`] if every trial breaks, or the quantity has no mean.
pub fn seen(
    case: &Case,
    target: &Target,
    seconds: f64,
    trial: Trial<'_>,
    progress: &dyn Fn(f64),
) -> Result<Findings, ExplainError> {
    let end = trial.watch.now() + seconds;
    findings(&mut Work { case, target, seconds, end, trial, whole: None }, progress)
}

/// A plan from what was measured: the scene as it stands, where that is as good and no plan is quicker.
///
/// # Errors
/// [`Unreached`], where no way comes to what is asked for.
pub fn planned(case: &Case, target: &Target, findings: &Findings, origin: &str) -> Result<Plan, Unreached> {
    Ok(made(case, target, findings, origin)?.or_as_it_stands(case, findings))
}

fn made(case: &Case, target: &Target, findings: &Findings, origin: &str) -> Result<Plan, Unreached> {
    let make = if target.is_kept() { keeping } else { plan };
    make(case, target, findings, origin)
}
