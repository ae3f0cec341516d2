//! Numbers with their provenance.

use serde::Deserialize;

/// Provenance of a number.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum NumberProvenance {
    /// Printed in the source that the note names.
    Sourced,
    /// Derived from sourced facts, by the argument in the note.
    Derived,
    /// Our choice, for the reason in the note; no source was found.
    Assumed,
}

/// A number or a fact with its provenance; the unit is that of its entry.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields, expecting = "a table of value, provenance and note")]
pub(crate) struct SourcedValue<T> {
    /// The number, positive and finite, or the fact.
    pub value: T,
    /// Origin of the value: a source, a derivation or our choice.
    pub provenance: NumberProvenance,
    /// Source, derivation or reason; never empty.
    pub(crate) note: String,
}

/// A number with its provenance.
pub(crate) type SourcedNumber = SourcedValue<f64>;
