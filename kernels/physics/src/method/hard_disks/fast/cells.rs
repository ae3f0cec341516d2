//! Cells of the registered positions: slots side by side, so that two neighbouring cells are compared in two registers.
//!
//! A cell is two ranges of sight wide and one high. A disc in its left half sees into the cell on the left, a disc in its right half into
//! the one on the right. Compared with three square cells in a row, as many slots are compared and a quarter less are stored: a wide cell
//! has relatively fewer discs more than the mean.
//!
//! A slot stores the position relative to the centre of its cell in single precision: its error is below 1e-7 of an edge in a box of
//! any size. Across a periodic side the neighbouring cell is the first or last one, and relative positions need no correction.

use crate::domain::{BoxSide, Domain};
use stripmine_kernels::backend::Registers;
use stripmine_kernels::isa::{AlignedColumn, Vector};

/// Maximum number of neighbours found around a disc, more than a list holds.
pub(super) const FOUND: usize = 128;

/// Slots of a cell are a multiple of this. On average a cell of equal discs fills six of them.
const SLOTS: usize = 12;
/// Slots that are compared together: those of two cells of equal discs.
const ABREAST: usize = 2 * SLOTS;
/// Slots beyond those of two cells that whole registers load.
const BEYOND: usize = 8;
/// Slots for each disc that a cell has on average.
const SPARE: f64 = 1.75;
/// Width and height of a cell, in ranges of sight.
const SIGHTS: [f64; 2] = [2.0, 1.0];
/// Marks an empty slot.
const EMPTY: u32 = u32::MAX;
/// Position in an empty slot: far from any disc, and its square is finite.
const FAR: f32 = 1e18;
/// Relative margin for positions in single precision.
const MARGIN: f64 = 4e-6;

/// Cells of the registered positions, row by row. A row begins and ends with a copy of the cell at its other end. Cells wrap around
/// the grid, except along a closed side, so an infinite side needs no more cells.
#[derive(Clone, Debug)]
pub(super) struct RegistrationCells {
    counts: [usize; 2],
    edge: [f64; 2],
    /// Slots of a cell: many if small discs are in cells of large ones.
    slots: usize,
    /// True for an axis along which the grid wraps around.
    wraps: [bool; 2],
    /// True if discs in neighbouring cells may be far apart, because an infinite side wraps around the grid.
    is_approximate: bool,
    /// Square of the distance within which discs are found (length²).
    near: f32,
    /// Relative positions in the slots (length).
    x: AlignedColumn<f32>,
    y: AlignedColumn<f32>,
    /// Discs in the slots.
    discs: AlignedColumn<u32>,
    /// Discs of each row of cells that found no slot.
    crowded: Vec<Vec<(u32, [f64; 2])>>,
    /// Offset of the cell of each slot, of the cells on the left, in the middle and on the right (length).
    offsets: AlignedColumn<f32>,
}

/// Cell of a position.
struct CellPosition {
    /// Column and row.
    cell: [usize; 2],
    /// Position relative to the centre of the cell (length).
    relative: [f32; 2],
}

impl RegistrationCells {
    /// Creates empty cells that find discs within `sight` (length).
    pub(super) fn new(domain: &Domain, count: usize, sight: f64) -> RegistrationCells {
        let most = (count as f64).sqrt().max(8.0);
        let least = SIGHTS.map(|sights| sights * sight);
        let counts = [0, 1].map(|axis| match domain.sides[axis] {
            // Lists without discs take no memory.
            _ if count == 0 => 1,
            BoxSide::Open | BoxSide::Flat => (most / SIGHTS[axis]) as usize,
            BoxSide::Periodic(side) | BoxSide::Closed(side) => ((side / least[axis]) as usize).max(1),
        });
        let edge = [0, 1].map(|axis| match domain.sides[axis] {
            BoxSide::Open | BoxSide::Flat => least[axis],
            BoxSide::Periodic(side) | BoxSide::Closed(side) => side / counts[axis] as f64,
        });
        let mean = count as f64 / (counts[0] * counts[1]) as f64;
        let slots = ((SPARE * mean) as usize).max(1).next_multiple_of(SLOTS);
        let all = (counts[0] + 2) * counts[1] * slots + BEYOND;
        let offsets = (0..3 * slots + BEYOND).map(|slot| (((slot / slots) as f64 - 1.0) * edge[0]) as f32);
        RegistrationCells {
            counts,
            edge,
            wraps: [0, 1].map(|axis| !matches!(domain.sides[axis], BoxSide::Closed(_))),
            is_approximate: (0..2).any(|axis| matches!(domain.sides[axis], BoxSide::Open | BoxSide::Flat)),
            near: (sight * sight * (1.0 + MARGIN)) as f32,
            slots,
            x: AlignedColumn::filled(12, FAR, all),
            y: AlignedColumn::filled(13, FAR, all),
            discs: AlignedColumn::filled(14, EMPTY, all),
            crowded: vec![vec![]; counts[1]],
            offsets: AlignedColumn::new(15, offsets),
        }
    }

    /// True if discs may be found that are far away.
    #[inline(always)]
    pub(super) fn is_approximate(&self) -> bool {
        self.is_approximate
    }

    /// Finds the discs within sight of a position inside the box, and perhaps some that are slightly farther, that pass a test, and adds
    /// them to the first `count`. Returns their number; none if there are too many.
    #[inline(always)]
    pub(super) fn find<R: Registers<Lane = f32>>(
        &self,
        registers: R,
        domain: &Domain,
        position: [f64; 2],
        is_near: impl Fn(u32) -> bool,
        found: &mut [u32; FOUND],
        mut count: usize,
    ) -> Option<usize> {
        let CellPosition { cell: [column, row], relative: [own_x, own_y] } = self.locate(domain, position);
        let (near, x) = (registers.splat(self.near), registers.splat(own_x));
        let left = self.slots_on_the_left(own_x);
        for step in [-1, 0, 1] {
            let Some(row) = self.neighbouring_row(row, step) else { continue };
            let first = self.slot([column, row]) - left;
            let y = registers.splat(own_y - step as f32 * self.edge[1] as f32);
            for start in (0..2 * self.slots).step_by(ABREAST) {
                let mut bits = 0;
                for begin in (start..start + ABREAST).step_by(R::LANES) {
                    // SAFETY: a row of cells is followed by another one or by as many slots as are loaded, and there are as many
                    // offsets: a register has at most sixteen lanes.
                    let [offset, there_x, there_y] = unsafe {
                        [
                            registers.load(self.offsets.as_ptr().add(self.slots - left + begin)),
                            registers.load(self.x.as_ptr().add(first + begin)),
                            registers.load(self.y.as_ptr().add(first + begin)),
                        ]
                    };
                    let (dx, dy) = ((there_x + offset) - x, there_y - y);
                    bits |= registers.bits((dx * dx + dy * dy).less_than(near)) << (begin - start);
                }
                bits &= (1 << ABREAST) - 1;
                if count + ABREAST > FOUND {
                    return None;
                }
                while bits != 0 {
                    found[count] = self.discs[first + start + bits.trailing_zeros() as usize];
                    count += usize::from(is_near(found[count]));
                    bits &= bits - 1;
                }
            }
            for &(disc, there) in &self.crowded[row] {
                if count == FOUND {
                    return None;
                }
                let [dx, dy] = domain.displacement(position, there);
                found[count] = disc;
                count += usize::from((dx * dx + dy * dy) as f32 <= self.near && is_near(disc));
            }
        }
        Some(count)
    }

    /// Finds the discs within a reach (length) of a position inside the box, which may be beyond the neighbouring cells, that pass a test; the test
    /// is exact. Adds them to the first `count`, and returns their number; none if there are too many.
    pub(super) fn find_beyond(
        &self,
        domain: &Domain,
        position: [f64; 2],
        reach: f64,
        is_near: impl Fn(u32) -> bool,
        found: &mut [u32; FOUND],
        mut count: usize,
    ) -> Option<usize> {
        let CellPosition { cell, .. } = self.locate(domain, position);
        let [columns, rows] = [0, 1].map(|axis| self.within(axis, cell[axis], reach));
        for row in rows {
            for column in columns.clone() {
                let first = self.slot([column, row]);
                let slots = self.discs[first..first + self.slots].iter().filter(|disc| **disc != EMPTY);
                for &disc in slots.filter(|disc| is_near(**disc)) {
                    *found.get_mut(count)? = disc;
                    count += 1;
                }
            }
            for &(disc, _) in self.crowded[row].iter().filter(|(disc, _)| is_near(*disc)) {
                *found.get_mut(count)? = disc;
                count += 1;
            }
        }
        Some(count)
    }

    /// Columns or rows of the cells within a reach of a cell, each once.
    fn within(&self, axis: usize, cell: usize, reach: f64) -> impl Iterator<Item = usize> + Clone + use<> {
        let (count, cell, wraps) = (self.counts[axis] as isize, cell as isize, self.wraps[axis]);
        let most = (reach / self.edge[axis]).ceil() as isize;
        let (first, last) = match 2 * most + 1 < count {
            true => (cell - most, cell + most),
            false => (0, count - 1),
        };
        let is_there = move |at: &isize| wraps || (0..count).contains(at);
        (first..=last).filter(is_there).map(move |at| at.rem_euclid(count) as usize)
    }

    /// Prefetches the cache lines that a search around a position reads.
    #[inline(always)]
    pub(super) fn prefetch(&self, domain: &Domain, position: [f64; 2]) {
        let CellPosition { cell: [column, row], relative: [own_x, _] } = self.locate(domain, position);
        for row in [-1, 0, 1].into_iter().filter_map(|step| self.neighbouring_row(row, step)) {
            let first = self.slot([column, row]) - self.slots_on_the_left(own_x);
            // Two cells are in up to three cache lines.
            for slot in [first, first + SLOTS, first + ABREAST - 1] {
                self.x.prefetch(slot);
                self.y.prefetch(slot);
                self.discs.prefetch(slot);
            }
        }
    }

    /// Adds a disc at a position inside the box.
    #[inline(always)]
    pub(super) fn add(&mut self, domain: &Domain, disc: u32, position: [f64; 2]) {
        let CellPosition { cell, relative } = self.locate(domain, position);
        match self.slot_of(cell, EMPTY) {
            Some(slot) => self.set(cell, slot, disc, relative),
            None => self.crowded[cell[1]].push((disc, position)),
        }
    }

    /// Removes a disc that was added at a position.
    #[inline(always)]
    pub(super) fn remove(&mut self, domain: &Domain, disc: u32, position: [f64; 2]) {
        let CellPosition { cell, .. } = self.locate(domain, position);
        match self.slot_of(cell, disc) {
            Some(slot) => self.set(cell, slot, EMPTY, [FAR; 2]),
            None => self.crowded[cell[1]].retain(|&(other, _)| other != disc),
        }
    }

    #[inline(always)]
    fn locate(&self, domain: &Domain, position: [f64; 2]) -> CellPosition {
        let [column, row] = [0, 1].map(|axis| {
            let (count, edge, wraps) = (self.counts[axis], self.edge[axis], self.wraps[axis]);
            // No position is below the origin of the box.
            let along = position[axis] - domain.origin[axis];
            let at = (along / edge) as usize;
            let at = if at >= count && !wraps { count - 1 } else { at };
            let relative = (along - (at as f64 + 0.5) * edge) as f32;
            // Usually inside.
            (if at < count { at } else { at % count }, relative)
        });
        CellPosition { cell: [column.0, row.0], relative: [column.1, row.1] }
    }

    /// Row next to another one, if there is one.
    #[inline(always)]
    fn neighbouring_row(&self, row: usize, step: isize) -> Option<usize> {
        let (count, next) = (self.counts[1] as isize, row as isize + step);
        if (0..count).contains(&next) {
            return Some(next as usize);
        }
        self.wraps[1].then(|| next.rem_euclid(count) as usize)
    }

    /// Slots before those of a disc's cell that the disc sees: all of the cell on the left from the left half, none from the right one.
    #[inline(always)]
    fn slots_on_the_left(&self, own_x: f32) -> usize {
        if own_x < 0.0 { self.slots } else { 0 }
    }

    /// First slot of a cell.
    #[inline(always)]
    fn slot(&self, [column, row]: [usize; 2]) -> usize {
        (row * (self.counts[0] + 2) + column + 1) * self.slots
    }

    /// Slot of a cell that holds a disc or is empty.
    #[inline(always)]
    fn slot_of(&self, cell: [usize; 2], disc: u32) -> Option<usize> {
        let first = self.slot(cell);
        let slots = &self.discs[first..first + self.slots];
        if slots.len() > SLOTS {
            return slots.iter().position(|&other| other == disc);
        }
        // No branch for each slot: the index is unpredictable.
        let bits = (0..SLOTS).fold(0_u32, |bits, slot| bits | u32::from(slots[slot] == disc) << slot);
        (bits != 0).then(|| bits.trailing_zeros() as usize)
    }

    /// Writes a slot of a cell, and of its copy at the other end of the row.
    #[inline(always)]
    fn set(&mut self, cell: [usize; 2], slot: usize, disc: u32, [x, y]: [f32; 2]) {
        let at = self.slot(cell) + slot;
        (self.x[at], self.y[at], self.discs[at]) = (x, y, disc);
        let [column, _] = cell;
        if self.wraps[0] && (column == 0 || column + 1 == self.counts[0]) {
            let length = self.counts[0] * self.slots;
            for (end, copy) in [(0, at + length), (self.counts[0] - 1, at - length.min(at))] {
                if column == end {
                    (self.x[copy], self.y[copy], self.discs[copy]) = (x, y, disc);
                }
            }
        }
    }
}
