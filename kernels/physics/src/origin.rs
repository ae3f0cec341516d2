//! The program that makes a result, the host, and the moment: what a run writes down of where it comes from.

use serde::{Deserialize, Serialize};
use std::time::SystemTime;

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
    /// Whether the source can be had again by its commit alone.
    pub fn is_committed(&self) -> bool {
        !self.dirty && self.commit != "unknown"
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
    #[expect(
        clippy::disallowed_methods,
        reason = "a system that does not name its processor is named by its platform alone"
    )]
    let cpuinfo = std::fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
    let name = cpuinfo.lines().find_map(|line| line.strip_prefix("model name")?.split_once(": "));
    name.map_or(platform.clone(), |(_, name)| format!("{name}, {platform}"))
}

/// Threads that ran or waited to run in the last minute, in the mean; none where the system does not say.
pub fn load_average() -> Option<f64> {
    std::fs::read_to_string("/proc/loadavg").ok()?.split(' ').next()?.parse().ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_source_is_committed_only_where_a_commit_names_all_of_it() {
        let origin = |commit: &str, dirty| {
            let [version, target] = [(); 2].map(|()| String::new());
            Origin { version, commit: commit.to_owned(), dirty, target }
        };
        let all = [("1234567890ab", false), ("1234567890ab", true), ("unknown", false)];
        assert_eq!(all.map(|(commit, dirty)| origin(commit, dirty).is_committed()), [true, false, false]);
    }
}
