//! Entry of lattice molecular dynamics in the list of methods.

use super::benches::BENCHES;
use super::document::GranularDocument;
use super::keys::VOCABULARY;
use super::quantities::QUANTITIES;
use super::trials::{AXES, TRIALS, TWINS};
use crate::method::MethodEntry;

/// Lattice molecular dynamics of granular discs.
pub static ENTRY: MethodEntry = MethodEntry {
    vocabulary: &VOCABULARY,
    source: "Buchholtz and Pöschel 1993 (BP93)",
    doc: "granular discs with soft contacts, on a lattice with at most one disc a cell, in sectors, or by lists",
    quantities: QUANTITIES,
    prepare: |values| GranularDocument::read(values)?.prepare(),
    benches: BENCHES,
    axes: AXES,
    twins: TWINS,
    trials: Some(&TRIALS),
};
