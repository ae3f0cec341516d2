//! Memory available to this program, the limit that applies, and the memory that a run needs.

use crate::input::{InputErrors, MistakeKind, Spot};
use crate::ranks::RankBackend;
use serde::{Serialize, Serializer};
use std::fs;
use stripmine_kernels::isa::aligned_column::column_memory;

/// Memory of the program itself: its code, threads and files (bytes).
pub(crate) const PROGRAM: f64 = 25.0e6;

/// Memory that a run needs and memory that is available (bytes).
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct MemoryForecast {
    /// Peak memory of the run.
    pub needed: u64,
    /// Memory available; none where the system does not report it.
    pub available: Option<Available>,
    /// Subject of the run, in words.
    #[serde(skip)]
    pub what: String,
    /// Advice on how to need less.
    #[serde(skip)]
    pub remedy: &'static str,
    /// Additional memory of several ranks.
    #[serde(skip)]
    pub ranks: RankMemory,
}

/// Additional memory of several ranks beside that of one (bytes).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct RankMemory {
    /// Gathered discs, on the first rank.
    pub(crate) gathered: f64,
    /// Copies of the whole scene that every rank stores, whatever its part.
    pub each: f64,
    /// Number of rows over all discs and the length of one. Each rank has the rows of its own discs, rounded up.
    pub rows: [f64; 2],
    /// Address space of their threads.
    pub threads: f64,
}

/// Address space of a thread: its stack, and pages that its short arrays share.
const THREAD: f64 = (2 << 20) as f64 + (4 << 20) as f64;

impl RankMemory {
    /// Memory of `count` discs in bands, with cells that every rank stores in full (bytes), and rows of the discs.
    pub(crate) fn in_bands(count: f64, cells: f64, rows: [f64; 2]) -> RankMemory {
        // Gathering: seven words for a disc in transit, six on arrival. Each rank: a row and the periods crossed; the rest is measured overhead of
        // allocators with several threads.
        RankMemory { gathered: 8.0 * (7.0 + 6.0) * count, each: 50.0 * count + cells, rows, threads: 0.0 }
    }

    /// Excess of the rows when split into as many parts (bytes).
    fn rounding(&self, ranks: f64) -> f64 {
        let [rows, bytes] = self.rows;
        rows * (ranks * column_memory(bytes / ranks) - column_memory(bytes))
    }
}

impl MemoryForecast {
    /// Returns the forecast for another crew than one rank. Processes may run on different machines, so theirs is the most that one process needs.
    #[must_use]
    pub fn for_crew(self, crew: RankBackend) -> MemoryForecast {
        let (more, threads) = match crew {
            RankBackend::One | RankBackend::Threads(..=1) => return self,
            RankBackend::Threads(count) => {
                let (ranks, others) = (&self.ranks, (count - 1) as f64);
                let threads = others * (rayon::current_num_threads() + 1) as f64 * THREAD;
                (ranks.gathered + others * ranks.each + ranks.rounding(count as f64), threads)
            }
            RankBackend::Processes(_) => (self.ranks.gathered, 0.0),
        };
        MemoryForecast {
            needed: self.needed + more as u64,
            ranks: RankMemory { threads, ..self.ranks },
            ..self
        }
    }

    /// Returns the forecast with another run in the same process.
    #[must_use]
    pub fn with_concurrent(self, other: &MemoryForecast) -> MemoryForecast {
        let needed = self.needed + other.needed.saturating_sub(PROGRAM as u64);
        let what = match self.what == other.what {
            true => format!("{}, twice,", self.what),
            false => format!("{} beside one of {}", self.what, other.what),
        };
        MemoryForecast { needed, what, ..self }
    }

    /// Checks that the run fits into the available memory; `scene` is its name in an error.
    ///
    /// # Errors
    /// [`InputErrors`] with both numbers if the run does not fit.
    pub fn fits(&self, scene: &str) -> Result<(), InputErrors> {
        let MemoryForecast { needed, available, what, remedy, ranks } = self;
        // Stacks reserve address space and use little of it.
        let of_threads = |by| if by == MemoryLimit::AddressSpace { ranks.threads as u64 } else { 0 };
        match *available {
            Some(Available { bytes, by }) if *needed + of_threads(by) > bytes => {
                let needed = &(needed + of_threads(by));
                let spot = Spot { file: scene.to_owned(), place: None };
                let message = format!(
                    "a run of {what} takes {needed} bytes of memory ({}); {} has {bytes} left ({})",
                    in_words(*needed),
                    by.in_words(),
                    in_words(bytes)
                );
                Err(spot.error(MistakeKind::Memory, message).advising(*remedy).into())
            }
            _ => Ok(()),
        }
    }
}

/// Formats bytes for people.
pub fn in_words(bytes: u64) -> String {
    match bytes as f64 {
        few if few < 1e9 => format!("{:.0} MB", few / 1e6),
        many => format!("{:.1} GB", many / 1e9),
    }
}

/// Memory that this program may still take.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Available {
    /// Number of bytes.
    pub bytes: u64,
    /// Limit that applies.
    pub by: MemoryLimit,
}

impl Serialize for Available {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_u64(self.bytes)
    }
}

/// Limit on the memory of a program.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MemoryLimit {
    /// The machine's memory.
    Machine,
    /// The share of a control group.
    ControlGroup,
    /// The address space of a process (RLIMIT_AS).
    AddressSpace,
    /// The data of a process (RLIMIT_DATA).
    Data,
}

impl MemoryLimit {
    /// Limit as the subject of a sentence.
    pub fn in_words(self) -> &'static str {
        match self {
            MemoryLimit::Machine => "this machine",
            MemoryLimit::ControlGroup => "the control group of this process",
            MemoryLimit::AddressSpace => "the limit of the address space (ulimit -v)",
            MemoryLimit::Data => "the limit of the data of a process (ulimit -d)",
        }
    }
}

/// Memory that a program may take without displacing others or being refused: the system's available memory, or less if control groups or process
/// limits leave less. None where the system does not report it.
pub(crate) fn available() -> Option<Available> {
    let meminfo = fs::read_to_string("/proc/meminfo").ok()?;
    let of_machine = Available { bytes: kibibytes(&meminfo, "MemAvailable:")?, by: MemoryLimit::Machine };
    let of_groups =
        left_of_groups().into_iter().map(|bytes| Available { bytes, by: MemoryLimit::ControlGroup });
    let all = of_groups.chain(left_of_process()).chain([of_machine]);
    all.min_by_key(|available| available.bytes)
}

/// Address space that the allocator reserves when a thread first allocates (bytes); any thread may do so at any time.
const RESERVED: u64 = 1 << 26;

/// Memory that the limits of this process leave.
#[expect(clippy::disallowed_methods, reason = "a system that does not report its limits has no known ones")]
fn left_of_process() -> impl Iterator<Item = Available> {
    let [limits, status] =
        ["/proc/self/limits", "/proc/self/status"].map(|file| fs::read_to_string(file).unwrap_or_default());
    let of = [
        (MemoryLimit::AddressSpace, "Max address space", "VmSize:", RESERVED),
        (MemoryLimit::Data, "Max data size", "VmData:", 0),
    ];
    of.into_iter().filter_map(move |(by, limit, used, reserved)| {
        let (limit, used) = (soft_limit(&limits, limit)?, kibibytes(&status, used)?);
        Some(Available { bytes: limit.saturating_sub(used).saturating_sub(reserved), by })
    })
}

/// Soft limit of a name (bytes); none where there is no limit.
fn soft_limit(limits: &str, name: &str) -> Option<u64> {
    limits.lines().find_map(|line| line.strip_prefix(name))?.split_whitespace().next()?.parse().ok()
}

/// Memory that the control groups of this process leave, from its own up to the root.
#[expect(clippy::disallowed_methods, reason = "a system without control groups has no limits by them")]
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

/// Peak memory of this process (bytes), where the system reports it (Linux: `VmHWM`).
pub fn peak() -> Option<u64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find(|line| line.starts_with("VmHWM:"))?;
    Some(line.split_whitespace().nth(1)?.parse::<u64>().ok()? * 1024)
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

    #[test]
    fn limits_are_read_by_their_name() {
        let text = "Limit                     Soft Limit           Hard Limit           Units     \n\
                    Max data size             unlimited            unlimited            bytes     \n\
                    Max address space         409600000            unlimited            bytes     \n";
        assert_eq!(soft_limit(text, "Max address space"), Some(409_600_000));
        assert_eq!(soft_limit(text, "Max data size"), None);
        assert_eq!(soft_limit(text, "Max of nothing"), None);
    }
}
