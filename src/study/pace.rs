//! How fast is the host at the moment? Beside every sample a yardstick is run, a fixed piece of work, so that times taken
//! at different moments can be told at one pace: other tenants of a processor change it.
//!
//! The yardstick keeps loads and arithmetic busy at once. Chains of arithmetic alone, each result waiting for the one
//! before, were tried: they take the same at all times, for a tenant on the same core takes what they leave. So was a
//! stream from memory, for work beyond the caches: it varies more than that work does.

use std::hint::black_box;
use std::time::Instant;

/// Numbers that the yardstick reads: few, so that they stay in the first-level cache.
static NUMBERS: [f64; 256] = [1.0; 256];
/// Where it reads them.
static PLACES: [u8; 3000] = places();
/// Passes over the places in a reading: some ten microseconds.
const PASSES: usize = 2;
/// How far the two readings around a steady sample may differ, as a share.
const UNSTEADY: f64 = 0.1;
/// How far the pace of a sample may be from the reference, as a share, where there are samples enough.
const NEAR: f64 = 0.1;
/// So many samples are enough.
const FEW: usize = 4;

const fn places() -> [u8; 3000] {
    let mut places = [0; 3000];
    let mut at = 0;
    while at < places.len() {
        // Knuth's multiplicative hash.
        places[at] = ((at as u32).wrapping_mul(2_654_435_761) >> 24) as u8;
        at += 1;
    }
    places
}

/// Runs the yardstick (ns).
pub fn reading() -> f64 {
    let start = Instant::now();
    (0..PASSES).for_each(|_| _ = black_box(work(black_box(&PLACES), black_box(&NUMBERS))));
    start.elapsed().as_nanos() as f64
}

/// Distances between numbers here and there, and sums over some of them, as a list of neighbours is gone through.
#[inline(never)]
fn work(places: &[u8; 3000], numbers: &[f64; 256]) -> f64 {
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

    fn is_steady(&self) -> bool {
        let [before, after] = self.around;
        (before - after).abs() <= UNSTEADY * before.min(after)
    }
}

/// The samples taken near the pace of a reference if there are some, else those nearest to it, for not everything is slowed
/// down alike; unsteady samples only where all are.
fn nearest(samples: &[Timed], reference: f64) -> Vec<&Timed> {
    let steady: Vec<&Timed> = samples.iter().filter(|sample| sample.is_steady()).collect();
    let mut usable = if steady.is_empty() { samples.iter().collect() } else { steady };
    let away = |sample: &Timed| sample.pace(reference).ln().abs();
    usable.sort_by(|a, b| away(a).total_cmp(&away(b)));
    let near = usable.iter().take_while(|sample| away(sample) <= NEAR).count();
    usable.truncate(near.max(FEW));
    usable
}

/// The times at the pace of a reference, rising, of the samples nearest to it.
pub fn at_pace(samples: &[Timed], reference: f64) -> Vec<f64> {
    let nearest = nearest(samples, reference).into_iter();
    let mut paced: Vec<f64> = nearest.map(|sample| sample.ns / sample.pace(reference)).collect();
    paced.sort_by(f64::total_cmp);
    paced
}

/// Whether there are samples enough near the pace of a reference, so that times need not be told at another pace than they
/// were taken at.
pub fn was_at_pace(samples: &[Timed], reference: f64) -> bool {
    let nearest = nearest(samples, reference);
    nearest.len() >= FEW && nearest.iter().all(|sample| sample.pace(reference).ln().abs() <= NEAR)
}

/// The value below which a share of rising values lies; none of none.
pub fn quantile(rising: &[f64], share: f64) -> Option<f64> {
    let last = rising.len().checked_sub(1)?;
    Some(rising[(share * last as f64).round() as usize])
}

/// The share of samples, told at one pace, that lie below the one that counts: what is rare on the one side and what is
/// disturbed on the other do not.
pub const COUNTS: f64 = 0.25;

#[cfg(test)]
mod tests {
    use super::*;

    fn timed(ns: f64, before: f64, after: f64) -> Timed {
        Timed { ns, around: [before, after] }
    }

    #[test]
    fn a_slow_moment_is_told_at_the_pace_of_the_reference() {
        let samples = [timed(100.0, 10.0, 10.0), timed(170.0, 17.0, 17.0), timed(126.0, 12.0, 13.2)];
        let paced = at_pace(&samples, 10.0);
        assert!(paced.iter().all(|ns| (ns - 100.0).abs() < 1e-9), "{paced:?}");
    }

    #[test]
    fn where_there_are_enough_only_samples_near_the_reference_count() {
        let near = [timed(100.0, 10.0, 10.0); FEW];
        let slow = [timed(300.0, 20.0, 20.0); 9];
        assert_eq!(at_pace(&[&slow[..], &near[..]].concat(), 10.0), [100.0; FEW]);
        let fewer = at_pace(&[&slow[..], &near[1..]].concat(), 10.0);
        assert_eq!(fewer, [100.0, 100.0, 100.0, 150.0]);
        assert!(was_at_pace(&near, 10.0) && !was_at_pace(&near[1..], 10.0) && !was_at_pace(&slow, 10.0));
    }

    #[test]
    fn unsteady_samples_count_only_where_there_are_no_others() {
        let (steady, unsteady) = (timed(100.0, 10.0, 10.0), timed(100.0, 10.0, 20.0));
        assert_eq!(at_pace(&[unsteady, steady], 10.0), [100.0]);
        assert_eq!(at_pace(&[unsteady], 10.0).len(), 1);
    }

    #[test]
    fn quantiles_are_values_that_were_there() {
        assert_eq!(
            [0.0, COUNTS, 1.0].map(|share| quantile(&[1.0, 2.0, 3.0, 4.0, 5.0], share)),
            [1.0, 2.0, 5.0].map(Some)
        );
        assert_eq!(quantile(&[], 0.5), None);
        assert!(reading() > 100.0);
    }
}
