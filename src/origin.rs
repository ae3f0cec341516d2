//! Where a result comes from: what a reader needs to get it again.

use serde::{Deserialize, Serialize};
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
}

/// How and where an item of a reproduction was made.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Provenance {
    /// The program.
    pub origin: Origin,
    /// The command.
    pub command: String,
    /// The processor, where the system names it, and the platform.
    pub host: String,
    /// Threads that were there to be used.
    pub threads: usize,
    /// The widest instructions.
    pub instruction_set: String,
    /// Seconds that it took.
    pub seconds: f64,
}

impl Provenance {
    /// Of something that this program, told by `command`, has just made in `seconds`.
    pub fn here(command: String, seconds: f64) -> Provenance {
        Provenance {
            origin: Origin::here(),
            command,
            host: host(),
            threads: rayon::current_num_threads(),
            instruction_set: InstructionSet::best().name().to_owned(),
            seconds,
        }
    }

    /// In a sentence.
    pub fn sentence(&self) -> String {
        let Provenance { origin, command, host, threads, instruction_set, seconds } = self;
        let Origin { version, commit, dirty, target } = origin;
        let state = if *dirty { ", with changes that are in no commit" } else { "" };
        format!(
            "Made in {seconds:.1} s by `{command}`, stripmine {version} of source commit {commit}{state}, built for \
             {target}, on {host} ({threads} threads, {instruction_set})."
        )
    }
}

/// The processor (Linux says it in `/proc/cpuinfo`) and the platform.
pub fn host() -> String {
    let platform = format!("{} {}", std::env::consts::OS, std::env::consts::ARCH);
    let cpuinfo = std::fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
    let name = cpuinfo.lines().find_map(|line| line.strip_prefix("model name")?.split_once(": "));
    name.map_or(platform.clone(), |(_, name)| format!("{name}, {platform}"))
}
