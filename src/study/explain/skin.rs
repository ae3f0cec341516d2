//! Skin of neighbour lists, chosen by trials: no constant predicts how discs move.

use super::findings::{MeasuredConfiguration, SceneTrials, sort_by_cost};
use crate::study::StudyCase;
use crate::study::rounded;
use stripmine_physics::scene::Overrides;

/// Skins tried, in parts of the scene's own.
const TRIED: [f64; 3] = [0.4, 0.65, 1.5];
/// Smallest saving, in parts of the time, for which a skin is changed: less is within timing noise.
const WORTH: f64 = 0.04;

impl SceneTrials<'_> {
    /// Tunes the skin of all configurations with neighbour lists, where lists are the cheapest search.
    pub(super) fn tune_skin(&self, configurations: &mut [MeasuredConfiguration], seconds: f64) {
        let by_lists = |configuration: &MeasuredConfiguration| {
            configuration.settings.iter().any(|(axis, name)| axis == "search" && name == LISTS)
        };
        let Some(best) = configurations
            .first()
            .filter(|configuration| by_lists(configuration) && self.left() > seconds)
            .cloned()
        else {
            return;
        };
        let Ok(prepared) = self.prepared(&best.overrides, best.step) else { return };
        // A resolved scene states its skin.
        let resolved = prepared.scene.parse::<toml::Table>().ok();
        let own = resolved.and_then(|scene| scene.get("search")?.get("skin")?.as_float());
        let Some(own) = own else { return };
        let each = seconds / (TRIED.len() + 1) as f64;
        let cost = |skin: f64| {
            let overrides = with_skin(best.overrides.clone(), self.case, skin);
            self.trial.timed(&self.prepared(&overrides, best.step).ok()?, each).ok().map(|it| it.seconds)
        };
        // Its own skin is timed again beside the others.
        let Some(of_own) = cost(own) else { return };
        let others = TRIED.iter().filter_map(|part| Some((part * own, cost(part * own)?)));
        let Some((skin, least)) = others.min_by(|a, b| a.1.total_cmp(&b.1)) else { return };
        if least > (1.0 - WORTH) * of_own {
            return;
        }
        for configuration in configurations.iter_mut().filter(|configuration| by_lists(configuration)) {
            configuration.overrides = with_skin(configuration.overrides.clone(), self.case, skin);
            configuration.cost = configuration.cost.map(|cost| cost * least / of_own);
            configuration.skin = Some([own, skin, least / of_own]);
        }
        sort_by_cost(configurations);
    }
}

/// Name of the search that has a skin.
const LISTS: &str = "neighbor-list";

/// Sets the skin, rounded to the printed precision.
fn with_skin(overrides: Overrides, case: &StudyCase, skin: f64) -> Overrides {
    match case.entry.vocabulary.keys.key("search", "skin") {
        Some(key) => overrides.set(key, rounded(skin, 3)),
        None => overrides,
    }
}

impl MeasuredConfiguration {
    /// Overrides that select this configuration.
    pub(super) fn configuration_overrides(&self, case: &StudyCase) -> Overrides {
        let overrides = self.choice(case).overrides();
        match self.skin {
            Some([_, skin, _]) => with_skin(overrides, case, skin),
            None => overrides,
        }
    }
}
