//! Expected pairs of an ideal gas at a distance: independent discs in the area that their centres can reach.
//!
//! The probability of two discs in a bin is the area of its ring, times the fraction of the ring that is reachable from a reachable position, over
//! the reachable area. This fraction has a formula between closed sides for discs of one size. For several sizes it is an integral over angles.
//! With wall discs it is sampled on a grid, on the part connected to the initial discs.

use super::pairs::bins;
use super::setting::{StructureSetting, species_numbers};
use crate::domain::Domain;
use crate::particles::{Particle, ParticleKind, Particles};
use rayon::iter::{IntoParallelIterator, ParallelIterator};
use std::f64::consts::{PI, TAU};

/// Largest number of disc sizes distinguished.
const SIZES: usize = 4;
/// Number of angles in a quarter turn.
const ANGLES: usize = 256;
/// Number of samples for each bin.
const SAMPLES: usize = 1 << 14;
/// Edge of the grid's cells over the radius, and the largest number of cells. The edge is a power of two, so that edges of walls at multiples of a
/// radius from a side fall between cells.
const EDGE: f64 = 0.0625;
const MOST_CELLS: f64 = 4e6;
/// Sequence that fills a square evenly: powers of the inverse of the root of x³ = x + 1.
const EVEN: [f64; 2] = [0.754_877_666_246_692_7, 0.569_840_290_998_053_2];

/// Discs of about one size.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct DiscSize {
    /// Mean radius (length).
    pub(super) radius: f64,
    /// Number of discs.
    count: f64,
}

/// Probability of a pair of discs in each bin of distances. Walls and the connected area are those of the start.
pub(super) fn pair_probabilities(setting: &StructureSetting, particles: &Particles) -> Vec<f64> {
    let domain = &setting.domain;
    let has_walls = particles.grain_count() < particles.len();
    let sizes = sizes(particles.grains());
    if has_walls {
        let grids: Vec<ReachableGrid> =
            sizes.iter().map(|size| ReachableGrid::new(domain, size.radius, particles)).collect();
        return average_over_sizes(setting, &sizes, |a, b, r| grids[a].share(&grids[b], r) / grids[b].area());
    }
    if sizes.len() > 1 && domain.periodic() != [true; 2] {
        let share = |a: usize, b: usize, r: f64| shared_area(domain, [sizes[a].radius, sizes[b].radius], r);
        return average_over_sizes(setting, &sizes, share);
    }
    let [x, y] = setting.room();
    let closed = [0, 1].map(|axis| f64::from(!domain.is_periodic(axis)));
    let [over_x, over_y] = [closed[0] / x, closed[1] / y];
    // Area within a distance r of a position, averaged over all positions: the integrated set covariance of the rectangle.
    let within = |r: f64| {
        let (linear, square) = (2.0 / PI * (over_x + over_y), over_x * over_y / PI);
        2.0 * PI * r * r * (0.5 - linear * r / 3.0 + 0.25 * square * r * r)
    };
    let width = setting.diameter / setting.bins;
    let of = |bin: usize| (within((bin + 1) as f64 * width) - within(bin as f64 * width)) / (x * y);
    (0..bins(setting)).map(of).collect()
}

/// Probability of a pair of discs of two species in each bin of distances, for each pair of species.
pub(super) fn probabilities_of_species(setting: &StructureSetting, particles: &Particles) -> Vec<Vec<f64>> {
    let (domain, has_walls) = (&setting.domain, particles.grain_count() < particles.len());
    let numbers = species_numbers(particles.grains()).0;
    let members = |species: usize| {
        let grains = particles.grains().iter().zip(&numbers);
        grains.filter(move |(_, number)| usize::from(**number) == species).map(|(grain, _)| *grain)
    };
    let sizes: Vec<Vec<DiscSize>> =
        (0..setting.species).map(|species| sizes(&members(species).collect::<Vec<_>>())).collect();
    let grid = |size: &DiscSize| ReachableGrid::new(domain, size.radius, particles);
    let grids: Vec<Vec<ReachableGrid>> = match has_walls {
        true => sizes.iter().map(|sizes| sizes.iter().map(grid).collect()).collect(),
        false => vec![],
    };
    let of = |[one, other]: [usize; 2]| {
        by_rings(setting, |r| {
            let (mut sum, mut pairs) = (0.0, 0.0);
            for (a, first) in sizes[one].iter().enumerate() {
                for (b, second) in sizes[other].iter().enumerate() {
                    let same = one == other && a == b;
                    let count = first.count * (second.count - f64::from(u8::from(same)));
                    pairs += count;
                    sum += count
                        * match grids.get(one) {
                            Some(own) => own[a].share(&grids[other][b], r) / grids[other][b].area(),
                            None => shared_area(domain, [first.radius, second.radius], r),
                        };
                }
            }
            sum / pairs
        })
    };
    setting.pairs_of_species().map(of).collect()
}

/// Averages the probability over pairs of sizes; `by_area` is the probability per unit of area at a distance.
fn average_over_sizes(
    setting: &StructureSetting,
    sizes: &[DiscSize],
    by_area: impl Fn(usize, usize, f64) -> f64 + Sync,
) -> Vec<f64> {
    let width = setting.diameter / setting.bins;
    let discs: f64 = sizes.iter().map(|size| size.count).sum();
    let of = |bin: usize| {
        let (ring, middle) = ring(bin, width);
        let mut chance = 0.0;
        for (a, one) in sizes.iter().enumerate() {
            for (b, other) in sizes.iter().enumerate() {
                let others = other.count - f64::from(u8::from(a == b));
                chance += one.count * others / (discs * (discs - 1.0)) * ring * by_area(a, b, middle);
            }
        }
        chance
    };
    (0..bins(setting)).into_par_iter().map(of).collect()
}

/// Probability in each bin from the probability per unit of area at a distance.
fn by_rings(setting: &StructureSetting, by_area: impl Fn(f64) -> f64 + Sync) -> Vec<f64> {
    let of = |bin: usize| {
        let (ring, middle) = ring(bin, setting.diameter / setting.bins);
        ring * by_area(middle)
    };
    (0..bins(setting)).into_par_iter().map(of).collect()
}

/// Area of the ring of a bin, and the mean distance over it, which makes linear fractions exact.
fn ring(bin: usize, width: f64) -> (f64, f64) {
    let [inner, outer] = [bin, bin + 1].map(|edge| edge as f64 * width);
    (PI * (outer * outer - inner * inner), 2.0 / 3.0 * (outer + inner - outer * inner / (outer + inner)))
}

/// Groups discs by radius: each radius alone if there are few, else ranges of radii with about as many discs each.
pub(super) fn sizes(grains: &[Particle]) -> Vec<DiscSize> {
    let mut radii: Vec<f64> = grains.iter().map(|grain| grain.radius).collect();
    radii.sort_by(f64::total_cmp);
    let mut sizes: Vec<DiscSize> = vec![];
    for alike in radii.chunk_by(|a, b| a == b).take(SIZES + 1) {
        sizes.push(DiscSize { radius: alike[0], count: alike.len() as f64 });
    }
    if sizes.len() <= SIZES {
        return sizes;
    }
    let of = |radii: &[f64]| {
        let count = radii.len() as f64;
        DiscSize { radius: radii.iter().sum::<f64>() / count, count }
    };
    radii.chunks(radii.len().div_ceil(SIZES)).map(of).collect()
}

/// Fraction of positions of a disc of one radius from which a step of a length leads to a position of one of another radius, over the area of the
/// latter; averaged over all directions.
fn shared_area(domain: &Domain, radii: [f64; 2], r: f64) -> f64 {
    let room = |axis: usize, radius: f64| match domain.is_periodic(axis) {
        true => domain.length(axis),
        false => domain.length(axis) - 2.0 * radius,
    };
    let overlap = |axis: usize, component: f64| {
        let [a, b] = radii.map(|radius| room(axis, radius));
        match domain.is_periodic(axis) {
            true => a,
            false => (0.5 * (a + b) - component).min(a).min(b).max(0.0),
        }
    };
    let at = |step: usize| {
        let (sine, cosine) = libm::sincos((step as f64 + 0.5) * 0.5 * PI / ANGLES as f64);
        overlap(0, r * cosine) * overlap(1, r * sine)
    };
    let mean = (0..ANGLES).map(at).sum::<f64>() / ANGLES as f64;
    mean / radii.map(|radius| room(0, radius) * room(1, radius)).iter().product::<f64>()
}

/// Grid over the rectangle between closed sides, with the cells that the centre of a disc can reach from the initial discs.
struct ReachableGrid {
    domain: Domain,
    /// Lower left corner of the rectangle (length); no closed side cuts a cell.
    origin: [f64; 2],
    counts: [usize; 2],
    edges: [f64; 2],
    /// True for reached cells, row by row.
    is_reached: Vec<bool>,
    /// Reached cells.
    reached: Vec<u32>,
}

impl ReachableGrid {
    /// Grid for discs of a radius (length).
    fn new(domain: &Domain, radius: f64, particles: &Particles) -> ReachableGrid {
        let edge = (EDGE * radius).max((domain.area() / MOST_CELLS).sqrt());
        let rim = [0, 1].map(|axis| if domain.is_periodic(axis) { 0.0 } else { radius });
        let origin = [0, 1].map(|axis| domain.origin[axis] + rim[axis]);
        // A disc that fills its box has one cell.
        let lengths = [0, 1].map(|axis| (domain.length(axis) - 2.0 * rim[axis]).max(edge));
        let counts = lengths.map(|length| (length / edge).ceil().max(1.0) as usize);
        let edges = [0, 1].map(|axis| lengths[axis] / counts[axis] as f64);
        let mut grid =
            ReachableGrid { domain: *domain, origin, counts, edges, is_reached: vec![], reached: vec![] };
        let is_free = grid.free_of_walls(radius, particles);
        grid.flood(&is_free, particles.grains());
        grid
    }

    /// Marks the cells at whose centre a disc overlaps no wall disc.
    fn free_of_walls(&self, radius: f64, particles: &Particles) -> Vec<bool> {
        let [columns, rows] = self.counts;
        let mut is_free = vec![true; columns * rows];
        for wall in particles.all().iter().filter(|disc| disc.kind == ParticleKind::Wall) {
            let reach = wall.radius + radius;
            let from = [0, 1].map(|axis| wall.position[axis] - self.origin[axis]);
            let [low, high] = [-reach, reach]
                .map(|offset| [0, 1].map(|axis| ((from[axis] + offset) / self.edges[axis]).floor() as i64));
            for row in low[1]..=high[1] {
                for column in low[0]..=high[0] {
                    let displacement = [(0, column), (1, row)]
                        .map(|(axis, at)| (at as f64 + 0.5) * self.edges[axis] - from[axis]);
                    if let Some(cell) = self.cell([column, row])
                        && displacement[0] * displacement[0] + displacement[1] * displacement[1]
                            < reach * reach
                    {
                        is_free[cell] = false;
                    }
                }
            }
        }
        is_free
    }

    /// Cell of a column and a row, across periodic sides; none beyond closed ones.
    fn cell(&self, at: [i64; 2]) -> Option<usize> {
        let mut inside = [0; 2];
        for axis in 0..2 {
            let count = self.counts[axis] as i64;
            let there = if self.domain.is_periodic(axis) { at[axis].rem_euclid(count) } else { at[axis] };
            inside[axis] = usize::try_from(there).ok().filter(|&there| there < self.counts[axis])?;
        }
        Some(inside[1] * self.counts[0] + inside[0])
    }

    /// Marks all cells connected to a disc through free ones. A disc that touches a wall may be in a cell that is not free.
    fn flood(&mut self, is_free: &[bool], grains: &[Particle]) {
        let mut is_reached = vec![false; is_free.len()];
        let mut reached: Vec<u32> = vec![];
        let mut enter = |cell: Option<usize>, reached: &mut Vec<u32>| {
            if let Some(cell) = cell.filter(|&cell| is_free[cell] && !is_reached[cell]) {
                is_reached[cell] = true;
                reached.push(cell as u32);
            }
        };
        for grain in grains {
            let [column, row] = [0, 1]
                .map(|axis| ((grain.position[axis] - self.origin[axis]) / self.edges[axis]).floor() as i64);
            for (right, up) in (-1..=1).flat_map(|up| (-1..=1).map(move |right| (right, up))) {
                enter(self.cell([column + right, row + up]), &mut reached);
            }
        }
        let mut next = 0;
        while let Some(&cell) = reached.get(next) {
            next += 1;
            let [column, row] = [cell as usize % self.counts[0], cell as usize / self.counts[0]];
            let [column, row] = [column as i64, row as i64];
            for at in [[column - 1, row], [column + 1, row], [column, row - 1], [column, row + 1]] {
                enter(self.cell(at), &mut reached);
            }
        }
        // The order of cells spreads samples evenly.
        reached.sort_unstable();
        (self.is_reached, self.reached) = (is_reached, reached);
    }

    /// Reached area (length²).
    fn area(&self) -> f64 {
        self.reached.len() as f64 * self.edges[0] * self.edges[1]
    }

    /// Fraction of reached positions from which a step of a length leads to one that is reached on another grid, over all directions.
    fn share(&self, other: &ReachableGrid, r: f64) -> f64 {
        let reached = self.reached.len() as f64;
        let leads = |sample: usize| {
            let [place, turn] = EVEN.map(|step| (step * sample as f64).fract());
            let cell = self.reached[((place * reached) as usize).min(self.reached.len() - 1)] as usize;
            let from = [cell % self.counts[0], cell / self.counts[0]];
            let (sine, cosine) = libm::sincos(TAU * turn);
            let to = [(0, cosine), (1, sine)].map(|(axis, along): (usize, f64)| {
                let at = self.origin[axis] + (from[axis] as f64 + 0.5) * self.edges[axis] + r * along;
                ((at - other.origin[axis]) / other.edges[axis]).floor() as i64
            });
            other.cell(to).is_some_and(|cell| other.is_reached[cell])
        };
        if self.reached.is_empty() {
            return 0.0;
        }
        (0..SAMPLES).filter(|&sample| leads(sample)).count() as f64 / SAMPLES as f64
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn disc(id: u32, kind: ParticleKind, position: [f64; 2], radius: f64) -> Particle {
        let position = [position[0], position[1], 0.0];
        Particle {
            id,
            kind,
            species: 0,
            position,
            velocity: [0.0; 3],
            angle: 0.0,
            omega: 0.0,
            radius,
            mass: 1.0,
        }
    }

    /// The integral over angles and the samples on a grid agree with the formula of the rectangle.
    #[test]
    fn three_ring_fraction_methods_agree() {
        let discs = Particles::new((0..3).map(|id| disc(id, ParticleKind::Grain, [3.0, 4.0], 0.5)).collect());
        for (sides, periodic) in [([12.0, 9.0], [true, false]), ([12.0, 9.0], [false, false])] {
            let domain = Domain::planar([0.0; 2], sides, periodic);
            let setting = StructureSetting::new(domain, &discs);
            let formula = pair_probabilities(&setting, &discs);
            let size = [DiscSize { radius: 0.5, count: 3.0 }];
            let integral = average_over_sizes(&setting, &size, |_, _, r| shared_area(&domain, [0.5; 2], r));
            let grid = ReachableGrid::new(&domain, 0.5, &discs);
            let sampled = average_over_sizes(&setting, &size, |_, _, r| grid.share(&grid, r) / grid.area());
            assert!(formula.len() > 100);
            for ((formula, integral), sampled) in formula.into_iter().zip(integral).zip(sampled) {
                assert!((integral / formula - 1.0).abs() < 1e-4, "{integral} {formula}");
                assert!((sampled / formula - 1.0).abs() < 0.01, "{sampled} {formula}");
            }
        }
    }

    /// A channel between rows of nearly touching wall discs is a strip with slightly uneven edges, and nothing outside of it is reached.
    #[test]
    fn channel_area_matches_its_walls() {
        let mut all = vec![disc(0, ParticleKind::Grain, [10.0, 6.0], 0.5)];
        for column in 0..200 {
            for height in [3.0, 9.0] {
                all.push(disc(all.len() as u32, ParticleKind::Wall, [0.1 * f64::from(column), height], 0.5));
            }
        }
        let particles = Particles::new(all);
        let domain = Domain::planar([0.0; 2], [20.0, 12.0], [true, false]);
        let grid = ReachableGrid::new(&domain, 0.5, &particles);
        // Centres come within 1 of the centres of the walls.
        assert!((grid.area() / (20.0 * 4.0) - 1.0).abs() < 0.01, "{}", grid.area());
        for r in [0.5, 2.0, 3.5] {
            let strip = 1.0 - 2.0 * r / (4.0 * PI);
            assert!((grid.share(&grid, r) - strip).abs() < 0.01, "{r}: {}", grid.share(&grid, r));
        }
    }
}
