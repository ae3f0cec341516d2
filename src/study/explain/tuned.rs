//! What `auto` of a scene becomes by what was measured on this host: of the scene itself, or of one that is alike.

use super::kept::{Kept, KeptError};
use crate::study::Case;
use stripmine_physics::method::Decides;

/// What `auto` becomes.
#[derive(Clone, Debug, PartialEq)]
pub struct Tuned {
    /// The overrides that say so.
    pub overrides: Vec<String>,
    /// Where it comes from.
    pub origin: String,
}

/// What is `auto` in a scene, by the cheapest way that was measured with the scene's own integrator and digits; none where nothing is kept of it or
/// of one that is alike, or nothing is open. Nothing that a scene states is changed.
///
/// # Errors
/// [`KeptError`] if what is kept cannot be read.
pub fn tuned(case: &Case, kept: &Kept) -> Result<Option<Tuned>, KeptError> {
    let Some((findings, origin)) = kept.alike(case)? else { return Ok(None) };
    let stated = |text: &str| {
        let (path, _) = text.split_once('=')?;
        let key = case.entry.vocabulary.keys.keys().find(|key| key.path() == path)?;
        case.values.choice(key)
    };
    let is_open = |text: &String| stated(text).as_deref() == Some("auto");
    let holds = |text: &String| {
        let now = stated(text);
        now.as_deref() == text.split_once('=').map(|(_, word)| word) || now.is_none()
    };
    // Those that were timed come with the cheapest first.
    for way in findings.ways.iter().filter(|way| way.cost.is_some()) {
        let settings: Vec<(&str, &str)> =
            way.settings.iter().map(|(axis, name)| (axis.as_str(), name.as_str())).collect();
        let choice = case.own.with(&settings);
        let is_own = [Decides::Order, Decides::Digits].iter().all(|&it| choice.agrees(&case.own, it));
        let overrides: Vec<String> = choice.overrides().collect();
        if is_own && overrides.iter().all(|text| is_open(text) || holds(text)) {
            let overrides: Vec<String> = overrides.into_iter().filter(is_open).collect();
            return Ok((!overrides.is_empty()).then_some(Tuned { overrides, origin }));
        }
    }
    Ok(None)
}
