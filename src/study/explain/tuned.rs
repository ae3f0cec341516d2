//! What `auto` of a scene becomes by what was measured on this host: of the scene itself, or of one that is alike.

use super::kept::{Kept, KeptError};
use crate::study::Case;
use stripmine_physics::method::Decides;
use stripmine_physics::scene::{Key, Overrides, Value};

/// What `auto` becomes.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Tuned {
    /// The overrides that say so.
    pub overrides: Overrides,
    /// Where it comes from.
    pub origin: String,
}

/// What is `auto` in a scene, by the cheapest way that was measured with the scene's own integrator and digits; none where nothing is kept of it or
/// of one that is alike, or nothing is open. Nothing that a scene states is changed.
///
/// # Errors
/// [`KeptError`] if what is kept cannot be read.
pub(crate) fn tuned(case: &Case, kept: &Kept) -> Result<Option<Tuned>, KeptError> {
    let Some((findings, origin)) = kept.alike(case)? else { return Ok(None) };
    let is_open = |key: &Key| case.values.choice(key).as_deref() == Some("auto");
    let holds =
        |key: &Key, value: &Value| case.values.choice(key).is_none_or(|now| Value::Word(now) == *value);
    // Those that were timed come with the cheapest first.
    for way in findings.ways.iter().filter(|way| way.cost.is_some()) {
        let choice = way.choice(case);
        let is_own = [Decides::Order, Decides::Digits].iter().all(|&it| choice.agrees(&case.own, it));
        let overrides = choice.overrides();
        if is_own && overrides.iter().all(|(key, value)| is_open(key) || holds(key, value)) {
            let open = overrides.iter().filter(|(key, _)| is_open(key));
            let overrides: Overrides = open.map(|(key, value)| (key, value.clone())).collect();
            return Ok((!overrides.is_empty()).then_some(Tuned { overrides, origin }));
        }
    }
    Ok(None)
}
