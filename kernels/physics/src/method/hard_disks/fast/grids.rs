//! Grids of the registered positions, one for each class of sizes.
//!
//! Cells as wide as the largest discs reach hold many small ones: with radii of 1:10 a single grid compares a disc with 220 others. Discs of a
//! class differ by less than a factor of three in size. A disc looks for its equals and for larger ones in their cells, next to its own, and for smaller ones in
//! all cells that it reaches.

use super::cells::{FOUND, RegistrationCells};
use crate::domain::Domain;
use stripmine_kernels::backend::Registers;

/// Ratio of the sizes in a class.
const CLASS_RATIO: f64 = 3.0;
/// Discs of a small class for each area of a squared range of sight, at least: fewer would leave most cells empty.
const LEAST_FILLED: f64 = 1.5;

/// Discs of similar size.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct SizeClass {
    /// Largest radius (length).
    largest: f64,
    /// Number of discs.
    count: usize,
}

impl SizeClass {
    /// Classes of some radii, the largest first.
    pub(super) fn of(radii: impl Iterator<Item = f64>) -> Vec<SizeClass> {
        let mut radii: Vec<f64> = radii.collect();
        radii.sort_by(|a, b| b.total_cmp(a));
        let mut classes: Vec<SizeClass> = vec![];
        for radius in radii {
            match classes.last_mut().filter(|class| CLASS_RATIO * radius > class.largest) {
                Some(class) => class.count += 1,
                None => classes.push(SizeClass { largest: radius, count: 1 }),
            }
        }
        classes
    }
}

/// Cells of the registered positions, for each class of sizes.
#[derive(Clone, Debug)]
pub(super) struct RegistrationGrids {
    /// The cells of a class, with the largest radius in them; the largest discs first.
    grids: Vec<(f64, RegistrationCells)>,
    displacement_limit: f64,
}

impl RegistrationGrids {
    /// Creates empty grids for discs that move by a displacement limit (length).
    pub(super) fn new(domain: &Domain, classes: &[SizeClass], displacement_limit: f64) -> RegistrationGrids {
        // Within half a period a disc is found once.
        let (area, widest) = (domain.area(), 0.49 * domain.shortest_period());
        let grid = |class: &SizeClass| {
            let sight = 2.0 * (class.largest + displacement_limit) * (1.0 + 1e-9);
            let filled = (LEAST_FILLED * area / class.count as f64).sqrt().min(widest);
            let sight = if classes.len() > 1 && area.is_finite() { sight.max(filled) } else { sight };
            (class.largest, RegistrationCells::new(domain, class.count, sight))
        };
        RegistrationGrids { grids: classes.iter().map(grid).collect(), displacement_limit }
    }

    /// Class of a radius: the smallest discs that are not smaller.
    #[inline(always)]
    fn class(&self, radius: f64) -> usize {
        match self.grids.len() {
            1 => 0,
            count => (1..count).rev().find(|&class| radius <= self.grids[class].0).unwrap_or(0),
        }
    }

    /// True if discs may be found that are far away.
    #[inline(always)]
    pub(super) fn is_approximate(&self) -> bool {
        self.grids.iter().any(|(_, cells)| cells.is_approximate())
    }

    /// Finds the discs within sight of a disc inside the box that pass a test. Returns their number; none if there are too many.
    #[inline(always)]
    pub(super) fn find<R: Registers<Lane = f32>>(
        &self,
        registers: R,
        domain: &Domain,
        (position, radius): ([f64; 2], f64),
        is_near: impl Fn(u32) -> bool,
        found: &mut [u32; FOUND],
    ) -> Option<usize> {
        if let [(_, cells)] = self.grids.as_slice() {
            return cells.find(registers, domain, position, is_near, found, 0);
        }
        let mut count = 0;
        for (largest, cells) in &self.grids {
            count = if radius <= *largest {
                cells.find(registers, domain, position, &is_near, found, count)?
            } else {
                let reach = (radius + largest + 2.0 * self.displacement_limit) * (1.0 + 1e-9);
                cells.find_beyond(domain, position, reach, &is_near, found, count)?
            };
        }
        Some(count)
    }

    /// Prefetches the cache lines that a search around a disc reads in the grid of its size.
    #[inline(always)]
    pub(super) fn prefetch(&self, domain: &Domain, position: [f64; 2], radius: f64) {
        if let Some((_, cells)) = self.grids.get(self.class(radius)) {
            cells.prefetch(domain, position);
        }
    }

    /// Adds a disc at a position inside the box.
    #[inline(always)]
    pub(super) fn add(&mut self, domain: &Domain, disc: u32, (position, radius): ([f64; 2], f64)) {
        let class = self.class(radius);
        self.grids[class].1.add(domain, disc, position);
    }

    /// Removes a disc that was added at a position.
    #[inline(always)]
    pub(super) fn remove(&mut self, domain: &Domain, disc: u32, (position, radius): ([f64; 2], f64)) {
        let class = self.class(radius);
        self.grids[class].1.remove(domain, disc, position);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::RngExt;
    use stripmine_kernels::backend::Scalar;
    use stripmine_kernels::noise::{RandomPurpose, Stream};

    /// By hand: 4 to 1.5 are one class, 0.9 to 0.4 the next, 0.2 the last.
    #[test]
    fn classes_span_a_factor_of_three() {
        let classes = SizeClass::of([1.5, 4.0, 0.9, 0.2, 0.4, 4.0].into_iter());
        let expected = [(4.0, 3), (0.9, 2), (0.2, 1)];
        assert_eq!(classes, expected.map(|(largest, count)| SizeClass { largest, count }));
        assert_eq!(SizeClass::of([].into_iter()), []);
    }

    /// Large discs reach over ten cells of the small ones, in boxes with and without closed sides; compared with all pairs.
    #[test]
    fn grids_match_a_search_over_pairs() {
        let mut stream = Stream::new(12, RandomPurpose::Test, 0);
        for (periodic, large) in
            [([true, true], 6), ([true, false], 6), ([true, true], 1), ([false, true], 2)]
        {
            let domain = Domain::planar([-3.0, 2.0], [12.0, 9.0], periodic);
            let radii = |disc: usize| if disc < large { 1.0 } else { 0.05 };
            let place =
                |_| [0, 1].map(|axis| domain.origin[axis] + stream.random_range(0.0..domain.length(axis)));
            let places: Vec<[f64; 2]> = (0..2500).map(place).collect();
            let classes = SizeClass::of((0..places.len()).map(radii));
            let mut grids = RegistrationGrids::new(&domain, &classes, 0.02);
            assert_eq!(grids.grids.len(), 2);
            for (disc, place) in places.iter().enumerate() {
                grids.add(&domain, disc as u32, (*place, radii(disc)));
            }
            for own in [0, 3, 5, 6, 700, 2499] {
                grids.remove(&domain, own as u32, (places[own], radii(own)));
                let is_near = |other: u32| {
                    let reach = radii(own) + radii(other as usize) + 0.04;
                    domain.distance(places[own], places[other as usize]) < reach
                };
                let mut found = [0; FOUND];
                let at = (places[own], radii(own));
                let count = grids.find(Scalar::<f32>::default(), &domain, at, is_near, &mut found).unwrap();
                let mut found = found[..count].to_vec();
                found.sort_unstable();
                let others = (0..places.len() as u32).filter(|&other| other != own as u32);
                assert_eq!(found, others.filter(|&other| is_near(other)).collect::<Vec<_>>(), "{own}");
                grids.add(&domain, own as u32, at);
            }
        }
    }
}
