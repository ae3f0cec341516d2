//! Neighbours of each disc: their number, and hexatic order. Every other disc counts once, by its nearest image.

use super::cells::{AT_ONCE, SampleCells};
use super::discs::SampledDiscs;
use super::pairs::displacements_from;
use super::setting::{MOST_SPECIES, StructureSetting};
use crate::domain::Domain;
use rayon::iter::{
    IndexedParallelIterator, IntoParallelRefIterator, IntoParallelRefMutIterator, ParallelIterator,
};
use std::f64::consts::PI;
use std::ops::Range;
use stripmine_kernels::backend::{RegisterTask, Registers, dispatch_best};

/// Largest distance of neighbours, in sums of the radii.
const NEIGHBOURS: f64 = 1.5;
/// Smallest and largest cap on the numbers of neighbours with a line, for discs that overlap.
const LINES: [f64; 2] = [24.0, 1000.0];
/// Bins of the order of single discs.
const ORDERS: usize = 50;
/// Number of discs that the hexatic order averages over.
const NEAREST: usize = 6;
/// Increasing search radii for these, in mean distances 1/√n. A gas has about ten others within the first, a corner twelve. If there still are
/// fewer, all discs are searched.
const LOOKED_FOR: [f64; 3] = [1.8, 2.7, 4.0];

/// Neighbours of all discs.
#[derive(Clone, Debug, Default)]
pub(super) struct Neighbours {
    parts: Vec<NeighbourSums>,
    /// True if ψ6 of each disc is stored beside the sums.
    pub(super) keeps_each: bool,
}

/// Sums over the neighbours of some discs, with buffers for one disc.
#[derive(Clone, Debug)]
struct NeighbourSums {
    /// Discs by number of neighbours, discs with more than any line has, and the total number of neighbours.
    numbers: Vec<u32>,
    beyond: u32,
    neighbours: u64,
    /// Neighbours by the species of a disc and of its neighbour.
    of_species: [[u64; MOST_SPECIES]; MOST_SPECIES],
    /// Discs by the bin of |ψ6|, and discs that have a ψ6.
    orders: [u32; ORDERS],
    ordered: u32,
    /// Sums of ψ6, and of |ψ6|.
    order: [f64; 3],
    /// Neighbours of a disc: components of the distance along x and y (length), squared distances, and indices in the order of cells.
    right: Vec<f64>,
    up: Vec<f64>,
    squares: Vec<f64>,
    places: Vec<usize>,
    /// Stored ψ6 of each disc by its number.
    each: Vec<(u32, [f64; 2])>,
    /// Search radius (length) of the last query, and its half-width along each row.
    reach: f64,
    halves: Vec<f64>,
}

impl Neighbours {
    /// Search radius for neighbours and the six nearest (length).
    pub(super) fn reach(setting: &StructureSetting, discs: usize) -> f64 {
        (2.0 * NEIGHBOURS * setting.largest_radius).max(Neighbours::search_radii(setting, discs)[2])
    }

    fn search_radii(setting: &StructureSetting, discs: usize) -> [f64; 3] {
        let [x, y] = setting.room();
        let apart = (x * y / discs as f64).sqrt();
        LOOKED_FOR.map(|distances| distances * apart)
    }

    /// Finds the neighbours of every disc.
    pub(super) fn find(&mut self, setting: &StructureSetting, discs: &SampledDiscs, cells: &SampleCells) {
        let none = NeighbourSums {
            numbers: vec![0; most_neighbours(setting) + 1],
            beyond: 0,
            neighbours: 0,
            of_species: [[0; MOST_SPECIES]; MOST_SPECIES],
            orders: [0; ORDERS],
            ordered: 0,
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
        let looked_for = Neighbours::search_radii(setting, discs.x.len());
        let (largest, keeps_each) = (setting.largest_radius, self.keeps_each);
        self.parts.par_iter_mut().zip(cells.parts.par_iter()).for_each(|(around, rows)| {
            let rows = rows.clone();
            let domain = &setting.domain;
            let has_species = (2..=MOST_SPECIES).contains(&setting.species);
            let looking = NeighbourTask {
                discs,
                domain,
                cells,
                rows,
                looked_for,
                largest,
                keeps_each,
                has_species,
                around,
            };
            dispatch_best(looking);
        });
    }

    /// Stored ψ6 of each disc, in the order of their numbers.
    pub(super) fn each(&self) -> Vec<[f64; 2]> {
        let mut all: Vec<(u32, [f64; 2])> =
            self.parts.iter().flat_map(|part| part.each.iter().copied()).collect();
        all.sort_unstable_by_key(|(number, _)| *number);
        all.into_iter().map(|(_, order)| order).collect()
    }

    /// Sum of a number over the tasks, in their order.
    fn sum<T: Into<f64>>(&self, of: impl Fn(&NeighbourSums) -> T) -> f64 {
        self.parts.iter().map(|part| of(part).into()).sum()
    }

    /// Total number of neighbours.
    fn count(&self) -> u64 {
        self.parts.iter().map(|part| part.neighbours).sum()
    }
}

/// Neighbour search for the discs of some rows.
struct NeighbourTask<'c> {
    discs: &'c SampledDiscs,
    domain: &'c Domain,
    cells: &'c SampleCells,
    rows: Range<usize>,
    looked_for: [f64; 3],
    largest: f64,
    keeps_each: bool,
    has_species: bool,
    around: &'c mut NeighbourSums,
}

impl RegisterTask<f64> for NeighbourTask<'_> {
    #[inline(always)]
    fn on<R: Registers<Lane = f64>>(self, _: R) {
        let NeighbourTask {
            discs,
            domain,
            cells,
            rows,
            looked_for,
            largest,
            keeps_each,
            has_species,
            around,
        } = self;
        let radius = &discs.radius;
        around.begin();
        // Images farther than half a side are not the nearest ones.
        let halves = [0, 1].map(|axis| match domain.is_periodic(axis) {
            true => 0.5 * domain.length(axis),
            false => f64::INFINITY,
        });
        let wanted = NEAREST.min(discs.x.len() - 1);
        for row in rows {
            for own in cells.own(row) {
                let own_radius = radius[cells.number[own] as usize];
                let near = (NEIGHBOURS * (own_radius + largest)).max(looked_for[0]);
                let mut found = around.search_within(cells, row, own, near, halves);
                let is_neighbour = |&(&at, &square): &(&usize, &f64)| {
                    let reach = NEIGHBOURS * (own_radius + radius[cells.number[at] as usize]);
                    square < reach * reach
                };
                let near_ones = || around.places[..found].iter().zip(&around.squares).filter(is_neighbour);
                let neighbours = near_ones().count();
                if has_species {
                    let species = |at: usize| usize::from(discs.species[cells.number[at] as usize]);
                    let mut counts = [0; MOST_SPECIES];
                    near_ones().for_each(|(&at, _)| counts[species(at)] += 1);
                    let sums = &mut around.of_species[species(own)];
                    sums.iter_mut().zip(counts).for_each(|(sum, count)| *sum += count);
                }
                around.neighbours += neighbours as u64;
                match around.numbers.get_mut(neighbours) {
                    Some(number) => *number += 1,
                    None => around.beyond += 1,
                }
                for reach in [looked_for[1], looked_for[2]] {
                    if found < wanted && near < reach {
                        found = around.search_within(cells, row, own, reach, halves);
                    }
                }
                if found < wanted {
                    found = around.search_everywhere(domain, discs, cells.number[own] as usize);
                }
                let [x, y] = around.hexatic(found);
                if found > 0 {
                    let order = (x * x + y * y).sqrt();
                    around.orders[((order * ORDERS as f64) as usize).min(ORDERS - 1)] += 1;
                    around.ordered += 1;
                    around.order[0] += x;
                    around.order[1] += y;
                    around.order[2] += order;
                }
                if keeps_each {
                    around.each.push((cells.number[own], [x, y]));
                }
            }
        }
    }
}

impl NeighbourSums {
    /// Resets the sums.
    fn begin(&mut self) {
        self.numbers.fill(0);
        self.orders.fill(0);
        (self.beyond, self.neighbours, self.ordered) = (0, 0, 0);
        self.of_species = [[0; MOST_SPECIES]; MOST_SPECIES];
        self.order = [0.0; 3];
        self.each.clear();
        self.reach = f64::NAN;
    }

    /// Stores the discs nearer than `reach` (length) to a disc, without itself and each by its nearest image within half a side, and returns their
    /// number. Entries beyond it are at infinite distance.
    #[inline(always)]
    fn search_within(
        &mut self,
        cells: &SampleCells,
        row: usize,
        own: usize,
        reach: f64,
        [half_x, half_y]: [f64; 2],
    ) -> usize {
        let (x, y) = (cells.x[own], cells.y[own]);
        // Consecutive discs mostly have the same radius.
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
                let [right, up, squares] = displacements_from(cells, begin, [x, y]);
                // The entry is written in any case and overwritten if it is too far.
                for at in 0..AT_ONCE.min(span.end - begin) {
                    self.squares[found] = squares[at];
                    self.right[found] = right[at];
                    self.up[found] = up[at];
                    self.places[found] = begin + at;
                    let is_nearest = (-half_x <= right[at]) & (right[at] < half_x);
                    let is_nearest = is_nearest & (-half_y <= up[at]) & (up[at] < half_y);
                    let is_near = squares[at] < reach * reach && begin + at != own;
                    found += usize::from(is_near & is_nearest);
                }
            }
        }
        self.squares[found..found + AT_ONCE].fill(f64::INFINITY);
        found
    }

    /// Stores all other discs, at any distance.
    fn search_everywhere(&mut self, domain: &Domain, discs: &SampledDiscs, own: usize) -> usize {
        for column in [&mut self.squares, &mut self.right, &mut self.up] {
            column.clear();
        }
        for other in (0..discs.x.len()).filter(|&other| other != own) {
            let [from, to] = [own, other].map(|disc| [discs.x[disc], discs.y[disc]]);
            let [x, y] = domain.displacement(from, to);
            self.right.push(x);
            self.up.push(y);
            self.squares.push(x * x + y * y);
        }
        let found = self.squares.len();
        for column in [&mut self.squares, &mut self.right, &mut self.up] {
            column.extend([f64::INFINITY; AT_ONCE]);
        }
        self.places.resize(found + AT_ONCE, 0);
        found
    }

    /// Mean of exp(6iθ) over the six nearest of those found; over all if they are fewer, NaN if there are none.
    #[inline(always)]
    fn hexatic(&self, found: usize) -> [f64; 2] {
        // The smallest distances so far are sorted; each pushes larger ones along.
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
        [x, y].map(|lanes| lanes.iter().sum::<f64>() / count as f64)
    }

    /// Hexatic order if several discs are as far as the sixth: the first ones of these count.
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

/// Largest number of neighbours with a line: as many of the smallest discs as fit around the largest one. Discs may overlap a little.
fn most_neighbours(setting: &StructureSetting) -> usize {
    let [large, small] = [setting.largest_radius, setting.smallest_radius];
    let rim = NEIGHBOURS * (large + small) + small;
    let fit = (rim * rim - large * large) / (small * small);
    (fit.clamp(LINES[0], LINES[1]) as usize).min(setting.discs.max(1) - 1)
}

/// Number of candidates for the neighbours of a disc of mean size, about.
pub(super) fn candidates(setting: &StructureSetting, discs: usize) -> f64 {
    let [x, y] = setting.room();
    let near = (NEIGHBOURS * (0.5 * setting.diameter + setting.largest_radius))
        .max(Neighbours::search_radii(setting, discs)[0]);
    (PI * near * near * discs as f64 / (x * y)).min(discs as f64)
}

pub(super) fn neighbour_numbers(setting: &StructureSetting) -> Vec<f64> {
    (0..=most_neighbours(setting)).map(|number| number as f64).collect()
}

/// Computes the fractions of discs by their number of neighbours, then the mean number, and the fraction of discs with more than any line has.
pub(super) fn coordination(discs: &SampledDiscs, found: &Neighbours, values: &mut [f64]) {
    let discs = discs.x.len() as f64;
    let (shares, whole) = values.split_at_mut(values.len() - 2);
    for (number, value) in shares.iter_mut().enumerate() {
        *value = found.sum(|part| part.numbers[number]) / discs;
    }
    whole[0] = found.count() as f64 / discs;
    whole[1] = found.sum(|part| part.beyond) / discs;
}

/// Computes the mean number of neighbours of each species around a disc of each species; NaN if it has none.
pub(super) fn partial_coordination(
    setting: &StructureSetting,
    discs: &SampledDiscs,
    found: &Neighbours,
    values: &mut [f64],
) {
    let pairs = (0..setting.species).flat_map(|a| (0..setting.species).map(move |b| [a, b]));
    for (value, [a, b]) in values.iter_mut().zip(pairs) {
        let own = discs.species.iter().filter(|species| usize::from(**species) == a).count() as f64;
        *value = found.parts.iter().map(|part| part.of_species[a][b]).sum::<u64>() as f64 / own;
    }
}

/// Ordered pairs of species, by their numbers from 1.
pub(super) fn ordered_species(setting: &StructureSetting) -> Vec<Vec<f64>> {
    let numbers = || (1..=setting.species).map(|species| species as f64);
    numbers().flat_map(|a| numbers().map(move |b| vec![a, b])).collect()
}

/// Centres of the bins of |ψ6|.
pub(super) fn orders(_: &StructureSetting) -> Vec<f64> {
    (0..ORDERS).map(|bin| (bin as f64 + 0.5) / ORDERS as f64).collect()
}

/// Computes the density of |ψ6| of the discs, then |Ψ6|, the order of all of them, and the mean |ψ6|. Only discs with others around them count;
/// without any the values are NaN.
pub(super) fn hexatic(found: &Neighbours, values: &mut [f64]) {
    let discs = found.sum(|part| part.ordered);
    let (densities, whole) = values.split_at_mut(ORDERS);
    for (bin, value) in densities.iter_mut().enumerate() {
        *value = found.sum(|part| part.orders[bin]) * ORDERS as f64 / discs;
    }
    let [x, y, single] = [0, 1, 2].map(|sum| found.sum(|part| part.order[sum]) / discs);
    whole[0] = x.hypot(y);
    whole[1] = single;
}

/// Sixth power (x + iy)⁶.
#[inline(always)]
fn sixth_power([x, y]: [f64; 2]) -> [f64; 2] {
    let [a, b] = [x * x - y * y, 2.0 * x * y];
    let [c, d] = [a * a - b * b, 2.0 * a * b];
    [a * c - b * d, a * d + b * c]
}
