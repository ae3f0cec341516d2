//! The entry of hard discs in the list of methods.

use super::benches::BENCHES;
use super::checked::prepare;
use super::keys::VOCABULARY;
use super::quantities::QUANTITIES;
use crate::method::{Axis, Decides, Entry, Setting};

/// Event-driven hard discs.
pub static ENTRY: Entry = Entry {
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

const AXES: &[Axis] = &[Axis {
    name: "engine",
    decides: Decides::Cost,
    settings: &[
        Setting { name: "fast", overrides: &["machine.engine=fast"] },
        Setting { name: "reference", overrides: &["machine.engine=reference"] },
    ],
    own: |prepared| Some(prepared.settings.get("engine")?.as_str()?.to_owned()),
}];
