//! A verb that is the laboratory's own.

use super::{Common, Failure};

/// A verb of the command that the laboratory of a method brings.
#[derive(Debug)]
pub(crate) struct Verb {
    /// The name.
    pub name: &'static str,
    /// Its help and arguments.
    pub command: fn(clap::Command) -> clap::Command,
    /// Carries it out.
    pub run: fn(&clap::ArgMatches, &Common) -> Result<(), Failure>,
}
