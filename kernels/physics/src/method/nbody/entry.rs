//! Entry of all-pairs gravity in the list of methods.

use super::benches::BENCHES;
use super::checked::prepare;
use super::keys::VOCABULARY;
use super::quantities::QUANTITIES;
use super::trials::{AXES, TRIALS, TWINS};
use crate::method::MethodEntry;

/// All-pairs gravity.
pub static ENTRY: MethodEntry = MethodEntry {
    vocabulary: &VOCABULARY,
    source: "all-pairs gravity (PWP)",
    doc: "bodies in space with softened all-pairs gravity, by eleven integrators",
    quantities: QUANTITIES,
    prepare,
    benches: BENCHES,
    axes: AXES,
    twins: TWINS,
    trials: Some(&TRIALS),
};
