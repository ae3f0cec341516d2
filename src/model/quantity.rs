//! Numbers and facts of a machine with where they come from.

use serde::Deserialize;

/// Where a number comes from.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Provenance {
    /// Printed in the source that the note names.
    Sourced,
    /// Follows from sourced facts, by the argument in the note.
    Derived,
    /// Our choice, for the reason in the note; no source we could point to.
    Assumed,
}

impl Provenance {
    /// The name in tables and machine files.
    pub const fn name(self) -> &'static str {
        match self {
            Provenance::Sourced => "sourced",
            Provenance::Derived => "derived",
            Provenance::Assumed => "assumed",
        }
    }
}

/// A number with its provenance; the unit is that of the entry it stands for.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Quantity {
    /// The number itself, positive and finite.
    pub value: f64,
    /// Whether it was printed somewhere, follows from something or is our choice.
    pub provenance: Provenance,
    /// The source, the derivation or the reason; never empty.
    pub note: String,
}

/// A property that a machine has or has not, with its provenance.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Fact {
    /// Whether it has it.
    pub value: bool,
    /// Whether it was printed somewhere, follows from something or is our choice.
    pub provenance: Provenance,
    /// The source, the derivation or the reason; never empty.
    pub note: String,
}
