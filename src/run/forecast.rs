//! What is to be expected of a run, before it begins: the step against its limits, its error, how long it takes.

use crate::method::{Fact, Prepared, Until, probed};
use indicatif::HumanDuration;
use serde_json::{Map, Value, json};
use std::time::Duration;

/// Steps of a probe at most.
const PROBED: u64 = 4096;

/// What is to be expected of the step of a scene, the same on every host.
pub fn of_the_step(prepared: &dyn Prepared) -> Vec<Fact> {
    let limits = prepared.step_limits();
    let mut facts = vec![];
    if !limits.is_empty() {
        facts.push(Fact::data("step_limits", json!(limits)));
    }
    let said = limits.into_iter().map(|limit| {
        let words = format!("dt is {:.3} of {:.4e}", limit.share, limit.step);
        Fact { data: None, words: Some((limit.name, words)) }
    });
    facts.extend(said);
    facts.extend(prepared.expected_error());
    facts
}

/// How long it takes on this host, by its first steps; none where it has no given number of steps, or does not come so far.
pub fn of_the_time(prepared: &dyn Prepared) -> Option<Fact> {
    let Until::Steps(steps) = prepared.schedule().until else { return None };
    let each = probed(prepared, steps.min(PROBED)).ok()?;
    let seconds = each * steps as f64;
    let about = match seconds {
        1.0.. => HumanDuration(Duration::from_secs_f64(seconds)).to_string(),
        _ => format!("{seconds:.2} seconds"),
    };
    let words = format!("about {about} for {steps} steps of {:.1} µs, by its first steps here", 1e6 * each);
    let data = json!({ "seconds": seconds, "seconds_per_step": each });
    Some(Fact::new("expected_time", data, "time of a run", words))
}

/// Facts as data, by name.
pub fn as_data(facts: Vec<Fact>) -> Map<String, Value> {
    facts.into_iter().filter_map(|fact| fact.data).map(|(name, value)| (name.to_owned(), value)).collect()
}
