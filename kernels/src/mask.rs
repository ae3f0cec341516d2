//! Masks: the cells around a cell that are searched for partners.

/// Offset of a cell from the own cell.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Offset {
    /// Columns to the right.
    pub columns: i32,
    /// Rows up.
    pub rows: i32,
}

impl Offset {
    /// Square of the smallest distance between points of the own cell and of this one, in cells².
    #[inline]
    pub(crate) const fn clearance_squared(self) -> u32 {
        let columns = self.columns.unsigned_abs().saturating_sub(1);
        let rows = self.rows.unsigned_abs().saturating_sub(1);
        columns * columns + rows * rows
    }
}

/// A mask: the neighbourhood of a cell, without the cell itself, in a fixed order.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Mask {
    offsets: Vec<Offset>,
    half_width: u32,
}

impl Mask {
    /// The square mask of `(2h + 1)² − 1` cells, numbered ring by ring outwards, each ring counter-clockwise from the right-hand
    /// cell. BP93 fig. 2 for `h = 2`.
    #[inline]
    pub fn square(half_width: u32) -> Mask {
        let mut offsets = Vec::new();
        for ring in 1..=half_width as i32 {
            // Sides of the ring, each from its first cell on: right side up, top left, left side down, bottom right.
            let up = (0..=ring).map(|rows| (ring, rows));
            let left = (-ring..ring).rev().map(|columns| (columns, ring));
            let down = (-ring..ring).rev().map(|rows| (-ring, rows));
            let right = (-ring + 1..=ring).map(|columns| (columns, -ring));
            let rest = (-ring + 1..0).map(|rows| (ring, rows));
            let ring = up.chain(left).chain(down).chain(right).chain(rest);
            offsets.extend(ring.map(|(columns, rows)| Offset { columns, rows }));
        }
        Mask { offsets, half_width }
    }

    /// The round mask of ISO99: the offsets with `i² + j² ≤ R² + R`, ring by ring as [`Mask::square`].
    #[inline]
    pub fn round(radius: u32) -> Mask {
        let bound = (radius * radius + radius) as i32;
        let mut mask = Mask::square(radius);
        mask.offsets.retain(|o| o.columns * o.columns + o.rows * o.rows <= bound);
        mask
    }

    /// Mask of the right-hand cell alone, to measure the cost of one offset. It covers the neighbourhood of no disc.
    #[inline]
    pub fn single_offset() -> Mask {
        Mask { offsets: vec![Offset { columns: 1, rows: 0 }], half_width: 1 }
    }

    /// Offsets in their order; BP93 numbers them from 1.
    #[inline]
    pub fn offsets(&self) -> &[Offset] {
        &self.offsets
    }

    /// Largest distance in columns or rows.
    #[inline]
    pub fn half_width(&self) -> u32 {
        self.half_width
    }

    /// Square of the reach, in cells²: the smallest distance from a point of the own cell to a point outside the mask. All closer
    /// points are covered. ISO99 table 1.
    #[inline]
    pub fn reach_squared(&self) -> u32 {
        let beyond = self.half_width as i32 + 1;
        let own = Offset { columns: 0, rows: 0 };
        (-beyond..=beyond)
            .flat_map(|columns| (-beyond..=beyond).map(move |rows| Offset { columns, rows }))
            .filter(|o| *o != own && !self.offsets.contains(o))
            .map(Offset::clearance_squared)
            .min()
            .unwrap_or(0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// BP93 fig. 2 as printed, top row first.
    #[test]
    fn five_by_five_is_numbered_as_figure_2() {
        let figure = [
            [15, 14, 13, 12, 11],
            [16, 4, 3, 2, 10],
            [17, 5, 0, 1, 9],
            [18, 6, 7, 8, 24],
            [19, 20, 21, 22, 23],
        ];
        let mask = Mask::square(2);
        assert_eq!(mask.offsets().len(), 24);
        for (i, offset) in mask.offsets().iter().enumerate() {
            assert_eq!(figure[(2 - offset.rows) as usize][(offset.columns + 2) as usize], i + 1);
        }
    }

    /// ISO99 table 1: numbers of cells and reach.
    #[test]
    fn round_masks_have_the_printed_sizes_and_reach() {
        let cells = [36, 68, 96, 136, 176, 224, 292, 348];
        let reach_squared = [5, 13, 18, 29, 40, 52, 72, 85];
        for (i, radius) in (3..=10).enumerate() {
            let mask = Mask::round(radius);
            assert_eq!(mask.offsets().len(), cells[i], "R = {radius}");
            assert_eq!(mask.reach_squared(), reach_squared[i], "R = {radius}");
        }
        assert_eq!(Mask::square(2).reach_squared(), 4, "MIN");
        assert_eq!(Mask::square(3).reach_squared(), 9);
        assert_eq!(Mask::square(3).offsets().len(), 48);
    }
}
