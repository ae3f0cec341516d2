//! Options, output and failures shared by all verbs.

mod failure;
mod output;
mod verb;

pub use failure::CommandFailure;
pub(crate) use failure::{FailureReport, report_failure};
pub use output::is_untouched;
pub(crate) use output::print_answer;
pub(crate) use output::{
    SHARES, STEPS, bar, clear_progress, print, print_json, print_message, print_prose, print_text, progress,
    to_json, warn,
};
pub(crate) use verb::Verb;

use clap::Args;
use stripmine_physics::ranks::RankBackend;

/// Limit of threads, above the cores of any machine at hand; each thread takes memory.
pub(crate) const MOST_THREADS: u16 = 1024;

/// Options that every verb takes.
#[derive(Args, Clone, Debug)]
pub(crate) struct Common {
    /// Prints one JSON document to standard output
    #[arg(long, global = true)]
    pub json: bool,
    /// Prints nothing but errors to standard error
    #[arg(long, global = true)]
    pub(crate) quiet: bool,
    /// Number of threads, at most 1024; default: all cores. `bench` takes a list, such as 1,2,4
    #[arg(long, global = true, value_delimiter = ',', value_parser = clap::value_parser!(u16).range(1..=i64::from(MOST_THREADS)))]
    pub threads: Vec<u16>,
    /// Crew of the simulations that a verb can distribute over ranks.
    #[arg(skip = RankBackend::One)]
    pub(crate) crew: RankBackend,
    /// The whole command line, recorded with results.
    #[arg(skip)]
    pub command: String,
}

/// Largest count on the command line: above it not every whole number is a double.
const MOST: u64 = 1 << 53;

/// Parses a count on the command line: a whole number from 1 to 2⁵³, also written as 1e6.
///
/// # Errors
/// A message if it is none.
pub(crate) fn count(text: &str) -> Result<u64, String> {
    count_up_to(MOST, text)
}

/// Parses a count up to a smaller limit.
///
/// # Errors
/// A message if it is none.
pub(crate) fn count_up_to(most: u64, text: &str) -> Result<u64, String> {
    let whole = text.parse::<u64>().ok().or_else(|| {
        let number: f64 = text.parse().ok()?;
        (number.fract() == 0.0 && (1.0..=MOST as f64).contains(&number)).then_some(number as u64)
    });
    whole.filter(|count| (1..=most).contains(count)).ok_or_else(|| match most {
        MOST => "expected a whole number, 1 or more, such as 1000 or 1e6".to_owned(),
        most => format!("expected a whole number from 1 to {most}"),
    })
}

#[cfg(test)]
mod tests {
    use super::{count, count_up_to};

    #[test]
    fn counts_are_whole_and_positive() {
        assert_eq!(["7", "1e3", "2.5e1"].map(|text| count(text).ok()), [Some(7), Some(1000), Some(25)]);
        let none = ["0", "-1", "1.5", "1e99", "many", "nan", "", "inf", "18446744073709551615"];
        assert!(none.iter().all(|text| count(text).is_err()));
        assert_eq!(
            ["7", "1e1", "11", "1e2"].map(|text| count_up_to(10, text).ok()),
            [Some(7), Some(10), None, None]
        );
    }
}
