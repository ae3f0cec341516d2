//! Event queue: the time of each disc's next event, and the order of the events.
//!
//! Only the next few events are sorted. All others are grouped, with a lower bound of the times in each group. The next event is
//! therefore known long before the current one is finished, and the processor overlaps both.

use stripmine_kernels::backend::Registers;
use stripmine_kernels::isa::{AlignedColumn, Vector};

/// Members of a group: two cache lines.
const GROUP: usize = 16;

/// Maximum number of events sorted at a time: a few times the prefetch distance.
const MOST_WANTED: usize = 256;

/// Time span of the first sorted events. It adapts quickly to the desired number, whatever the unit of time.
const SHORTEST: f64 = f64::MIN_POSITIVE;

/// Times of a group.
#[derive(Clone, Copy, Debug)]
#[repr(align(64))]
struct TimeGroup([f64; GROUP]);

impl TimeGroup {
    const NONE: TimeGroup = TimeGroup([f64::INFINITY; GROUP]);

    /// Bit mask of the members below a bound.
    #[inline(always)]
    fn below<R: Registers<Lane = f64>>(&self, registers: R, bound: f64) -> u32 {
        let bound = registers.splat(bound);
        let mut bits = 0;
        for begin in (0..GROUP).step_by(R::LANES) {
            // SAFETY: a group is a whole number of registers.
            let some = unsafe { registers.load(self.0.as_ptr().add(begin)) };
            bits |= registers.bits(some.less_than(bound)) << begin;
        }
        bits as u32
    }

    /// Smallest member that is not below a bound.
    #[inline(always)]
    fn smallest_from<R: Registers<Lane = f64>>(&self, registers: R, bound: f64) -> f64 {
        let (bound, never) = (registers.splat(bound), registers.splat(f64::INFINITY));
        let mut least = never;
        for begin in (0..GROUP).step_by(R::LANES) {
            // SAFETY: a group is a whole number of registers.
            let some = unsafe { registers.load(self.0.as_ptr().add(begin)) };
            least = least.min(R::V::select(some.less_than(bound), never, some));
        }
        let mut lanes = [f64::INFINITY; 8];
        // SAFETY: a register of numbers of 64 bits has eight lanes at most.
        unsafe { registers.store(lanes.as_mut_ptr(), least) };
        let least = |a: f64, b: f64| if b < a { b } else { a };
        let [a, b, c, d, e, f, g, h] = lanes;
        least(least(least(a, e), least(c, g)), least(least(b, f), least(d, h)))
    }
}

/// Sorted event.
#[derive(Clone, Copy, Debug)]
struct QueuedEvent {
    /// Time of the event.
    time: f64,
    /// Index of the disc in memory.
    slot: u32,
}

impl QueuedEvent {
    /// No event; sorts last.
    const NONE: QueuedEvent = QueuedEvent { time: f64::INFINITY, slot: 0 };
}

/// Order of a disc's event among those at the same time.
pub(super) trait Rank: Fn(u32) -> [u32; 2] {}

impl<F: Fn(u32) -> [u32; 2]> Rank for F {}

#[derive(Clone, Debug)]
pub(crate) struct EventQueue {
    /// Times, and above them, level by level, lower bounds of each group, which exclude the sorted events.
    levels: Vec<AlignedColumn<TimeGroup>>,
    /// Sorted next events, and how many are over. An entry is stale if its disc has another time now.
    next: Vec<QueuedEvent>,
    over: usize,
    /// All events before this time are sorted.
    end: f64,
    /// Time span of the sorted events, and their desired number.
    span: f64,
    wanted: usize,
    /// Scratch of the search: groups of each level with members, indices of their discs, and their times.
    visited: Vec<Vec<u32>>,
    found: Vec<u32>,
    times: Vec<f64>,
}

impl EventQueue {
    /// Creates the queue of `count` discs without events.
    pub(super) fn new(count: usize) -> EventQueue {
        let groups = |members: usize, level| {
            AlignedColumn::filled(level, TimeGroup::NONE, members.div_ceil(GROUP).max(1))
        };
        let mut levels = vec![groups(count, 3)];
        while let Some(last) = levels.last().filter(|last| last.len() > 1) {
            let above = groups(last.len(), 3 + levels.len());
            levels.push(above);
        }
        let wanted = ((count as f64).sqrt() as usize).clamp(8, MOST_WANTED);
        EventQueue {
            visited: vec![vec![]; levels.len()],
            levels,
            next: vec![],
            over: 0,
            end: 0.0,
            span: SHORTEST,
            wanted,
            found: vec![],
            times: vec![],
        }
    }

    /// Removes all events.
    pub(super) fn clear(&mut self) {
        self.levels.iter_mut().for_each(|level| level.fill(TimeGroup::NONE));
        self.next.clear();
        (self.over, self.end, self.span) = (0, 0.0, SHORTEST);
    }

    /// Time of each disc's next event, padded with infinities.
    #[inline(always)]
    pub(super) fn times(&self) -> &[f64] {
        let groups = &self.levels[0];
        // SAFETY: a group consists of its numbers, has their total size and a stricter alignment.
        unsafe { std::slice::from_raw_parts(groups.as_ptr().cast::<f64>(), groups.len() * GROUP) }
    }

    /// Sets the time (at least 0) of a disc's next event; `rank` orders events at the same time.
    #[inline(always)]
    pub(super) fn set(&mut self, disc: u32, time: f64, rank: impl Rank) {
        let mut slot = disc as usize;
        self.levels[0][slot / GROUP].0[slot % GROUP] = time;
        if time < self.end {
            return self.insert(QueuedEvent { time, slot: disc }, rank);
        }
        for level in &mut self.levels[1..] {
            slot /= GROUP;
            let known = &mut level[slot / GROUP].0[slot % GROUP];
            if time >= *known {
                return;
            }
            *known = time;
        }
    }

    #[cold]
    #[inline(never)]
    fn insert(&mut self, entry: QueuedEvent, rank: impl Rank) {
        let is_before = |other: &QueuedEvent| {
            other.time < entry.time || other.time == entry.time && rank(other.slot) < rank(entry.slot)
        };
        let at = self.over + self.next[self.over..].partition_point(is_before);
        self.next.insert(at, entry);
    }

    /// Returns the time of the first event and the index of its disc; of several at one time, the one with the smallest rank.
    #[inline(always)]
    pub(super) fn first<R: Registers<Lane = f64>>(
        &mut self,
        registers: R,
        rank: impl Rank,
    ) -> Option<(f64, u32)> {
        loop {
            while let Some(&QueuedEvent { time, slot, .. }) = self.next.get(self.over) {
                if self.times()[slot as usize] == time {
                    return Some((time, slot));
                }
                self.over += 1;
            }
            if !self.fill(registers, &rank) {
                return None;
            }
        }
    }

    /// Prefetches the cache line of a disc's time.
    #[inline(always)]
    pub(crate) fn prefetch(&self, slot: usize) {
        self.levels[0].prefetch(slot / GROUP);
    }

    /// Time of the event that is `ahead` events after the next one, and index of its disc, if it is sorted already.
    #[inline(always)]
    pub(crate) fn upcoming(&self, ahead: usize) -> Option<(f64, u32)> {
        self.next.get(self.over + ahead).map(|entry| (entry.time, entry.slot))
    }

    /// Sorts the next events. Returns false if none are left.
    #[inline(always)]
    fn fill<R: Registers<Lane = f64>>(&mut self, registers: R, rank: &impl Rank) -> bool {
        let top = self.levels.len() - 1;
        let begin = self.levels[top][0].smallest_from(registers, f64::NEG_INFINITY).max(self.end);
        if begin == f64::INFINITY {
            return false;
        }
        self.end = (begin + self.span).max(begin.next_up());
        self.over = 0;
        self.find(registers);
        self.sort(registers, rank);
        match self.next.len() {
            few if few < self.wanted / 2 => self.span *= 1.5,
            many if many > 2 * self.wanted => self.span *= 0.7,
            _ => {}
        }
        true
    }

    /// Finds all events before the end, from the top level down, and updates the lower bounds of the others from the bottom
    /// up.
    #[inline(always)]
    fn find<R: Registers<Lane = f64>>(&mut self, registers: R) {
        let EventQueue { levels, visited, found, end, .. } = self;
        let top = levels.len() - 1;
        visited[top].clear();
        visited[top].push(0);
        for level in (0..=top).rev() {
            let (below, here) = visited.split_at_mut(level);
            let into = below.last_mut().unwrap_or(found);
            into.clear();
            for &group in &here[0] {
                let mut members = levels[level][group as usize].below(registers, *end);
                while members != 0 {
                    let member = GROUP as u32 * group + members.trailing_zeros();
                    if let Some(below) = level.checked_sub(1) {
                        levels[below].prefetch(member as usize);
                    }
                    into.push(member);
                    members &= members - 1;
                }
            }
        }
        for level in 0..top {
            let (here, above) = levels.split_at_mut(level + 1);
            for &group in &visited[level] {
                let group = group as usize;
                let least = here[level][group].smallest_from(registers, *end);
                above[0][group / GROUP].0[group % GROUP] = least;
            }
        }
    }

    /// Sorts the found events. The index of each is the number of earlier ones, counted a register at a time without
    /// unpredictable branches.
    #[inline(always)]
    fn sort<R: Registers<Lane = f64>>(&mut self, registers: R, rank: &impl Rank) {
        let mut times = std::mem::take(&mut self.times);
        times.clear();
        times.extend(self.found.iter().map(|&slot| self.times()[slot as usize]));
        times.resize(self.found.len().next_multiple_of(R::LANES), f64::INFINITY);
        self.next.clear();
        self.next.resize(self.found.len(), QueuedEvent::NONE);
        let mut has_ties = false;
        for (&time, &slot) in times.iter().zip(&self.found) {
            let own = registers.splat(time);
            let mut before = 0;
            for begin in (0..times.len()).step_by(R::LANES) {
                // SAFETY: the times are a whole number of registers.
                let some = unsafe { registers.load(times.as_ptr().add(begin)) };
                before += registers.bits(some.less_than(own)).count_ones() as usize;
            }
            // Events at one time take the indices in the order in which they were found, until they are ranked below.
            while self.next[before].time == time {
                has_ties = true;
                before += 1;
            }
            self.next[before] = QueuedEvent { time, slot };
        }
        self.times = times;
        if has_ties {
            self.order_ties(rank);
        }
    }

    /// Orders events at the same time by their ranks.
    #[cold]
    #[inline(never)]
    fn order_ties(&mut self, rank: &impl Rank) {
        for tied in self.next.chunk_by_mut(|a, b| a.time == b.time) {
            tied.sort_unstable_by_key(|event| rank(event.slot));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::RngExt;
    use stripmine_kernels::backend::Scalar;
    use stripmine_kernels::noise::{RandomPurpose, Stream};

    /// Compared with a linear search, with occasional equal times, as events occur and times change.
    #[test]
    fn queue_keeps_order_under_changes() {
        let mut stream = Stream::new(7, RandomPurpose::Test, 0);
        for count in [1usize, 2, 16, 17, 300, 5000] {
            let mut times = vec![f64::INFINITY; count];
            // Indices in reverse order.
            let rank = |slot: u32| [count as u32 - slot, 0];
            let mut queue = EventQueue::new(count);
            let mut now = 0.0;
            for _ in 0..3000 {
                for _ in 0..stream.random_range(1..4) {
                    let changed = stream.random_range(0..count);
                    times[changed] = match stream.random_range(0..20) {
                        0 => f64::INFINITY,
                        1 => now,
                        _ => now + f64::from(stream.random_range(0..200)) / 16.0,
                    };
                    queue.set(changed as u32, times[changed], rank);
                }
                let first = (0..count)
                    .filter(|&slot| times[slot] < f64::INFINITY)
                    .min_by(|&a, &b| times[a].total_cmp(&times[b]).then(b.cmp(&a)));
                let expected = first.map(|slot| (times[slot], slot as u32));
                assert_eq!(queue.first(Scalar::default(), rank), expected);
                assert_eq!(&queue.times()[..count], times);
                now = expected.map_or(now, |(time, _)| time);
            }
        }
    }
}
