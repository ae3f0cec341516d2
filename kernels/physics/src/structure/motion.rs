//! Displacements across periodic sides and velocity correlations of discs: functions of the time between two samples.
//!
//! Lags are 0 to 7 samples, then 4 to 7 times each power of two. A sample is stored only as long as a lag needs it, so memory grows with the
//! logarithm of a run's length (the order-n algorithm of Frenkel and Smit, section 4.4.2, without coarse-graining).

use stripmine_kernels::backend::{RegisterTask, Registers, dispatch_best};

/// Number of lags of one power of two; the upper half is new.
const LAGS: u64 = 8;
/// Number of discs summed in parallel.
const LANES: usize = 4;
/// Number of powers of two.
const LEVELS: u32 = 16;

/// Square displacement |r(t) − r(0)|² (length²).
pub(super) fn square_displacement([x, y, _, _]: [f64; 4]) -> f64 {
    x + y
}

/// Product v(0)·v(t) (length²/time²).
pub(super) fn velocity_product([_, _, x, y]: [f64; 4]) -> f64 {
    x + y
}

/// Slope of a function between two lags.
pub(super) fn slope(lags: &[f64], values: &[f64], from: usize, to: usize) -> f64 {
    (values[to] - values[from]) / (lags[to] - lags[from])
}

/// Integral up to a lag by the trapezoidal rule.
pub(super) fn integral(lags: &[f64], values: &[f64], to: usize) -> f64 {
    let pairs = lags[..=to].windows(2).zip(values[..=to].windows(2));
    pairs.map(|(lag, value)| 0.5 * (lag[1] - lag[0]) * (value[0] + value[1])).sum()
}

/// Factor by which error bars exceed those of as many independent blocks of `length` samples, for a lag (samples) that is at most a block: pairs
/// that start in a block may end in the next one.
///
/// Squared displacements of free particles over intervals that overlap by a fraction f have the correlation f². With x the lag over the length, the
/// means of two consecutive blocks have ρ = (x²/12)/(2x/3 − x²/6), others none. The squared error of n of them is (1 + 2ρ)/(1 − 2ρ/n) times that of
/// n independent ones.
pub fn widening(lag: u64, length: u64, blocks: usize) -> f64 {
    let x = lag as f64 / length as f64;
    let correlation = x / (8.0 - 2.0 * x);
    ((1.0 + 2.0 * correlation) / (1.0 - 2.0 * correlation / blocks as f64)).sqrt()
}

/// Stored samples of discs: unwrapped positions and velocities; NaN where a disc is lost.
#[derive(Clone, Debug, PartialEq)]
pub struct MotionHistory {
    /// Number of discs.
    discs: usize,
    /// Number of samples so far.
    looks: u64,
    /// Times of the first and the last sample.
    times: [f64; 2],
    /// Stored samples in their order.
    kept: Vec<(u64, Vec<[f64; 4]>)>,
    /// Memory for later samples.
    spare: Vec<Vec<[f64; 4]>>,
}

impl MotionHistory {
    /// Motion of a number of discs, without samples.
    pub fn new(discs: usize) -> MotionHistory {
        MotionHistory { discs, looks: 0, times: [0.0; 2], kept: vec![], spare: vec![] }
    }

    /// Restores what [`MotionHistory::ends`] and [`MotionHistory::column`] returned; none if it does not fit the discs.
    pub(crate) fn restored(
        discs: usize,
        looks: u64,
        times: [f64; 2],
        column: &[f64],
    ) -> Option<MotionHistory> {
        let mut motion = MotionHistory::new(discs);
        let length = 1 + 4 * discs;
        let of = |row: &[f64]| {
            let (states, _) = row[1..].as_chunks::<4>();
            (row[0] as u64, states.to_vec())
        };
        if !column.len().is_multiple_of(length) {
            return None;
        }
        motion.kept = column.chunks(length).map(of).collect();
        (motion.looks, motion.times) = (looks, times);
        let ascends = motion.kept.is_sorted_by(|(a, _), (b, _)| a < b);
        let ends = motion.kept.last().map_or(0, |(look, _)| look + 1) == looks;
        (ascends && ends && motion.kept.iter().all(|(look, _)| is_kept(*look, looks))).then_some(motion)
    }

    /// Times of the first and the last sample.
    pub fn ends(&self) -> [f64; 2] {
        self.times
    }

    /// All stored samples in one column, each with its number.
    pub fn column(&self) -> Vec<f64> {
        let of = |(look, states): &(u64, Vec<[f64; 4]>)| {
            std::iter::once(*look as f64).chain(states.iter().flatten().copied()).collect::<Vec<f64>>()
        };
        self.kept.iter().flat_map(of).collect()
    }

    /// Number of samples so far.
    pub fn looks(&self) -> u64 {
        self.looks
    }

    /// All lags (samples).
    pub fn lags() -> impl ExactSizeIterator<Item = u64> {
        const NEW: u64 = LAGS / 2;
        (0..NEW as u32 * (LEVELS + 1)).map(|place| match u64::from(place).checked_sub(NEW) {
            None => u64::from(place),
            Some(place) => (NEW + place % NEW) << (place / NEW),
        })
    }

    /// All lags (time).
    pub fn times(&self) -> Vec<f64> {
        let between = (self.times[1] - self.times[0]) / (self.looks.max(2) - 1) as f64;
        MotionHistory::lags().map(|lag| lag as f64 * between).collect()
    }

    /// Largest number of samples stored after a number of them, about: eight, and half of seven for each power of two whose lags reach farther
    /// back.
    pub fn most_kept(looks: u64) -> u64 {
        let levels = (1..LEVELS).take_while(|level| (LAGS - 1) << (level - 1) < looks).count() as u64;
        looks.min(LAGS + (LAGS - 1) * levels / 2)
    }

    /// Adds a sample: unwrapped discs in the order of the scene, at a time. Passes each pair of samples separated by a lag to `meet`: the number of
    /// the earlier sample, the index of the lag, and the means over the discs of Δx², Δy² and the products of velocities along x and y. With the
    /// species of all discs, each species passes its own means beside those of all, with its number.
    pub fn add_sample(
        &mut self,
        discs: &[[f64; 4]],
        time: f64,
        species: &[u8],
        mut meet: impl FnMut(u64, usize, Option<usize>, [f64; 4]),
    ) {
        let largest = species.iter().max().map_or(0, |&largest| usize::from(largest) + 1);
        let mut states = self.spare.pop().unwrap_or_default();
        states.clear();
        states.extend_from_slice(discs);
        let look = self.looks;
        self.kept.push((look, states));
        self.looks += 1;
        if look == 0 {
            self.times[0] = time;
        }
        self.times[1] = time;
        let later = &self.kept[self.kept.len() - 1].1;
        for (place, lag) in MotionHistory::lags().enumerate() {
            let Some(earlier) = look.checked_sub(lag) else { break };
            // Only samples whose number is divisible by the lag's power of two are stored long enough.
            let Ok(at) = self.kept.binary_search_by_key(&earlier, |(look, _)| *look) else { continue };
            let before = &self.kept[at].1;
            if let Some(means) = means(before, later) {
                meet(earlier, place, None, means);
            }
            for own in 0..largest {
                if let Some(means) = means_of_species(before, later, species, own) {
                    meet(earlier, place, Some(own), means);
                }
            }
        }
        let looks = self.looks;
        for at in (0..self.kept.len()).rev() {
            if !is_kept(self.kept[at].0, looks) {
                self.spare.push(self.kept.remove(at).1);
            }
        }
    }
}

/// Means over the discs present in both samples.
fn means(earlier: &[[f64; 4]], later: &[[f64; 4]]) -> Option<[f64; 4]> {
    let mut sums = MotionSums { sums: [[0.0; 4]; LANES], count: 0 };
    // The dispatch selects an instruction set of this processor.
    dispatch_best(MotionTask { earlier, later, to: &mut sums });
    let total = |place: usize| sums.sums.iter().map(|lane| lane[place]).sum::<f64>();
    (sums.count > 0).then(|| [0, 1, 2, 3].map(|place| total(place) / sums.count as f64))
}

/// As [`means`], over the discs of a species.
fn means_of_species(
    earlier: &[[f64; 4]],
    later: &[[f64; 4]],
    species: &[u8],
    own: usize,
) -> Option<[f64; 4]> {
    let (mut sums, mut count) = ([0.0; 4], 0.0);
    let discs = earlier.iter().zip(later).zip(species).filter(|(_, species)| usize::from(**species) == own);
    for ((a, b), _) in discs {
        let [x, y] = [b[0] - a[0], b[1] - a[1]];
        if !x.is_nan() {
            let adds = [x * x, y * y, a[2] * b[2], a[3] * b[3]];
            sums.iter_mut().zip(adds).for_each(|(sum, add)| *sum += add);
            count += 1.0;
        }
    }
    (count > 0.0).then(|| sums.map(|sum| sum / count))
}

/// Sums over discs, distributed to lanes in turn.
struct MotionSums {
    sums: [[f64; 4]; LANES],
    count: u64,
}

struct MotionTask<'m> {
    earlier: &'m [[f64; 4]],
    later: &'m [[f64; 4]],
    to: &'m mut MotionSums,
}

impl RegisterTask<f64> for MotionTask<'_> {
    #[inline(always)]
    fn on<R: Registers<Lane = f64>>(self, _: R) {
        let MotionTask { earlier, later, to } = self;
        let mut sums = [[0.0; 4]; LANES];
        let mut add = |lane: usize, a: &[f64; 4], b: &[f64; 4]| {
            let [x, y] = [b[0] - a[0], b[1] - a[1]];
            // A lost disc adds nothing.
            let is_there = !x.is_nan();
            let adds = [x * x, y * y, a[2] * b[2], a[3] * b[3]];
            for place in 0..4 {
                sums[lane][place] += if is_there { adds[place] } else { 0.0 };
            }
            u64::from(is_there)
        };
        let (whole_a, rest_a) = earlier.as_chunks::<LANES>();
        let (whole_b, rest_b) = later.as_chunks::<LANES>();
        let mut count = 0;
        for (a, b) in whole_a.iter().zip(whole_b) {
            for lane in 0..LANES {
                count += add(lane, &a[lane], &b[lane]);
            }
        }
        for (lane, (a, b)) in rest_a.iter().zip(rest_b).enumerate() {
            count += add(lane, a, b);
        }
        *to = MotionSums { sums, count };
    }
}

/// True if a sample is the earlier one of a lag to sample `next` or a later one.
fn is_kept(look: u64, next: u64) -> bool {
    let level = look.trailing_zeros().min(LEVELS - 1);
    next - look <= (LAGS - 1) << level || look + 1 == next
}
