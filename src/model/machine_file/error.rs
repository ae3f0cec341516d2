//! What can be wrong with a machine file.

use super::FORMAT;
use stripmine_kernels::isa::op::OpClass;

/// Why a machine file cannot be used.
#[derive(Debug, thiserror::Error)]
pub enum MachineFileError {
    /// Not TOML, or an entry that is missing, unknown or of the wrong type; the cause shows line and column.
    #[error("machine file `{file}`: {cause}")]
    Syntax {
        /// Name of the file.
        file: String,
        /// What the TOML reader says, with the place.
        cause: Box<toml::de::Error>,
    },
    /// A format version that this program does not know.
    #[error("machine file `{file}`: format = {found}, but this program reads format {FORMAT}")]
    UnsupportedFormat {
        /// Name of the file.
        file: String,
        /// The version it states.
        found: u32,
    },
    /// A name that is no class of operations.
    #[error("machine file `{file}`: `{entry}` names no class of operations; known are {}", class_names())]
    UnknownClass {
        /// Name of the file.
        file: String,
        /// The entry with the unknown name.
        entry: String,
    },
    /// A number that is zero, negative or not finite.
    #[error("machine file `{file}`: `{entry}` is {value}, but must be positive and finite")]
    NotPositive {
        /// Name of the file.
        file: String,
        /// The entry with the number.
        entry: String,
        /// The number.
        value: f64,
    },
    /// A number with a fraction where things are counted.
    #[error("machine file `{file}`: `{entry}` is {value}, but must be a whole number")]
    NotWhole {
        /// Name of the file.
        file: String,
        /// The entry with the number.
        entry: String,
        /// The number.
        value: f64,
    },
    /// A number that does not say where it comes from.
    #[error("machine file `{file}`: the note of `{entry}` is empty; say where the number comes from")]
    EmptyNote {
        /// Name of the file.
        file: String,
        /// The entry without a note.
        entry: String,
    },
    /// A class that the machine executes, without a start-up.
    #[error("machine file `{file}`: neither `{entry}` nor `start_up.default` is given")]
    MissingStartUp {
        /// Name of the file.
        file: String,
        /// The missing entry.
        entry: String,
    },
    /// An expansion into nothing.
    #[error("machine file `{file}`: `{entry}` has no steps")]
    EmptyExpansion {
        /// Name of the file.
        file: String,
        /// The entry without steps.
        entry: String,
    },
    /// Expansions that lead back to where they started.
    #[error("machine file `{file}`: `{entry}` never ends: {}", cycle.join(" -> "))]
    EndlessExpansion {
        /// Name of the file.
        file: String,
        /// The entry from which the circle is reached.
        entry: String,
        /// The classes passed through; the last one occurred before.
        cycle: Vec<&'static str>,
    },
}

fn class_names() -> String {
    OpClass::ALL.iter().map(|class| class.name()).collect::<Vec<_>>().join(", ")
}
