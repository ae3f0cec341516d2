//! Exclusive grid without a ceiling (ISO99): only the occupied cells are stored, as in the paper.
//!
//! ```text
//! N_G = N_gx j + i                    number of the cell in column i and row j, both from 0
//! A, BX, BY                           disc, column and row of the occupied cells, in the order of N_G
//! k = ⌊N_G / L⌋                       block of L cells that contains it
//! C(k), D(k)                          first entry of a block and number of its entries: at most L
//! ```
//! A look-up reads C and D once and at most L entries of A, BX and BY.
//!
//! # As printed
//! N_G and k count from 1. k_max = INT(N_Gmax/L) is one short unless L divides N_Gmax; and "k_max < N" is wrong: C and D grow with the
//! height of the highest disc.

use super::grid::{CellMisfit, DiscCells, ExclusiveGridSize};
use crate::domain::Domain;
use stripmine_kernels::mask::Mask;

/// L: cells per block.
const BLOCK: usize = 8;
/// Maximum number of blocks, independent of the memory: 2 GB.
const MOST: usize = 1 << 28;

/// Disc, column and row of an occupied cell.
type OccupiedCell = (u32, u32, u32);

/// Grid that stores only the occupied cells.
#[derive(Clone, Debug)]
pub(crate) struct HalfSpaceGrid {
    domain: Domain,
    sizes: ExclusiveGridSize,
    /// Offsets from a cell to the cells of its mask: columns and rows.
    offsets: Vec<[isize; 2]>,
    /// A, BX, BY: disc, column and row.
    occupied: Vec<OccupiedCell>,
    /// C, followed by the end of the last block: D(k) is the difference of two neighbours.
    starts: Vec<u32>,
    /// Column and row of each disc.
    cell: Vec<[u32; 2]>,
}

impl HalfSpaceGrid {
    /// Creates the empty grid above a floor, for a mask.
    pub(super) fn new(domain: Domain, sizes: ExclusiveGridSize, mask: &Mask) -> HalfSpaceGrid {
        let offsets = mask.offsets().iter().map(|it| [it.columns as isize, it.rows as isize]).collect();
        HalfSpaceGrid { domain, sizes, offsets, occupied: vec![], starts: vec![], cell: vec![] }
    }

    /// Number of discs.
    pub(super) fn count(&self) -> u32 {
        self.cell.len() as u32
    }

    /// Memory of the arrays (bytes).
    pub(super) fn bytes(&self) -> usize {
        12 * self.occupied.len() + 4 * self.starts.len() + 8 * self.cell.len()
    }

    /// Entries of the block of a cell.
    fn entries(&self, column: usize, row: usize) -> &[OccupiedCell] {
        let block = (self.sizes.cells[0] * row + column) / BLOCK;
        match [block, block + 1].map(|k| self.starts.get(k)) {
            [Some(&from), Some(&to)] => &self.occupied[from as usize..to as usize],
            _ => &[],
        }
    }

    /// Visits the discs of a mask, as [`for_each_around`](DiscCells::for_each_around) does, by a search through all occupied cells.
    pub(super) fn for_each_by_search(&self, disc: u32, visit: impl FnMut(u32)) {
        self.for_each_among(disc, |_, _| &self.occupied, visit);
    }

    /// Visits the discs of a mask; `entries` has the occupied cells among which a column and a row are.
    #[inline(always)]
    fn for_each_among<'g>(
        &'g self,
        disc: u32,
        entries: impl Fn(usize, usize) -> &'g [OccupiedCell],
        visit: impl FnMut(u32),
    ) {
        let [column, row] = self.cell[disc as usize].map(|at| at as usize);
        let (columns, wraps) = (self.sizes.cells[0], self.domain.is_periodic(0));
        let there = |&[right, up]: &[isize; 2]| {
            let row = row.checked_add_signed(up)?;
            let column = match column.checked_add_signed(right) {
                Some(column) if column < columns => column,
                _ if !wraps => return None,
                _ => (column as isize + right).rem_euclid(columns as isize) as usize,
            };
            let is_it = |&&(_, x, y): &&OccupiedCell| (x as usize, y as usize) == (column, row);
            entries(column, row).iter().find(is_it).map(|&(disc, ..)| disc)
        };
        self.offsets.iter().filter_map(there).for_each(visit);
    }
}

impl DiscCells for HalfSpaceGrid {
    fn fill(&mut self, places: impl Iterator<Item = [f64; 2]>) -> Result<(), CellMisfit> {
        self.cell.clear();
        self.occupied.clear();
        for (number, at) in places.enumerate() {
            let [x, y] = [0, 1].map(|axis| at[axis] - self.domain.origin[axis]);
            let row = (y / self.sizes.edge[1]).min(f64::from(u32::MAX)) as u32;
            let cell = [self.sizes.along(0, x) as u32, row];
            self.cell.push(cell);
            self.occupied.push((number as u32, cell[0], cell[1]));
        }
        self.occupied.sort_unstable_by_key(|&(disc, column, row)| (row, column, disc));
        let shares = |pair: &&[OccupiedCell]| (pair[0].1, pair[0].2) == (pair[1].1, pair[1].2);
        if let Some(pair) = self.occupied.windows(2).find(shares) {
            return Err(CellMisfit::Shared([pair[0].0, pair[1].0]));
        }
        let columns = self.sizes.cells[0];
        let of = |&(_, column, row): &OccupiedCell| (columns * row as usize + column as usize) / BLOCK;
        let blocks = self.occupied.last().map_or(0, |last| of(last) + 1);
        if blocks > MOST {
            return Err(CellMisfit::TooHigh(self.occupied[self.occupied.len() - 1].0, blocks));
        }
        let mut starts = std::mem::take(&mut self.starts);
        starts.clear();
        starts.resize(blocks + 1, 0);
        for entry in &self.occupied {
            starts[of(entry) + 1] += 1;
        }
        for k in 1..starts.len() {
            starts[k] += starts[k - 1];
        }
        self.starts = starts;
        Ok(())
    }

    fn centre(&self, disc: u32) -> [f64; 2] {
        let cell = self.cell[disc as usize];
        [0, 1].map(|axis| self.domain.origin[axis] + self.sizes.centre(axis, cell[axis] as usize))
    }

    fn for_each_around(&self, disc: u32, visit: impl FnMut(u32)) {
        self.for_each_among(disc, |column, row| self.entries(column, row), visit);
    }

    /// Number of entries of C and D.
    fn figure(&self) -> (&'static str, f64) {
        ("blocks", self.starts.len().saturating_sub(1) as f64)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::domain::BoxSide;

    fn half_space(periodic: bool) -> HalfSpaceGrid {
        let first = if periodic { BoxSide::Periodic(10.0) } else { BoxSide::Closed(10.0) };
        let domain = Domain { origin: [0.0; 3], sides: [first, BoxSide::Open, BoxSide::Flat] };
        HalfSpaceGrid::new(domain, ExclusiveGridSize::new(&domain, 0.5), &Mask::square(2))
    }

    /// Calculated by hand: neighbours beside, above and across the side. One disc at a height of 10⁵ needs blocks for all rows below.
    #[test]
    fn masks_find_discs_in_occupied_cells() {
        let places = [[0.6, 0.6], [1.7, 0.6], [0.6, 1.7], [9.8, 0.6], [5.0, 1e5]];
        for (periodic, near) in [(true, vec![1, 2, 3]), (false, vec![1, 2])] {
            let mut cells = half_space(periodic);
            cells.fill(places.into_iter()).unwrap();
            let seen = |disc: u32| {
                let mut seen = vec![];
                cells.for_each_around(disc, |other| seen.push(other));
                seen.sort_unstable();
                seen
            };
            assert_eq!((seen(0), seen(4)), (near, vec![]));
            let (_, blocks) = cells.figure();
            // 15 cells per row, rows of just below 0.7071.
            assert!(
                (blocks - 15.0 * 1e5 / std::f64::consts::FRAC_1_SQRT_2 / BLOCK as f64).abs() < 15.0,
                "{blocks}"
            );
        }
    }

    #[test]
    fn shared_cells_and_high_discs_are_reported() {
        let mut cells = half_space(true);
        let fill = |cells: &mut HalfSpaceGrid, places: &[[f64; 2]]| cells.fill(places.iter().copied());
        assert_eq!(
            fill(&mut cells, &[[5.0, 5.0], [1.0, 1.0], [5.01, 5.01]]),
            Err(CellMisfit::Shared([0, 2]))
        );
        assert!(matches!(fill(&mut cells, &[[5.0, 1.0], [5.0, 1e12]]), Err(CellMisfit::TooHigh(1, _))));
    }
}
