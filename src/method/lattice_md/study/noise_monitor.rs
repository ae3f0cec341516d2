//! Whether other programs use the core at the moment. Today's hosts share their cores: for parts of a millisecond a core is
//! ours alone, and in between another program slows it down by half or more. A reference loop, a fixed piece of work, is
//! timed beside every sample. Undisturbed, it takes the same time to within some per cent, on every day. Samples are
//! therefore taken, or corrected, by what the reference loop took beside them.
//!
//! The reference loop keeps loads and arithmetic busy at once. Two other loops were tried and rejected. A chain of
//! dependent arithmetic takes the same time at all times, because it leaves most of the core to the other program. A
//! stream from memory varies more than the work that is measured.

use crate::statistics::quantile;
use std::cell::RefCell;
use std::hint::black_box;
use std::time::Instant;
use stripmine_kernels::probe::{Probe, probed};

/// Numbers that the reference loop reads: few, so that they stay in the first-level cache.
static NUMBERS: [f64; 256] = [1.0; 256];
/// Where it reads them.
static PLACES: [u8; 1000] = places();
/// Runs of the reference loop in a reading.
const RUNS: usize = 3;
/// By how much, as a share, a reading may exceed the reference for the core to count as undisturbed. After work on wide
/// registers a core is some per cent slower for a while by itself; another program on it costs about half.
const NEAR: f64 = 0.08;

const fn places() -> [u8; 1000] {
    let mut places = [0; 1000];
    let mut at = 0;
    while at < places.len() {
        // Knuth's multiplicative hash.
        places[at] = ((at as u32).wrapping_mul(2_654_435_761) >> 24) as u8;
        at += 1;
    }
    places
}

/// Runs the reference loop some times (ns, of one run).
fn reading() -> f64 {
    let run = |_| {
        let start = Instant::now();
        black_box(work(black_box(&PLACES), black_box(&NUMBERS)));
        start.elapsed().as_nanos() as f64
    };
    // The first run fills the caches and the branch predictors.
    run(0);
    (0..RUNS).map(run).sum::<f64>() / RUNS as f64
}

/// Distances between numbers, and sums over some of them: what a walk through a neighbour list does.
#[inline(never)]
fn work(places: &[u8; 1000], numbers: &[f64; 256]) -> f64 {
    let [mut near, mut far] = [0.0; 2];
    for &place in places {
        let (x, y) = (numbers[usize::from(place)], numbers[usize::from(place ^ 85)]);
        let square = x * x + y * y;
        if square < 1.5 {
            near += square.sqrt() * x;
        } else {
            far += y;
        }
        near += x - y;
    }
    near + far
}

/// A time, and the readings before and after.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Timed {
    /// Nanoseconds.
    pub ns: f64,
    /// Readings of the reference loop before and after (ns).
    pub around: [f64; 2],
}

impl Timed {
    /// How many times as slow the host was as where the reference loop takes `reference`.
    pub fn slowdown(&self, reference: f64) -> f64 {
        0.5 * (self.around[0] + self.around[1]) / reference
    }

    /// Whether the host was undisturbed before and after: the reference loop took about `reference`.
    pub fn was_quiet(&self, reference: f64) -> bool {
        self.around.iter().all(|&reading| is_quiet(reading, reference))
    }
}

fn is_quiet(reading: f64, reference: f64) -> bool {
    reading <= (1.0 + NEAR) * reference
}

/// Watches how much other programs disturb the host, by all readings so far.
#[derive(Clone, Debug)]
pub struct NoiseMonitor {
    /// The shortest readings.
    shortest: [f64; 3],
    /// Readings before and after samples: undisturbed more often than not.
    readings: Vec<f64>,
    /// Readings within long runs, which do not wait for an undisturbed core.
    within: Vec<f64>,
    /// Moving average of the readings, and the time of the last one.
    lately: f64,
    last: Instant,
    /// Nanoseconds spent on waiting, and when this count began.
    waited: f64,
    since: Instant,
}

/// Time constant of the moving average (ns).
const LATELY: f64 = 1e6;
/// A wait is given up after this multiple of the duration of the work, but not before this time (ns).
const PATIENCE: (f64, f64) = (2.0, 4e6);
/// This many undisturbed samples are enough.
pub const ENOUGH: usize = 16;
/// The largest share of the time that is spent on waiting.
const WAITING: f64 = 0.5;
/// The quantile of the readings that is taken as the reference. On most hosts a larger share is undisturbed, and those take
/// equal times; chance does not make this share of them too short.
const QUIET: f64 = 0.02;

impl Default for NoiseMonitor {
    fn default() -> NoiseMonitor {
        NoiseMonitor {
            shortest: [f64::INFINITY; 3],
            readings: vec![],
            within: vec![],
            lately: f64::NAN,
            last: Instant::now(),
            waited: 0.0,
            since: Instant::now(),
        }
    }
}

impl NoiseMonitor {
    /// A reading, or the moving average if that is longer: a program that was on the core shortly before has left its data in
    /// the caches.
    fn smoothed(&mut self, reading: f64, at: Instant) -> f64 {
        let passed = at.duration_since(self.last).as_nanos() as f64;
        self.last = at;
        let new = if self.lately.is_nan() { 1.0 } else { 1.0 - (-passed / LATELY).exp() };
        let before = if self.lately.is_nan() { reading } else { self.lately };
        self.lately = before + new * (reading - before);
        reading.max(self.lately)
    }

    fn reading(&mut self) -> f64 {
        let reading = reading();
        let smoothed = self.smoothed(reading, Instant::now());
        if let Some(at) = self.shortest.iter().position(|&shortest| reading < shortest) {
            self.shortest[at..].rotate_right(1);
            self.shortest[at] = reading;
        }
        smoothed
    }

    /// Waits until the core is undisturbed before work that takes about `lasting` nanoseconds, unless there are enough
    /// undisturbed samples or it takes too long. Returns whether it waited: the caches may then hold another program's data.
    pub fn wait(&mut self, quiet: usize, lasting: f64) -> bool {
        if quiet >= ENOUGH {
            return false;
        }
        let start = Instant::now();
        let patience = PATIENCE.1.max(PATIENCE.0 * lasting);
        let left = WAITING * self.since.elapsed().as_nanos() as f64 - self.waited;
        let mut readings = 0;
        loop {
            let reading = self.reading();
            readings += 1;
            let waited = start.elapsed().as_nanos() as f64;
            // A single reading that is too short by chance does not count.
            if is_quiet(reading, self.shortest[2]) || waited > left.min(patience) {
                self.waited += waited;
                return readings > 1;
            }
        }
    }

    /// Does some short work, and counts it if the core was undisturbed. Returns the readings before and after it too.
    pub fn around<T>(&mut self, quiet: &mut usize, work: impl FnOnce() -> T) -> (T, [f64; 2]) {
        let before = self.reading();
        let result = work();
        let around = [before, self.reading()];
        self.readings.extend(around);
        *quiet += usize::from(around.iter().all(|&reading| is_quiet(reading, self.shortest[2])));
        (result, around)
    }

    /// Does some long work, and times its segments between probes, each with the number of the work that it belongs to. Counts
    /// the work if nearly all segments were undisturbed.
    pub fn in_segments<T>(
        &mut self,
        quiet: &mut usize,
        work: impl FnOnce() -> T,
    ) -> (T, Vec<(usize, Timed)>) {
        let result = probed(record, work);
        let recorded = RECORDED.take();
        self.within.extend(recorded.iter().map(|(_, _, reading, _)| reading));
        let recorded: Vec<_> = recorded
            .into_iter()
            .map(|(rest, rested, reading, went_on)| (rest, rested, self.smoothed(reading, went_on), went_on))
            .collect();
        let mut number = None;
        let mut segments = vec![];
        for pair in recorded.windows(2) {
            let [(rest, _, before, went_on), (_, rested, after, _)] = [pair[0], pair[1]];
            match rest {
                Probe::Begins(begun) => number = Some(begun),
                Probe::Ends(_) => number = None,
                Probe::Within => {}
            }
            let ns = rested.duration_since(went_on).as_nanos() as f64;
            segments.extend(number.map(|number| (number, Timed { ns, around: [before, after] })));
        }
        let noisy = segments.iter().filter(|(_, timed)| !timed.was_quiet(self.shortest[2])).count();
        *quiet += usize::from(10 * noisy <= segments.len());
        (result, segments)
    }

    /// What the reference loop takes undisturbed (ns).
    pub fn reference(&self) -> f64 {
        let all = self.readings.iter().chain(&self.within);
        quantile(&rising(all), QUIET).unwrap_or(f64::NAN)
    }

    /// How many times as long it takes in the median, where nothing waits for an undisturbed core.
    pub fn usual_slowdown(&self) -> f64 {
        quantile(&rising(self.within.iter()), 0.5).unwrap_or(f64::NAN) / self.reference()
    }
}

fn rising<'a>(values: impl Iterator<Item = &'a f64>) -> Vec<f64> {
    let mut values: Vec<f64> = values.copied().collect();
    values.sort_by(f64::total_cmp);
    values
}

thread_local! {
    /// The probes of a run: which, when it was reached, the reading there, and when the run went on.
    static RECORDED: RefCell<Vec<(Probe, Instant, f64, Instant)>> = const { RefCell::new(vec![]) };
}

fn record(at: Probe) {
    let reached = Instant::now();
    let reading = reading();
    RECORDED.with_borrow_mut(|recorded| recorded.push((at, reached, reading, Instant::now())));
}

#[cfg(test)]
mod tests {
    use super::*;
    use stripmine_kernels::probe::probe;

    #[test]
    fn times_in_segments_belong_to_the_work_that_was_begun() {
        let mut monitor = NoiseMonitor::default();
        let ((), segments) = monitor.in_segments(&mut 0, || {
            for at in [Probe::Begins(1), Probe::Within, Probe::Ends(1), Probe::Begins(0), Probe::Ends(0)] {
                probe(at);
            }
        });
        assert_eq!(segments.iter().map(|(number, _)| *number).collect::<Vec<_>>(), [1, 1, 0]);
        assert!(segments.iter().all(|(_, timed)| timed.around.iter().all(|&reading| reading > 100.0)));
        assert_eq!(monitor.within.len(), 5);
    }

    #[test]
    fn a_low_quantile_is_the_reference_and_the_median_the_usual_slowdown() {
        let readings = |slow: usize| -> Vec<f64> {
            let slow = (0..slow).map(|i| 150.0 + i as f64 / 10.0);
            (0..40).map(|i| 100.0 + f64::from(i) / 100.0).chain(slow).collect()
        };
        let [few, many] =
            [10, 200].map(|slow| NoiseMonitor { within: readings(slow), ..NoiseMonitor::default() });
        for monitor in [&few, &many] {
            assert!((100.0..100.3).contains(&monitor.reference()), "{}", monitor.reference());
        }
        assert!(few.usual_slowdown() < 1.1 && many.usual_slowdown() > 1.4);
    }

    #[test]
    fn a_wait_ends_and_takes_no_more_than_its_share() {
        let mut monitor = NoiseMonitor::default();
        let sample = |_| {
            monitor.wait(0, 0.0);
            monitor.around(&mut 0, || ()).1
        };
        let samples: Vec<_> = (0..50).map(sample).collect();
        assert!(samples.iter().flatten().all(|&reading| reading > 100.0));
        assert!(monitor.shortest.is_sorted() && monitor.readings.len() == 100);
        // The core is never undisturbed.
        monitor.shortest = [1.0; 3];
        monitor.waited = f64::INFINITY;
        monitor.wait(0, 0.0);
        assert!(!monitor.wait(ENOUGH, 0.0) && monitor.around(&mut 0, || true).0);
    }
}
