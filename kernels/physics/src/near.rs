//! Neighbour search in a planar box: positions sorted into squares, any number in each.

use crate::domain::Domain;
use std::collections::HashMap;
use std::hash::{BuildHasherDefault, Hasher};

/// Positions in a box, sorted into squares at least as wide as a search radius. A query visits neighbouring squares only. Memory grows with the
/// number of positions, not with the box.
#[derive(Clone, Debug)]
pub struct NeighbourSearch {
    domain: Domain,
    squares: [f64; 2],
    /// Index of the last member added to a square.
    last: HashMap<[i64; 2], u32, BuildHasherDefault<SquareHasher>>,
    members: Vec<SquareMember>,
}

/// Hash of the two indices of a square. It is several times as fast as a hash that resists an adversary, and nothing depends on the order of the
/// table.
#[derive(Default)]
struct SquareHasher(u64);

impl Hasher for SquareHasher {
    fn write(&mut self, bytes: &[u8]) {
        for number in bytes.chunks(8) {
            let number = number.iter().fold(0, |number, &byte| number << 8 | u64::from(byte));
            let mixed = (self.0.rotate_left(5) ^ number).wrapping_mul(0x9e37_79b9_7f4a_7c15);
            self.0 = mixed ^ (mixed >> 32);
        }
    }

    fn finish(&self) -> u64 {
        self.0.wrapping_mul(0xff51_afd7_ed55_8ccd)
    }
}

#[derive(Clone, Copy, Debug)]
struct SquareMember {
    number: u32,
    position: [f64; 2],
    /// Member added to the same square before.
    before: Option<u32>,
}

impl NeighbourSearch {
    /// Memory of [`NeighbourSearch::over_positions`] for a number of positions (bytes): the members, and the table of squares. The table has a power of two of entries
    /// and keeps an eighth of them empty.
    pub fn bytes(positions: usize) -> usize {
        let entries = (8 * positions / 7 + 1).next_power_of_two();
        size_of::<SquareMember>() * positions + (size_of::<([i64; 2], u32)>() + 1) * entries
    }

    /// Empty search for positions closer than `reach` (length).
    pub fn new(domain: Domain, reach: f64) -> Self {
        // An integer number of squares fills a side, so that a periodic side closes. 2^30 squares are far more than there are discs. NaN becomes
        // one square.
        let squares = domain.lengths().map(|side| (side / reach).floor().max(1.0).min(2f64.powi(30)));
        NeighbourSearch { domain, squares, last: HashMap::default(), members: Vec::new() }
    }

    /// Search over these positions, numbered from 0.
    pub fn over_positions(
        domain: Domain,
        positions: impl ExactSizeIterator<Item = [f64; 2]>,
        reach: f64,
    ) -> Self {
        let mut near = NeighbourSearch::new(domain, reach);
        near.members.reserve_exact(positions.len());
        near.last.reserve(positions.len());
        positions.zip(0..).for_each(|(position, number)| near.add(number, position));
        near
    }

    fn square(&self, position: [f64; 2]) -> [i64; 2] {
        [0, 1].map(|axis| {
            let fraction = (position[axis] - self.domain.origin[axis]) / self.domain.length(axis);
            // The last square extends beyond a side that is not periodic.
            (fraction * self.squares[axis]).floor().clamp(0.0, self.squares[axis] - 1.0) as i64
        })
    }

    /// Adds a wrapped position under a number.
    pub fn add(&mut self, number: u32, position: [f64; 2]) {
        let before = self.last.insert(self.square(position), self.members.len() as u32);
        self.members.push(SquareMember { number, position, before });
    }

    /// Index of a square and of its neighbours along one axis, each once.
    fn around(&self, axis: usize, square: i64) -> impl Iterator<Item = i64> + use<> {
        let count = self.squares[axis] as i64;
        let (periodic, few) = (self.domain.is_periodic(axis), count < 3);
        let range = if few { 0..=count - 1 } else { square - 1..=square + 1 };
        range.filter_map(move |at| match periodic {
            true => Some(at.rem_euclid(count)),
            false => (0..count).contains(&at).then_some(at),
        })
    }

    /// Number and position of everything that may be within reach of a wrapped position.
    pub fn candidates_near(&self, position: [f64; 2]) -> impl Iterator<Item = (u32, [f64; 2])> + '_ {
        let [column, row] = self.square(position);
        self.around(0, column)
            .flat_map(move |column| self.around(1, row).map(move |row| [column, row]))
            .filter_map(|square| self.last.get(&square).copied())
            .flat_map(|last| {
                let chain = std::iter::successors(Some(last), |&at| self.members[at as usize].before);
                chain.map(|at| (self.members[at as usize].number, self.members[at as usize].position))
            })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::RngExt;
    use stripmine_kernels::noise::{RandomPurpose, Stream};

    /// Compares the search with a test of all pairs, in boxes of one square to many, closed and periodic.
    #[test]
    fn everything_within_reach_is_found_once() {
        let mut random = Stream::new(1, RandomPurpose::Test, 0);
        for (sides, periodic) in [
            ([10.0, 7.0], [true, true]),
            ([10.0, 1.5], [true, false]),
            ([2.5, 3.9], [true, true]),
            ([0.5, 40.0], [false, true]),
        ] {
            let domain = Domain::planar([-3.0, 1.0], sides, periodic);
            let points: Vec<[f64; 2]> = (0..150)
                .map(|_| {
                    [0, 1].map(|axis| {
                        random.random_range(domain.origin[axis]..domain.origin[axis] + sides[axis])
                    })
                })
                .collect();
            let near = NeighbourSearch::over_positions(domain, points.iter().copied(), 1.0);
            for point in &points {
                let mut found: Vec<u32> = near
                    .candidates_near(*point)
                    .filter(|(_, other)| domain.distance(*point, *other) < 1.0)
                    .map(|(i, _)| i)
                    .collect();
                found.sort_unstable();
                let all: Vec<u32> =
                    (0..150).filter(|&i| domain.distance(*point, points[i as usize]) < 1.0).collect();
                assert_eq!(found, all);
            }
        }
    }
}
