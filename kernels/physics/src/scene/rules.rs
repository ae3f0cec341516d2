//! Rules between keys: unused, missing, exclusive and inconsistent ones.

use super::SceneError;
use super::disc_keys::{
    COUNT, FILE, GENERATE, MASS, MASSES, MESH, OMEGAS, PACKING_FRACTION, PLACED, POSITIONS, RADII, RADIUS,
    SPEED, TEMPERATURE, VELOCITIES,
};
use super::domain::{SIDES, check_periodicity};
use super::key_set::ExclusiveKeys;
use super::keys::{Fallback, Key, KeyValue, Use};
use super::values::SceneValues;
use crate::input::MistakeKind;

const ALWAYS: Use = None;

/// Keys of discs that exclude each other.
pub static DISC_RIVALS: &[ExclusiveKeys] = &[
    ExclusiveKeys { keys: &[&GENERATE, &FILE], used: ALWAYS, needed: true, with: None },
    ExclusiveKeys { keys: &[&COUNT, &PACKING_FRACTION], used: PLACED, needed: true, with: Some(&SIDES) },
    ExclusiveKeys { keys: &[&COUNT, &PACKING_FRACTION], used: MESH, needed: true, with: Some(&SIDES) },
    ExclusiveKeys { keys: &[&TEMPERATURE, &SPEED], used: ALWAYS, needed: false, with: None },
];

/// Keys of a generator that also supply what a start file lacks.
const OF_START: [&str; 7] = ["radius", "mass", "temperature", "speed", "virial", "exact_temperature", "seed"];

/// Applies all rules to the values, sets aside values that overrides make obsolete, and records every mistake.
pub(super) fn apply_rules(values: &mut SceneValues) {
    rivals(values);
    unused(values);
    missing(values);
    for rule in values.vocabulary.rules {
        let errors = rule(values);
        values.errors.extend(errors);
    }
}

fn quoted(keys: &[&Key], between: &str) -> String {
    keys.iter().map(|key| format!("`{}`", key.path())).collect::<Vec<_>>().join(between)
}

fn rivals(values: &mut SceneValues) {
    for rivals in values.vocabulary.keys.rivals.iter().copied().flatten() {
        if values.applies(rivals.used) != Some(true) {
            continue;
        }
        // An override replaces all rivals given in the file.
        let replaces = rivals.with.is_none_or(|key| values.is_given(key));
        if replaces && rivals.keys.iter().filter_map(|key| values.entry(key)).any(|entry| entry.overrides) {
            for key in rivals.keys {
                if values.entry(key).is_some_and(|entry| !entry.overrides) {
                    values.set_aside(key);
                }
                values.faulty.remove(&key.id());
            }
        }
        let is_free = rivals.with.is_some_and(|key| !values.is_given(key) && !values.is_faulty(key));
        let given: Vec<&Key> =
            rivals.keys.iter().copied().filter(|key| values.entry(key).is_some()).collect();
        if given.len() > 1 && !is_free {
            let last = given.iter().max_by_key(|key| values.spot(key).place).unwrap_or(&given[0]);
            let error = values
                .spot(last)
                .error(MistakeKind::Contradiction, format!("{} exclude each other", quoted(&given, " and ")))
                .expecting(format!("one of {}", quoted(rivals.keys, ", ")));
            values.errors.push(error);
        }
        let faulty = rivals.keys.iter().any(|key| values.is_faulty(key));
        if given.is_empty() && rivals.needed && !faulty {
            let error = values
                .spot(rivals.keys[0])
                .error(MistakeKind::Missing, format!("neither {} is given", quoted(rivals.keys, " nor ")))
                .expecting(rivals.keys.iter().map(|key| key.expected()).collect::<Vec<_>>().join("; or "));
            values.errors.push(error);
        }
    }
}

fn unused(values: &mut SceneValues) {
    for key in values.vocabulary.keys.keys() {
        let Some((by, choices)) = key.used else { continue };
        let (Some(choice), Some(entry)) = (values.choice(by), values.entry(key)) else { continue };
        if !entry.overrides && choice == "file" && is_replaced_by_file(values, key) {
            values.set_aside(key);
            continue;
        }
        if choices.contains(&choice.as_str()) {
            continue;
        }
        // A choice made on the command line makes the file's keys for the old choice obsolete.
        if !entry.overrides && values.is_chosen_by_override(by) {
            values.set_aside(key);
            continue;
        }
        let chosen = match values.implying(by).find(|other| values.is_given(other)) {
            Some(other) => format!("`{}`", other.path()),
            None => format!("{} = \"{choice}\"", by.path()),
        };
        let error = entry
            .spot
            .error(MistakeKind::Unused, format!("`{}` has no effect with {chosen}", key.path()))
            .advising(format!("leave it out; it is used with {}", choices.join(", ")));
        values.errors.push(error);
    }
}

/// True if a start file given as an override replaces a generator of the text, and this key of it: the file has such values of its own.
fn is_replaced_by_file(values: &SceneValues, key: &Key) -> bool {
    let (section, name) = key.id();
    section == GENERATE.section && OF_START.contains(&name) && values.set_aside.contains_key(&GENERATE.id())
}

fn missing(values: &mut SceneValues) {
    for key in values.vocabulary.keys.keys() {
        let absent = !values.is_given(key) && !values.is_faulty(key);
        if key.fallback == Fallback::Required && absent && values.is_used(key) {
            let error = values
                .spot(key)
                .error(MistakeKind::Missing, format!("`{}` is missing", key.path()))
                .expecting(key.expected())
                .advising(key.doc);
            values.errors.push(error);
        }
    }
}

/// Inconsistencies between the keys of a start.
pub fn start_inconsistencies(values: &SceneValues) -> Vec<SceneError> {
    let mut errors = Vec::new();
    let choice = values.choice(&GENERATE);
    match choice.as_deref() {
        Some("hexagonal") => {
            let why = "a hexagonal lattice is periodic along x and y";
            errors.extend(check_periodicity(values, [true, true], why));
            for key in [&COUNT, &PACKING_FRACTION] {
                if !values.is_given(key) && !values.is_faulty(key) {
                    let error =
                        values.spot(key).error(MistakeKind::Missing, format!("`{}` is missing", key.path()));
                    errors.push(error.expecting(key.expected()).advising(key.doc));
                }
            }
        }
        Some("pipe") => {
            let why = "a pipe is periodic along x and walled along y";
            errors.extend(check_periodicity(values, [true, false], why));
        }
        Some("box") => {
            errors.extend(check_periodicity(
                values,
                [true, false],
                "a box is periodic along x and has a floor",
            ));
        }
        _ => {}
    }
    errors.extend(missing_for_generators(values, choice.as_deref()));
    errors.extend(lengths_of_lists(values));
    errors
}

/// Reports what generated and listed discs need and start files may have themselves.
fn missing_for_generators(values: &SceneValues, choice: Option<&str>) -> Vec<SceneError> {
    let is_absent = |key: &&Key| !values.is_given(key) && !values.is_faulty(key);
    let Some(choice) = choice.filter(|choice| *choice != "file") else { return vec![] };
    let determines_box =
        choice != "list" && ![&COUNT, &PACKING_FRACTION].into_iter().any(|key| is_absent(&key));
    let needs_sides = choice != "hexagonal" && !determines_box;
    let needed: &[&Key] = if needs_sides { &[&SIDES, &RADIUS, &MASS] } else { &[&RADIUS, &MASS] };
    let errors = needed.iter().copied().filter(is_absent).map(|key| {
        let error = values.spot(key).error(MistakeKind::Missing, format!("`{}` is missing", key.path()));
        error.expecting(key.expected()).advising(key.doc)
    });
    errors.collect()
}

/// Reports lists that do not have one value for each grain.
fn lengths_of_lists(values: &SceneValues) -> Vec<SceneError> {
    let mut errors = Vec::new();
    let Some(KeyValue::Pairs(positions)) = values.given(&POSITIONS) else { return errors };
    if positions.is_empty() {
        errors.push(values.spot(&POSITIONS).error(MistakeKind::Range, "`particles.positions` lists no disc"));
    }
    for key in [&VELOCITIES, &OMEGAS, &RADII, &MASSES] {
        let length = match values.given(key) {
            Some(KeyValue::Pairs(list)) => list.len(),
            Some(KeyValue::Numbers(list)) => list.len(),
            _ => continue,
        };
        let count = positions.len();
        if length != count {
            let message =
                format!("`{}` lists {length} values, but `particles.positions` lists {count}", key.path());
            let error = values.spot(key).error(MistakeKind::Contradiction, message);
            errors.push(error.expecting(format!("{count} values, one for each grain")));
        }
    }
    errors
}
