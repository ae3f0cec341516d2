//! Where a result comes from: what a reader needs to get it again.

use crate::quoted;
use serde::{Deserialize, Serialize};
use std::ffi::OsString;
use std::path::Path;
use std::time::SystemTime;
use stripmine_kernels::InstructionSet;

/// The program that made a result.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Origin {
    /// Version of the package.
    pub version: String,
    /// Commit of the source it was built from.
    pub commit: String,
    /// Whether the source had changes that are in no commit.
    pub dirty: bool,
    /// The platform it was built for.
    pub target: String,
}

impl Origin {
    /// Of this program.
    pub fn here() -> Origin {
        Origin {
            version: env!("CARGO_PKG_VERSION").to_owned(),
            commit: env!("STRIPMINE_COMMIT").to_owned(),
            dirty: env!("STRIPMINE_DIRTY") == "true",
            target: env!("STRIPMINE_TARGET").to_owned(),
        }
    }

    /// Whether the source can be had again by its commit alone.
    pub fn is_committed(&self) -> bool {
        !self.dirty && self.commit != "unknown"
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
            origin: Origin::here(),
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

/// A moment to the second, in universal time, as RFC 3339 writes it.
pub fn moment(time: SystemTime) -> String {
    humantime::format_rfc3339_seconds(time).to_string()
}

/// The day, in universal time.
pub fn today() -> String {
    moment(SystemTime::now()).split('T').next().unwrap_or_default().to_owned()
}

/// The processor (Linux says it in `/proc/cpuinfo`) and the platform.
pub fn host() -> String {
    let platform = format!("{} {}", std::env::consts::OS, std::env::consts::ARCH);
    let cpuinfo = std::fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
    let name = cpuinfo.lines().find_map(|line| line.strip_prefix("model name")?.split_once(": "));
    name.map_or(platform.clone(), |(_, name)| format!("{name}, {platform}"))
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

    #[test]
    fn a_source_is_committed_only_where_a_commit_names_all_of_it() {
        let origin = |commit: &str, dirty| Origin { commit: commit.to_owned(), dirty, ..Origin::here() };
        let all = [("1234567890ab", false), ("1234567890ab", true), ("unknown", false)];
        assert_eq!(all.map(|(commit, dirty)| origin(commit, dirty).is_committed()), [true, false, false]);
    }
}
