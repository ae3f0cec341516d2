//! Entry of Langevin dynamics in the list of methods.

use super::benches::BENCHES;
use super::checked::prepare;
use super::keys::VOCABULARY;
use super::laws::TWINS;
use super::quantities::QUANTITIES;
use super::trials::{AXES, TRIALS};
use crate::method::MethodEntry;

/// Langevin dynamics.
pub static ENTRY: MethodEntry = MethodEntry {
    vocabulary: &VOCABULARY,
    source: "Langevin dynamics of 2017 (LAN17)",
    doc: "particles in a bath of friction and noise, with or without pair forces",
    quantities: QUANTITIES,
    prepare,
    benches: BENCHES,
    axes: AXES,
    twins: TWINS,
    trials: Some(&TRIALS),
};
