//! Other programs beside ours on the same scenes and the same core.
//!
//! They cannot be had everywhere, so scripts in `tests/rivals/` measure them; what the scripts wrote last is shipped in
//! `measured/`, with date, host and commit.

pub mod section;

use crate::console::Failure;
use serde::{Deserialize, Serialize};

/// What the scripts wrote: a name, the contests, and where they come from.
const MEASURED: [(&str, &str, &str); 4] = [
    (
        "lammps.py",
        include_str!("measured/granular/contests.json"),
        include_str!("measured/granular/provenance.json"),
    ),
    (
        "langevin.py",
        include_str!("measured/langevin/contests.json"),
        include_str!("measured/langevin/provenance.json"),
    ),
    (
        "particular.py",
        include_str!("measured/particular/contests.json"),
        include_str!("measured/particular/provenance.json"),
    ),
    ("edmd.py", include_str!("measured/edmd/contests.json"), include_str!("measured/edmd/provenance.json")),
];

/// Contests with another program.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Rival {
    /// The program.
    pub rival: String,
    /// Its version.
    pub version: String,
    /// Which build it is.
    pub build: String,
    /// Instructions that ours used.
    pub instruction_set: String,
    /// The unit of the rates.
    pub unit: String,
    /// The contests.
    pub contests: Vec<Contest>,
    /// What both must agree in.
    pub same: Vec<Same>,
    /// What both take of the machine's memory, where it was measured.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub memory: Vec<Memory>,
    /// Where they come from; beside the contests in a file of its own.
    #[serde(skip_deserializing)]
    pub source: Source,
}

/// A system, ours and theirs in turns.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Contest {
    /// What is simulated.
    pub system: String,
    /// How many particles.
    pub particles: u64,
    /// Our way: search, precision, integrator.
    pub way: String,
    /// Our rates, a number for each round.
    pub ours: Vec<f64>,
    /// Theirs.
    pub theirs: Vec<f64>,
    /// Ours over theirs in each round.
    pub ratios: Vec<f64>,
}

/// A quantity that both programs computed.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Same {
    /// Which.
    pub what: String,
    /// Ours.
    pub ours: f64,
    /// Theirs.
    pub theirs: f64,
    /// By how much they may differ.
    pub within: f64,
}

/// The most memory that both programs had at once, in bytes.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Memory {
    /// What is simulated.
    pub system: String,
    /// How many particles.
    pub particles: u64,
    /// Ours.
    pub ours: u64,
    /// Theirs.
    pub theirs: u64,
}

/// Where contests come from.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Source {
    /// The day.
    pub date: String,
    /// Commit of our source.
    pub commit: String,
    /// The command that measured.
    pub command: String,
    /// The processor.
    pub host: String,
}

/// All contests.
///
/// # Errors
/// If a shipped file is not what the scripts write.
pub fn rivals() -> Result<Vec<Rival>, Failure> {
    let read = |(script, contests, source): &(&str, &str, &str)| {
        let wrong =
            |cause: serde_json::Error| Failure::writing(format!("contests of {script}"))(cause.into());
        let rival: Rival = serde_json::from_str(contests).map_err(wrong)?;
        Ok(Rival { source: serde_json::from_str(source).map_err(wrong)?, ..rival })
    };
    MEASURED.iter().map(read).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn both_programs_do_the_same_physics_in_every_contest() {
        for rival in rivals().unwrap() {
            assert!(!rival.contests.is_empty(), "{}", rival.rival);
            for it in &rival.contests {
                assert!(it.ratios.len() >= 2 && it.ours.len() == it.theirs.len(), "{it:?}");
            }
            for same in &rival.same {
                assert!((same.ours - same.theirs).abs() <= same.within, "{}: {same:?}", rival.rival);
            }
            let Source { date, commit, command, host } = &rival.source;
            assert!(!date.is_empty() && !host.is_empty() && command.contains("tests/rivals/"), "{rival:?}");
            assert!(!commit.contains("dirty"), "{} was measured with a changed source", rival.rival);
        }
    }
}
