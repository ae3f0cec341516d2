//! Provenance of results: program, command and machine, as needed to reproduce them.

mod machine;

pub(crate) use machine::MachineDescription;

use serde::{Deserialize, Serialize};
use std::ffi::OsString;
use std::path::Path;
use stripmine_kernels::InstructionSet;
use stripmine_physics::number::count_with_noun;
use stripmine_physics::origin::{Origin, today};
use stripmine_physics::quoted;

/// Version, commit and target of this program.
pub fn built() -> Origin {
    Origin {
        version: env!("CARGO_PKG_VERSION").to_owned(),
        commit: env!("STRIPMINE_COMMIT").to_owned(),
        dirty: env!("STRIPMINE_DIRTY") == "true",
        target: env!("STRIPMINE_TARGET").to_owned(),
    }
}

/// Provenance of an item of a report.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Provenance {
    /// The program.
    pub origin: Origin,
    /// The whole command line as given.
    pub command: String,
    /// The machine.
    pub machine: MachineDescription,
    /// Number of available threads.
    pub threads: usize,
    /// The widest instruction set.
    pub(crate) instruction_set: String,
    /// Duration (s).
    pub seconds: f64,
    /// Day in universal time, as year-month-day.
    pub date: String,
    /// Number of processes that measured times; one if none were measured.
    #[serde(default = "one")]
    pub(crate) processes: usize,
    /// Fingerprints of the code it depends on; none for results of earlier versions.
    #[serde(default)]
    pub code: Option<Fingerprints>,
    /// Earlier measurements that it repeats.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub repeated: Vec<RepeatedMeasurement>,
}

fn one() -> usize {
    1
}

/// Fingerprints of the code that results depend on, by crate.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Fingerprints {
    pub(crate) kernels: String,
    /// Physics, without file formats, records and processes.
    pub(crate) physics: String,
}

impl Fingerprints {
    /// Returns those of this program.
    pub(crate) fn here() -> Fingerprints {
        Fingerprints {
            kernels: env!("STRIPMINE_KERNELS").to_owned(),
            physics: env!("STRIPMINE_PHYSICS").to_owned(),
        }
    }
}

/// Earlier measurement that a report repeats.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct RepeatedMeasurement {
    /// Day, as year-month-day.
    pub date: String,
    /// Source commit of the program.
    pub commit: String,
    /// Command of the measurement.
    pub command: String,
    /// Name of the processor.
    pub(crate) host: String,
}

impl Provenance {
    /// Provenance of a result that this program, called by `command`, has just made in `seconds`.
    pub(crate) fn here(command: String, seconds: f64) -> Provenance {
        Provenance {
            origin: built(),
            command,
            machine: MachineDescription::here(),
            threads: rayon::current_num_threads(),
            instruction_set: InstructionSet::best().name().to_owned(),
            seconds,
            date: today(),
            processes: 1,
            code: Some(Fingerprints::here()),
            repeated: vec![],
        }
    }

    /// Returns true if `reproduce` made it.
    pub(crate) fn is_from_reproduce(&self) -> bool {
        self.command.split(' ').nth(1) == Some("reproduce")
    }

    /// Returns true if kernels or physics have changed since it was made.
    pub(crate) fn is_stale(&self) -> bool {
        self.code != Some(Fingerprints::here())
    }

    /// Day of the measurement: the last one for repeated results.
    pub fn measured_on(&self) -> &str {
        self.repeated.iter().map(|it| it.date.as_str()).max().unwrap_or(&self.date)
    }

    /// Returns true if the same command of the same program, built from a commit or a release, made it on the same host.
    pub(crate) fn has_same_origin(&self, other: &Provenance) -> bool {
        let of = |it: &Provenance| (it.origin.clone(), it.command.clone(), it.machine.processor.clone());
        !other.origin.dirty && of(self) == of(other)
    }

    /// Phrase with date and program, to follow the number of items.
    pub(crate) fn program_phrase(&self) -> String {
        let Origin { version, commit, dirty, .. } = &self.origin;
        let state = if *dirty { ", with changes that are in no commit" } else { "" };
        format!("made on {} by stripmine {version} of source commit {commit}{state}", self.date)
    }

    /// Phrase with instruction set and machine.
    pub(crate) fn machine_phrase(&self) -> String {
        format!("{}, on {}", self.instruction_set, self.machine.without_clock())
    }

    /// Sentence with date, duration, command and commit.
    pub(crate) fn sentence(&self) -> String {
        let Provenance { origin, command, threads, seconds, date, repeated, processes, .. } = self;
        if !repeated.is_empty() {
            let one = |it: &RepeatedMeasurement| {
                format!("on {} by `{}`, source commit {}, {}", it.date, it.command, it.commit, it.host)
            };
            return format!("Measured {}.", repeated.iter().map(one).collect::<Vec<_>>().join("; "));
        }
        let state = if origin.dirty { " with changes" } else { "" };
        format!(
            "Made on {date} in {seconds:.1} s with {threads} threads in {} by `{command}`, source commit {}{state}.",
            count_with_noun(processes, "process", "processes"),
            origin.commit
        )
    }
}

/// Command line that a shell accepts again: the program without its folder, and the arguments, quoted where a shell needs it.
pub(crate) fn command_line(arguments: &[OsString]) -> String {
    let name = arguments.first().map(Path::new).and_then(Path::file_stem);
    let given = arguments.iter().skip(1).map(OsString::as_os_str);
    name.into_iter()
        .chain(given)
        .map(|word| shell_quoted(&word.to_string_lossy()))
        .collect::<Vec<_>>()
        .join(" ")
}

fn shell_quoted(word: &str) -> String {
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
    fn recorded_command_lines_can_be_repeated() {
        let given = ["/opt/bin/stripmine", "reproduce", "--only", "mask", "--out", "my reports", "it's", ""];
        assert_eq!(
            command_line(&given.map(OsString::from)),
            r"stripmine reproduce --only mask --out 'my reports' 'it'\''s' ''"
        );
        assert_eq!(command_line(&[]), "");
    }
}
