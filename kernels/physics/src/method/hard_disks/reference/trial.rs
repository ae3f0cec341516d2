//! Cells outside an engine, for measurements of their registration, look-ups and memory.

use super::grid::{DiscCells, ExclusiveGrid, ExclusiveGridSize};
use super::half_space::HalfSpaceGrid;
use super::linked_cells::{CellCounts, LinkedCells};
use crate::domain::Domain;
use stripmine_kernels::mask::Mask;

/// Kind of cells.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CellKind {
    /// All cells of the exclusive grid.
    Plain,
    /// Occupied cells of the exclusive grid, found by ISO99's hashing.
    Hashing,
    /// Occupied cells of the exclusive grid, found by a search through all of them.
    Linear,
    /// Linked cells, and lists of the neighbours within the reach of the mask.
    LinkedLists,
}

/// Cells of a box that is closed above and below.
pub struct TrialCells(Cells);

enum Cells {
    Plain(ExclusiveGrid),
    Hashing(HalfSpaceGrid),
    Linear(HalfSpaceGrid),
    LinkedLists {
        domain: Domain,
        cells: LinkedCells,
        reach: f64,
        /// Neighbours of all discs, one after the other, and the end of those of each disc.
        lists: Vec<u32>,
        ends: Vec<u32>,
    },
}

impl TrialCells {
    /// Creates empty cells for discs of a radius (length), with the neighbours of a mask.
    pub fn new(kind: CellKind, domain: &Domain, radius: f64, mask: &Mask) -> TrialCells {
        let sizes = ExclusiveGridSize::new(domain, radius);
        TrialCells(match kind {
            CellKind::Plain => Cells::Plain(ExclusiveGrid::new(*domain, sizes, mask)),
            CellKind::Hashing => Cells::Hashing(HalfSpaceGrid::new(*domain, sizes, mask)),
            CellKind::Linear => Cells::Linear(HalfSpaceGrid::new(*domain, sizes, mask)),
            CellKind::LinkedLists => {
                let reach = sizes.reach(mask);
                let counts = [0, 1].map(|axis| ((domain.length(axis) / reach) as usize).max(3));
                let cells = LinkedCells::new(*domain, CellCounts(counts));
                Cells::LinkedLists { domain: *domain, cells, reach, lists: vec![], ends: vec![] }
            }
        })
    }

    /// Registers the neighbours of discs at some places in the box (length). Returns false if two discs share a cell.
    pub fn register(&mut self, places: &[[f64; 2]]) -> bool {
        let all = places.iter().copied();
        match &mut self.0 {
            Cells::Plain(cells) => cells.fill(all).is_ok(),
            Cells::Hashing(cells) | Cells::Linear(cells) => cells.fill(all).is_ok(),
            Cells::LinkedLists { domain, cells, reach, lists, ends } => {
                let is_filled = cells.fill(all).is_ok();
                lists.clear();
                ends.clear();
                for (disc, &here) in (0..).zip(places) {
                    cells.for_each_around(disc, |other| {
                        let [dx, dy] = domain.displacement(here, places[other as usize]);
                        if dx * dx + dy * dy < *reach * *reach {
                            lists.push(other);
                        }
                    });
                    ends.push(lists.len() as u32);
                }
                is_filled
            }
        }
    }

    /// Visits the neighbours of every disc; returns their number, and the sum of their numbers.
    pub fn visit_all(&self) -> [u64; 2] {
        let mut found = [0; 2];
        let mut visit = |other: u32| found = [found[0] + 1, found[1] + u64::from(other)];
        match &self.0 {
            Cells::Plain(cells) => {
                (0..cells.count()).for_each(|disc| cells.for_each_around(disc, &mut visit))
            }
            Cells::Hashing(cells) => {
                (0..cells.count()).for_each(|disc| cells.for_each_around(disc, &mut visit))
            }
            Cells::Linear(cells) => {
                (0..cells.count()).for_each(|disc| cells.for_each_by_search(disc, &mut visit))
            }
            Cells::LinkedLists { lists, ends, .. } => {
                let mut start = 0;
                for &end in ends {
                    lists[start..end as usize].iter().for_each(|&other| visit(other));
                    start = end as usize;
                }
            }
        }
        found
    }

    /// Memory of the arrays (bytes).
    pub fn bytes(&self) -> usize {
        match &self.0 {
            Cells::Plain(cells) => cells.bytes(),
            Cells::Hashing(cells) | Cells::Linear(cells) => cells.bytes(),
            Cells::LinkedLists { cells, lists, ends, .. } => cells.bytes() + 4 * (lists.len() + ends.len()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Cells of the exclusive grid find the same neighbours however they are stored; lists have those within reach.
    #[test]
    fn every_kind_finds_the_same_neighbours() {
        let domain = Domain::planar([-3.0, 1.0], [24.0, 30.0], [true, false]);
        let places: Vec<[f64; 2]> = (0..300)
            .map(|number| [f64::from(number % 15) * 1.6 - 2.9, f64::from(number / 15) * 1.2 + 1.6])
            .collect();
        let mask = Mask::square(2);
        let found = |kind: CellKind| {
            let mut cells = TrialCells::new(kind, &domain, 0.5, &mask);
            assert!(cells.register(&places) && cells.bytes() > 0);
            cells.visit_all()
        };
        let plain = found(CellKind::Plain);
        assert_eq!([found(CellKind::Hashing), found(CellKind::Linear)], [plain; 2]);
        let reach = 2.0 * (24.0_f64 / 34.0).min(30.0 / 43.0);
        let near = |a: &[f64; 2], b: &[f64; 2]| a != b && domain.distance(*a, *b) < reach;
        let pairs = places.iter().map(|a| places.iter().filter(|b| near(a, b)).count() as u64).sum::<u64>();
        assert_eq!(found(CellKind::LinkedLists)[0], pairs);
        assert!(pairs < plain[0], "{pairs} {plain:?}");
    }
}
