//! Pairs of discs by their distance, and the pair correlation g(r).

use super::cells::{AT_ONCE, SampleCells};
use super::discs::SampledDiscs;
use super::setting::StructureSetting;
use crate::particles::Particle;
use rayon::iter::{
    IndexedParallelIterator, IntoParallelRefIterator, IntoParallelRefMutIterator, ParallelIterator,
};
use std::ops::Range;
use stripmine_kernels::backend::{RegisterTask, Registers, dispatch_best};

/// Number of bins of distances.
pub(super) fn bins(setting: &StructureSetting) -> usize {
    (setting.reach * setting.bins / setting.diameter + 1e-9).floor() as usize
}

/// Centres of the bins of distances (length).
pub(super) fn distances(setting: &StructureSetting) -> Vec<f64> {
    (0..bins(setting)).map(|bin| (bin as f64 + 0.5) * setting.diameter / setting.bins).collect()
}

/// Pairs by the bin of their distance.
#[derive(Clone, Debug, Default)]
pub(super) struct Distances {
    counts: Vec<u64>,
    /// Counts of each task, then pairs beyond the last bin.
    parts: Vec<Vec<u32>>,
}

impl Distances {
    /// Counts each pair once: every disc of the box with those behind it in its row and with those in the rows above.
    ///
    /// With the species of the discs, pairs of species are counted apart: a row of bins for each.
    pub(super) fn count(&mut self, setting: &StructureSetting, cells: &SampleCells, species: &[u8]) {
        let bins = bins(setting);
        let rows = if species.is_empty() { 1 } else { setting.species * setting.species };
        let count = rows * bins;
        let halves: Vec<f64> = cells.halves(setting.reach).collect();
        self.parts.resize(cells.parts.len(), vec![]);
        let of = |(counts, rows): (&mut Vec<u32>, &Range<usize>)| {
            counts.clear();
            counts.resize(count + 1, 0);
            let by_length = setting.bins / setting.diameter;
            let counting = PairCountTask { cells, rows: rows.clone(), halves: &halves, by_length, counts };
            // The dispatch selects an instruction set of this processor.
            match species {
                [] => dispatch_best(counting),
                _ => counting.count_species(species, [bins, setting.species]),
            }
        };
        self.parts.par_iter_mut().zip(cells.parts.par_iter()).for_each(of);
        self.counts.clear();
        self.counts.resize(count, 0);
        for part in &self.parts {
            self.counts.iter_mut().zip(part).for_each(|(sum, &count)| *sum += u64::from(count));
        }
    }
}

/// Count of the pairs of some rows of the box.
struct PairCountTask<'c> {
    cells: &'c SampleCells,
    rows: Range<usize>,
    halves: &'c [f64],
    by_length: f64,
    counts: &'c mut [u32],
}

impl PairCountTask<'_> {
    /// Counts pairs by their species, the smaller number first, and their distance.
    fn count_species(self, species: &[u8], [bins, all]: [usize; 2]) {
        let PairCountTask { cells, rows, halves, by_length, counts } = self;
        for row in rows {
            for own in cells.own(row) {
                let (x, y, one) = (cells.x[own], cells.y[own], species[cells.number[own] as usize]);
                for (&half, up) in halves.iter().zip(0..) {
                    let span = cells.span(row, up, x, half);
                    let first = if up == 0 { own + 1 } else { span.start };
                    for there in first..span.end {
                        let [right, above] = [cells.x[there] - x, cells.y[there] - y];
                        let bin = ((right * right + above * above).sqrt() * by_length) as usize;
                        let other = species[cells.number[there] as usize];
                        let [a, b] = [one.min(other), one.max(other)].map(usize::from);
                        if bin < bins {
                            counts[(a * all + b) * bins + bin] += 1;
                        }
                    }
                }
            }
        }
    }
}

impl RegisterTask<f64> for PairCountTask<'_> {
    #[inline(always)]
    fn on<R: Registers<Lane = f64>>(self, _: R) {
        let PairCountTask { cells, rows, halves, by_length, counts } = self;
        let far = (counts.len() - 1) as f64;
        for row in rows {
            for own in cells.own(row) {
                let (x, y) = (cells.x[own], cells.y[own]);
                for (&half, up) in halves.iter().zip(0..) {
                    let span = cells.span(row, up, x, half);
                    let first = if up == 0 { own + 1 } else { span.start };
                    for begin in (first..span.end).step_by(AT_ONCE) {
                        let [_, _, squares] = displacements_from(cells, begin, [x, y]);
                        let bins = squares.map(|square| {
                            let bin = square.sqrt() * by_length;
                            let bin = if bin < far { bin } else { far };
                            // SAFETY: it is not NaN, not below 0 and at most `far`, the last index of `counts`, which fits in 32 bits.
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

/// Vectors from a position to consecutive discs along x and y (length), and the squared distances.
#[inline(always)]
pub(super) fn displacements_from(cells: &SampleCells, first: usize, [x, y]: [f64; 2]) -> [[f64; AT_ONCE]; 3] {
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

/// Counts pairs of discs by the bin of their distance with a cell search.
pub fn pair_counts(setting: &StructureSetting, discs: &[Particle]) -> Vec<u64> {
    let of = |place: fn(&Particle) -> f64| discs.iter().map(place).collect();
    let discs =
        SampledDiscs { x: of(|it| it.position[0]), y: of(|it| it.position[1]), ..SampledDiscs::default() };
    let (mut cells, mut distances) = (SampleCells::default(), Distances::default());
    cells.sort(setting, &discs, setting.reach);
    distances.count(setting, &cells, &[]);
    distances.counts
}

/// Counts pairs of discs by a loop over all of them: the reference for tests.
pub fn pair_counts_of_all(setting: &StructureSetting, discs: &[Particle]) -> Vec<u64> {
    let mut counts = vec![0; bins(setting)];
    for (number, own) in discs.iter().enumerate() {
        for other in &discs[number + 1..] {
            let [x, y] = setting.domain.displacement(own.planar_position(), other.planar_position());
            let bin = ((x * x + y * y).sqrt() * (setting.bins / setting.diameter)) as usize;
            counts.iter_mut().skip(bin).take(1).for_each(|count| *count += 1);
        }
    }
    counts
}

/// g(r) in each bin: pairs over those of the ideal gas of this moment. Weights make a mean over moments the ratio of all pairs to all those of the
/// ideal gases.
pub(super) fn correlation_over(found: &Distances, pairs: &[f64], values: &mut [f64], weights: &mut [f64]) {
    let bins = values.iter_mut().zip(weights).zip(&found.counts).zip(pairs);
    for (((value, weight), &count), &pairs) in bins {
        (*value, *weight) = if pairs > 0.0 { (count as f64 / pairs, pairs) } else { (0.0, 0.0) };
    }
}

/// g(r) in each bin: pairs over the mean number in an ideal gas, where each pair has a probability `chance`.
pub(super) fn correlation(discs: &SampledDiscs, found: &Distances, chances: &[f64], values: &mut [f64]) {
    let discs = discs.x.len() as f64;
    let pairs = 0.5 * discs * (discs - 1.0);
    for ((value, &count), &chance) in values.iter_mut().zip(&found.counts).zip(chances) {
        *value = if pairs > 0.0 { count as f64 / (pairs * chance) } else { f64::NAN };
    }
}

/// g_ab(r) in each bin, for each pair of species: pairs over the mean number in an ideal gas, where each pair has a probability `chances`.
pub(super) fn partial_correlations(
    setting: &StructureSetting,
    discs: &SampledDiscs,
    found: &Distances,
    chances: &[Vec<f64>],
    values: &mut [f64],
) {
    let bins = bins(setting);
    let count =
        |species: usize| discs.species.iter().filter(|it| usize::from(**it) == species).count() as f64;
    let rows = values.chunks_mut(bins.max(1)).zip(setting.pairs_of_species()).zip(chances);
    for ((values, [a, b]), chances) in rows {
        let pairs = if a == b { 0.5 * count(a) * (count(a) - 1.0) } else { count(a) * count(b) };
        let counts = &found.counts[(a * setting.species + b) * bins..];
        for ((value, &count), &chance) in values.iter_mut().zip(counts).zip(chances) {
            *value = if pairs > 0.0 { count as f64 / (pairs * chance) } else { f64::NAN };
        }
    }
}

/// Species and distances of g_ab(r).
pub(super) fn distances_of_species(setting: &StructureSetting) -> Vec<Vec<f64>> {
    let over: Vec<Vec<f64>> = distances(setting).into_iter().map(|r| vec![r]).collect();
    setting.by_pairs_of_species(&over)
}
