//! Values for `auto` settings of a scene, from cached measurements of it or of a similar scene on this host.

use super::cache::{PlanCache, PlanCacheError};
use crate::study::StudyCase;
use stripmine_physics::method::ChoiceEffect;
use stripmine_physics::scene::{Key, KeyValue, Overrides};

/// Values for the `auto` settings of a scene.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct TunedSettings {
    /// Overrides with these values.
    pub overrides: Overrides,
    /// Origin of the measurements.
    pub origin: String,
}

/// Returns values for the `auto` settings of a scene, from the cheapest cached configuration with the scene's own integrator and precision. None
/// where nothing is cached of it or of a similar scene, or no setting is `auto`. Explicit settings of a scene are never changed.
///
/// # Errors
/// [`PlanCacheError`] if the cache cannot be read.
pub(crate) fn tuned_settings(
    case: &StudyCase,
    kept: &PlanCache,
) -> Result<Option<TunedSettings>, PlanCacheError> {
    let Some((findings, origin)) = kept.nearest_findings(case)? else { return Ok(None) };
    let is_open = |key: &Key| case.values.choice(key).as_deref() == Some("auto");
    let holds =
        |key: &Key, value: &KeyValue| case.values.choice(key).is_none_or(|now| KeyValue::Word(now) == *value);
    // Timed configurations are sorted by cost.
    for configuration in findings.configurations.iter().filter(|configuration| configuration.cost.is_some()) {
        let choice = configuration.choice(case);
        let is_own =
            [ChoiceEffect::Order, ChoiceEffect::Precision].iter().all(|&it| choice.agrees_on(&case.own, it));
        let overrides = choice.overrides();
        if is_own && overrides.iter().all(|(key, value)| is_open(key) || holds(key, value)) {
            let open = overrides.iter().filter(|(key, _)| is_open(key));
            let overrides: Overrides = open.map(|(key, value)| (key, value.clone())).collect();
            return Ok((!overrides.is_empty()).then_some(TunedSettings { overrides, origin }));
        }
    }
    Ok(None)
}
