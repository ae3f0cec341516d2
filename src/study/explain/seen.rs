//! The trials of a scene one after the other, and the plan that follows.

use super::findings::{Findings, Work};
use super::keeping::keeping;
use super::plan::{dear_for_what_is_unknown, plan};
use super::recommended::Plan;
use super::reference::refined;
use super::{ExplainError, Target};
use crate::study::Case;
use std::sync::atomic::AtomicBool;

/// Measures a scene in about some seconds.
///
/// # Errors
/// [`ExplainError`] if every trial breaks, or the quantity comes to no mean.
fn findings(case: &Case, target: &Target, seconds: f64, stop: &AtomicBool) -> Result<Findings, ExplainError> {
    let mut work = Work { case, target, seconds, stop, whole: None };
    let mut ways = work.timed_ways()?;
    if target.is_kept() {
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

/// What is measured in about some seconds, and once more as long where a plan would be dear only for what that does not tell.
/// # Errors
/// [`ExplainError`] if every trial breaks, or the quantity comes to no mean.
pub fn seen(case: &Case, target: &Target, seconds: f64, stop: &AtomicBool) -> Result<Findings, ExplainError> {
    let mut found = findings(case, target, seconds, stop)?;
    let plan = planned(case, target, &found, "").ok();
    if let Some((way, costs)) = plan.and_then(|plan| dear_for_what_is_unknown(&plan, &found)) {
        let work = Work { case, target, seconds, stop, whole: found.whole };
        refined(&work, &mut found, &way, costs);
    }
    Ok(found)
}

/// A plan from what was measured.
///
/// # Errors
/// The least error that can be had, where no way comes to what is asked for.
pub fn planned(case: &Case, target: &Target, findings: &Findings, origin: &str) -> Result<Plan, f64> {
    let make = if target.is_kept() { keeping } else { plan };
    make(case, target, findings, origin)
}
