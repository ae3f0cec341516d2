//! How much memory there is left for this program, who sets the limit, and whether a run fits into it.

use crate::input::{InputErrors, Reason, Spot};
use crate::ranks::Crew;
use serde::{Serialize, Serializer};
use std::fs;
use stripmine_kernels::isa::aligned_column::taken;

/// Bytes of the program itself: its text, its threads, its files.
pub(crate) const PROGRAM: f64 = 17.0e6;

/// What a run needs and what there is (bytes).
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Foreseen {
    /// The most that the run takes at one time.
    pub needed: u64,
    /// What there is left; none where the system does not say.
    pub available: Option<Available>,
    /// What the run is of, in words.
    #[serde(skip)]
    pub what: String,
    /// What takes less.
    #[serde(skip)]
    pub remedy: &'static str,
    /// What several ranks take beside it.
    #[serde(skip)]
    pub ranks: OfRanks,
}

/// What ranks take beside what one of them would take alone (bytes).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct OfRanks {
    /// Where discs are gathered, on the first rank.
    pub(crate) gathered: f64,
    /// What every rank holds of the whole scene, whatever its own part.
    pub each: f64,
    /// How many rows of all discs there are, and how long one is: each rank has those of its own, rounded up.
    pub rows: [f64; 2],
    /// Address space of their threads.
    pub threads: f64,
}

/// Address space that a thread takes: its stack, and pages that short arrays of it share.
const THREAD: f64 = (2 << 20) as f64 + (4 << 20) as f64;

impl OfRanks {
    /// Of `count` discs in bands, with cells of which every rank has all (bytes), and rows of the discs.
    pub(crate) fn in_bands(count: f64, cells: f64, rows: [f64; 2]) -> OfRanks {
        // Seven words a disc on their way, and six where they have arrived. Its row, the periods that it has crossed; the rest is what allocators of
        // several threads keep, as measured.
        OfRanks { gathered: 8.0 * (7.0 + 6.0) * count, each: 50.0 * count + cells, rows, threads: 0.0 }
    }

    /// By how much more the rows take in as many parts (bytes).
    fn rounding(&self, ranks: f64) -> f64 {
        let [rows, bytes] = self.rows;
        rows * (ranks * taken(bytes / ranks) - taken(bytes))
    }
}

impl Foreseen {
    /// The same where a run is carried out by others than one rank. Of processes, each may be on a machine of its own: what one of them takes at most.
    #[must_use]
    pub fn on(self, crew: Crew) -> Foreseen {
        let (more, threads) = match crew {
            Crew::One | Crew::Threads(..=1) => return self,
            Crew::Threads(count) => {
                let (ranks, others) = (&self.ranks, (count - 1) as f64);
                let threads = others * (rayon::current_num_threads() + 1) as f64 * THREAD;
                (ranks.gathered + others * ranks.each + ranks.rounding(count as f64), threads)
            }
            Crew::Processes(_) => (self.ranks.gathered, 0.0),
        };
        Foreseen { needed: self.needed + more as u64, ranks: OfRanks { threads, ..self.ranks }, ..self }
    }

    /// The same with another run under way in the same process.
    #[must_use]
    pub fn beside(self, other: &Foreseen) -> Foreseen {
        let needed = self.needed + other.needed.saturating_sub(PROGRAM as u64);
        let what = match self.what == other.what {
            true => format!("{}, twice,", self.what),
            false => format!("{} beside one of {}", self.what, other.what),
        };
        Foreseen { needed, what, ..self }
    }

    /// Whether the run fits this machine; `scene` is the name that an error gives it.
    ///
    /// # Errors
    /// [`InputErrors`] with both numbers, where it does not.
    pub fn fits(&self, scene: &str) -> Result<(), InputErrors> {
        let Foreseen { needed, available, what, remedy, ranks } = self;
        // Stacks are address space, of which little is ever taken.
        let of_threads = |by| if by == Limit::AddressSpace { ranks.threads as u64 } else { 0 };
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

/// Bytes that this program may still take.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Available {
    /// How many.
    pub bytes: u64,
    /// What sets the limit.
    pub by: Limit,
}

impl Serialize for Available {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_u64(self.bytes)
    }
}

/// What limits the memory of a program.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Limit {
    /// The machine's memory.
    Machine,
    /// The share of a control group.
    ControlGroup,
    /// The address space of a process (RLIMIT_AS).
    AddressSpace,
    /// The data of a process (RLIMIT_DATA).
    Data,
}

impl Limit {
    /// As the subject of a sentence.
    pub fn in_words(self) -> &'static str {
        match self {
            Limit::Machine => "this machine",
            Limit::ControlGroup => "the control group of this process",
            Limit::AddressSpace => "the limit of the address space (ulimit -v)",
            Limit::Data => "the limit of the data of a process (ulimit -d)",
        }
    }
}

/// What a program may still take without pushing others out or being refused: what the system calls available, or what the
/// shares of its control groups or its own limits leave, if that is less. None where the system does not say.
pub(crate) fn available() -> Option<Available> {
    let meminfo = fs::read_to_string("/proc/meminfo").ok()?;
    let of_machine = Available { bytes: kibibytes(&meminfo, "MemAvailable:")?, by: Limit::Machine };
    let of_groups = left_of_groups().into_iter().map(|bytes| Available { bytes, by: Limit::ControlGroup });
    let all = of_groups.chain(left_of_process()).chain([of_machine]);
    all.min_by_key(|available| available.bytes)
}

/// Bytes of address space that the allocator reserves for a thread when it first asks for memory: one may do so at any time.
const RESERVED: u64 = 1 << 26;

/// What the limits of this process leave.
#[expect(
    clippy::disallowed_methods,
    reason = "a system that does not say its limits has none that are known"
)]
fn left_of_process() -> impl Iterator<Item = Available> {
    let [limits, status] =
        ["/proc/self/limits", "/proc/self/status"].map(|file| fs::read_to_string(file).unwrap_or_default());
    let of = [
        (Limit::AddressSpace, "Max address space", "VmSize:", RESERVED),
        (Limit::Data, "Max data size", "VmData:", 0),
    ];
    of.into_iter().filter_map(move |(by, limit, used, reserved)| {
        let (limit, used) = (soft_limit(&limits, limit)?, kibibytes(&status, used)?);
        Some(Available { bytes: limit.saturating_sub(used).saturating_sub(reserved), by })
    })
}

/// The soft limit of a name (bytes); none where there is no limit.
fn soft_limit(limits: &str, name: &str) -> Option<u64> {
    limits.lines().find_map(|line| line.strip_prefix(name))?.split_whitespace().next()?.parse().ok()
}

/// What the shares of the control groups of this process leave, from its own up to the root.
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

/// The most memory that this process has had (bytes), where the system gives it (Linux: `VmHWM`).
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
