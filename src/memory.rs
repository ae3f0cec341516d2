//! How much memory this machine has left, and whether a run fits into it.

use crate::scene::{Reason, SceneErrors, Spot};
use std::fs;

/// Bytes of the program itself: its text, its threads, its files.
pub const PROGRAM: f64 = 17.0e6;

/// What a run needs and what there is (bytes).
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
pub struct Foreseen {
    /// The most that the run takes at one time.
    pub needed: u64,
    /// What the machine has left; none where it does not say.
    pub available: Option<u64>,
    /// What the run is of, in words.
    #[serde(skip)]
    pub what: String,
    /// What takes less.
    #[serde(skip)]
    pub remedy: &'static str,
}

impl Foreseen {
    /// Whether the run fits this machine; `scene` is the name that an error gives it.
    ///
    /// # Errors
    /// [`SceneErrors`] with both numbers, where it does not.
    pub fn fits(&self, scene: &str) -> Result<(), SceneErrors> {
        let Foreseen { needed, available, what, remedy } = self;
        match *available {
            Some(available) if *needed > available => {
                let spot = Spot { file: scene.to_owned(), place: None };
                let message = format!(
                    "a run of {what} takes {needed} bytes of memory ({}); this machine has {available} left ({})",
                    in_words(*needed),
                    in_words(available)
                );
                Err(spot.error(Reason::Memory, message).advising(*remedy).into())
            }
            _ => Ok(()),
        }
    }
}

/// Bytes as a person reads them.
pub fn in_words(bytes: u64) -> String {
    match bytes as f64 {
        few if few < 1e9 => format!("{:.0} MB", few / 1e6),
        many => format!("{:.1} GB", many / 1e9),
    }
}

/// Bytes that a program may still take without pushing others out: what the system calls available, or what is left of a
/// control group's share if that is less. None where the system does not say.
pub fn available() -> Option<u64> {
    let meminfo = fs::read_to_string("/proc/meminfo").ok()?;
    let free = kibibytes(&meminfo, "MemAvailable:")?;
    Some(left_of_groups().into_iter().fold(free, u64::min))
}

/// What the shares of the control groups of this process leave, from its own up to the root.
fn left_of_groups() -> Vec<u64> {
    let groups = fs::read_to_string("/proc/self/cgroup").unwrap_or_default();
    let mut left = Vec::new();
    for line in groups.lines() {
        let mut fields = line.splitn(3, ':').skip(1);
        let (Some(controllers), Some(path)) = (fields.next(), fields.next()) else { continue };
        // Version 2 has one tree; version 1 has one for memory.
        let (root, limit, usage) = match controllers {
            "" => ("/sys/fs/cgroup", "memory.max", "memory.current"),
            _ if controllers.split(',').any(|controller| controller == "memory") => {
                ("/sys/fs/cgroup/memory", "memory.limit_in_bytes", "memory.usage_in_bytes")
            }
            _ => continue,
        };
        let number = |folder: &str, file: &str| -> Option<u64> {
            fs::read_to_string(format!("{root}{folder}/{file}")).ok()?.trim().parse().ok()
        };
        let mut folder = path.trim_end_matches('/');
        loop {
            if let (Some(limit), Some(usage)) = (number(folder, limit), number(folder, usage)) {
                left.push(limit.saturating_sub(usage));
            }
            match folder.rfind('/') {
                Some(end) => folder = &folder[..end],
                None => break,
            }
        }
    }
    left
}

fn kibibytes(text: &str, name: &str) -> Option<u64> {
    let line = text.lines().find_map(|line| line.strip_prefix(name))?;
    line.split_whitespace().next()?.parse::<u64>().ok()?.checked_mul(1024)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn kibibytes_are_read_by_their_name() {
        let text = "MemTotal:       24000000 kB\nMemAvailable:   23000000 kB\n";
        assert_eq!(kibibytes(text, "MemAvailable:"), Some(23_000_000 * 1024));
        assert_eq!(kibibytes(text, "MemNone:"), None);
        assert_eq!(kibibytes("MemAvailable: many", "MemAvailable:"), None);
    }
}
