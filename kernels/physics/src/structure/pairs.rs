//! What discs have with those around them: distances, neighbours, hexatic order. All from one order of cells.

use super::cells::{AT_ONCE, Cells};
use super::discs::Discs;
use super::setting::Setting;
use crate::particles::Particle;
use rayon::iter::{
    IndexedParallelIterator, IntoParallelRefIterator, IntoParallelRefMutIterator, ParallelIterator,
};
use std::f64::consts::PI;
use std::ops::Range;
use stripmine_kernels::InstructionSet;
use stripmine_kernels::backend::{Registers, Task, dispatch_native};

/// Bins of distances in a mean diameter, so that one of them begins at contact.
const BINS: f64 = 50.0;
/// Neighbours are nearer than this many sums of the radii.
const NEIGHBOURS: f64 = 1.5;
/// More neighbours than a disc has.
const MOST_NEIGHBOURS: usize = 16;
/// Bins of the order of single discs.
const ORDERS: usize = 50;
/// Whom the hexatic order is over.
const NEAREST: usize = 6;
/// Where these are looked for, farther and farther, in mean distances 1/√n: about ten others are there in a gas, and twelve in a
/// corner at last.
const LOOKED_FOR: [f64; 3] = [1.8, 2.7, 4.0];

/// How many bins of distances there are.
fn bins(setting: &Setting) -> usize {
    (setting.reach * BINS / setting.diameter + 1e-9).floor() as usize
}

/// The middles of the bins of distances (length).
pub(super) fn distances(setting: &Setting) -> Vec<f64> {
    (0..bins(setting)).map(|bin| (bin as f64 + 0.5) * setting.diameter / BINS).collect()
}

/// Pairs by the bin of their distance.
#[derive(Clone, Debug, Default)]
pub(super) struct Distances {
    counts: Vec<u64>,
    /// The same of each part, then those that are farther.
    parts: Vec<Vec<u32>>,
}

impl Distances {
    /// Each pair once: of the box with those behind it in its row and with those in the rows above.
    pub(super) fn count(&mut self, setting: &Setting, cells: &Cells) {
        let count = bins(setting);
        let halves: Vec<f64> = cells.halves(setting.reach).collect();
        self.parts.resize(cells.parts.len(), vec![]);
        let of = |(counts, rows): (&mut Vec<u32>, &Range<usize>)| {
            counts.clear();
            counts.resize(count + 1, 0);
            let by_length = BINS / setting.diameter;
            let counting = Counting { cells, rows: rows.clone(), halves: &halves, by_length, counts };
            // The best set is one of this processor.
            dispatch_native(InstructionSet::best(), counting).unwrap_or_default();
        };
        self.parts.par_iter_mut().zip(cells.parts.par_iter()).for_each(of);
        self.counts.clear();
        self.counts.resize(count, 0);
        for part in &self.parts {
            self.counts.iter_mut().zip(part).for_each(|(sum, &count)| *sum += u64::from(count));
        }
    }
}

/// Counts the pairs of some rows of the box.
struct Counting<'c> {
    cells: &'c Cells,
    rows: Range<usize>,
    halves: &'c [f64],
    by_length: f64,
    counts: &'c mut [u32],
}

impl Task<f64> for Counting<'_> {
    #[inline(always)]
    fn on<R: Registers<Lane = f64>>(self, _: R) {
        let Counting { cells, rows, halves, by_length, counts } = self;
        let far = (counts.len() - 1) as f64;
        for row in rows {
            for own in cells.own(row) {
                let (x, y) = (cells.x[own], cells.y[own]);
                for (&half, up) in halves.iter().zip(0..) {
                    let span = cells.span(row, up, x, half);
                    let first = if up == 0 { own + 1 } else { span.start };
                    for begin in (first..span.end).step_by(AT_ONCE) {
                        let [_, _, squares] = ways(cells, begin, [x, y]);
                        let bins = squares.map(|square| {
                            let bin = square.sqrt() * by_length;
                            let bin = if bin < far { bin } else { far };
                            // SAFETY: it is a number, not below 0 and at most `far`, the last place of `counts`, which are few.
                            unsafe { bin.to_int_unchecked::<i32>() }
                        });
                        for &bin in &bins[..AT_ONCE.min(span.end - begin)] {
                            counts[bin as usize] += 1;
                        }
                    }
                }
            }
        }
    }
}

/// From a place to some discs one after the other: along x, along y (length), and the squares of the distances.
#[inline(always)]
fn ways(cells: &Cells, first: usize, [x, y]: [f64; 2]) -> [[f64; AT_ONCE]; 3] {
    let [mut right, mut up, mut squares] = [[0.0; AT_ONCE]; 3];
    right.copy_from_slice(&cells.x[first..first + AT_ONCE]);
    up.copy_from_slice(&cells.y[first..first + AT_ONCE]);
    for at in 0..AT_ONCE {
        right[at] -= x;
        up[at] -= y;
        squares[at] = right[at] * right[at] + up[at] * up[at];
    }
    [right, up, squares]
}

/// Pairs of discs by the bin of their distance, found in cells.
pub fn pair_counts(setting: &Setting, discs: &[Particle]) -> Vec<u64> {
    let of = |place: fn(&Particle) -> f64| discs.iter().map(place).collect();
    let discs = Discs { x: of(|it| it.position[0]), y: of(|it| it.position[1]), ..Discs::default() };
    let (mut cells, mut distances) = (Cells::default(), Distances::default());
    cells.sort(setting, &discs, setting.reach);
    distances.count(setting, &cells);
    distances.counts
}

/// The same by looking at every pair: the oracle.
pub fn pair_counts_of_all(setting: &Setting, discs: &[Particle]) -> Vec<u64> {
    let mut counts = vec![0; bins(setting)];
    for (number, own) in discs.iter().enumerate() {
        for other in &discs[number + 1..] {
            let [x, y] = setting.domain.displacement(own.place(), other.place());
            let bin = ((x * x + y * y).sqrt() * (BINS / setting.diameter)) as usize;
            counts.iter_mut().skip(bin).take(1).for_each(|count| *count += 1);
        }
    }
    counts
}

/// g(r) in each bin: pairs over those that an ideal gas has on average.
pub(super) fn correlation(setting: &Setting, discs: &Discs, found: &Distances, values: &mut [f64]) {
    let width = setting.diameter / BINS;
    let [x, y] = setting.room();
    let closed = [0, 1].map(|axis| f64::from(!setting.domain.is_periodic(axis)));
    let [over_x, over_y] = [closed[0] / x, closed[1] / y];
    // Within a distance r of a place, on average over all places: the set covariance of the rectangle, integrated.
    let within = |r: f64| {
        let (linear, square) = (2.0 / PI * (over_x + over_y), over_x * over_y / PI);
        2.0 * PI * r * r * (0.5 - linear * r / 3.0 + 0.25 * square * r * r)
    };
    let discs = discs.x.len() as f64;
    let density_of_pairs = 0.5 * discs * (discs - 1.0) / (x * y);
    let ideal =
        |bin: usize| density_of_pairs * (within((bin + 1) as f64 * width) - within(bin as f64 * width));
    for (bin, (value, &count)) in values.iter_mut().zip(&found.counts).enumerate() {
        *value = if count == 0 { 0.0 } else { count as f64 / ideal(bin) };
    }
}

/// Who is next to whom.
#[derive(Clone, Debug, Default)]
pub(super) struct Neighbours {
    parts: Vec<Around>,
    /// Whether ψ6 of each disc is kept beside the sums.
    pub(super) keeps_each: bool,
}

/// What some discs have around them, summed up, and room for the others around one.
#[derive(Clone, Debug)]
struct Around {
    /// Discs by their number of neighbours, and by the bin of |ψ6|.
    numbers: [u32; MOST_NEIGHBOURS + 1],
    orders: [u32; ORDERS],
    /// Sums of ψ6, and of |ψ6|.
    order: [f64; 3],
    /// Of those around a disc the ways along x and y (length), the squares of the distances, and the places in the order of cells.
    right: Vec<f64>,
    up: Vec<f64>,
    squares: Vec<f64>,
    places: Vec<usize>,
    /// ψ6 of each disc by its number, where it is kept.
    each: Vec<(u32, [f64; 2])>,
    /// The reach (length) that was last asked for, and how far it goes along each row.
    reach: f64,
    halves: Vec<f64>,
}

impl Neighbours {
    /// How far neighbours and the six nearest are looked for (length).
    pub(super) fn reach(setting: &Setting, discs: usize) -> f64 {
        (2.0 * NEIGHBOURS * setting.largest_radius).max(Neighbours::looked_for(setting, discs)[2])
    }

    fn looked_for(setting: &Setting, discs: usize) -> [f64; 3] {
        let [x, y] = setting.room();
        let apart = (x * y / discs as f64).sqrt();
        LOOKED_FOR.map(|distances| distances * apart)
    }

    /// Looks around every disc.
    pub(super) fn find(&mut self, setting: &Setting, discs: &Discs, cells: &Cells) {
        let none = Around {
            numbers: [0; MOST_NEIGHBOURS + 1],
            orders: [0; ORDERS],
            order: [0.0; 3],
            right: vec![],
            up: vec![],
            squares: vec![],
            places: vec![],
            each: vec![],
            reach: f64::NAN,
            halves: vec![],
        };
        self.parts.resize(cells.parts.len(), none);
        let looked_for = Neighbours::looked_for(setting, discs.x.len());
        let (largest, keeps_each) = (setting.largest_radius, self.keeps_each);
        self.parts.par_iter_mut().zip(cells.parts.par_iter()).for_each(|(around, rows)| {
            let rows = rows.clone();
            let looking =
                Looking { radius: &discs.radius, cells, rows, looked_for, largest, keeps_each, around };
            dispatch_native(InstructionSet::best(), looking).unwrap_or_default();
        });
    }

    /// ψ6 of each disc, where it was kept, in the order of their numbers.
    pub(super) fn each(&self) -> Vec<[f64; 2]> {
        let mut all: Vec<(u32, [f64; 2])> =
            self.parts.iter().flat_map(|part| part.each.iter().copied()).collect();
        all.sort_unstable_by_key(|(number, _)| *number);
        all.into_iter().map(|(_, order)| order).collect()
    }

    /// The sum of a number of each part, in the order of the parts.
    fn sum<T: Into<f64>>(&self, of: impl Fn(&Around) -> T) -> f64 {
        self.parts.iter().map(|part| of(part).into()).sum()
    }
}

/// Looks around the discs of some rows.
struct Looking<'c> {
    radius: &'c [f64],
    cells: &'c Cells,
    rows: Range<usize>,
    looked_for: [f64; 3],
    largest: f64,
    keeps_each: bool,
    around: &'c mut Around,
}

impl Task<f64> for Looking<'_> {
    #[inline(always)]
    fn on<R: Registers<Lane = f64>>(self, _: R) {
        let Looking { radius, cells, rows, looked_for, largest, keeps_each, around } = self;
        around.numbers.fill(0);
        around.orders.fill(0);
        around.order = [0.0; 3];
        around.each.clear();
        around.reach = f64::NAN;
        for row in rows {
            for own in cells.own(row) {
                let own_radius = radius[cells.number[own] as usize];
                let near = (NEIGHBOURS * (own_radius + largest)).max(looked_for[0]);
                let mut found = around.look(cells, row, own, near);
                let neighbours =
                    around.places[..found].iter().zip(&around.squares).filter(|&(&at, &square)| {
                        let reach = NEIGHBOURS * (own_radius + radius[cells.number[at] as usize]);
                        square < reach * reach
                    });
                around.numbers[neighbours.count().min(MOST_NEIGHBOURS)] += 1;
                for reach in [looked_for[1], looked_for[2]] {
                    if found < NEAREST && near < reach {
                        found = around.look(cells, row, own, reach);
                    }
                }
                let [x, y] = around.hexatic(found);
                let order = (x * x + y * y).sqrt();
                around.orders[((order * ORDERS as f64) as usize).min(ORDERS - 1)] += 1;
                around.order[0] += x;
                around.order[1] += y;
                around.order[2] += order;
                if keeps_each {
                    around.each.push((cells.number[own], [x, y]));
                }
            }
        }
    }
}

impl Around {
    /// Writes down who is nearer than `reach` (length) to a disc, itself left out: how many. Those that follow are at no finite distance.
    #[inline(always)]
    fn look(&mut self, cells: &Cells, row: usize, own: usize, reach: f64) -> usize {
        let (x, y) = (cells.x[own], cells.y[own]);
        // Mostly the same for one disc after the other.
        if reach != self.reach {
            self.reach = reach;
            self.halves.clear();
            self.halves.extend(cells.halves(reach));
        }
        let rows = self.halves.len() as i64 - 1;
        let mut found = 0;
        for up in -rows..=rows {
            let span = cells.span(row, up, x, self.halves[up.unsigned_abs() as usize]);
            if self.squares.len() < found + span.len() + AT_ONCE {
                let room = 2 * (found + span.len() + AT_ONCE);
                for column in [&mut self.squares, &mut self.right, &mut self.up] {
                    column.resize(room, 0.0);
                }
                self.places.resize(room, 0);
            }
            for begin in (span.start..span.end).step_by(AT_ONCE) {
                let [right, up, squares] = ways(cells, begin, [x, y]);
                // Written in any case, one over the other where it is too far.
                for at in 0..AT_ONCE.min(span.end - begin) {
                    self.squares[found] = squares[at];
                    self.right[found] = right[at];
                    self.up[found] = up[at];
                    self.places[found] = begin + at;
                    found += usize::from(squares[at] < reach * reach && begin + at != own);
                }
            }
        }
        self.squares[found..found + AT_ONCE].fill(f64::INFINITY);
        found
    }

    /// ⟨exp(6iθ)⟩ over the six nearest of those found; over all where they are fewer, 0 of none.
    #[inline(always)]
    fn hexatic(&self, found: usize) -> [f64; 2] {
        // The smallest so far, in order: each pushes what is larger along.
        let mut nearest = [f64::INFINITY; NEAREST];
        for &square in &self.squares[..found] {
            let mut pushed = square;
            for held in &mut nearest {
                (*held, pushed) = if pushed < *held { (pushed, *held) } else { (*held, pushed) };
            }
        }
        let [.., farthest] = nearest.map(|square| if square.is_finite() { square } else { f64::MAX });
        let ([mut x, mut y], mut count) = ([[0.0; AT_ONCE]; 2], 0);
        for begin in (0..found).step_by(AT_ONCE) {
            let [mut right, mut up, mut squares] = [[0.0; AT_ONCE]; 3];
            right.copy_from_slice(&self.right[begin..begin + AT_ONCE]);
            up.copy_from_slice(&self.up[begin..begin + AT_ONCE]);
            squares.copy_from_slice(&self.squares[begin..begin + AT_ONCE]);
            for at in 0..AT_ONCE {
                let is_near = squares[at] <= farthest;
                let part = sixth_power([right[at], up[at]])
                    .map(|part| part / (squares[at] * squares[at] * squares[at]));
                x[at] += if is_near { part[0] } else { 0.0 };
                y[at] += if is_near { part[1] } else { 0.0 };
                count += usize::from(is_near);
            }
        }
        if count > NEAREST {
            return self.hexatic_of_equals(found, farthest);
        }
        [x, y].map(|lanes| lanes.iter().sum::<f64>() / count.max(1) as f64)
    }

    /// The same where several are just as far as the sixth: the first ones of these count.
    fn hexatic_of_equals(&self, found: usize, farthest: f64) -> [f64; 2] {
        let nearer = self.squares[..found].iter().filter(|&&square| square < farthest).count();
        let (mut sum, mut equals) = ([0.0; 2], NEAREST - nearer);
        for at in 0..found {
            let square = self.squares[at];
            if square < farthest || square == farthest && equals > 0 {
                equals -= usize::from(square == farthest);
                let [x, y] = sixth_power([self.right[at], self.up[at]]);
                sum = [sum[0] + x / (square * square * square), sum[1] + y / (square * square * square)];
            }
        }
        sum.map(|part| part / NEAREST as f64)
    }
}

/// Numbers of neighbours.
pub(super) fn neighbour_numbers(_: &Setting) -> Vec<f64> {
    (0..=MOST_NEIGHBOURS).map(|number| number as f64).collect()
}

/// Shares of discs by their number of neighbours.
pub(super) fn coordination(discs: &Discs, found: &Neighbours, values: &mut [f64]) {
    let discs = discs.x.len() as f64;
    for (number, value) in values.iter_mut().enumerate() {
        *value = found.sum(|part| part.numbers[number]) / discs;
    }
}

/// The middles of the bins of |ψ6|.
pub(super) fn orders(_: &Setting) -> Vec<f64> {
    (0..ORDERS).map(|bin| (bin as f64 + 0.5) / ORDERS as f64).collect()
}

/// The density of |ψ6| of the discs, then |Ψ6|, the order of all of them, and the mean |ψ6|.
pub(super) fn hexatic(discs: &Discs, found: &Neighbours, values: &mut [f64]) {
    let discs = discs.x.len() as f64;
    let (densities, whole) = values.split_at_mut(ORDERS);
    for (bin, value) in densities.iter_mut().enumerate() {
        *value = found.sum(|part| part.orders[bin]) * ORDERS as f64 / discs;
    }
    let [x, y, single] = [0, 1, 2].map(|sum| found.sum(|part| part.order[sum]) / discs);
    whole[0] = x.hypot(y);
    whole[1] = single;
}

/// (x + iy)⁶.
#[inline(always)]
fn sixth_power([x, y]: [f64; 2]) -> [f64; 2] {
    let [a, b] = [x * x - y * y, 2.0 * x * y];
    let [c, d] = [a * a - b * b, 2.0 * a * b];
    [a * c - b * d, a * d + b * c]
}
