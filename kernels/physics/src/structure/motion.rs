//! How far discs go, across periodic sides, and how long they remember their velocity: functions of the time between two looks.
//!
//! Lags are 0 to 7 looks, then 4 to 7 times each power of two: looks are kept only as long as a lag needs them, so that memory
//! goes with the logarithm of the length of a run (the order-n algorithm of Frenkel and Smit, section 4.4.2, without coarse-graining).

use stripmine_kernels::backend::{Registers, Task, dispatch_best};

/// Lags of one power of two, of which the upper half is new.
const LAGS: u64 = 8;
/// Discs that are added up side by side.
const LANES: usize = 4;
/// Powers of two.
const LEVELS: u32 = 16;

/// |r(t) − r(0)|² (length²).
pub(super) fn square_displacement([x, y, _, _]: [f64; 4]) -> f64 {
    x + y
}

/// v(0)·v(t) (length²/time²).
pub(super) fn velocity_product([_, _, x, y]: [f64; 4]) -> f64 {
    x + y
}

/// The slope between two lags of a function of these.
pub(super) fn slope(lags: &[f64], values: &[f64], from: usize, to: usize) -> f64 {
    (values[to] - values[from]) / (lags[to] - lags[from])
}

/// The integral up to a lag, trapezium by trapezium.
pub(super) fn integral(lags: &[f64], values: &[f64], to: usize) -> f64 {
    let pairs = lags[..=to].windows(2).zip(values[..=to].windows(2));
    pairs.map(|(lag, value)| 0.5 * (lag[1] - lag[0]) * (value[0] + value[1])).sum()
}

/// By how much bars are wider than those of as many independent blocks of `length` looks, for a lag (looks) that is no longer than a
/// block: what begins in a block ends in the next one.
///
/// Squares of displacements of free particles that overlap by a part f have the correlation f². With x the lag over the length, the
/// means of two blocks in a row have ρ = (x²/12)/(2x/3 − x²/6), others none; the square of the error of n of them is (1 + 2ρ)/(1 − 2ρ/n)
/// times that of n that are independent.
pub fn widening(lag: u64, length: u64, blocks: usize) -> f64 {
    let x = lag as f64 / length as f64;
    let correlation = x / (8.0 - 2.0 * x);
    ((1.0 + 2.0 * correlation) / (1.0 - 2.0 * correlation / blocks as f64)).sqrt()
}

/// Discs as they were at some looks: where they would be without periodic sides, and velocity; not a number where a disc is lost.
#[derive(Clone, Debug, PartialEq)]
pub struct Motion {
    /// How many discs there are.
    discs: usize,
    /// Looks so far.
    looks: u64,
    /// Times of the first and the last of them.
    times: [f64; 2],
    /// The looks that are kept, in their order.
    kept: Vec<(u64, Vec<[f64; 4]>)>,
    /// Room for later ones.
    spare: Vec<Vec<[f64; 4]>>,
}

impl Motion {
    /// Of as many discs.
    pub fn new(discs: usize) -> Motion {
        Motion { discs, looks: 0, times: [0.0; 2], kept: vec![], spare: vec![] }
    }

    /// What was kept of discs, as [`Motion::ends`] and [`Motion::column`] gave it; none where it does not fit the discs.
    pub(crate) fn restored(discs: usize, looks: u64, times: [f64; 2], column: &[f64]) -> Option<Motion> {
        let mut motion = Motion::new(discs);
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

    /// Times of the first and the last look.
    pub fn ends(&self) -> [f64; 2] {
        self.times
    }

    /// All that is kept, in one column: each look with its number.
    pub fn column(&self) -> Vec<f64> {
        let of = |(look, states): &(u64, Vec<[f64; 4]>)| {
            std::iter::once(*look as f64).chain(states.iter().flatten().copied()).collect::<Vec<f64>>()
        };
        self.kept.iter().flat_map(of).collect()
    }

    /// Looks so far.
    pub fn looks(&self) -> u64 {
        self.looks
    }

    /// Every lag, in looks.
    pub fn lags() -> impl ExactSizeIterator<Item = u64> {
        const NEW: u64 = LAGS / 2;
        (0..NEW as u32 * (LEVELS + 1)).map(|place| match u64::from(place).checked_sub(NEW) {
            None => u64::from(place),
            Some(place) => (NEW + place % NEW) << (place / NEW),
        })
    }

    /// The lags, in time.
    pub fn times(&self) -> Vec<f64> {
        let between = (self.times[1] - self.times[0]) / (self.looks.max(2) - 1) as f64;
        Motion::lags().map(|lag| lag as f64 * between).collect()
    }

    /// About how many looks are kept at most, once there were a number of them: eight, and half of seven for each power of two
    /// whose lags are farther back than those before.
    pub fn most_kept(looks: u64) -> u64 {
        let levels = (1..LEVELS).take_while(|level| (LAGS - 1) << (level - 1) < looks).count() as u64;
        looks.min(LAGS + (LAGS - 1) * levels / 2)
    }

    /// Looks at the discs at a time: in the order of the scene, each where it would be without periodic sides. Gives each pair of looks that
    /// a lag is between to `meet`: the number of the earlier look, the place among the lags, and the means over the discs of Δx², Δy² and
    /// the products of velocities along x and y.
    pub fn look(&mut self, discs: &[[f64; 4]], time: f64, mut meet: impl FnMut(u64, usize, [f64; 4])) {
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
        for (place, lag) in Motion::lags().enumerate() {
            let Some(earlier) = look.checked_sub(lag) else { break };
            // Only looks whose number the power of two of the lag divides are kept long enough.
            let Ok(at) = self.kept.binary_search_by_key(&earlier, |(look, _)| *look) else { continue };
            if let Some(means) = means(&self.kept[at].1, later) {
                meet(earlier, place, means);
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

/// The means over the discs that are there both times.
fn means(earlier: &[[f64; 4]], later: &[[f64; 4]]) -> Option<[f64; 4]> {
    let mut sums = Sums { sums: [[0.0; 4]; LANES], count: 0 };
    // The best set is one of this processor.
    dispatch_best(Meeting { earlier, later, to: &mut sums });
    let total = |place: usize| sums.sums.iter().map(|lane| lane[place]).sum::<f64>();
    (sums.count > 0).then(|| [0, 1, 2, 3].map(|place| total(place) / sums.count as f64))
}

/// Sums over discs, one disc after the other in each of some lanes.
struct Sums {
    sums: [[f64; 4]; LANES],
    count: u64,
}

struct Meeting<'m> {
    earlier: &'m [[f64; 4]],
    later: &'m [[f64; 4]],
    to: &'m mut Sums,
}

impl Task<f64> for Meeting<'_> {
    #[inline(always)]
    fn on<R: Registers<Lane = f64>>(self, _: R) {
        let Meeting { earlier, later, to } = self;
        let mut sums = [[0.0; 4]; LANES];
        let mut add = |lane: usize, a: &[f64; 4], b: &[f64; 4]| {
            let [x, y] = [b[0] - a[0], b[1] - a[1]];
            // A disc that is lost adds nothing.
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
        *to = Sums { sums, count };
    }
}

/// Whether a look is the earlier one of a lag to the look number `next` or a later one.
fn is_kept(look: u64, next: u64) -> bool {
    let level = look.trailing_zeros().min(LEVELS - 1);
    next - look <= (LAGS - 1) << level || look + 1 == next
}
