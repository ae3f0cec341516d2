//! Validation of checkpoints before they are restored. A forged or foreign one is rejected with the name of the bad entry and never computed with.

use super::Clock;
use crate::io::checkpoint::{CheckpointColumn, CheckpointCounter};
use std::collections::BTreeMap;
use stripmine_kernels::isa::{Element, Storage};

/// Largest count: above it not every whole number is exact as a double. No count comes near it.
pub(super) const MOST: u64 = 1 << 53;

/// Returns the named column if it has precision `T`, this length and finite entries only.
///
/// # Errors
/// Says what is missing or wrong.
pub(crate) fn find_column<T: Element>(
    columns: &[(String, CheckpointColumn)],
    name: &str,
    length: usize,
) -> Result<Vec<T>, String> {
    let values: Vec<T> = match find(columns, name, length)? {
        CheckpointColumn::F64(values) if T::NAME == f64::NAME => {
            values.iter().map(|&x| T::from_f64(x)).collect()
        }
        CheckpointColumn::F32(values) if T::NAME == f32::NAME => {
            values.iter().map(|&x| T::from_f64(x.into())).collect()
        }
        _ => return Err(format!("the column {name} has another precision")),
    };
    match values.iter().position(|value| !value.to_f64().is_finite()) {
        None => Ok(values),
        Some(at) => Err(format!("entry {at} of the column {name} is not finite")),
    }
}

/// Returns the named column of counts if it has this length and no count above `most`.
///
/// # Errors
/// As [`find_column`].
pub(crate) fn find_counts<'c>(
    columns: &'c [(String, CheckpointColumn)],
    name: &str,
    length: usize,
    most: u64,
) -> Result<&'c [u64], String> {
    let CheckpointColumn::U64(values) = find(columns, name, length)? else {
        return Err(format!("the column {name} has another type"));
    };
    match values.iter().find(|&&value| value > most) {
        None => Ok(values),
        Some(value) => Err(format!("the column {name} holds {value}, more than {most}")),
    }
}

fn find<'c>(
    columns: &'c [(String, CheckpointColumn)],
    name: &str,
    length: usize,
) -> Result<&'c CheckpointColumn, String> {
    let (_, column) = columns
        .iter()
        .find(|(there, _)| there == name)
        .ok_or_else(|| format!("the column {name} is missing"))?;
    match column.len() {
        found if found == length => Ok(column),
        found => Err(format!("the column {name} has {found} entries, not {length}")),
    }
}

/// Returns the named sum if it is finite.
///
/// # Errors
/// Says what is missing or wrong.
pub(crate) fn find_sum(counters: &BTreeMap<String, CheckpointCounter>, name: &str) -> Result<f64, String> {
    match counters.get(name) {
        Some(CheckpointCounter::Sum(sum)) if sum.is_finite() => Ok(*sum),
        Some(CheckpointCounter::Sum(sum)) => Err(format!("the sum {name} is {sum}, not a finite number")),
        _ => Err(format!("the sum {name} is missing")),
    }
}

/// Returns the named count if it is at most `most`.
///
/// # Errors
/// As [`find_sum`].
pub(crate) fn find_count(
    counters: &BTreeMap<String, CheckpointCounter>,
    name: &str,
    most: u64,
) -> Result<u64, String> {
    match counters.get(name) {
        Some(CheckpointCounter::Count(count)) if *count <= most => Ok(*count),
        Some(CheckpointCounter::Count(count)) => {
            Err(format!("the count {name} is {count}, more than {most}"))
        }
        _ => Err(format!("the count {name} is missing")),
    }
}

impl Clock {
    /// Checks that this is the clock of a method with steps of `dt` (time).
    ///
    /// # Errors
    /// Says what is wrong.
    pub fn check_step_clock(&self, dt: f64) -> Result<(), String> {
        let Clock { steps, time, events } = *self;
        let expected = steps as f64 * dt;
        if steps > MOST || time != expected {
            return Err(format!("the time after {steps} steps of {dt:?} is {time:?}, not {expected:?}"));
        }
        if events > 0 {
            return Err(format!("it counts {events} events, but this method has none"));
        }
        Ok(())
    }

    /// Checks that this is the clock of an event-driven method.
    ///
    /// # Errors
    /// Says what is wrong.
    pub(crate) fn check_event_clock(&self) -> Result<(), String> {
        let Clock { steps, time, events } = *self;
        if steps > 0 {
            return Err(format!("it counts {steps} steps, but this method has none"));
        }
        if events > MOST || !(time.is_finite() && time >= 0.0) {
            return Err(format!("it counts {events} events up to time {time:?}, which no run reaches"));
        }
        Ok(())
    }
}
