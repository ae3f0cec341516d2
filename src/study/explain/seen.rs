//! The trials of a scene one after the other, and the plan that follows.

use super::findings::{FIRST, Findings, Work};
use super::keeping::keeping;
use super::plan::{dear_for_what_is_unknown, plan};
use super::recommended::Plan;
use super::reference::refined;
use super::unreached::Unreached;
use super::{ExplainError, Target};
use crate::study::Case;
use std::sync::atomic::AtomicBool;
use std::time::{Duration, Instant};

/// Measures a scene.
///
/// # Errors
/// [`ExplainError`] if every trial breaks, or the quantity comes to no mean.
fn findings(work: &mut Work<'_>) -> Result<Findings, ExplainError> {
    let mut ways = work.timed_ways()?;
    if work.target.is_kept() {
        return work.drifts(ways);
    }
    let mut reference = work.reference(&ways)?;
    work.compare(&mut ways, &mut reference);
    let best = &ways[0];
    let one_thread = work.one_thread(best);
    let starts_differ = work.starts_differ(best, &mut reference);
    // What finds the end of a transient errs by a part of the run that it looks at, mostly to the later side.
    reference.known.transient = reference.transients.iter().copied().fold(f64::INFINITY, f64::min);
    let without = work.without(best, &reference.known);
    Ok(Findings {
        reference: reference.known,
        reference_way: reference.way,
        reference_step: reference.step,
        whole: work.whole,
        starts_differ,
        start: reference.start,
        row: reference.row,
        one_thread,
        threads: rayon::current_num_threads(),
        without,
        ways,
    })
}

/// What is measured in some seconds; the second half of them is for plans that would be dear only for what the first does not tell.
///
/// # Errors
/// [`ExplainError`] if every trial breaks, or the quantity comes to no mean.
pub fn seen(case: &Case, target: &Target, seconds: f64, stop: &AtomicBool) -> Result<Findings, ExplainError> {
    let end = Instant::now() + Duration::from_secs_f64(seconds);
    let first = if target.is_kept() { seconds } else { FIRST * seconds };
    let mut work = Work { case, target, seconds: first, end, stop, whole: None };
    let mut found = findings(&mut work)?;
    let plan = made(case, target, &found, "").ok();
    if let Some((way, costs)) = plan.and_then(|plan| dear_for_what_is_unknown(&plan, &found)) {
        refined(&work, &mut found, &way, costs);
    }
    Ok(found)
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
