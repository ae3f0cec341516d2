//! Next collision of a disc among all its partners, one register of partners at a time.

use super::{FlightState, FlyingDisc, Space, collision_times};
use crate::backend::Registers;
use crate::isa::Vector;

/// Largest number of entries in a row of partners.
pub const MOST_PARTNERS: usize = 64;

/// Unit of the length of a row of partners; registers of every instruction set divide it.
pub const ROW_UNIT: usize = 16;

/// The earliest collision of a disc.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EarliestCollision {
    /// Time of the first collision; infinite if there is none.
    pub time: f64,
    /// Partners that collide at that time, one bit each.
    pub partners: u64,
}

/// Finds the earliest collision of the disc `own` with its partners and writes the time of every collision to `times`, infinite
/// where [`collision_time`](super::collision_time) is. The partners are the first `count` entries of a `row`. The entries behind them may be
/// the number of any disc: the number of partners is random, so a branch would be mispredicted. `radius` is that of all discs, if
/// they are equal.
///
/// # Panics
/// If a row is longer than [`MOST_PARTNERS`] or not a multiple of [`ROW_UNIT`], or a number is beyond the discs.
#[inline(always)]
pub fn earliest_collision<R: Registers<Lane = f64>>(
    registers: R,
    space: &Space,
    discs: &[FlyingDisc],
    radius: Option<f64>,
    (own, row, count): (u32, &[u32], usize),
    now: f64,
    times: &mut [f64; MOST_PARTNERS],
) -> EarliestCollision {
    let is_whole = row.len() <= MOST_PARTNERS && row.len().is_multiple_of(ROW_UNIT);
    assert!(is_whole && count <= row.len(), "{count} partners in a row of {}", row.len());
    let disc = &discs[own as usize];
    let splat = |value: f64| registers.splat(value);
    let flight = FlightState {
        position: disc.position.map(splat),
        velocity: disc.velocity.map(splat),
        time: splat(disc.time),
        radius: splat(disc.radius),
    };
    let mut least = splat(f64::INFINITY);
    for begin in (0..count).step_by(R::LANES) {
        let some = &row[begin..begin + R::LANES];
        let mut numbers = [0; 16];
        for lane in 0..R::LANES {
            numbers[lane] = some[lane] as usize;
        }
        let by_lane = |of: &dyn Fn(usize) -> f64| {
            let mut lanes = LaneBuffer([0.0; 16]);
            for lane in 0..R::LANES {
                lanes.0[lane] = of(lane);
            }
            // SAFETY: there are sixteen numbers, and a register has at most that many lanes.
            unsafe { registers.load(lanes.0.as_ptr()) }
        };
        let column = |of: &dyn Fn(usize) -> f64| by_lane(&|lane| of(numbers[lane]));
        let others = FlightState {
            position: [column(&|it| discs[it].position[0]), column(&|it| discs[it].position[1])],
            velocity: [column(&|it| discs[it].velocity[0]), column(&|it| discs[it].velocity[1])],
            time: column(&|it| discs[it].time),
            radius: radius.map_or_else(|| column(&|it| discs[it].radius), splat),
        };
        let met = collision_times(registers, space, &flight, &others, now, f64::INFINITY);
        let here = (count - begin).min(ROW_UNIT);
        // SAFETY: any of the first seventeen entries has sixteen from it on.
        let met = met.max(unsafe { registers.load(ABSENT.0.as_ptr().add(ROW_UNIT - here)) });
        // SAFETY: a whole number of registers fits, because their lanes are a power of two up to sixteen.
        unsafe { registers.store(times.as_mut_ptr().add(begin), met) };
        least = least.min(met);
    }
    let mut lanes = LaneBuffer([f64::INFINITY; 16]);
    // SAFETY: there are sixteen numbers, and a register has at most that many lanes.
    unsafe { registers.store(lanes.0.as_mut_ptr(), least) };
    let time = smallest(&lanes.0, R::LANES);
    let mut first = 0;
    if time < f64::INFINITY {
        for begin in (0..count).step_by(R::LANES) {
            // SAFETY: this register was stored above.
            let met = unsafe { registers.load(times.as_ptr().add(begin)) };
            first |= registers.bits(met.equal(splat(time))) << begin;
        }
    }
    EarliestCollision { time, partners: first }
}

/// Smallest of the first `count` numbers, by repeated halving.
#[inline(always)]
fn smallest(numbers: &[f64; 16], count: usize) -> f64 {
    let mut halves = *numbers;
    let mut left = count;
    while left > 1 {
        left /= 2;
        for lane in 0..left {
            halves[lane] =
                if halves[lane + left] < halves[lane] { halves[lane + left] } else { halves[lane] };
        }
    }
    halves[0]
}

/// Lower bounds of collision times: 0 for partners, then infinity for absent ones. A row reads it from the entry that matches its
/// length.
static ABSENT: AbsentPartners = {
    let mut soonest = [0.0; 2 * ROW_UNIT];
    let mut lane = ROW_UNIT;
    while lane < soonest.len() {
        soonest[lane] = f64::INFINITY;
        lane += 1;
    }
    AbsentPartners(soonest)
};

/// Aligned array of two row units.
#[repr(align(64))]
struct AbsentPartners([f64; 2 * ROW_UNIT]);

/// Aligned buffer of a register's numbers.
#[repr(align(64))]
struct LaneBuffer([f64; 16]);

#[cfg(test)]
mod tests {
    use super::super::{RadiusGrowth, collision_time};
    use super::*;
    use crate::backend::{InstructionSet, RegisterTask, dispatch_native};
    use crate::noise::{RandomPurpose, Stream};
    use rand::RngExt;

    struct PartnerSearch<'a> {
        space: &'a Space,
        discs: &'a [FlyingDisc],
        radius: Option<f64>,
        partners: (&'a [u32], usize),
        times: &'a mut [f64; MOST_PARTNERS],
        found: &'a mut Option<EarliestCollision>,
    }

    impl RegisterTask<f64> for PartnerSearch<'_> {
        #[inline(always)]
        fn on<R: Registers<Lane = f64>>(self, registers: R) {
            let PartnerSearch { space, discs, radius, partners, times, found } = self;
            *found = Some(earliest_collision(
                registers,
                space,
                discs,
                radius,
                (0, partners.0, partners.1),
                3.0,
                times,
            ));
        }
    }

    /// Bit-equal to the result for each pair, on every instruction set.
    #[test]
    fn rows_of_partners_match_single_pairs() {
        let mut stream = Stream::new(3, RandomPurpose::Test, 0);
        let mut meetings = 0;
        for (gravity, rate) in [([0.0; 2], 0.0), ([0.5, -1.0], 0.0), ([0.0; 2], 0.3)] {
            let space = Space::new([Some(12.0), None], gravity);
            let space = if rate > 0.0 { space.growing(RadiusGrowth { from: 0.5, rate }) } else { space };
            for count in [1usize, 2, 7, 8, 9, 16, 31, 64] {
                let mut draw = |low: f64, high: f64| stream.random_range(low..high);
                let discs: Vec<FlyingDisc> = (0..=count)
                    .map(|_| FlyingDisc {
                        position: [draw(0.0, 12.0), draw(0.0, 12.0)],
                        velocity: [draw(-1.0, 1.0), draw(-1.0, 1.0)],
                        time: draw(0.0, 3.0),
                        radius: draw(0.2, 0.5),
                        mass: 1.0,
                        events: 0,
                    })
                    .collect();
                let equal = (count == 9).then_some(0.4);
                let discs: Vec<FlyingDisc> = discs
                    .into_iter()
                    .map(|disc| FlyingDisc { radius: equal.unwrap_or(disc.radius), ..disc })
                    .collect();
                let mut row: Vec<u32> = (1..=count as u32).collect();
                // Behind the partners are the disc itself, and one that it may collide with.
                row.resize(count.next_multiple_of(ROW_UNIT), 0);
                if let Some(behind) = row.get_mut(count) {
                    *behind = 1;
                }
                let partners = (&row[..], count);
                let times = |set: InstructionSet| {
                    let mut times = [0.0; MOST_PARTNERS];
                    let (space, discs) = (&space, &discs);
                    let mut found = None;
                    let search = PartnerSearch {
                        space,
                        discs,
                        radius: equal,
                        partners,
                        times: &mut times,
                        found: &mut found,
                    };
                    dispatch_native(set, search).unwrap();
                    (found.unwrap(), times[..count].to_vec())
                };
                let expected: Vec<f64> = discs[1..]
                    .iter()
                    .map(|disc| collision_time(&space, &discs[0], disc, 3.0, f64::INFINITY))
                    .collect();
                meetings += expected.iter().filter(|time| time.is_finite()).count();
                let least = expected.iter().copied().fold(f64::INFINITY, f64::min);
                for set in InstructionSet::available() {
                    let (found, times) = times(set);
                    assert_eq!(times, expected, "{set:?}");
                    assert_eq!(found.time, least);
                    for (lane, time) in expected.iter().enumerate() {
                        let is = |bits: u64| bits >> lane & 1 == 1;
                        assert_eq!(is(found.partners), *time == least && time.is_finite());
                    }
                }
            }
        }
        assert!(meetings > 10, "{meetings}");
    }
}
