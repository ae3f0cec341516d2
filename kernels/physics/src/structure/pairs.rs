//! What discs have with those around them: distances, neighbours, hexatic order.

use super::setting::Setting;
use crate::near::Near;
use crate::particles::Particle;
use rayon::iter::{IndexedParallelIterator, IntoParallelRefIterator, ParallelIterator};
use std::f64::consts::PI;

/// Bins of distances in a mean diameter, so that one of them begins at contact.
const BINS: f64 = 50.0;
/// Neighbours are nearer than this many sums of the radii.
const NEIGHBOURS: f64 = 1.5;
/// More neighbours than a disc has.
const MOST_NEIGHBOURS: usize = 16;
/// Bins of the order of single discs.
const ORDERS: usize = 50;
/// Discs that a thread takes at a time.
const AT_A_TIME: usize = 512;

/// The width of the bins of distances (length), and their number.
fn bins(setting: &Setting) -> (f64, usize) {
    let width = setting.diameter / BINS;
    (width, (setting.reach / width + 1e-9).floor() as usize)
}

/// The middles of the bins of distances (length).
pub(super) fn distances(setting: &Setting) -> Vec<f64> {
    let (width, count) = bins(setting);
    (0..count).map(|bin| (bin as f64 + 0.5) * width).collect()
}

/// Pairs of discs by the bin of their distance: of those that are near each other, found in squares.
pub fn pair_counts(setting: &Setting, discs: &[Particle]) -> Vec<u64> {
    let (width, count) = bins(setting);
    let (domain, reach) = (setting.domain, width * count as f64);
    let near = Near::among(domain, discs.iter().map(Particle::place), reach);
    let of = |(chunk, own): (usize, &[Particle])| {
        let mut counts = vec![0_u64; count];
        for (own, number) in own.iter().zip((chunk * AT_A_TIME) as u32..) {
            let place = own.place();
            for (other, at) in near.of(place) {
                let [x, y] = domain.displacement(place, at);
                let square = x * x + y * y;
                if other > number && square < reach * reach {
                    let bin = (square.sqrt() / width) as usize;
                    counts[bin.min(count - 1)] += 1;
                }
            }
        }
        counts
    };
    // Whole numbers: the same in any order.
    let sum = |a: Vec<u64>, b: Vec<u64>| a.into_iter().zip(b).map(|(a, b)| a + b).collect();
    let chunks: Vec<&[Particle]> = discs.chunks(AT_A_TIME).collect();
    chunks.par_iter().copied().enumerate().map(of).reduce(|| vec![0; count], sum)
}

/// The same by looking at every pair: the oracle.
pub fn pair_counts_of_all(setting: &Setting, discs: &[Particle]) -> Vec<u64> {
    let (width, count) = bins(setting);
    let reach = width * count as f64;
    let mut counts = vec![0; count];
    for (number, own) in discs.iter().enumerate() {
        for other in &discs[number + 1..] {
            let [x, y] = setting.domain.displacement(own.place(), other.place());
            let square = x * x + y * y;
            if square < reach * reach {
                counts[((square.sqrt() / width) as usize).min(count - 1)] += 1;
            }
        }
    }
    counts
}

/// g(r) in each bin: pairs over those that an ideal gas has on average.
pub(super) fn correlation(setting: &Setting, discs: &[Particle]) -> Vec<f64> {
    let (width, _) = bins(setting);
    let [x, y] = setting.room();
    let closed = [0, 1].map(|axis| f64::from(!setting.domain.is_periodic(axis)));
    let [over_x, over_y] = [closed[0] / x, closed[1] / y];
    // Within a distance r of a place, on average over all places: the set covariance of the rectangle, integrated.
    let within = |r: f64| {
        let (linear, square) = (2.0 / PI * (over_x + over_y), over_x * over_y / PI);
        2.0 * PI * r * r * (0.5 - linear * r / 3.0 + 0.25 * square * r * r)
    };
    let density_of_pairs = 0.5 * discs.len() as f64 * (discs.len() as f64 - 1.0) / (x * y);
    let ideal =
        |bin: usize| density_of_pairs * (within((bin + 1) as f64 * width) - within(bin as f64 * width));
    let counts = pair_counts(setting, discs).into_iter().enumerate();
    counts.map(|(bin, count)| if count == 0 { 0.0 } else { count as f64 / ideal(bin) }).collect()
}

/// Numbers of neighbours.
pub(super) fn neighbour_numbers(_: &Setting) -> Vec<f64> {
    (0..=MOST_NEIGHBOURS).map(|number| number as f64).collect()
}

/// Shares of discs by their number of neighbours.
pub(super) fn coordination(setting: &Setting, discs: &[Particle]) -> Vec<f64> {
    let largest = discs.iter().map(|disc| disc.radius).fold(0.0, f64::max);
    let near = Near::among(setting.domain, discs.iter().map(Particle::place), 2.0 * NEIGHBOURS * largest);
    let of = |(number, own): (usize, &Particle)| {
        let is_neighbour = |&(other, at): &(u32, [f64; 2])| {
            let reach = NEIGHBOURS * (own.radius + discs[other as usize].radius);
            other as usize != number && setting.domain.distance(own.place(), at) < reach
        };
        near.of(own.place()).filter(is_neighbour).count().min(MOST_NEIGHBOURS)
    };
    let numbers: Vec<usize> = discs.par_iter().enumerate().map(of).collect();
    let mut shares = vec![0.0; MOST_NEIGHBOURS + 1];
    numbers.into_iter().for_each(|number| shares[number] += 1.0 / discs.len() as f64);
    shares
}

/// The middles of the bins of |ψ6|.
pub(super) fn orders(_: &Setting) -> Vec<f64> {
    (0..ORDERS).map(|bin| (bin as f64 + 0.5) / ORDERS as f64).collect()
}

/// ψ6 of each disc, its real and its imaginary part: the mean of exp(6iθ) over the six nearest.
pub fn hexatic_orders(setting: &Setting, discs: &[Particle]) -> Vec<[f64; 2]> {
    let domain = setting.domain;
    // About ten others are within it in a gas, too; where there are fewer than six, those that there are.
    let [x, y] = setting.room();
    let reach = 2.0 * (x * y / discs.len() as f64).sqrt();
    let near = Near::among(domain, discs.iter().map(Particle::place), reach);
    let of = |(number, own): (usize, &Particle)| {
        let others = near.of(own.place()).filter(|&(other, _)| other as usize != number);
        let mut around: Vec<(f64, [f64; 2])> = others
            .map(|(_, at)| domain.displacement(own.place(), at))
            .map(|[x, y]| (x * x + y * y, [x, y]))
            .collect();
        let nearest = around.len().min(6);
        if nearest == 0 {
            return [0.0; 2];
        }
        around.select_nth_unstable_by(nearest - 1, |a, b| a.0.total_cmp(&b.0));
        around.truncate(nearest);
        // What is left is in an order that depends on the search alone, which is that of the discs.
        let sum = around.iter().fold([0.0; 2], |sum, &(square, way)| {
            let [x, y] = sixth_power(way).map(|part| part / (square * square * square));
            [sum[0] + x, sum[1] + y]
        });
        sum.map(|part| part / nearest as f64)
    };
    discs.par_iter().enumerate().map(of).collect()
}

/// The density of |ψ6| of the discs, then |Ψ6|, the order of all of them, and the mean |ψ6|.
pub(super) fn hexatic(setting: &Setting, discs: &[Particle]) -> Vec<f64> {
    let share = 1.0 / discs.len() as f64;
    let mut values = vec![0.0; ORDERS + 2];
    let mut whole = [0.0; 2];
    for [x, y] in hexatic_orders(setting, discs) {
        let order = x.hypot(y);
        values[((order * ORDERS as f64) as usize).min(ORDERS - 1)] += share * ORDERS as f64;
        values[ORDERS + 1] += share * order;
        whole = [whole[0] + share * x, whole[1] + share * y];
    }
    values[ORDERS] = whole[0].hypot(whole[1]);
    values
}

/// (x + iy)⁶.
fn sixth_power([x, y]: [f64; 2]) -> [f64; 2] {
    let [a, b] = [x * x - y * y, 2.0 * x * y];
    let [c, d] = [a * a - b * b, 2.0 * a * b];
    [a * c - b * d, a * d + b * c]
}
