//! What verbs share, those of the command and those that methods bring: options, output, failures.

mod failure;
mod output;

pub use failure::{Failure, tell};
pub(crate) use output::print_answer;
pub use output::{SHARES, bar, clear_progress, print, print_json, progress, say, to_json, warn};

use clap::Args;

/// More threads than any machine at hand has cores; each takes memory of its own.
const MOST_THREADS: i64 = 1024;

/// What every verb takes.
#[derive(Args, Clone, Debug)]
pub struct Common {
    /// One JSON document on standard output
    #[arg(long, global = true)]
    pub json: bool,
    /// Nothing on standard error but errors
    #[arg(long, global = true)]
    pub quiet: bool,
    /// Threads, at most 1024; all cores by default
    #[arg(long, global = true, value_parser = clap::value_parser!(u16).range(1..=MOST_THREADS))]
    pub threads: Option<u16>,
    /// The whole command line, for the record of where results come from.
    #[arg(skip)]
    pub command: String,
}
