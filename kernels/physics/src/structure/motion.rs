//! How far discs go, and how long they remember their velocity: functions of the time between two looks.
//!
//! Lags are 0 to 7 looks, then 4 to 7 times each power of two: looks are kept only as long as a lag needs them, so that memory
//! goes with the logarithm of the length of a run (the order-n algorithm of Frenkel and Smit, section 4.4.2, without coarse-graining).

use crate::domain::Domain;
use crate::particles::Particle;

/// Lags of one power of two, of which the upper half is new.
const LAGS: u64 = 8;
/// Powers of two.
const LEVELS: u32 = 16;
/// More of a periodic side than a disc may go between two looks for its way to be certain.
const CERTAIN: f64 = 0.25;

/// A disc at two moments.
#[derive(Clone, Copy, Debug)]
pub struct Pair<'m> {
    earlier: &'m [f64; 4],
    later: &'m [f64; 4],
}

/// |r(t) − r(0)|² (length²).
pub(super) fn square_displacement(Pair { earlier, later }: &Pair<'_>) -> f64 {
    let [x, y] = [later[0] - earlier[0], later[1] - earlier[1]];
    x * x + y * y
}

/// v(0)·v(t)/2 (length²/time²).
pub(super) fn velocity_product(Pair { earlier, later }: &Pair<'_>) -> f64 {
    0.5 * (earlier[2] * later[2] + earlier[3] * later[3])
}

/// D by the slope of the second half of the mean square displacement: (M(t) − M(t/2))/(4 t/2).
pub(super) fn by_displacements(lags: &[f64], _: &[f64], block: &[f64]) -> f64 {
    let last = lags.len() - 1;
    let middle = lags.partition_point(|&lag| lag < 0.5 * lags[last]).min(last.saturating_sub(1));
    (block[last] - block[middle]) / (4.0 * (lags[last] - lags[middle]))
}

/// D by the integral of the autocorrelation of a component, trapezium by trapezium.
pub(super) fn by_velocities(lags: &[f64], _: &[f64], block: &[f64]) -> f64 {
    let pairs = lags.windows(2).zip(block.windows(2));
    pairs.map(|(lag, value)| 0.5 * (lag[1] - lag[0]) * (value[0] + value[1])).sum()
}

/// Discs as they were at some looks: place across periodic sides, and velocity; not a number where a disc is lost.
#[derive(Clone, Debug, PartialEq)]
pub struct Motion {
    /// The numbers of the discs, in ascending order.
    ids: Vec<u32>,
    /// Looks so far.
    looks: u64,
    /// Times of the first and the last of them.
    times: [f64; 2],
    /// The largest part of a periodic side that a disc went between two looks.
    farthest: f64,
    /// The looks that are kept, in their order.
    kept: Vec<(u64, Vec<[f64; 4]>)>,
}

impl Motion {
    /// Of these discs.
    pub fn new(discs: &[Particle]) -> Motion {
        let mut ids: Vec<u32> = discs.iter().map(|disc| disc.id).collect();
        ids.sort_unstable();
        Motion { ids, looks: 0, times: [0.0; 2], farthest: 0.0, kept: vec![] }
    }

    /// What was kept of discs, as [`Motion::numbers`] and [`Motion::column`] gave it; none where it does not fit the discs.
    pub fn restored(
        discs: &[Particle],
        looks: u64,
        [first, last, farthest]: [f64; 3],
        column: &[f64],
    ) -> Option<Motion> {
        let mut motion = Motion::new(discs);
        let length = 1 + 4 * motion.ids.len();
        let of = |row: &[f64]| {
            let (states, _) = row[1..].as_chunks::<4>();
            (row[0] as u64, states.to_vec())
        };
        if !column.len().is_multiple_of(length) {
            return None;
        }
        motion.kept = column.chunks(length).map(of).collect();
        (motion.looks, motion.times, motion.farthest) = (looks, [first, last], farthest);
        let ascends = motion.kept.is_sorted_by(|(a, _), (b, _)| a < b);
        let ends = motion.kept.last().map_or(0, |(look, _)| look + 1) == looks;
        (ascends && ends && motion.kept.iter().all(|(look, _)| is_kept(*look, looks))).then_some(motion)
    }

    /// Times of the first and the last look, and the largest part of a side.
    pub fn numbers(&self) -> [f64; 3] {
        [self.times[0], self.times[1], self.farthest]
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

    /// Whether no disc went so far between two looks that its way is not certain.
    pub fn is_certain(&self) -> bool {
        self.farthest <= CERTAIN
    }

    /// Every lag, in looks.
    pub fn lags() -> Vec<u64> {
        let of = |level: u32| (LAGS / 2..LAGS).map(move |lag| lag << level);
        (0..LAGS / 2).chain((0..LEVELS).flat_map(of)).collect()
    }

    /// The lags, in time.
    pub fn times(&self) -> Vec<f64> {
        let between = (self.times[1] - self.times[0]) / (self.looks.max(2) - 1) as f64;
        Motion::lags().into_iter().map(|lag| lag as f64 * between).collect()
    }

    /// Looks at the discs at a time; gives each pair of looks that a lag is between to `meet`: the number of the earlier look, the
    /// place among the lags, and the means of the functions over the discs.
    pub fn look(
        &mut self,
        domain: &Domain,
        discs: &[Particle],
        time: f64,
        functions: &[fn(&Pair<'_>) -> f64],
        mut meet: impl FnMut(u64, usize, &[f64]),
    ) {
        let mut states = vec![[f64::NAN; 4]; self.ids.len()];
        let last = self.kept.last().map(|(_, states)| states.as_slice());
        for (at_hand, disc) in discs.iter().enumerate() {
            // Discs are mostly in the order of their numbers.
            let place = match self.ids.get(at_hand) == Some(&disc.id) {
                true => Ok(at_hand),
                false => self.ids.binary_search(&disc.id),
            };
            let Ok(place) = place else { continue };
            let (mut at, velocity) = (disc.place(), disc.planar_velocity());
            if let Some(before) = last.map(|states| states[place]) {
                let before = [before[0], before[1]];
                let way = domain.displacement(before, at);
                for axis in 0..2 {
                    at[axis] = before[axis] + way[axis];
                    if domain.is_periodic(axis) {
                        self.farthest = self.farthest.max(way[axis].abs() / domain.length(axis));
                    }
                }
            }
            states[place] = [at[0], at[1], velocity[0], velocity[1]];
        }
        let look = self.looks;
        self.kept.push((look, states));
        self.looks += 1;
        if look == 0 {
            self.times[0] = time;
        }
        self.times[1] = time;
        let later = &self.kept[self.kept.len() - 1].1;
        for (place, lag) in Motion::lags().into_iter().enumerate() {
            let Some(earlier) = look.checked_sub(lag) else { break };
            // Only looks whose number the power of two of the lag divides are kept long enough.
            let Ok(at) = self.kept.binary_search_by_key(&earlier, |(look, _)| *look) else { continue };
            if let Some(means) = means(&self.kept[at].1, later, functions) {
                meet(earlier, place, &means);
            }
        }
        let looks = self.looks;
        self.kept.retain(|(look, _)| is_kept(*look, looks));
    }
}

/// The mean of each function over the discs that are there both times.
fn means(earlier: &[[f64; 4]], later: &[[f64; 4]], functions: &[fn(&Pair<'_>) -> f64]) -> Option<Vec<f64>> {
    let pairs = || {
        let pairs = earlier.iter().zip(later).filter(|(_, later)| !later[0].is_nan());
        pairs.map(|(earlier, later)| Pair { earlier, later })
    };
    let count = pairs().count() as f64;
    let mean = |function: &fn(&Pair<'_>) -> f64| pairs().map(|pair| function(&pair)).sum::<f64>() / count;
    (count > 0.0).then(|| functions.iter().map(mean).collect())
}

/// Whether a look is the earlier one of a lag to the look number `next` or a later one.
fn is_kept(look: u64, next: u64) -> bool {
    let level = look.trailing_zeros().min(LEVELS - 1);
    next - look <= (LAGS - 1) << level || look + 1 == next
}
