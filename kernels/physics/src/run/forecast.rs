//! Forecast of a run before it starts: the step and its limits, the error, the time it takes.

use super::structured::sampling_strides;
use crate::memory::in_words;
use crate::method::{
    Clock, Fact, LimitConsequence, PhysicsFailure, Prepared, START_TEMPERATURE, StartPurpose, StepLimit,
    Until,
};
use crate::number::{count_with_noun, of_limit, significant};
use crate::scene::{DT, Warning};
use crate::units::with_symbol;
use serde_json::{Map, Value, json};
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;
use std::time::{Duration, Instant};

/// Number of timed intervals at the start of a run, after the first.
const STRETCHES: usize = 9;
/// Shortest interval that is timed.
const LONG_ENOUGH: Duration = Duration::from_millis(3);
/// Longest time spent on the forecast; no interval starts or is waited for after it.
const PATIENCE: Duration = Duration::from_millis(400);
/// First interval of a run for a time, as a fraction of the run.
const FIRST_STRETCH: f64 = 1e-9;
/// Factor by which a run may be faster or slower than its start: density changes, and other programs start and end.
const MARGIN: f64 = 1.5;

/// Forecast of a scene's step, the same on every host.
pub fn step_forecast(prepared: &Prepared) -> Vec<Fact> {
    let limits = &prepared.step_limits;
    let mut facts = vec![];
    if !limits.is_empty() {
        facts.push(Fact::data("step_limits", json!(limits)));
    }
    let said = limits.iter().map(|limit| {
        let words = format!(
            "dt is {} the {} {}; {}{}",
            of_limit(limit.share),
            if limit.is_advice() { "advised" } else { "limit" },
            with_symbol(&significant(limit.step, 5), &prepared.units, "time"),
            effect_beyond_limit(limit),
            borne(limit)
        );
        Fact { data: None, words: Some((limit.name, words)) }
    });
    facts.extend(said);
    facts.extend(prepared.expected_error.clone());
    facts
}

/// Multiple of a limit that most runs bear, for a step between both; empty elsewhere.
fn borne(limit: &StepLimit) -> String {
    match limit.share > 1.0 && !limit.is_advice() && !limit.is_passed() {
        true => format!(", but most runs bear {} times", significant(limit.warned_beyond, 3)),
        false => String::new(),
    }
}

fn effect_beyond_limit(limit: &StepLimit) -> &'static str {
    match limit.beyond {
        LimitConsequence::Unstable => "errors grow beyond",
        LimitConsequence::Inaccurate => "inaccurate beyond",
        LimitConsequence::Unseen => "contacts are missed beyond",
    }
}

/// Warning of a step above the lowest limit that is not advice, unless the scene's check has already warned of its step.
pub fn above_limits(prepared: &Prepared) -> Option<Warning> {
    let key = DT.path();
    if prepared.warnings.iter().any(|warning| warning.key == key) {
        return None;
    }
    let above = prepared.step_limits.iter().filter(|limit| limit.share > 1.0 && !limit.is_advice());
    let limit = above.max_by(|a, b| a.share.total_cmp(&b.share))?;
    let in_units = |step: f64, digits| with_symbol(&significant(step, digits), &prepared.units, "time");
    let message = format!(
        "dt = {} is {} the limit {} ({}); {}{}",
        in_units(limit.share * limit.step, 5),
        of_limit(limit.share),
        in_units(limit.step, 5),
        limit.name,
        effect_beyond_limit(limit),
        borne(limit)
    );
    let suggestion = format!("use dt <= {}", significant(limit.step, 3));
    Some(Warning { check: limit.name, share: limit.share, is_refusal: false, key, message, suggestion })
}

/// Fact about the start of a run.
pub fn start_forecast(prepared: &Prepared) -> Option<Fact> {
    let is_it = |fact: &&Fact| fact.data.as_ref().is_some_and(|(name, _)| *name == START_TEMPERATURE);
    prepared.facts.iter().find(is_it).cloned()
}

/// Memory needed by the run, and memory available on this host.
pub fn memory_forecast(prepared: &Prepared) -> Fact {
    let memory = &prepared.memory;
    let left = memory.available.map(|available| format!(" of {} left", in_words(available.bytes)));
    let words = in_words(memory.needed) + &left.unwrap_or_default();
    Fact::new("memory", json!(memory), "memory of a run", words)
}

/// Number of rows and frames, if known in advance, and the strides of structure samples.
pub fn output_forecast(prepared: &Prepared) -> Vec<Fact> {
    let schedule = prepared.schedule;
    let counts = [
        ("thermo_rows", "rows of thermo.csv", schedule.row_count()),
        ("frames", "frames of a trajectory", schedule.snapshot_count()),
    ];
    let known = counts.into_iter().filter_map(|(name, label, count)| Some((name, label, count?)));
    let mut facts: Vec<Fact> =
        known.map(|(name, label, count)| Fact::new(name, count, label, count.to_string())).collect();
    if !prepared.output.structure.is_empty() {
        let [rows, snapshots] = sampling_strides(prepared);
        let words = format!("at every {} and every {}", nth(rows, "row"), nth(snapshots, "snapshot"));
        facts.push(Fact::new("structure_every", json!([rows, snapshots]), "samples of the structure", words));
    }
    facts
}

fn nth(number: u64, what: &str) -> String {
    let ending = match (number % 10, number % 100) {
        _ if number == 1 => return what.to_owned(),
        (_, 11..=13) => "th",
        (1, _) => "st",
        (2, _) => "nd",
        (3, _) => "rd",
        _ => "th",
    };
    format!("{number}{ending} {what}")
}

/// Range of the run's duration on this host, from its first intervals after warm-up and one row of observables; none if the start does not get that
/// far.
pub fn time_forecast(prepared: &Prepared) -> Option<Fact> {
    let schedule = prepared.schedule;
    let StartTimings { each, row } = probed(prepared).ok()??;
    let length = length(schedule.until);
    let rows = schedule.row_count().unwrap_or(0) as f64;
    let seconds = each.map(|each| each * length + row * rows);
    let (unit, name) = match schedule.until {
        Until::Steps(_) => ("steps", "seconds_per_step"),
        Until::Events(_) => ("events", "seconds_per_event"),
        Until::Time(_) => ("units of time", "seconds_per_time"),
    };
    let [low, typical, high] = seconds;
    let words = format!(
        "{} to {}: {} {unit} of about {} µs, as measured on the first ones here after warm-up, plus output",
        rounded_duration(low),
        rounded_duration(high),
        significant(length, 6),
        significant(1e6 * each[1], 2),
    );
    let data = json!({ "seconds": typical, "at_least": low, "at_most": high, name: each[1], "seconds_per_row": row });
    Some(Fact::new("expected_time", data, "time of a run", words))
}

fn rounded_duration(seconds: f64) -> String {
    if seconds < 1.0 {
        return format!("{} seconds", significant(seconds, 2));
    }
    let units = [
        ("day", "days", 86_400.0),
        ("hour", "hours", 3600.0),
        ("minute", "minutes", 60.0),
        ("second", "seconds", 1.0),
    ];
    // A unit with a count below one and a half is too coarse.
    let (one, many, unit) = units.into_iter().find(|unit| seconds >= 1.5 * unit.2).unwrap_or(units[3]);
    count_with_noun((seconds / unit).round(), one, many)
}

/// Length of a run, in the unit of its end.
fn length(until: Until) -> f64 {
    match until {
        Until::Steps(steps) => steps as f64,
        Until::Events(events) => events as f64,
        Until::Time(time) => time,
    }
}

/// Progress of a run, in the same unit.
fn progress_in_unit_of_end(until: Until, clock: &Clock) -> f64 {
    match until {
        Until::Steps(_) => clock.steps as f64,
        Until::Events(_) => clock.events as f64,
        Until::Time(_) => clock.time,
    }
}

/// Timings of the start of a run.
struct StartTimings {
    /// Wall time for each unit of the run's end (s): smallest, median and largest to be expected.
    each: [f64; 3],
    /// Wall time for a row of observables (s).
    row: f64,
}

/// Times the start of a scene's run. Intervals too short to be timed are doubled. The first timed one is affected by cold memory and starting
/// threads, and is dropped if others follow. None if the run has nothing to do.
fn probed(prepared: &Prepared) -> Result<Option<StartTimings>, PhysicsFailure> {
    let until = prepared.schedule.until;
    let mut simulation = prepared.start(StartPurpose::Run)?;
    let mut stretch = match until {
        Until::Steps(_) => Until::Steps(1),
        Until::Events(_) => Until::Events(1),
        Until::Time(time) => Until::Time(time * FIRST_STRETCH),
    };
    let (begun, mut each) = (Instant::now(), vec![]);
    let is_late = AtomicBool::new(false);
    thread::scope(|scope| -> Result<(), PhysicsFailure> {
        let wait = || {
            thread::park_timeout(PATIENCE);
            is_late.store(true, Ordering::Relaxed);
        };
        // Without a timer thread, the forecast ends after the first interval.
        let timer = thread::Builder::new().spawn_scoped(scope, wait);
        is_late.store(timer.is_err(), Ordering::Relaxed);
        let mut probe = || {
            while !until.has_been_reached(&simulation.clock()) && each.len() <= STRETCHES {
                let (from, start) = (simulation.clock(), Instant::now());
                simulation.advance(&[until, stretch.after(&from)], &is_late)?;
                let seconds = start.elapsed();
                let gone = progress_in_unit_of_end(until, &simulation.clock())
                    - progress_in_unit_of_end(until, &from);
                match seconds < LONG_ENOUGH {
                    true => stretch = stretch.doubled(),
                    false => each.push(seconds.as_secs_f64() / gone),
                }
                if is_late.load(Ordering::Relaxed) {
                    break;
                }
            }
            Ok(())
        };
        let done = probe();
        timer.iter().for_each(|timer| timer.thread().unpark());
        done
    })?;
    let all = progress_in_unit_of_end(until, &simulation.clock());
    if each.len() > 1 {
        each.remove(0);
    }
    if all > 0.0 && each.is_empty() {
        each.push(begun.elapsed().as_secs_f64() / all);
    }
    // An interval interrupted before anything happened has no rate.
    each.retain(|seconds| seconds.is_finite());
    each.sort_by(f64::total_cmp);
    let mut rows: Vec<f64> = (0..3).map(|_| timed(|| simulation.observe())).collect();
    rows.sort_by(f64::total_cmp);
    let [Some(first), Some(last)] = [each.first(), each.last()] else { return Ok(None) };
    Ok(Some(StartTimings { each: [first / MARGIN, each[each.len() / 2], last * MARGIN], row: rows[1] }))
}

fn timed<R>(work: impl FnOnce() -> R) -> f64 {
    let begun = Instant::now();
    let _done = work();
    begun.elapsed().as_secs_f64()
}

/// Facts as data, by name.
pub fn as_data(facts: Vec<Fact>) -> Map<String, Value> {
    facts.into_iter().filter_map(|fact| fact.data).map(|(name, value)| (name.to_owned(), value)).collect()
}
