//! Verbs of the laboratory.

use super::{CommandFailure, Common};

/// Verb of the command defined by the laboratory of a method.
#[derive(Debug)]
pub(crate) struct Verb {
    pub name: &'static str,
    /// Adds help and arguments.
    pub command: fn(clap::Command) -> clap::Command,
    /// Executes the verb.
    pub run: fn(&clap::ArgMatches, &Common) -> Result<(), CommandFailure>,
}
