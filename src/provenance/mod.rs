//! Where a result comes from: what a reader needs to get it again.

mod machine;

pub(crate) use machine::Machine;

use serde::{Deserialize, Serialize};
use std::ffi::OsString;
use std::path::Path;
use stripmine_kernels::InstructionSet;
use stripmine_physics::number::counted;
use stripmine_physics::origin::{Origin, today};
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
    /// The machine.
    pub machine: Machine,
    /// Threads that were there to be used.
    pub threads: usize,
    /// The widest instructions.
    pub(crate) instruction_set: String,
    /// Seconds that it took.
    pub seconds: f64,
    /// When it was made: the day, in universal time, as year-month-day.
    pub date: String,
    /// Processes that measured its times; one where it has none.
    #[serde(default = "one")]
    pub(crate) processes: usize,
    /// Code that it depends on; none of results of earlier versions.
    #[serde(default)]
    pub code: Option<Fingerprints>,
    /// Measurements that it repeats.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub repeated: Vec<Measurement>,
}

fn one() -> usize {
    1
}

/// Fingerprints of the code that results depend on, crate by crate.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Fingerprints {
    pub(crate) kernels: String,
    /// Physics, without files, records and processes.
    pub(crate) physics: String,
}

impl Fingerprints {
    /// Fingerprints of this program.
    pub(crate) fn here() -> Fingerprints {
        Fingerprints {
            kernels: env!("STRIPMINE_KERNELS").to_owned(),
            physics: env!("STRIPMINE_PHYSICS").to_owned(),
        }
    }
}

/// A measurement that was made before, and is repeated by a report.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Measurement {
    /// Day: year-month-day.
    pub date: String,
    /// Commit of our source.
    pub commit: String,
    /// Command that measured.
    pub command: String,
    /// Processor.
    pub(crate) host: String,
}

impl Provenance {
    /// Of something that this program, called by `command`, has just made in `seconds`.
    pub(crate) fn here(command: String, seconds: f64) -> Provenance {
        Provenance {
            origin: built(),
            command,
            machine: Machine::here(),
            threads: rayon::current_num_threads(),
            instruction_set: InstructionSet::best().name().to_owned(),
            seconds,
            date: today(),
            processes: 1,
            code: Some(Fingerprints::here()),
            repeated: vec![],
        }
    }

    /// Returns whether `reproduce` made it.
    pub(crate) fn is_of_the_report(&self) -> bool {
        self.command.split(' ').nth(1) == Some("reproduce")
    }

    /// Returns whether kernels or physics have changed since it was made.
    pub(crate) fn is_stale(&self) -> bool {
        self.code != Some(Fingerprints::here())
    }

    /// The day on which its results were measured: of results that are repeated, the last.
    pub fn measured_on(&self) -> &str {
        self.repeated.iter().map(|it| it.date.as_str()).max().unwrap_or(&self.date)
    }

    /// Whether the same command of the same program, from a source that is in a commit or was released, made it on the same host.
    pub(crate) fn is_of_the_command(&self, other: &Provenance) -> bool {
        let of = |it: &Provenance| (it.origin.clone(), it.command.clone(), it.machine.processor.clone());
        !other.origin.dirty && of(self) == of(other)
    }

    /// The program, in words that go on after how many were made.
    pub(crate) fn of_program(&self) -> String {
        let Origin { version, commit, dirty, .. } = &self.origin;
        let state = if *dirty { ", with changes that are in no commit" } else { "" };
        format!("made on {} by stripmine {version} of source commit {commit}{state}", self.date)
    }

    /// The machine, in words.
    pub(crate) fn of_machine(&self) -> String {
        format!("{}, on {}", self.instruction_set, self.machine.without_clock())
    }

    /// When, how long, by which command and commit, in a sentence.
    pub(crate) fn sentence(&self) -> String {
        let Provenance { origin, command, threads, seconds, date, repeated, processes, .. } = self;
        if !repeated.is_empty() {
            let one = |it: &Measurement| {
                format!("on {} by `{}`, source commit {}, {}", it.date, it.command, it.commit, it.host)
            };
            return format!("Measured {}.", repeated.iter().map(one).collect::<Vec<_>>().join("; "));
        }
        let state = if origin.dirty { " with changes" } else { "" };
        format!(
            "Made on {date} in {seconds:.1} s with {threads} threads in {} by `{command}`, source commit {}{state}.",
            counted(processes, "process", "processes"),
            origin.commit
        )
    }
}

/// A command line as a shell takes it again: the name of the program without its folder, and the arguments as they were
/// given, in quotation marks where a shell needs them.
pub(crate) fn command_line(arguments: &[OsString]) -> String {
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
