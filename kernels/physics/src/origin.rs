//! Provenance of a run: the program, the host and the time.

use serde::{Deserialize, Serialize};
use std::time::SystemTime;

/// Program that made a result.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Origin {
    /// Version of the package.
    pub version: String,
    /// Commit of the source it was built from.
    pub commit: String,
    /// True if the source had uncommitted changes.
    pub dirty: bool,
    /// Platform it was built for.
    pub target: String,
}

impl Origin {
    /// True if a commit identifies the whole source.
    pub fn is_committed(&self) -> bool {
        !self.dirty && self.commit != "unknown"
    }
}

/// Formats a time in UTC to the second (RFC 3339).
pub fn moment(time: SystemTime) -> String {
    humantime::format_rfc3339_seconds(time).to_string()
}

/// Date in UTC.
pub fn today() -> String {
    moment(SystemTime::now()).split('T').next().unwrap_or_default().to_owned()
}

/// Processor (Linux: `/proc/cpuinfo`) and platform.
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

/// Mean number of threads that ran or waited to run in the last minute; none where the system does not report it.
pub fn load_average() -> Option<f64> {
    std::fs::read_to_string("/proc/loadavg").ok()?.split(' ').next()?.parse().ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn dirty_or_unknown_sources_are_not_committed() {
        let origin = |commit: &str, dirty| {
            let [version, target] = [(); 2].map(|()| String::new());
            Origin { version, commit: commit.to_owned(), dirty, target }
        };
        let all = [("1234567890ab", false), ("1234567890ab", true), ("unknown", false)];
        assert_eq!(all.map(|(commit, dirty)| origin(commit, dirty).is_committed()), [true, false, false]);
    }
}
