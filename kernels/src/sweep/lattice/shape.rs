//! Shape of a lattice, and the positions of its cells in memory.

use crate::GROUP;
use crate::mask::{Mask, Offset};
use std::ops::Range;

/// Reasons why a lattice is impossible.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum ShapeError {
    /// A side without cells.
    #[error("a lattice needs at least one column and one row, not {columns}×{rows}")]
    Empty {
        /// Columns requested.
        columns: usize,
        /// Rows requested.
        rows: usize,
    },
    /// A periodic side so short that a pair would be visited twice.
    #[error(
        "a periodic side of {cells} cells is too short for a mask of half-width {half_width}: it needs at least {least}"
    )]
    PeriodicTooShort {
        /// Cells of the side.
        cells: usize,
        /// Half-width of the mask.
        half_width: u32,
        /// Cells needed.
        least: usize,
    },
    /// More cells than an index can number.
    #[error("{columns}×{rows} cells with their halo are more than the 2^32 − 1 that an index numbers")]
    TooMany {
        /// Columns requested.
        columns: usize,
        /// Rows requested.
        rows: usize,
    },
}

/// Position of the lattice in space, and the size of its cells.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LatticeFrame {
    /// Lower left corner (length).
    pub origin: [f64; 2],
    /// Sides of a cell (length).
    pub edge: [f64; 2],
}

/// Reference point of positions on the lattice.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum Coordinates {
    /// From the origin, as in BP93.
    Absolute,
    /// From the centre of the disc's cell: in single precision as precise as the cell is small, and an image is an exact copy.
    #[default]
    CellRelative,
}

/// A halo cell and the cell that it repeats, as positions in the padded lattice.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Image {
    /// Position of the halo cell.
    pub cell: usize,
    /// Position of the cell it repeats.
    pub source: usize,
    /// Number of periods by which the image is to the right and up.
    pub periods: [i32; 2],
}

/// A lattice of `columns × rows` cells with a halo as wide as its mask on every side, stored row by row.
///
/// Lattice vectors are *padded*: `lead` elements, the `swept` ones (all rows, each with the halo at its two ends), and `lead`
/// elements more, so that a shift by any offset of the mask stays inside. Lead and swept length are multiples of `GROUP`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct LatticeShape {
    columns: usize,
    rows: usize,
    half_width: usize,
    periodic: [bool; 2],
}

impl LatticeShape {
    /// A lattice for a mask, with given periodic sides.
    ///
    /// # Errors
    /// [`ShapeError`]: no cells, a periodic side shorter than `2h + 1` cells, or too many cells to number.
    pub fn new(columns: usize, rows: usize, mask: &Mask, periodic: [bool; 2]) -> Result<Self, ShapeError> {
        if columns == 0 || rows == 0 {
            return Err(ShapeError::Empty { columns, rows });
        }
        let half_width = mask.half_width();
        let least = 2 * half_width as usize + 1;
        for (cells, periodic) in [columns, rows].into_iter().zip(periodic) {
            if periodic && cells < least {
                return Err(ShapeError::PeriodicTooShort { cells, half_width, least });
            }
        }
        let shape = LatticeShape { columns, rows, half_width: half_width as usize, periodic };
        let wide = (columns as u128 + 2 * half_width as u128) * (rows as u128 + 4 * half_width as u128 + 2);
        if wide + 4 * GROUP as u128 >= u128::from(u32::MAX) {
            return Err(ShapeError::TooMany { columns, rows });
        }
        Ok(shape)
    }

    /// Cells along x.
    #[inline]
    pub fn columns(&self) -> usize {
        self.columns
    }

    /// Cells along y.
    #[inline]
    pub fn rows(&self) -> usize {
        self.rows
    }

    /// Cells that discs may occupy: LMAX of BP93.
    #[inline]
    pub fn cells(&self) -> usize {
        self.columns * self.rows
    }

    /// True for periodic sides.
    #[inline]
    pub fn periodic(&self) -> [bool; 2] {
        self.periodic
    }

    /// Elements from one row to the next.
    #[inline]
    pub fn stride(&self) -> usize {
        self.columns + 2 * self.half_width
    }

    /// Elements before the first row (and again behind the last).
    #[inline]
    pub(crate) fn lead(&self) -> usize {
        (self.half_width * (self.stride() + 1)).next_multiple_of(GROUP)
    }

    /// Elements that a sweep runs over; their number is the vector length of the forces.
    #[inline]
    pub fn swept(&self) -> Range<usize> {
        let lead = self.lead();
        lead..lead + (self.rows * self.stride()).next_multiple_of(GROUP)
    }

    /// Elements of a lattice vector.
    #[inline]
    pub fn padded(&self) -> usize {
        self.swept().end + self.lead()
    }

    /// Position of a cell in a padded lattice vector. Halo cells have negative or too large columns and rows.
    #[inline]
    pub fn position(&self, column: isize, row: isize) -> usize {
        let from_first = row * self.stride() as isize + self.half_width as isize + column;
        (self.lead() as isize + from_first) as usize
    }

    /// Column and row of the cell at a position in a padded lattice vector. Inverts [`position`](Self::position), except for halo
    /// cells at the end of a row.
    #[inline]
    pub fn column_and_row(&self, position: usize) -> [isize; 2] {
        let from_first = position as isize - self.position(0, 0) as isize;
        let stride = self.stride() as isize;
        [from_first.rem_euclid(stride), from_first.div_euclid(stride)]
    }

    /// Distance in elements from the own cell to the cell at `offset`.
    #[inline]
    pub fn shift(&self, offset: Offset) -> isize {
        offset.rows as isize * self.stride() as isize + offset.columns as isize
    }

    /// Halo cells that repeat a cell of the lattice, in order of their positions.
    pub fn images(&self) -> Vec<Image> {
        let halo = self.half_width as isize;
        let mut images = Vec::new();
        for row in -halo..self.rows as isize + halo {
            for column in -halo..self.columns as isize + halo {
                let periods = [
                    column.div_euclid(self.columns as isize) as i32,
                    row.div_euclid(self.rows as isize) as i32,
                ];
                let repeats = (periods[0] == 0 || self.periodic[0]) && (periods[1] == 0 || self.periodic[1]);
                if periods != [0, 0] && repeats {
                    let home = (column.rem_euclid(self.columns as isize), row.rem_euclid(self.rows as isize));
                    let source = self.position(home.0, home.1);
                    images.push(Image { cell: self.position(column, row), source, periods });
                }
            }
        }
        images
    }

    /// Padded lattice vector that is 1 in the cells of discs and 0 in the halo and the padding.
    #[inline]
    pub fn interior<T: crate::isa::Element>(&self) -> Vec<T> {
        let mut interior = vec![T::from_f64(0.0); self.padded()];
        for row in 0..self.rows as isize {
            let first = self.position(0, row);
            interior[first..first + self.columns].fill(T::from_f64(1.0));
        }
        interior
    }

    /// Padded lattice vector with the x of empty cells: finite, and farther from every disc and every other empty cell than any
    /// contact reaches.
    #[inline]
    pub fn far<T: crate::isa::Element>(&self, frame: LatticeFrame) -> Vec<T> {
        let extent = (0..2)
            .map(|axis| {
                let cells = [self.columns, self.rows][axis] + 2 * self.half_width + 2;
                frame.origin[axis].abs() + 2.0 * cells as f64 * frame.edge[axis]
            })
            .fold(0.0, f64::max);
        // A power of two times a whole number: exact in either precision. In single precision beyond 2^24 cells, neighbouring
        // empty cells may coincide, which spoils only their own, unused sums.
        let unit = (4.0 * extent).log2().ceil().exp2();
        (0..self.padded()).map(|position| T::from_f64(unit * (position + 1) as f64)).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn impossible_lattices_are_rejected() {
        let mask = Mask::square(2);
        assert_eq!(
            LatticeShape::new(0, 3, &mask, [false; 2]),
            Err(ShapeError::Empty { columns: 0, rows: 3 })
        );
        assert_eq!(
            LatticeShape::new(9, 4, &mask, [true; 2]),
            Err(ShapeError::PeriodicTooShort { cells: 4, half_width: 2, least: 5 })
        );
        let (columns, rows) = (1 << 17, 1 << 16);
        assert_eq!(
            LatticeShape::new(columns, rows, &mask, [false; 2]),
            Err(ShapeError::TooMany { columns, rows })
        );
        assert!(LatticeShape::new(5, 5, &mask, [true; 2]).is_ok());
        assert!(LatticeShape::new(1, 1, &mask, [false; 2]).is_ok());
    }

    /// Every cell finds at every offset of the mask exactly the cell that the geometry gives, images included.
    #[test]
    fn shifts_and_images_agree_with_the_geometry() {
        for periodic in [[false, false], [true, false], [false, true], [true, true]] {
            let mask = Mask::square(3);
            let shape = LatticeShape::new(7, 9, &mask, periodic).unwrap();
            let images = shape.images();
            for row in 0..9isize {
                for column in 0..7isize {
                    let own = shape.position(column, row) as isize;
                    for &offset in mask.offsets() {
                        let there = (own + shape.shift(offset)) as usize;
                        let (c, r) = (column + offset.columns as isize, row + offset.rows as isize);
                        assert_eq!(there, shape.position(c, r));
                        let inside = (0..7).contains(&c) && (0..9).contains(&r);
                        let wrapped =
                            (periodic[0] || (0..7).contains(&c)) && (periodic[1] || (0..9).contains(&r));
                        let image = images.iter().find(|image| image.cell == there);
                        assert_eq!(image.is_some(), wrapped && !inside);
                        if let Some(image) = image {
                            assert_eq!(image.source, shape.position(c.rem_euclid(7), r.rem_euclid(9)));
                            assert_eq!(image.periods, [c.div_euclid(7) as i32, r.div_euclid(9) as i32]);
                        }
                    }
                }
            }
        }
    }

    #[test]
    fn shifts_stay_in_the_padded_lattice() {
        for (columns, rows, half_width) in [(1, 1, 2), (5, 3, 2), (16, 1, 3), (1, 40, 3), (33, 17, 2)] {
            let mask = Mask::square(half_width);
            let shape = LatticeShape::new(columns, rows, &mask, [false; 2]).unwrap();
            for &offset in mask.offsets() {
                let shift = shape.shift(offset);
                assert!(shape.lead() as isize + shift >= 0);
                assert!(shape.swept().end as isize + shift <= shape.padded() as isize);
            }
        }
    }

    #[test]
    fn empty_cells_are_far_in_both_precisions() {
        let mask = Mask::square(2);
        let shape = LatticeShape::new(300, 200, &mask, [true; 2]).unwrap();
        let frame = LatticeFrame { origin: [-3.0, 1e3], edge: [0.5, 0.7] };
        let far: Vec<f32> = shape.far(frame);
        let reach = 2.0 * 1e3 + 300.0;
        assert!(far.iter().all(|x| x.is_finite() && *x > 2.0 * reach));
        assert!(far.windows(2).all(|pair| pair[1] - pair[0] > reach));
        assert!(far.iter().all(|x| (x * x).is_finite()));
    }
}
