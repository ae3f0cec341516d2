//! How fast is the host at the moment? A core of today is shared: for parts of a millisecond nobody else is on it, and in
//! between somebody is, and what keeps it busy takes half as long again or more. Beside every sample a yardstick is run, a
//! fixed piece of work. In quiet moments it takes always the same, to some parts in a hundred, whatever the day: that is the pace
//! at which all times are told.
//!
//! The yardstick keeps loads and arithmetic busy at once. Chains of arithmetic alone, each result waiting for the one
//! before, were tried: they take the same at all times, for a tenant on the same core takes what they leave. So was a
//! stream from memory, for work beyond the caches: it varies more than that work does.

use super::statistics::quantile;
use std::cell::RefCell;
use std::hint::black_box;
use std::time::Instant;
use stripmine_kernels::rests::{Rest, listening};

/// Numbers that the yardstick reads: few, so that they stay in the first-level cache.
static NUMBERS: [f64; 256] = [1.0; 256];
/// Where it reads them.
static PLACES: [u8; 1000] = places();
/// Runs of the yardstick in a reading.
const RUNS: usize = 3;
/// How far a reading may be from the reference, as a share, so that the moment was quiet: after work on wide registers a core
/// is some parts in a hundred slower for a while by itself; a neighbour makes it half as slow again.
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

/// Runs the yardstick some times (ns, of one run).
fn reading() -> f64 {
    let run = |_| {
        let start = Instant::now();
        black_box(work(black_box(&PLACES), black_box(&NUMBERS)));
        start.elapsed().as_nanos() as f64
    };
    // Something else was in the caches and the predictors before.
    run(0);
    (0..RUNS).map(run).sum::<f64>() / RUNS as f64
}

/// Distances between numbers here and there, and sums over some of them, as a list of neighbours is gone through.
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
    /// Readings of the yardstick before and after (ns).
    pub around: [f64; 2],
}

impl Timed {
    /// How much slower the host was than where the yardstick took `reference`.
    pub fn pace(&self, reference: f64) -> f64 {
        0.5 * (self.around[0] + self.around[1]) / reference
    }

    /// Whether the moment was as quiet as where the yardstick took `reference`, before and after.
    pub fn was_quiet(&self, reference: f64) -> bool {
        self.around.iter().all(|&reading| is_quiet(reading, reference))
    }
}

fn is_quiet(reading: f64, reference: f64) -> bool {
    reading <= (1.0 + NEAR) * reference
}

/// The pace of the host from moment to moment, by all readings so far.
#[derive(Clone, Debug)]
pub struct Pace {
    /// The shortest readings.
    shortest: [f64; 3],
    /// Readings before and after samples: in quiet moments more often than not.
    readings: Vec<f64>,
    /// Readings within long runs, which wait for nothing.
    within: Vec<f64>,
    /// What readings were lately, and when the last one was.
    lately: f64,
    last: Instant,
    /// Nanoseconds spent on waiting, and since when.
    waited: f64,
    since: Instant,
}

/// So many nanoseconds are lately.
const LATELY: f64 = 1e6;
/// A wait is given up after so many times what is waited for lasts, and no sooner than after so many nanoseconds.
const PATIENCE: (f64, f64) = (2.0, 4e6);
/// So many samples of a quiet moment are enough.
pub const ENOUGH: usize = 16;
/// Of all the time such a share at most is spent on waiting.
const WAITING: f64 = 0.5;
/// The share of readings below the one that is taken for a quiet moment's: on most hosts more are quiet, and those take all
/// the same; and no chance makes so many of them short.
const QUIET: f64 = 0.02;

impl Default for Pace {
    fn default() -> Pace {
        Pace {
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

impl Pace {
    /// What a reading at some moment says: itself, or what readings were lately if that is longer. Whoever was on the core
    /// then has left his own in its caches.
    fn heard(&mut self, reading: f64, at: Instant) -> f64 {
        let passed = at.duration_since(self.last).as_nanos() as f64;
        self.last = at;
        let new = if self.lately.is_nan() { 1.0 } else { 1.0 - (-passed / LATELY).exp() };
        let before = if self.lately.is_nan() { reading } else { self.lately };
        self.lately = before + new * (reading - before);
        reading.max(self.lately)
    }

    fn reading(&mut self) -> f64 {
        let reading = reading();
        let said = self.heard(reading, Instant::now());
        if let Some(at) = self.shortest.iter().position(|&shortest| reading < shortest) {
            self.shortest[at..].rotate_right(1);
            self.shortest[at] = reading;
        }
        said
    }

    /// Waits for a quiet moment before work that lasts about so many nanoseconds, if one comes soon and there are not enough
    /// samples in such moments yet. Whether it had to wait: then the caches may be another's.
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
            // One that was cut short by chance does not count.
            if is_quiet(reading, self.shortest[2]) || waited > left.min(patience) {
                self.waited += waited;
                return readings > 1;
            }
        }
    }

    /// Does some short work, and counts it if the moment was quiet; with the readings before and after it.
    pub fn around<T>(&mut self, quiet: &mut usize, work: impl FnOnce() -> T) -> (T, [f64; 2]) {
        let before = self.reading();
        let said = work();
        let around = [before, self.reading()];
        self.readings.extend(around);
        *quiet += usize::from(around.iter().all(|&reading| is_quiet(reading, self.shortest[2])));
        (said, around)
    }

    /// Does some long work, and times it from rest to rest: with the number of the work that each time belongs to. Counts it if
    /// nearly all of it was done in quiet moments.
    pub fn from_rest_to_rest<T>(
        &mut self,
        quiet: &mut usize,
        work: impl FnOnce() -> T,
    ) -> (T, Vec<(usize, Timed)>) {
        let said = listening(hear, work);
        let heard = HEARD.take();
        self.within.extend(heard.iter().map(|(_, _, reading, _)| reading));
        let heard: Vec<_> = heard
            .into_iter()
            .map(|(rest, rested, reading, went_on)| (rest, rested, self.heard(reading, went_on), went_on))
            .collect();
        let mut number = None;
        let mut pieces = vec![];
        for pair in heard.windows(2) {
            let [(rest, _, before, went_on), (_, rested, after, _)] = [pair[0], pair[1]];
            match rest {
                Rest::Begins(begun) => number = Some(begun),
                Rest::Ends(_) => number = None,
                Rest::Within => {}
            }
            let ns = rested.duration_since(went_on).as_nanos() as f64;
            pieces.extend(number.map(|number| (number, Timed { ns, around: [before, after] })));
        }
        let noisy = pieces.iter().filter(|(_, timed)| !timed.was_quiet(self.shortest[2])).count();
        *quiet += usize::from(10 * noisy <= pieces.len());
        (said, pieces)
    }

    /// What the yardstick takes in a quiet moment (ns).
    pub fn reference(&self) -> f64 {
        let all = self.readings.iter().chain(&self.within);
        quantile(&rising(all), QUIET).unwrap_or(f64::NAN)
    }

    /// How many times as long it takes mostly, where no quiet moment is waited for.
    pub fn mostly(&self) -> f64 {
        quantile(&rising(self.within.iter()), 0.5).unwrap_or(f64::NAN) / self.reference()
    }
}

fn rising<'a>(values: impl Iterator<Item = &'a f64>) -> Vec<f64> {
    let mut values: Vec<f64> = values.copied().collect();
    values.sort_by(f64::total_cmp);
    values
}

thread_local! {
    /// What was heard of a run: where it rested, when, the reading there, and when it went on.
    static HEARD: RefCell<Vec<(Rest, Instant, f64, Instant)>> = const { RefCell::new(vec![]) };
}

fn hear(rest: Rest) {
    let rested = Instant::now();
    let reading = reading();
    HEARD.with_borrow_mut(|heard| heard.push((rest, rested, reading, Instant::now())));
}

#[cfg(test)]
mod tests {
    use super::*;
    use stripmine_kernels::rests::rest;

    #[test]
    fn times_from_rest_to_rest_belong_to_the_work_that_was_begun() {
        let mut pace = Pace::default();
        let ((), pieces) = pace.from_rest_to_rest(&mut 0, || {
            for at in [Rest::Begins(1), Rest::Within, Rest::Ends(1), Rest::Begins(0), Rest::Ends(0)] {
                rest(at);
            }
        });
        assert_eq!(pieces.iter().map(|(number, _)| *number).collect::<Vec<_>>(), [1, 1, 0]);
        assert!(pieces.iter().all(|(_, timed)| timed.around.iter().all(|&reading| reading > 100.0)));
        assert_eq!(pace.within.len(), 5);
    }

    #[test]
    fn a_quiet_reading_is_the_reference_and_the_middle_one_what_it_is_mostly() {
        let readings = |slow: usize| -> Vec<f64> {
            let slow = (0..slow).map(|i| 150.0 + i as f64 / 10.0);
            (0..40).map(|i| 100.0 + f64::from(i) / 100.0).chain(slow).collect()
        };
        let [few, many] = [10, 200].map(|slow| Pace { within: readings(slow), ..Pace::default() });
        for pace in [&few, &many] {
            assert!((100.0..100.3).contains(&pace.reference()), "{}", pace.reference());
        }
        assert!(few.mostly() < 1.1 && many.mostly() > 1.4);
    }

    #[test]
    fn a_wait_ends_and_takes_no_more_than_its_share() {
        let mut pace = Pace::default();
        let sample = |_| {
            pace.wait(0, 0.0);
            pace.around(&mut 0, || ()).1
        };
        let samples: Vec<_> = (0..50).map(sample).collect();
        assert!(samples.iter().flatten().all(|&reading| reading > 100.0));
        assert!(pace.shortest.is_sorted() && pace.readings.len() == 100);
        // A moment that never comes.
        pace.shortest = [1.0; 3];
        pace.waited = f64::INFINITY;
        pace.wait(0, 0.0);
        assert!(!pace.wait(ENOUGH, 0.0) && pace.around(&mut 0, || true).0);
    }
}
