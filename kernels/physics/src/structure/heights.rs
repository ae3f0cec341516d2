//! Expected pairs of an ideal gas at a distance, above a floor without a ceiling.
//!
//! The area that centres can reach is infinite there. The ideal gas has the discs of the same moment, each at its height but anywhere along the
//! floor, so that density profiles due to gravity are not counted as correlations. Differences of heights are distributed to the nearest tabulated
//! heights. These are much closer than bins, and each has a table of probabilities for the bins of distances.

use super::discs::SampledDiscs;
use super::ideal::{DiscSize, sizes};
use super::pairs::bins;
use super::setting::StructureSetting;
use crate::domain::BoxSide;
use crate::particles::Particles;

/// Number of tabulated heights in a bin of distances.
const STEPS: usize = 8;

/// Expected pairs of the ideal gas of one moment.
#[derive(Clone, Debug)]
pub(super) struct Heights {
    /// Sizes that differ in their distance from the sides of the box.
    sizes: Vec<DiscSize>,
    bins: usize,
    /// Tabulated heights per length.
    by_length: f64,
    /// Probabilities from the first possible bin, for each pair of sizes and each height.
    chances: Vec<Vec<f64>>,
    /// Heights in ascending order, each with the index of its size.
    ascending: Vec<(f64, usize)>,
    /// Number of pairs of each pair of sizes at each height.
    counts: Vec<f64>,
    /// Number of pairs in each bin of distances.
    pub(super) pairs: Vec<f64>,
}

impl Heights {
    /// Tables for the discs of a scene in a box with an open top.
    pub(super) fn new(setting: &StructureSetting, particles: &Particles) -> Heights {
        let mut sizes = sizes(particles.grains());
        if setting.domain.is_periodic(0) {
            sizes.truncate(1);
        }
        let (bins, width) = (bins(setting), setting.diameter / setting.bins);
        let step = width / STEPS as f64;
        let mut chances = vec![];
        for high in 0..sizes.len() {
            for low in 0..=high {
                let radii = [low, high].map(|size| sizes[size].radius);
                let near = |distance: f64, height: f64| {
                    let along = (distance * distance - height * height).max(0.0).sqrt();
                    probability_along(setting.domain.sides[0], radii, along)
                };
                let of_height = |at: usize| {
                    let height = at as f64 * step;
                    let edge = |bin: usize| near(bin as f64 * width, height);
                    (at / STEPS..bins).map(|bin| edge(bin + 1) - edge(bin)).collect()
                };
                chances.extend((0..=bins * STEPS).map(of_height));
            }
        }
        let counts = vec![0.0; chances.len()];
        let (by_length, pairs) = (1.0 / step, vec![0.0; bins]);
        Heights { sizes, bins, by_length, chances, ascending: vec![], counts, pairs }
    }

    /// Computes the pairs of the ideal gas of some discs.
    pub(super) fn find(&mut self, discs: &SampledDiscs) {
        let Heights { sizes, bins, by_length, chances, ascending, counts, pairs } = self;
        let size_of = |radius: f64| {
            let off = |size: &usize| (sizes[*size].radius - radius).abs();
            (0..sizes.len()).min_by(|a, b| off(a).total_cmp(&off(b))).unwrap_or(0)
        };
        ascending.clear();
        ascending.extend(discs.y.iter().zip(&discs.radius).map(|(&y, &radius)| (y, size_of(radius))));
        ascending.sort_by(|(a, _), (b, _)| a.total_cmp(b));
        counts.fill(0.0);
        let steps = *bins * STEPS;
        for (number, &(below, one)) in ascending.iter().enumerate() {
            for &(above, other) in &ascending[number + 1..] {
                let height = (above - below) * *by_length;
                if height >= steps as f64 {
                    break;
                }
                let [low, high] = [one.min(other), one.max(other)];
                let at = (high * (high + 1) / 2 + low) * (steps + 1) + height as usize;
                counts[at] += 1.0 - height.fract();
                counts[at + 1] += height.fract();
            }
        }
        pairs.fill(0.0);
        for (at, (&count, chances)) in counts.iter().zip(&*chances).enumerate() {
            if count > 0.0 {
                let first = at % (steps + 1) / STEPS;
                pairs[first..].iter_mut().zip(chances).for_each(|(pairs, chance)| *pairs += count * chance);
            }
        }
    }
}

/// Probability that discs of two radii, each anywhere along a side, are closer along it than some length.
fn probability_along(side: BoxSide, radii: [f64; 2], separation: f64) -> f64 {
    let room = match side {
        BoxSide::Closed(length) => radii.map(|radius| (length - 2.0 * radius).max(0.0)),
        _ => return (2.0 * separation / side.length()).min(1.0),
    };
    let [narrow, wide] = [room[0].min(room[1]), room[0].max(room[1])];
    // The narrow range is within reach of the wide one up to here.
    let [inner, outer] = [0.5 * (wide - narrow), 0.5 * (wide + narrow)];
    match () {
        () if separation >= outer => 1.0,
        () if separation <= inner => 2.0 * separation / wide,
        () => {
            (2.0 * inner * narrow + 2.0 * outer * (separation - inner) - separation * separation
                + inner * inner)
                / (narrow * wide)
        }
    }
}

/// Cost for each disc (ns): its pairs, and its part of the tables.
pub(super) fn nanoseconds(setting: &StructureSetting, discs: usize) -> f64 {
    const PAIR: f64 = 1.5;
    const CHANCE: f64 = 0.3;
    let [bins, discs] = [bins(setting), discs].map(|count| count as f64);
    let share = (2.0 * setting.reach / setting.room()[1]).min(1.0);
    PAIR * 0.5 * share * discs + CHANCE * (0.5 * STEPS as f64 * bins * bins).min(bins * discs * discs) / discs
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Hand calculation: density of the difference of two uniform positions.
    #[test]
    fn probabilities_match_two_uniform_positions() {
        for (side, radii, separation, chance) in [
            (BoxSide::Periodic(10.0), [0.5, 1.0], 2.0, 0.4),
            // Ranges of 9 and 9: 1 − (1 − 3/9)².
            (BoxSide::Closed(10.0), [0.5; 2], 3.0, 5.0 / 9.0),
            // Ranges of 4 and 8: from the centre, 2 in each direction are within the wide range.
            (BoxSide::Closed(10.0), [3.0, 1.0], 1.0, 0.25),
            (BoxSide::Closed(10.0), [1.0, 3.0], 4.0, (16.0 + 2.0 * 6.0 * 2.0 - 16.0 + 4.0) / 32.0),
            (BoxSide::Closed(10.0), [3.0, 1.0], 6.0, 1.0),
            (BoxSide::Closed(2.0), [1.0; 2], 0.0, 1.0),
        ] {
            let found = probability_along(side, radii, separation);
            assert!(
                (found - chance).abs() < 1e-12,
                "{side:?} {radii:?} {separation}: {found} in place of {chance}"
            );
        }
    }
}
