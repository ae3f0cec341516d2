//! Which step of a way and which time reach an error most cheaply, and over how many runs that time is spread.

use super::bias::Off;
use super::findings::{Findings, Way};
use super::margin::Bars;
use super::optimum::{Optimum, SHORTEST, Terms, UNBIASED, optimum};
use crate::study::Case;
use crate::study::trial::Known;
use stripmine_physics::averages::LIKELY_ENOUGH;
use stripmine_physics::method::Every;
use stripmine_physics::number::significant;

/// Independent samples that a run has at least: enough that it is likely to know the error of its own mean.
pub(super) const SAMPLES: f64 = LIKELY_ENOUGH;

/// A way with what it takes for the error.
pub(super) struct Weighed<'w> {
    pub(super) way: &'w Way,
    pub(super) optimum: Optimum,
}

/// The cheapest step and time of a way; a way that was not compared has the bias of none, and is not weighed where others were.
pub(super) fn weigh(way: &Way, findings: &Findings, chance: &Chance, wanted: f64) -> Option<Optimum> {
    let terms = Terms {
        cost: way.cost?,
        rows: findings.row * findings.mean.rows(),
        transient: findings.mean.transient,
    };
    let time_for = |bar| chance.time_for(bar);
    match (way.step, way.bias) {
        (None, _) => optimum(terms, (wanted, 1.0), |_, _| Off::default(), time_for),
        (Some(step), Some(bias)) => {
            let shortest = if bias.is_significant() || bias.creep > 0.0 { SHORTEST } else { UNBIASED };
            optimum(terms, (wanted, shortest), |part, time| bias.over(part * step, time), time_for)
        }
        (Some(_), None) => None,
    }
}

/// What chance leaves of an error, by the time of all runs together.
pub(super) struct Chance {
    bars: Bars,
    /// Square of the bar of a mean over one unit of time.
    square: f64,
    /// Time of a whole run, where these are averaged over (time).
    whole: Option<f64>,
}

impl Findings {
    /// Wall seconds of the rows of a run of some time.
    pub(super) fn of_rows(&self, time: f64) -> f64 {
        self.row * self.mean.rows_in(time)
    }

    /// What chance leaves by the time.
    pub(super) fn chance(&self) -> Chance {
        Chance::of(&self.mean, self.whole)
    }
}

impl Chance {
    /// By a mean, and the time of a whole run where these are averaged over (time).
    pub(super) fn of(mean: &Known, whole: Option<f64>) -> Chance {
        Chance { bars: mean.bars(), square: mean.square, whole }
    }

    /// The time of all runs together that leaves no more than this to chance (time).
    pub(super) fn time_for(&self, bar: f64) -> f64 {
        let alone = self.square / (bar * bar);
        // A whole run that is enough has no bar of its own: its error is that which other starts show.
        if self.whole.is_some_and(|time| alone <= time) { alone } else { self.bars.time_for(bar) }
    }

    /// What chance leaves at most in runs of that time together (time): as [`time_for`](Self::time_for).
    pub(super) fn over(&self, time: f64) -> f64 {
        match self.whole {
            Some(whole) if time <= whole => (self.square / time).sqrt(),
            _ => self.bars.over(time),
        }
    }
}

/// How the time is spread over runs.
pub(super) struct Length {
    /// Time that is averaged over, of all runs (time).
    pub(super) time: f64,
    pub(super) seeds: u64,
    /// Wall seconds of all.
    pub(super) seconds: f64,
    pub(super) why: String,
}

/// # Errors
/// The bar of one run, where more of them are needed and there is one start only.
pub(super) fn length(case: &Case, best: &Weighed<'_>, findings: &Findings) -> Result<Length, f64> {
    if let Some(time) = findings.whole {
        return whole_runs(case, best, findings, time);
    }
    Ok(length_of_stretches(case, best, findings))
}

/// Whole runs, as many as the error asks for.
fn whole_runs(case: &Case, best: &Weighed<'_>, findings: &Findings, time: f64) -> Result<Length, f64> {
    let seeds = (best.optimum.time / time).ceil().max(1.0);
    let chance = (findings.mean.square / time).sqrt();
    if seeds > 1.0 && case.prepared.seed.is_none() {
        return Err(best.optimum.bias.with(chance));
    }
    let cost = best.way.cost.unwrap_or(0.0) / best.optimum.part;
    let threads = findings.threads as f64;
    let (together, one_thread) = if seeds > 1.0 { (threads, findings.one_thread) } else { (1.0, 1.0) };
    let rounds = (seeds / together).ceil();
    Ok(Length {
        time: seeds * time,
        seeds: seeds as u64,
        seconds: rounds * (findings.start + findings.of_rows(time) + cost * one_thread * time),
        why: format!(
            "whole runs from starts that differ have means ± {} of each other",
            significant(chance, 2)
        ),
    })
}

fn length_of_stretches(case: &Case, best: &Weighed<'_>, findings: &Findings) -> Length {
    let transient = findings.mean.transient;
    // So that each run has a mean of its own, with a bar; what does not vary is seen in a run of the scene's own time, or in some rows.
    let first = match case.prepared.schedule.rows {
        Every::Time(time) => SAMPLES * time,
        _ => 1.0,
    };
    let least = match findings.mean.square {
        0.0 => case.duration().unwrap_or(first),
        _ => SAMPLES * findings.mean.apart,
    };
    let time = best.optimum.time.max(transient).max(least);
    let cost = best.way.cost.unwrap_or(0.0) / best.optimum.part;
    let seconds = |time: f64, cost: f64| findings.start + findings.of_rows(time) + cost * time;
    let together = seconds(time + transient, cost);
    let threads = findings.threads as f64;
    if let Some(difference) = findings.starts_differ {
        let why = format!(
            "another start has a mean {} off: what a start keeps, such as its energy, does not average out in a run, and the plan is for this one",
            significant(difference, 2)
        );
        return Length { time, seeds: 1, seconds: together, why };
    }
    let apart = seconds(time / threads + transient, cost * findings.one_thread);
    if findings.threads > 1 && apart < 0.95 * together && time / threads > transient.max(least) {
        return Length {
            time,
            seeds: findings.threads as u64,
            seconds: apart,
            why: format!(
                "one on each core: one thread takes {} times what {} take, and the transient ({}) is made again by each",
                significant(findings.one_thread, 2),
                findings.threads,
                significant(transient, 2)
            ),
        };
    }
    let why = if findings.threads == 1 {
        "there is one thread".to_owned()
    } else {
        format!("the transient ({}) would be made again by each of several", significant(transient, 2))
    };
    Length { time, seeds: 1, seconds: together, why }
}
