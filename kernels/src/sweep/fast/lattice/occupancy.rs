//! Assignment of discs to cells: the Index, updated with the discs that change cells, and positions inside cells.

use super::bits::CellBits;
use crate::GROUP;
use crate::backend::coordinate_pair;
use crate::isa::AlignedColumn;
use crate::sweep::fast::advance::PositionCopies;
use crate::sweep::fast::grid::CellGrid;
use crate::sweep::fast::pairs::SENTINELS;
use crate::sweep::lattice::{LatticeFrame, LatticeShape};

/// Error: the cell belongs to another disc.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("disc {0} is already in that cell; a cell holds one disc")]
pub struct CellTaken(pub usize);

/// Coordinates of the largest contact distance, if cells are not wider than that.
const REACH: f64 = 8192.0;

/// Largest distance of an own disc from the centre of a partner's cell. The difference to a partner's position then fits 16 bits,
/// and an empty cell is farther away than a contact.
const FARTHEST: f64 = 24_000.0;

/// Coordinates by which a distance may be too large after rounding: half of one for each of two positions and an offset, along both
/// axes.
const ROUNDING: f64 = 3.0;

/// The position of an empty cell, from which nothing is near.
const EMPTY: u32 = coordinate_pair(i16::MAX, 0);

/// Alignment numbers of the columns, which place them on cache lines of their own; the discs' columns have smaller numbers.
const INDEX: usize = 32;
const RADIUS: usize = 33;
const POSITION: usize = 34;

/// Positions of empty cells.
fn empty_positions(cells: usize) -> AlignedColumn<u32> {
    AlignedColumn::filled(POSITION, EMPTY, cells)
}

/// Fraction of occupied cells below which comparing registers of cells does not pay: then each disc looks for its neighbours
/// alone. It is a constant, so that the order of every sum depends on the scene alone.
pub const SPARSE: f64 = 0.15;

/// Assignment of discs to cells. Where the lattice is not sparse, it also stores each disc's position in its cell and its radius.
///
/// These lengths are 16-bit integers, in units of 1/8192 of the largest contact distance, or more if cells are wider: good for finding contacts, not for forces.
/// Every disc is in at most one cell, and every cell has at most one disc.
#[derive(Clone, Debug)]
pub struct Occupancy {
    shape: LatticeShape,
    frame: LatticeFrame,
    half_width: usize,
    /// Largest contact distance (length).
    reach: f64,
    /// Coordinates per length.
    unit: f64,
    discs: usize,
    cell: Vec<u32>,
    index: AlignedColumn<u32>,
    sparse: bool,
    /// Pairs of coordinates by cell.
    position: AlignedColumn<u32>,
    /// Radii by cell, rounded up, as pairs with 0.
    radius: Option<AlignedColumn<u32>>,
    occupied: CellBits,
    /// Halo cells, each with the cell that it repeats.
    images: Vec<[u32; 2]>,
    /// Number of discs in no cell.
    outside: usize,
    /// Discs in cells that belong to another disc, with these cells.
    shared: Vec<(u32, [usize; 2])>,
}

/// Cell number of a disc in no cell.
const NOWHERE: u32 = u32::MAX;

impl Occupancy {
    /// An empty lattice for `discs` discs that touch when their centres are `reach` (length) apart; where radii vary, `reach` is
    /// the largest such distance.
    ///
    /// # Panics
    /// If there are 2³² − 3 discs or more, or the mask is neither 5×5 nor 7×7.
    pub fn new(shape: LatticeShape, frame: LatticeFrame, discs: usize, reach: f64, vary: bool) -> Self {
        assert!(
            discs < u32::MAX as usize - SENTINELS,
            "{discs} discs are too many to number: a lattice holds fewer than 2^32 − 3"
        );
        let half_width = (shape.stride() - shape.columns()) / 2;
        assert!(
            (2..=3).contains(&half_width),
            "no search for a mask of half-width {half_width}: masks of 5×5 and 7×7 cells are supported"
        );
        let farthest = frame.edge[0].max(frame.edge[1]) * (half_width as f64 + 0.5);
        // The last register of the last row may extend beyond the padded lattice.
        let length = shape.padded() + GROUP + 1;
        let sparse = (discs as f64) < SPARSE * shape.cells() as f64;
        let stored = if sparse { 0 } else { length };
        Occupancy {
            frame,
            half_width,
            reach,
            unit: (REACH / reach).min(FARTHEST / farthest),
            discs,
            cell: vec![NOWHERE; discs],
            index: AlignedColumn::filled(INDEX, discs as u32, length),
            sparse,
            position: empty_positions(stored),
            radius: (vary && !sparse).then(|| AlignedColumn::filled(RADIUS, 0, length)),
            occupied: CellBits::new(&shape, half_width),
            images: shape
                .images()
                .iter()
                .map(|image| [image.cell, image.source].map(|at| at as u32))
                .collect(),
            outside: discs,
            shared: vec![],
            shape,
        }
    }

    /// Empty copy of the lattice for `discs` discs, sparse if this one is.
    ///
    /// # Panics
    /// If there are 2³² − 3 discs or more.
    #[inline]
    pub fn empty_copy(&self, discs: usize) -> Self {
        assert!(
            discs < u32::MAX as usize - SENTINELS,
            "{discs} discs are too many to number: a lattice holds fewer than 2^32 − 3"
        );
        Occupancy {
            discs,
            cell: vec![NOWHERE; discs],
            index: AlignedColumn::filled(INDEX, discs as u32, self.index.len()),
            position: empty_positions(self.position.len()),
            radius: self.radius.as_ref().map(|radius| AlignedColumn::filled(RADIUS, 0, radius.len())),
            occupied: CellBits::new(&self.shape, self.half_width),
            images: self.images.clone(),
            outside: discs,
            shared: vec![],
            ..*self
        }
    }

    /// Shape of the lattice.
    #[inline]
    pub fn shape(&self) -> &LatticeShape {
        &self.shape
    }

    /// Grid of its cells.
    #[inline]
    pub fn grid(&self) -> CellGrid {
        let counts = [self.shape.columns(), self.shape.rows()];
        CellGrid { frame: self.frame, counts, periodic: self.shape.periodic() }
    }

    /// Number of discs.
    #[inline]
    pub fn discs(&self) -> usize {
        self.discs
    }

    /// Column and row of a disc; `None` if it is in no cell.
    #[inline]
    pub fn cell(&self, disc: usize) -> Option<[usize; 2]> {
        let cell = self.cell[disc];
        if cell == self.spare_cell() {
            return self.shared.iter().find(|shared| shared.0 as usize == disc).map(|shared| shared.1);
        }
        (cell != NOWHERE).then(|| self.column_and_row(cell as usize))
    }

    /// Spare cell behind the lattice. Copies of the positions of discs in shared cells are written there and never read.
    #[inline]
    fn spare_cell(&self) -> u32 {
        self.index.len() as u32 - 1
    }

    /// The disc in a cell of the lattice.
    #[inline]
    pub fn disc(&self, column: usize, row: usize) -> Option<usize> {
        let disc = self.index[self.shape.position(column as isize, row as isize)] as usize;
        (disc < self.discs).then_some(disc)
    }

    #[inline]
    fn column_and_row(&self, position: usize) -> [usize; 2] {
        let from_first = position - self.shape.position(0, 0);
        [from_first % self.shape.stride(), from_first / self.shape.stride()]
    }

    /// Places a disc of some radius (length) in a cell, at a position relative to the cell's centre (length).
    ///
    /// # Errors
    /// [`CellTaken`] if another disc is there; nothing has changed then.
    ///
    /// # Panics
    /// If the disc is already in a cell, or there is no such disc or cell.
    pub fn enter(
        &mut self,
        disc: usize,
        cell: [usize; 2],
        position: [f64; 2],
        radius: f64,
    ) -> Result<(), CellTaken> {
        assert!(self.cell[disc] == NOWHERE, "disc {disc} is already in a cell");
        assert!(
            cell[0] < self.shape.columns() && cell[1] < self.shape.rows(),
            "no cell {cell:?} in this lattice"
        );
        let at = self.shape.position(cell[0] as isize, cell[1] as isize);
        if self.index[at] as usize != self.discs {
            return Err(CellTaken(self.index[at] as usize));
        }
        self.cell[disc] = at as u32;
        self.outside -= 1;
        self.index[at] = disc as u32;
        if let Some(radii) = &mut self.radius {
            radii[at] = coordinate_pair((radius * self.unit).ceil() as i16, 0);
        }
        self.update_position(disc, position);
        self.occupied.set(at, true);
        Ok(())
    }

    /// Places a disc in a cell that belongs to another disc. The list of such discs stays in order of `number`.
    ///
    /// # Panics
    /// If the disc is already in a cell, or there is no such disc or cell.
    #[inline]
    pub fn share(&mut self, disc: usize, cell: [usize; 2], number: impl Fn(usize) -> usize) {
        assert!(self.cell[disc] == NOWHERE, "disc {disc} is already in a cell");
        assert!(
            cell[0] < self.shape.columns() && cell[1] < self.shape.rows(),
            "no cell {cell:?} in this lattice"
        );
        self.cell[disc] = self.spare_cell();
        self.outside -= 1;
        let own = number(disc);
        let before = self.shared.iter().take_while(|shared| number(shared.0 as usize) < own).count();
        self.shared.insert(before, (disc as u32, cell));
    }

    /// Discs in cells that belong to another disc, with these cells.
    #[inline]
    pub fn shared_cells(&self) -> &[(u32, [usize; 2])] {
        &self.shared
    }

    /// Removes a disc from its cell, if it is in one.
    pub fn leave(&mut self, disc: usize) {
        if self.cell[disc] == NOWHERE {
            return;
        }
        self.outside += 1;
        if self.cell[disc] == self.spare_cell() {
            self.cell[disc] = NOWHERE;
            return self.shared.retain(|shared| shared.0 as usize != disc);
        }
        let at = self.cell[disc] as usize;
        self.cell[disc] = NOWHERE;
        self.index[at] = self.discs as u32;
        if !self.sparse {
            self.position[at] = EMPTY;
        }
        if let Some(radii) = &mut self.radius {
            radii[at] = 0;
        }
        self.occupied.set(at, false);
    }

    /// Moves a disc inside its cell.
    ///
    /// # Panics
    /// If the disc is in no cell.
    #[inline]
    pub fn update_position(&mut self, disc: usize, position: [f64; 2]) {
        let at = self.cell[disc] as usize;
        assert!(at < self.index.len(), "disc {disc} is in no cell");
        if self.sparse {
            return;
        }
        let [x, y] = position.map(|along| (along * self.unit).round_ties_even() as i16);
        self.position[at] = coordinate_pair(x, y);
    }

    /// Copies the cells at periodic sides to the halo.
    pub fn repeat_images(&mut self) {
        for &[cell, source] in &self.images {
            let [cell, source] = [cell, source].map(|at| at as usize);
            let disc = self.index[source];
            // Positions change with every step, occupants rarely.
            if self.index[cell] != disc {
                self.index[cell] = disc;
                self.occupied.set(cell, (disc as usize) < self.discs);
            }
            if !self.sparse {
                self.position[cell] = self.position[source];
            }
            if let Some(radii) = &mut self.radius {
                radii[cell] = radii[source];
            }
        }
    }

    /// The discs in order of their cells, row by row; those in shared cells come last.
    pub fn order(&self) -> Vec<u32> {
        let rows = (0..self.shape.rows() as isize).map(|row| self.shape.position(0, row));
        rows.flat_map(|first| &self.index[first..first + self.shape.columns()])
            .copied()
            .filter(|&disc| (disc as usize) < self.discs)
            .chain(self.shared.iter().map(|shared| shared.0))
            .collect()
    }

    /// Renumbers the discs: the new disc `n` is the old disc `order[n]`.
    ///
    /// # Panics
    /// If `order` does not name every disc once.
    pub fn renumber(&mut self, order: &[u32]) {
        let old = std::mem::replace(&mut self.cell, vec![NOWHERE; self.discs]);
        assert_eq!(order.len(), self.discs, "the order must have one entry per disc");
        let mut now = vec![NOWHERE; self.discs];
        let spare_cell = self.spare_cell();
        for (disc, &before) in order.iter().enumerate() {
            let before = before as usize;
            let first = std::mem::replace(&mut now[before], disc as u32) == NOWHERE;
            assert!(first, "disc {before} is named twice");
            self.cell[disc] = old[before];
            if old[before] != NOWHERE && old[before] != spare_cell {
                self.index[old[before] as usize] = disc as u32;
            }
        }
        self.shared.iter_mut().for_each(|shared| shared.0 = now[shared.0 as usize]);
        self.repeat_images();
    }

    /// Largest contact distance (length).
    #[inline]
    pub(super) fn reach(&self) -> f64 {
        self.reach
    }

    /// Coordinates beyond the contact distance at which a pair is found that may be farther apart than a contact by a fraction of it.
    #[inline]
    pub(super) fn beyond(&self, slack: f64) -> f64 {
        (self.reach * self.unit * slack + ROUNDING).ceil().min(FARTHEST)
    }

    /// Square of the coordinates within which such a pair of the largest discs is found.
    #[inline]
    pub(super) fn limit(&self, slack: f64) -> i32 {
        ((self.reach * self.unit).ceil() + self.beyond(slack)).min(FARTHEST).powi(2) as i32
    }

    #[inline]
    pub(super) fn half_width(&self) -> usize {
        self.half_width
    }

    /// Pair of coordinates of an offset, in columns and rows.
    #[inline(always)]
    pub(super) fn offset_pair(&self, offset: [isize; 2]) -> u32 {
        let along =
            |axis: usize| (offset[axis] as f64 * self.frame.edge[axis] * self.unit).round_ties_even() as i16;
        coordinate_pair(along(0), along(1))
    }

    #[inline]
    pub(super) fn index(&self) -> &[u32] {
        &self.index
    }

    #[inline]
    pub(super) fn positions(&self) -> &[u32] {
        &self.position
    }

    #[inline]
    pub(super) fn radii(&self) -> Option<&[u32]> {
        self.radius.as_deref()
    }

    /// True if so few cells are occupied that positions are not stored.
    #[inline]
    pub(crate) fn is_sparse(&self) -> bool {
        self.sparse
    }

    /// Bits of the occupied cells, images included.
    #[inline]
    pub(super) fn occupied(&self) -> &CellBits {
        &self.occupied
    }

    /// Copies that a pass over the discs must update; `None` if the lattice is sparse.
    ///
    /// # Panics
    /// If a disc is in no cell.
    #[inline]
    pub fn copies(&mut self) -> Option<PositionCopies<'_>> {
        assert!(self.outside == 0, "{} discs are in no cell", self.outside);
        let (cells, unit) = (&self.cell, self.unit);
        (!self.sparse).then_some(PositionCopies { cells, positions: &mut self.position, unit })
    }
}
