//! Conclusions of a diagram: the cheapest run for an error.

use super::dataset::{DiagramRun, WorkPrecision};
use super::measures::Measure;
use crate::study::TIE;

/// Target errors of positions (the method's length).
pub(crate) const WISHES: [f64; 5] = [3e-2, 1e-2, 1e-3, 1e-4, 1e-6];

/// The cheapest run for an error.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Cheapest<'d> {
    pub run: &'d DiagramRun,
    /// Cost relative to the scene's own configuration at its own step; none where that one fails.
    pub(crate) of_own: Option<f64>,
}

/// Returns the cheapest run with an error of positions of at most `error`. Among ties it is the scene's own configuration, or the first in the order
/// of the settings.
fn cheapest(data: &WorkPrecision, error: f64, is_meant: fn(&DiagramRun) -> bool) -> Option<Cheapest<'_>> {
    let serves =
        |run: &&DiagramRun| is_meant(run) && run.error(Measure::Position).is_some_and(|it| it <= error);
    let timed: Vec<(&DiagramRun, f64)> =
        data.runs.iter().filter(serves).filter_map(|run| Some((run, run.cost()?))).collect();
    let least = timed.iter().map(|(_, cost)| *cost).reduce(f64::min)?;
    let tied = timed.into_iter().filter(|(_, cost)| *cost <= TIE * least);
    let place = |run: &DiagramRun| (data.of(run).label != data.own, run.configuration);
    let (run, cost) = tied.min_by(|a, b| place(a.0).cmp(&place(b.0)).then(a.1.total_cmp(&b.1)))?;
    let own = own_run(data).and_then(DiagramRun::cost);
    Some(Cheapest { run, of_own: own.map(|own| cost / own) })
}

/// For each target error that is above the reference's own and reached by a run, returns the cheapest run without a warning, or the reason why no run
/// is recommended.
pub(crate) fn cheapest_runs(data: &WorkPrecision) -> Vec<(f64, Result<Cheapest<'_>, String>)> {
    let floor = data.reference.floor.get(&Measure::Position).copied().unwrap_or(0.0);
    let answer = |wish: f64| {
        let first = cheapest(data, wish, |_| true)?.run;
        if let Some(why) = &data.undecided {
            return Some((wish, Err(format!("not decided: {why}"))));
        }
        let denied = || {
            let (label, step) = (&data.of(first).label, multiple(first.power));
            format!("every run has a warning; {label} at {step}: {}", first.objections())
        };
        Some((wish, cheapest(data, wish, DiagramRun::is_sound).ok_or_else(denied)))
    };
    WISHES.into_iter().filter(|wish| *wish > floor).filter_map(answer).collect()
}

/// The scene's own configuration at its own step.
pub(crate) fn own_run(data: &WorkPrecision) -> Option<&DiagramRun> {
    data.runs.iter().find(|run| run.power == 0 && data.of(run).label == data.own)
}

/// Describes a step as a multiple of the scene's own.
fn multiple(power: i32) -> String {
    match power {
        0 => "its own step".to_owned(),
        1.. => format!("{} times its own step", 1_u64 << power),
        _ => format!("1/{} of its own step", 1_u64 << -power),
    }
}

/// Returns the cheapest run without a warning that is as accurate as the scene's own configuration; none where nothing is decided, or that one failed
/// or was not timed.
pub(crate) fn cheapest_equivalent(data: &WorkPrecision) -> Option<Cheapest<'_>> {
    let error = own_run(data).filter(|_| data.undecided.is_none())?.error(Measure::Position)?;
    cheapest(data, error, DiagramRun::is_sound).filter(|found| found.of_own.is_some())
}
