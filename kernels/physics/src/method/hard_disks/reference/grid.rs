//! Exclusive grid (ISO99): each cell holds at most one centre, and a mask of cells covers all possible partners of a disc.
//!
//! All cells of a closed box are stored. Without a ceiling (`half_space`) only the occupied cells are.

use crate::domain::{BoxSide, Domain};
use crate::method::hard_disks::event::Arena;
use stripmine_kernels::flight::FlyingDisc;
use stripmine_kernels::mask::Mask;

/// Marks an empty cell.
pub(crate) const EMPTY: u32 = u32::MAX;

/// Number and size of the cells of a box.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct ExclusiveGridSize {
    /// Cells along x and y.
    pub cells: [usize; 2],
    /// Sides of a cell (length).
    pub edge: [f64; 2],
}

impl ExclusiveGridSize {
    /// Smallest number of cells such that no cell can hold the centres of two discs of at least this radius. ISO99 (2)–(5), with σ a radius.
    ///
    /// # As printed
    /// The symbols for the number of cells and for their size are swapped in (2)–(5).
    pub(crate) fn new(domain: &Domain, smallest_radius: f64) -> ExclusiveGridSize {
        let bound = std::f64::consts::SQRT_2 * smallest_radius;
        // An infinite side saturates.
        let cells = [0, 1].map(|axis| ((domain.length(axis) / bound) as usize).saturating_add(1));
        let edge = [0, 1].map(|axis| match domain.sides[axis] {
            // An open side need not be divided evenly: just below the bound.
            BoxSide::Open => bound * (1.0 - 1e-9),
            _ => domain.length(axis) / cells[axis] as f64,
        });
        ExclusiveGridSize { cells, edge }
    }

    /// Column or row of the cell at a distance from the lower end (length).
    pub(crate) fn along(&self, axis: usize, from_low: f64) -> usize {
        ((from_low / self.edge[axis]) as usize).min(self.cells[axis] - 1)
    }

    /// Centre of a cell along an axis, from the lower end (length).
    pub(super) fn centre(&self, axis: usize, cell: usize) -> f64 {
        (cell as f64 + 0.5) * self.edge[axis]
    }

    /// Distance within which a mask contains every other disc (length): r_NL.
    pub(crate) fn reach(&self, mask: &Mask) -> f64 {
        f64::from(mask.reach_squared()).sqrt() * self.edge[0].min(self.edge[1])
    }

    /// True if periodic sides have enough cells for a mask not to overlap itself.
    pub(crate) fn is_wide_enough(&self, domain: &Domain, mask: &Mask) -> bool {
        let least = 2 * mask.half_width() as usize + 1;
        (0..2).all(|axis| !domain.is_periodic(axis) || self.cells[axis] >= least)
    }
}

/// Assignment of discs to cells. It holds until the next fill, unless discs cross their cells by events of their own.
pub(crate) trait DiscCells: Send {
    /// True if discs cross their cells by events of their own.
    const HAS_CROSSINGS: bool = false;

    /// Assigns every disc, in the order of their numbers, to the cell of its position inside the box (length).
    ///
    /// # Errors
    /// [`CellMisfit`] if two discs share a cell or one is too high.
    fn fill(&mut self, places: impl Iterator<Item = [f64; 2]>) -> Result<(), CellMisfit>;

    /// Centre of the cell of a disc (length). Filling the cells with the centres assigns the same cells.
    fn centre(&self, disc: u32) -> [f64; 2];

    /// Visits the discs in the cells around a disc and in its own.
    fn for_each_around(&self, disc: u32, visit: impl FnMut(u32));

    /// Name and value of the cells for the summary of a run.
    fn figure(&self) -> (&'static str, f64);

    /// Predicts when a disc leaves its cell, after its motion or its cell has changed at `now` (time).
    fn predict_crossing(&mut self, _arena: &Arena, _number: u32, _disc: &FlyingDisc, _now: f64) {}

    /// Time at which a disc leaves its cell; infinite if cells hold until the next fill.
    fn crossing_time(&self, _disc: u32) -> f64 {
        f64::INFINITY
    }

    /// Moves a disc to the cell that it enters at its crossing time.
    fn cross(&mut self, _disc: u32) {}

    /// Visits the discs in the cells around a disc that were not around it before it crossed.
    fn for_each_entered(&self, _disc: u32, _visit: impl FnMut(u32)) {}
}

/// Reason why discs cannot be assigned to cells.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum CellMisfit {
    /// Two discs share a cell.
    Shared([u32; 2]),
    /// A disc is so high that the look-up needs more entries than are allowed.
    TooHigh(u32, usize),
}

/// Grid that stores every cell of a box.
#[derive(Clone, Debug)]
pub(crate) struct ExclusiveGrid {
    domain: Domain,
    sizes: ExclusiveGridSize,
    /// Width of the margin, in cells, that mirrors cells across periodic sides.
    margin: usize,
    width: usize,
    /// Disc in each cell, row by row, including the margins.
    discs: Vec<u32>,
    /// The cell of each disc.
    cell: Vec<u32>,
    /// Offsets from a cell to the cells of its mask.
    offsets: Vec<isize>,
}

impl ExclusiveGrid {
    /// Creates the empty grid of a box, for a mask.
    pub(crate) fn new(domain: Domain, sizes: ExclusiveGridSize, mask: &Mask) -> ExclusiveGrid {
        let margin = mask.half_width() as usize;
        let [width, height] = sizes.cells.map(|cells| cells + 2 * margin);
        let offset = |columns: i32, rows: i32| columns as isize + rows as isize * width as isize;
        ExclusiveGrid {
            domain,
            sizes,
            margin,
            width,
            discs: vec![EMPTY; width * height],
            cell: vec![],
            offsets: mask.offsets().iter().map(|it| offset(it.columns, it.rows)).collect(),
        }
    }

    /// Number of discs.
    pub(super) fn count(&self) -> u32 {
        self.cell.len() as u32
    }

    /// Memory of the arrays (bytes).
    pub(super) fn bytes(&self) -> usize {
        4 * (self.discs.len() + self.cell.len())
    }

    /// Copies cells across periodic sides into the margins.
    fn mirror(&mut self) {
        let ([columns, rows], margin, width) = (self.sizes.cells, self.margin, self.width);
        let is_periodic = |axis: usize| matches!(self.domain.sides[axis], BoxSide::Periodic(_));
        if is_periodic(0) {
            for row in self.discs.chunks_exact_mut(width) {
                row.copy_within(columns..columns + margin, 0);
                row.copy_within(margin..2 * margin, columns + margin);
            }
        }
        if is_periodic(1) {
            self.discs.copy_within(rows * width..(rows + margin) * width, 0);
            self.discs.copy_within(margin * width..2 * margin * width, (rows + margin) * width);
        }
    }
}

impl DiscCells for ExclusiveGrid {
    fn fill(&mut self, places: impl Iterator<Item = [f64; 2]>) -> Result<(), CellMisfit> {
        self.discs.fill(EMPTY);
        self.cell.clear();
        for (number, at) in places.enumerate() {
            let [column, row] =
                [0, 1].map(|axis| self.sizes.along(axis, at[axis] - self.domain.origin[axis]) + self.margin);
            let cell = row * self.width + column;
            if self.discs[cell] != EMPTY {
                return Err(CellMisfit::Shared([self.discs[cell], number as u32]));
            }
            self.discs[cell] = number as u32;
            self.cell.push(cell as u32);
        }
        self.mirror();
        Ok(())
    }

    fn centre(&self, disc: u32) -> [f64; 2] {
        let cell = self.cell[disc as usize] as usize;
        let cell = [cell % self.width, cell / self.width].map(|along| along - self.margin);
        [0, 1].map(|axis| self.domain.origin[axis] + self.sizes.centre(axis, cell[axis]))
    }

    #[inline(always)]
    fn for_each_around(&self, disc: u32, visit: impl FnMut(u32)) {
        let cell = self.cell[disc as usize] as usize;
        let there = |&offset: &isize| self.discs[cell.wrapping_add_signed(offset)];
        self.offsets.iter().map(there).filter(|&other| other != EMPTY).for_each(visit);
    }

    /// Mean number of discs per cell.
    fn figure(&self) -> (&'static str, f64) {
        let [columns, rows] = self.sizes.cells;
        ("occupancy", self.cell.len() as f64 / (columns * rows) as f64)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::RngExt;
    use stripmine_kernels::noise::{RandomPurpose, Stream};

    /// Random discs: the mask contains every disc within its reach, also across periodic sides.
    #[test]
    fn masks_cover_everything_within_reach() {
        let mut stream = Stream::new(11, RandomPurpose::Test, 0);
        for (periodic, mask) in [
            ([true, true], Mask::square(2)),
            ([true, false], Mask::round(3)),
            ([false, false], Mask::round(5)),
        ] {
            let domain = Domain::planar([-1.0, 2.0], [14.0, 11.3], periodic);
            let sizes = ExclusiveGridSize::new(&domain, 0.5);
            assert!(
                sizes.is_wide_enough(&domain, &mask)
                    && sizes.edge.iter().all(|edge| *edge < 0.5 * 2f64.sqrt())
            );
            let mut discs: Vec<[f64; 2]> = vec![];
            while discs.len() < 60 {
                let at =
                    [0, 1].map(|axis| domain.origin[axis] + stream.random_range(0.0..domain.length(axis)));
                if discs.iter().all(|other| domain.distance(*other, at) > 1.0) {
                    discs.push(at);
                }
            }
            let mut grid = ExclusiveGrid::new(domain, sizes, &mask);
            grid.fill(discs.iter().copied()).unwrap();
            for (number, here) in discs.iter().enumerate() {
                let mut seen = vec![];
                grid.for_each_around(number as u32, |other| seen.push(other));
                for (other, there) in discs.iter().enumerate().filter(|(other, _)| *other != number) {
                    let distance = domain.distance(*here, *there);
                    assert!(distance >= sizes.reach(&mask) || seen.contains(&(other as u32)), "{distance}");
                }
            }
        }
    }

    #[test]
    fn shared_cells_are_reported() {
        let domain = Domain::planar([0.0; 2], [10.0; 2], [true; 2]);
        let mut grid = ExclusiveGrid::new(domain, ExclusiveGridSize::new(&domain, 0.5), &Mask::square(2));
        let places = [[5.0, 5.0], [1.0, 1.0], [5.01, 5.01]];
        assert_eq!(grid.fill(places.into_iter()), Err(CellMisfit::Shared([0, 2])));
    }
}
