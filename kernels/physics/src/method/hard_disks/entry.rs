//! Entry of hard discs in the list of methods.

use super::benches::BENCHES;
use super::checked::prepare;
use super::keys::{ENGINE, VOCABULARY};
use super::options::EngineChoice;
use super::quantities::QUANTITIES;
use crate::method::trials::settings;
use crate::method::{ChoiceEffect, MethodEntry, SettingAxis};

/// Event-driven hard discs.
pub static ENTRY: MethodEntry = MethodEntry {
    vocabulary: &VOCABULARY,
    source: "Isobe 1999 (ISO99)",
    doc: "hard discs that fly straight between instantaneous collisions: no time step",
    quantities: QUANTITIES,
    prepare,
    benches: BENCHES,
    axes: AXES,
    twins: &[],
    trials: None,
};

const AXES: &[SettingAxis] = &[SettingAxis {
    name: "engine",
    decides: ChoiceEffect::Cost,
    settings: settings! {
        "fast" [ENGINE = EngineChoice::Fast],
        "reference" [ENGINE = EngineChoice::Reference],
    },
    own: |prepared| Some(prepared.settings.get("engine")?.as_str()?.to_owned()),
}];
