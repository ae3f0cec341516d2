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

use super::grid::{CellMisfit, DiscCells, EMPTY, ExclusiveGridSize};
use crate::domain::Domain;
use stripmine_kernels::mask::Mask;

/// L: cells per block.
const BLOCK: usize = 8;
/// Maximum number of blocks, independent of the memory: 2 GB.
const MOST: usize = 1 << 28;

/// Grid that stores only the occupied cells.
#[derive(Clone, Debug)]
pub(crate) struct HalfSpaceGrid {
    domain: Domain,
    sizes: ExclusiveGridSize,
    /// Offsets from a cell to the cells of its mask: columns and rows.
    offsets: Vec<[isize; 2]>,
    /// A, BX, BY: disc, column and row.
    occupied: Vec<(u32, u32, u32)>,
    /// C, followed by the end of the last block: D(k) is the difference of two neighbours.
    starts: Vec<u32>,
    /// Column and row of each disc.
    cell: Vec<[u32; 2]>,
    places: Vec<[f64; 2]>,
}

impl HalfSpaceGrid {
    /// Creates the empty grid above a floor, for a mask.
    pub(super) fn new(domain: Domain, sizes: ExclusiveGridSize, mask: &Mask) -> HalfSpaceGrid {
        let offsets = mask.offsets().iter().map(|it| [it.columns as isize, it.rows as isize]).collect();
        HalfSpaceGrid {
            domain,
            sizes,
            offsets,
            occupied: vec![],
            starts: vec![],
            cell: vec![],
            places: vec![],
        }
    }

    /// Returns the disc in a cell; [`EMPTY`] if there is none.
    fn find(&self, column: usize, row: usize) -> u32 {
        let block = (self.sizes.cells[0] * row + column) / BLOCK;
        let [Some(&from), Some(&to)] = [block, block + 1].map(|k| self.starts.get(k)) else { return EMPTY };
        let entries = &self.occupied[from as usize..to as usize];
        let is_it = |&&(_, x, y): &&(u32, u32, u32)| (x as usize, y as usize) == (column, row);
        entries.iter().find(is_it).map_or(EMPTY, |&(disc, ..)| disc)
    }
}

impl DiscCells for HalfSpaceGrid {
    fn fill(&mut self, places: Vec<[f64; 2]>) -> Result<(), CellMisfit> {
        self.cell.clear();
        self.occupied.clear();
        for (number, at) in places.iter().enumerate() {
            let [x, y] = [0, 1].map(|axis| at[axis] - self.domain.origin[axis]);
            let row = (y / self.sizes.edge[1]).min(f64::from(u32::MAX)) as u32;
            let cell = [self.sizes.along(0, x) as u32, row];
            self.cell.push(cell);
            self.occupied.push((number as u32, cell[0], cell[1]));
        }
        self.places = places;
        self.occupied.sort_unstable_by_key(|&(disc, column, row)| (row, column, disc));
        let shares = |pair: &&[(u32, u32, u32)]| (pair[0].1, pair[0].2) == (pair[1].1, pair[1].2);
        if let Some(pair) = self.occupied.windows(2).find(shares) {
            return Err(CellMisfit::Shared([pair[0].0, pair[1].0]));
        }
        let columns = self.sizes.cells[0];
        let of = |&(_, column, row): &(u32, u32, u32)| (columns * row as usize + column as usize) / BLOCK;
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

    fn position_at_fill(&self, disc: u32) -> [f64; 2] {
        self.places[disc as usize]
    }

    fn around(&self, disc: u32) -> impl Iterator<Item = u32> + '_ {
        let [column, row] = self.cell[disc as usize].map(|at| at as usize);
        let (columns, wraps) = (self.sizes.cells[0], self.domain.is_periodic(0));
        let there = move |&[right, up]: &[isize; 2]| {
            let row = row.checked_add_signed(up)?;
            let column = match column.checked_add_signed(right) {
                Some(column) if column < columns => column,
                _ if !wraps => return None,
                _ => (column as isize + right).rem_euclid(columns as isize) as usize,
            };
            Some(self.find(column, row)).filter(|&other| other != EMPTY)
        };
        self.offsets.iter().filter_map(there)
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
        let places = vec![[0.6, 0.6], [1.7, 0.6], [0.6, 1.7], [9.8, 0.6], [5.0, 1e5]];
        for (periodic, near) in [(true, vec![1, 2, 3]), (false, vec![1, 2])] {
            let mut cells = half_space(periodic);
            cells.fill(places.clone()).unwrap();
            let mut seen: Vec<u32> = cells.around(0).collect();
            seen.sort_unstable();
            assert_eq!(seen, near);
            assert_eq!(cells.around(4).count(), 0);
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
        let fill = |cells: &mut HalfSpaceGrid, places: &[[f64; 2]]| cells.fill(places.to_vec());
        assert_eq!(
            fill(&mut cells, &[[5.0, 5.0], [1.0, 1.0], [5.01, 5.01]]),
            Err(CellMisfit::Shared([0, 2]))
        );
        assert!(matches!(fill(&mut cells, &[[5.0, 1.0], [5.0, 1e12]]), Err(CellMisfit::TooHigh(1, _))));
    }
}
