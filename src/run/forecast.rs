//! What is to be expected of a run, before it begins: the step against its limits, its error, how long it takes.

use crate::memory::in_words;
use crate::method::{Beyond, Clock, Every, Fact, Failure, Prepared, Purpose, Until};
use crate::number::significant;
use indicatif::HumanDuration;
use serde_json::{Map, Value, json};
use std::sync::atomic::AtomicBool;
use std::time::{Duration, Instant};

/// Steps of a probe at most.
const PROBED: u64 = 4096;
/// Steps are timed over about this long.
const LONG_ENOUGH: Duration = Duration::from_millis(20);

/// What is to be expected of the step of a scene, the same on every host.
pub fn of_the_step(prepared: &dyn Prepared) -> Vec<Fact> {
    let limits = prepared.step_limits();
    let mut facts = vec![];
    if !limits.is_empty() {
        facts.push(Fact::data("step_limits", json!(limits)));
    }
    let said = limits.into_iter().map(|limit| {
        let beyond = match limit.beyond {
            Beyond::Unstable => "errors grow beyond",
            Beyond::Inaccurate => "inaccurate beyond",
            Beyond::Unseen => "contacts pass unseen beyond",
        };
        let words = format!("dt is {:.3} of {}; {beyond}", limit.share, significant(limit.step, 5));
        Fact { data: None, words: Some((limit.name, words)) }
    });
    facts.extend(said);
    facts.extend(prepared.expected_error());
    facts
}

/// The memory that it takes, and what this host has left.
pub fn of_the_memory(prepared: &dyn Prepared) -> Fact {
    let memory = prepared.memory();
    let left = memory.available.map(|available| format!(" of {} left", in_words(available.bytes)));
    let words = in_words(memory.needed) + &left.unwrap_or_default();
    Fact::new("memory", json!(memory), "memory of a run", words)
}

/// How long it takes on this host, by its first steps and one row of observables; none where it has no given number of steps, or
/// does not come so far.
pub fn of_the_time(prepared: &dyn Prepared) -> Option<Fact> {
    let schedule = prepared.schedule();
    let Until::Steps(steps) = schedule.until else { return None };
    let [each, row] = timed(prepared, steps.min(PROBED)).ok()?;
    let rows = match schedule.rows {
        Every::Steps(every) => steps / every,
        Every::Never | Every::Time(_) => 0,
    };
    let seconds = each * steps as f64 + row * rows as f64;
    let about = match seconds {
        1.0.. => HumanDuration(Duration::from_secs_f64(seconds)).to_string(),
        _ => format!("{seconds:.2} seconds"),
    };
    let words = format!(
        "about {about}: {steps} steps of {:.1} µs and {rows} rows of {:.1} µs, as the first ones take here; snapshots are not counted",
        1e6 * each,
        1e6 * row
    );
    let data = json!({ "seconds": seconds, "seconds_per_step": each, "seconds_per_row": row });
    Some(Fact::new("expected_time", data, "time of a run", words))
}

/// Wall seconds of a step of a run, and of a row of observables.
fn timed(prepared: &dyn Prepared, most: u64) -> Result<[f64; 2], Failure> {
    let mut simulation = prepared.start(Purpose::Run)?;
    let (begun, mut steps) = (Instant::now(), 0);
    while steps < most && begun.elapsed() < LONG_ENOUGH {
        let moment = Until::Steps((2 * steps).clamp(1, most));
        simulation.advance(&[moment], &AtomicBool::new(false))?;
        let Clock { steps: done, .. } = simulation.clock();
        steps = done;
    }
    let each = begun.elapsed().as_secs_f64() / steps.max(1) as f64;
    let begun = Instant::now();
    let _values = simulation.observe();
    Ok([each, begun.elapsed().as_secs_f64()])
}

/// Facts as data, by name.
pub fn as_data(facts: Vec<Fact>) -> Map<String, Value> {
    facts.into_iter().filter_map(|fact| fact.data).map(|(name, value)| (name.to_owned(), value)).collect()
}
