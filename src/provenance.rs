//! Where a result comes from: what a reader needs to get it again.

use serde::{Deserialize, Serialize};
use std::ffi::OsString;
use std::path::Path;
use stripmine_kernels::InstructionSet;
use stripmine_physics::origin::{Origin, host, today};
use stripmine_physics::quoted;

/// This program, as it was built.
pub fn built() -> Origin {
    Origin {
        version: env!("CARGO_PKG_VERSION").to_owned(),
        commit: env!("STRIPMINE_COMMIT").to_owned(),
        dirty: env!("STRIPMINE_DIRTY") == "true",
        target: env!("STRIPMINE_TARGET").to_owned(),
    }
}

/// How and where an item of a reproduction was made.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Provenance {
    /// The program.
    pub origin: Origin,
    /// The whole command line, as it was given.
    pub command: String,
    /// The processor, where the system names it, and the platform.
    pub host: String,
    /// Threads that were there to be used.
    pub threads: usize,
    /// The widest instructions.
    pub instruction_set: String,
    /// Seconds that it took.
    pub seconds: f64,
    /// When it was made: the day, in universal time, as year-month-day.
    pub date: String,
}

impl Provenance {
    /// Of something that this program, called by `command`, has just made in `seconds`.
    pub fn here(command: String, seconds: f64) -> Provenance {
        Provenance {
            origin: built(),
            command,
            host: host(),
            threads: rayon::current_num_threads(),
            instruction_set: InstructionSet::best().name().to_owned(),
            seconds,
            date: today(),
        }
    }

    /// Date and commit, with a link to the file that says all.
    pub fn in_short(&self, file: &str) -> String {
        let state = if self.origin.dirty { " with changes" } else { "" };
        format!("[Made]({file}) {}, commit {}{state}.", self.date, self.origin.commit)
    }

    /// In a sentence.
    pub fn sentence(&self) -> String {
        let Provenance { origin, command, host, threads, instruction_set, seconds, date } = self;
        let Origin { version, commit, dirty, target } = origin;
        let state = if *dirty { ", with changes that are in no commit" } else { "" };
        format!(
            "Made on {date} in {seconds:.1} s by `{command}`, stripmine {version} of source commit {commit}{state}, built for \
             {target}, on {host} ({threads} threads, {instruction_set})."
        )
    }
}

/// A command line as a shell takes it again: the name of the program without its folder, and the arguments as they were
/// given, in quotation marks where a shell needs them.
pub fn command_line(arguments: &[OsString]) -> String {
    let name = arguments.first().map(Path::new).and_then(Path::file_stem);
    let given = arguments.iter().skip(1).map(OsString::as_os_str);
    name.into_iter().chain(given).map(|word| in_shell(&word.to_string_lossy())).collect::<Vec<_>>().join(" ")
}

fn in_shell(word: &str) -> String {
    let is_plain = |c: char| c.is_ascii_alphanumeric() || "-_=+:,./@%".contains(c);
    match !word.is_empty() && word.chars().all(is_plain) {
        true => word.to_owned(),
        false => format!("'{}'", quoted::one_line(word).replace('\'', "'\\''")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_command_line_is_recorded_whole_and_a_shell_takes_it_again() {
        let given = ["/opt/bin/stripmine", "reproduce", "--only", "mask", "--out", "my reports", "it's", ""];
        assert_eq!(
            command_line(&given.map(OsString::from)),
            r"stripmine reproduce --only mask --out 'my reports' 'it'\''s' ''"
        );
        assert_eq!(command_line(&[]), "");
    }
}
