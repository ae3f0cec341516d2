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
/// How far the pace of a sample may be from a reference, as a share, so that it was taken at that pace.
const NEAR: f64 = 0.1;
/// So many such samples are enough.
const FEW: usize = 4;
/// How far the paces of two samples are apart at least that tell how a time follows the pace, as a logarithm.
const APART: f64 = 0.1;
/// So many pairs of samples say beforehand that it goes with the pace itself: a few samples tell little.
const BEFOREHAND: usize = 50;
/// The highest power of the pace that is believed: what a neighbour slows down most goes with its square.
const HIGHEST: f64 = 2.5;

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
}

/// With which power of the pace the times of some work go: the median over pairs of samples (Theil and Sen's). A neighbour
/// on the same core slows down what keeps the core busy by more than the yardstick, and what waits for memory by less; and
/// what takes longer than the pace lasts follows two readings hardly at all.
fn power(samples: &[Timed]) -> f64 {
    let points: Vec<[f64; 2]> = samples
        .iter()
        .filter(|sample| sample.ns > 0.0)
        .map(|sample| [sample.pace(1.0).ln(), sample.ns.ln()])
        .collect();
    let pairs = points.iter().enumerate().flat_map(|(at, a)| points[..at].iter().map(move |b| (a, b)));
    let apart = pairs.filter(|(a, b)| (a[0] - b[0]).abs() > APART);
    let mut slopes: Vec<f64> = apart.map(|(a, b)| (a[1] - b[1]) / (a[0] - b[0])).collect();
    slopes.extend([1.0; BEFOREHAND]);
    let middle = slopes.len() / 2;
    slopes.select_nth_unstable_by(middle, f64::total_cmp).1.clamp(0.0, HIGHEST)
}

/// The times at the pace of a reference, rising.
pub fn at_pace(samples: &[Timed], reference: f64) -> Vec<f64> {
    let power = power(samples);
    let mut told: Vec<f64> =
        samples.iter().map(|sample| sample.ns / sample.pace(reference).powf(power)).collect();
    told.sort_by(f64::total_cmp);
    told
}

/// Whether there are samples enough near the pace of a reference, so that times need not be told at another pace than they
/// were taken at.
pub fn was_at_pace(samples: &[Timed], reference: f64) -> bool {
    samples.iter().filter(|sample| sample.pace(reference).ln().abs() <= NEAR).count() >= FEW
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
        let told = at_pace(&samples, 10.0);
        assert!(told.iter().all(|ns| (ns - 100.0).abs() < 1e-9), "{told:?}");
    }

    #[test]
    fn how_times_follow_the_pace_is_their_own() {
        for power in [0.3, 1.8] {
            let each = |i: i32| {
                let pace = 1.0 + 0.05 * f64::from(i % 10);
                timed(100.0 * pace.powf(power), 10.0 * pace, 10.0 * pace)
            };
            let mut samples: Vec<Timed> = (0..40).map(each).collect();
            // One that was interrupted says nothing of the others.
            samples.push(timed(9000.0, 15.0, 15.0));
            let told = at_pace(&samples, 12.0);
            let expected = 100.0 * 1.2_f64.powf(power);
            assert!(told[..40].iter().all(|ns| (ns / expected - 1.0).abs() < 0.02), "{power}: {told:?}");
        }
        // A few samples are believed less than what is known beforehand, and what cannot be is not believed of any.
        let few = [timed(100.0, 10.0, 10.0), timed(100.0, 20.0, 20.0), timed(100.0, 40.0, 40.0)];
        assert_eq!(at_pace(&few, 10.0), [25.0, 50.0, 100.0]);
        let wild: Vec<Timed> =
            (0..40).map(|at| timed(f64::from(1 << (at % 10)), 10.0 + f64::from(at % 10), 10.0)).collect();
        assert_eq!(power(&wild), HIGHEST);
    }

    #[test]
    fn a_few_samples_near_the_reference_are_enough() {
        let near = [timed(100.0, 10.0, 10.0); FEW];
        let slow = [timed(300.0, 20.0, 20.0); 9];
        assert!(was_at_pace(&near, 10.0) && was_at_pace(&[&slow[..], &near[..]].concat(), 10.0));
        assert!(!was_at_pace(&near[1..], 10.0) && !was_at_pace(&slow, 10.0));
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
