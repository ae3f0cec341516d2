//! What verbs share, those of the command and those that methods bring: options, output, failures.

mod failure;
mod output;
mod verb;

pub use failure::Failure;
pub(crate) use failure::tell;
pub use output::is_untouched;
pub(crate) use output::print_answer;
pub(crate) use output::{
    SHARES, STEPS, bar, clear_progress, print, print_json, progress, say, to_json, warn,
};
pub(crate) use verb::Verb;

use clap::Args;
use stripmine_physics::ranks::Crew;

/// More threads than any machine at hand has cores; each takes memory of its own.
pub(crate) const MOST_THREADS: u16 = 1024;

/// What every verb takes.
#[derive(Args, Clone, Debug)]
pub(crate) struct Common {
    /// One JSON document on standard output
    #[arg(long, global = true)]
    pub json: bool,
    /// Nothing on standard error but errors
    #[arg(long, global = true)]
    pub(crate) quiet: bool,
    /// Threads, at most 1024; all cores by default. `bench` takes several numbers, such as 1,2,4
    #[arg(long, global = true, value_delimiter = ',', value_parser = clap::value_parser!(u16).range(1..=i64::from(MOST_THREADS)))]
    pub threads: Vec<u16>,
    /// By whom simulations are carried out that a verb may give to several ranks.
    #[arg(skip = Crew::One)]
    pub(crate) crew: Crew,
    /// The whole command line, for the record of where results come from.
    #[arg(skip)]
    pub command: String,
}

/// The largest count on the command line: above it not every whole number is a double.
const MOST: u64 = 1 << 53;

/// A count on the command line: a whole number from 1 to 2⁵³, also as 1e6.
///
/// # Errors
/// A sentence, if it is none.
pub(crate) fn count(text: &str) -> Result<u64, String> {
    count_up_to(MOST, text)
}

/// The same up to a smaller number.
///
/// # Errors
/// A sentence, if it is none.
pub(crate) fn count_up_to(most: u64, text: &str) -> Result<u64, String> {
    let whole = text.parse::<u64>().ok().or_else(|| {
        let number: f64 = text.parse().ok()?;
        (number.fract() == 0.0 && (1.0..=MOST as f64).contains(&number)).then_some(number as u64)
    });
    whole.filter(|count| (1..=most).contains(count)).ok_or_else(|| match most {
        MOST => "a whole number, 1 or more, such as 1000 or 1e6".to_owned(),
        most => format!("a whole number from 1 to {most}"),
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
