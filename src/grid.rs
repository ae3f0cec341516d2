//! Linked cells: who is near whom, for any number of particles a cell.

use crate::domain::Domain;
use stripmine_kernels::sweep::fast::{Grid, GridError};

/// Particles sorted into bins at least as wide as a distance of interest.
#[derive(Clone, Debug)]
pub struct Bins {
    domain: Domain,
    counts: [usize; 2],
    widths: [f64; 2],
    members: Vec<Vec<u32>>,
}

impl Bins {
    /// Sorts positions into bins for finding everything nearer than `reach` (length).
    pub fn new(domain: Domain, positions: impl ExactSizeIterator<Item = [f64; 2]>, reach: f64) -> Bins {
        // More bins than positions gain nothing: an empty box must not cost memory.
        let share = domain.sides[0] * domain.sides[1] / (positions.len() + 1) as f64;
        let wide = reach.max(share.sqrt());
        let counts = domain.sides.map(|side| (side / wide).clamp(1.0, f64::from(u16::MAX)) as usize);
        let widths = [domain.sides[0] / counts[0] as f64, domain.sides[1] / counts[1] as f64];
        let members = vec![Vec::new(); counts[0] * counts[1]];
        let mut bins = Bins { domain, counts, widths, members };
        for (i, position) in positions.enumerate() {
            let [column, row] = bins.bin(position);
            bins.members[row * counts[0] + column].push(i as u32);
        }
        bins
    }

    fn bin(&self, position: [f64; 2]) -> [usize; 2] {
        // A cast saturates, so that what lies at a rim, or beyond, is in the bin at the rim.
        [0, 1].map(|axis| {
            let along = (position[axis] - self.domain.origin[axis]) / self.widths[axis];
            (along as usize).min(self.counts[axis] - 1)
        })
    }

    /// The bins next to one along an axis, each once.
    fn beside(&self, bin: usize, axis: usize) -> impl Iterator<Item = usize> + use<> {
        let count = self.counts[axis] as isize;
        let mut beside: Vec<usize> = (-1..=1)
            .map(|step| bin as isize + step)
            .filter(|next| self.domain.periodic[axis] || (0..count).contains(next))
            .map(|next| next.rem_euclid(count) as usize)
            .collect();
        beside.sort_unstable();
        beside.dedup();
        beside.into_iter()
    }

    /// Calls `take` with everything that may be nearer to `position` than the reach.
    pub fn around(&self, position: [f64; 2], mut take: impl FnMut(u32)) {
        let [column, row] = self.bin(position);
        for row in self.beside(row, 1) {
            for column in self.beside(column, 0) {
                self.members[row * self.counts[0] + column].iter().for_each(|&member| take(member));
            }
        }
    }
}

/// Sectors at least `reach` wide (length) for `discs` discs in a box. Where numbers of single precision are at work, places
/// seen from a sector's centre must be short, so that sectors are narrow even if nearly all are empty.
///
/// # Errors
/// [`GridError`] if the box is none for sectors.
pub fn sectors_of(domain: &Domain, reach: f64, single: bool, discs: usize) -> Result<Grid, GridError> {
    let widest = if single { 2.0 * reach } else { f64::INFINITY };
    let Domain { origin, sides, periodic } = *domain;
    Grid::new(origin, sides, periodic, reach, widest, discs)
}

#[cfg(test)]
mod tests {
    use super::*;
    use stripmine_kernels::noise::{Purpose, Stream};

    /// Every pair nearer than the reach is found, and no particle is offered twice.
    #[test]
    fn all_near_pairs_are_found_once() {
        for periodic in [[true, true], [false, true], [false, false]] {
            for sides in [[9.0, 4.0], [2.5, 1.1], [0.8, 30.0]] {
                let domain = Domain { origin: [-1.0, 5.0], sides, periodic };
                let mut random = Stream::new(3, Purpose::Test, 0);
                let positions: Vec<[f64; 2]> = (0..150)
                    .map(|_| [0, 1].map(|a| domain.origin[a] + sides[a] * random.uniform()))
                    .collect();
                let bins = Bins::new(domain, positions.iter().copied(), 1.0);
                for (i, &own) in positions.iter().enumerate() {
                    let mut offered = Vec::new();
                    bins.around(own, |j| offered.push(j as usize));
                    let before = offered.len();
                    offered.sort_unstable();
                    offered.dedup();
                    assert_eq!(offered.len(), before);
                    for (j, &there) in positions.iter().enumerate() {
                        let [dx, dy] = domain.displacement(own, there);
                        assert!(dx.hypot(dy) >= 1.0 || offered.contains(&j), "{i} and {j} in {domain:?}");
                    }
                }
            }
        }
    }

    /// A large box with few particles takes no more memory than they need.
    #[test]
    fn empty_boxes_have_few_bins() {
        let domain = Domain { origin: [0.0; 2], sides: [1e7, 1e6], periodic: [true, false] };
        let positions = [[1.0, 1.0], [9e6, 5e5], [9e6 + 0.5, 5e5]];
        let bins = Bins::new(domain, positions.into_iter(), 1.0);
        assert!(bins.members.len() <= 8, "{}", bins.members.len());
        let mut found = vec![];
        bins.around(positions[1], |member| found.push(member));
        assert!(found.contains(&1) && found.contains(&2), "{found:?}");
    }
}
