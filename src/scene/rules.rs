//! What keys demand of each other: which are used, which are missing, which exclude each other, which must agree.

use super::document::{Entries, Entry};
use super::error::{Reason, SceneError};
use super::key_table::*;
use super::keys::{Fallback, Key, Selector, Use, Value};

/// Holds all rules against the values, drops what overrides have made meaningless, and notes every mistake.
pub(super) fn apply(entries: &mut Entries) {
    rivals(entries);
    unused(entries);
    missing(entries);
    agreement(entries);
}

/// Whether a key is used; nothing where the choice that decides it is not known.
fn is_used(entries: &Entries, used: Use) -> Option<bool> {
    match used {
        None => Some(true),
        Some((selector, choices)) => {
            selector.choice(entries).map(|choice| choices.contains(&choice.as_str()))
        }
    }
}

fn quoted(keys: &[&Key], between: &str) -> String {
    keys.iter().map(|key| format!("`{}`", key.path())).collect::<Vec<_>>().join(between)
}

fn rivals(entries: &mut Entries) {
    for rivals in &RIVALS {
        if is_used(entries, rivals.used) != Some(true) {
            continue;
        }
        // An override takes the place of all rivals that the file gives.
        if rivals.keys.iter().filter_map(|key| entries.given(key)).any(|entry| entry.overrides) {
            for key in rivals.keys {
                if entries.given(key).is_some_and(|entry| !entry.overrides) {
                    entries.values.remove(&key.id());
                }
                entries.faulty.remove(&key.id());
            }
        }
        let given: Vec<&Key> =
            rivals.keys.iter().copied().filter(|key| entries.given(key).is_some()).collect();
        if given.len() > 1 {
            let last = given.iter().max_by_key(|key| entries.spot(key).place).unwrap_or(&given[0]);
            let error = entries
                .spot(last)
                .error(Reason::Contradiction, format!("{} exclude each other", quoted(&given, " and ")))
                .expecting(format!("one of {}", quoted(rivals.keys, ", ")));
            entries.errors.push(error);
        }
        let faulty = rivals.keys.iter().any(|key| entries.is_faulty(key));
        if given.is_empty() && rivals.needed && !faulty {
            let error = entries
                .spot(rivals.keys[0])
                .error(Reason::Missing, format!("neither {} is given", quoted(rivals.keys, " nor ")))
                .expecting(rivals.keys.iter().map(|key| key.expected()).collect::<Vec<_>>().join("; or "));
            entries.errors.push(error);
        }
    }
}

fn unused(entries: &mut Entries) {
    for key in KEYS {
        let Some((selector, choices)) = key.used else { continue };
        let (Some(choice), Some(entry)) = (selector.choice(entries), entries.given(key)) else { continue };
        if choices.contains(&choice.as_str()) {
            continue;
        }
        // Another choice made on the command line leaves the file's keys for the old one behind.
        if !entry.overrides && selector.is_overridden(entries) {
            entries.values.remove(&key.id());
            continue;
        }
        let chosen = match (selector, choice.as_str()) {
            (Selector::Start, "file") => "a start file".to_owned(),
            (Selector::Start, choice) => format!("generate = \"{choice}\""),
            (Selector::Method, choice) => format!("kind = \"{choice}\""),
            (Selector::WallMotion, choice) => format!("wall_motion = \"{choice}\""),
            (Selector::Integrator, choice) => format!("kind = \"{choice}\""),
        };
        let error = entry
            .spot
            .error(Reason::Unused, format!("`{}` means nothing with {chosen}", key.path()))
            .advising(format!("leave it out; it is used with {}", choices.join(", ")));
        entries.errors.push(error);
    }
}

fn missing(entries: &mut Entries) {
    let hexagonal = Selector::Start.choice(entries).as_deref() == Some("hexagonal");
    for key in KEYS {
        let both = hexagonal && (key.id() == COUNT.id() || key.id() == PACKING_FRACTION.id());
        let required = key.fallback == Fallback::Required || both;
        let absent = entries.given(key).is_none() && !entries.is_faulty(key);
        if required && absent && is_used(entries, key.used) == Some(true) {
            let error = entries
                .spot(key)
                .error(Reason::Missing, format!("`{}` is missing", key.path()))
                .expecting(key.expected())
                .advising(key.doc);
            entries.errors.push(error);
        }
    }
}

/// The value of a key, given or by default, if it is a number.
fn number(entries: &Entries, key: &Key) -> Option<f64> {
    match (entries.given(key).map(|entry| &entry.value), key.fallback) {
        (Some(Value::Number(value)), _) => Some(*value),
        (None, Fallback::Is(text)) if !entries.is_faulty(key) => text.parse().ok(),
        _ => None,
    }
}

/// As many as `run.steps` may be.
const MOST_STEPS: f64 = 1e12;

/// What finds contacts in which way only.
fn search(entries: &Entries) -> Option<SceneError> {
    let word = |key: &Key| match entries.given(key).map(|entry| &entry.value) {
        Some(Value::Word(word)) => Some(word.as_str()),
        _ => None,
    };
    let fast = word(&EXECUTION) == Some("fast");
    if word(&METHOD) == Some("sectors") && !fast && !entries.is_faulty(&EXECUTION) {
        let key = if entries.given(&EXECUTION).is_some() { &EXECUTION } else { &METHOD };
        let message = "sectors have no vector programs: they are searched by the fast execution only";
        return Some(
            entries.spot(key).error(Reason::Contradiction, message).expecting("execution = \"fast\""),
        );
    }
    if word(&ON_CONFLICT) == Some("resolve") && !fast && !entries.is_faulty(&EXECUTION) {
        let message =
            "the source's programs know one disc a cell: only the fast execution resolves conflicts";
        let error = entries.spot(&ON_CONFLICT).error(Reason::Contradiction, message);
        return Some(error.expecting("execution = \"fast\""));
    }
    if fast && word(&REBUILD) == Some("all-pairs") {
        let message = "the fast execution makes its lists by cells";
        let error = entries.spot(&REBUILD).error(Reason::Contradiction, message);
        return Some(error.advising("leave it out, or choose execution = \"chained\""));
    }
    None
}

fn agreement(entries: &mut Entries) {
    let mut errors = Vec::new();
    let choice = Selector::Start.choice(entries);
    let choice = choice.as_deref().unwrap_or_default();

    let periodic = match entries.given(&PERIODIC).map(|entry| &entry.value) {
        Some(Value::Switches(periodic)) => Some(*periodic),
        None if !entries.is_faulty(&PERIODIC) => Some([true, true]),
        _ => None,
    };
    let needed = match choice {
        "hexagonal" => Some(([true, true], "a hexagonal lattice closes on both sides")),
        "pipe" => Some(([true, false], "a pipe is periodic along x and walled along y")),
        "box" => Some(([true, false], "a box is periodic along x and has a floor")),
        _ => None,
    };
    if let (Some(periodic), Some((needed, why))) = (periodic, needed)
        && periodic != needed
    {
        let found = Value::Switches(periodic).to_toml();
        let error = entries
            .spot(&PERIODIC)
            .error(Reason::Contradiction, format!("`domain.periodic` is {found}, but {why}"))
            .expecting(format!("periodic = {}", Value::Switches(needed).to_toml()));
        errors.push(error);
    }

    if let Some(Value::Pairs(positions)) = entries.given(&POSITIONS).map(|entry| &entry.value) {
        if positions.is_empty() {
            errors.push(entries.spot(&POSITIONS).error(Reason::Range, "`particles.positions` lists no disc"));
        }
        for key in [&VELOCITIES, &OMEGAS, &RADII] {
            let Some(Entry { value, spot, .. }) = entries.given(key) else { continue };
            let length = match value {
                Value::Pairs(list) => list.len(),
                Value::Numbers(list) => list.len(),
                _ => continue,
            };
            if length != positions.len() {
                let count = positions.len();
                let error = spot
                    .error(
                        Reason::Contradiction,
                        format!(
                            "`{}` lists {length} values, but `particles.positions` lists {count}",
                            key.path()
                        ),
                    )
                    .expecting(format!("{count} values, one for each grain"));
                errors.push(error);
            }
        }
    }

    if let (Some(time), Some(dt)) = (number(entries, &TIME), number(entries, &DT))
        && time / dt > MOST_STEPS
    {
        let message = format!("`run.time` = {time} takes {:.3e} steps of dt = {dt}", time / dt);
        let error = entries.spot(&TIME).error(Reason::Range, message);
        errors.push(error.expecting(format!("at most {MOST_STEPS:.0e} steps")));
    }

    let mut ordered = |low: &'static Key, high: &'static Key, why: &str| {
        if let (Some(a), Some(b)) = (number(entries, low), number(entries, high))
            && a > b
        {
            let later = if entries.given(low).is_some() { low } else { high };
            let message = format!("`{}` = {a} is above `{}` = {b}, but {why}", low.path(), high.path());
            errors.push(entries.spot(later).error(Reason::Contradiction, message));
        }
    };
    ordered(&MAX_PENETRATION, &STOP_PENETRATION, "a run warns before it stops");
    errors.extend(search(entries));
    entries.errors.extend(errors);
}
